"""The docks of the page, one file each. A panel that holds a choice of the visitor's has three methods.

write(value)    shows a choice
refresh()       writes on the page what follows from the moved controls, and beside them why a value is invalid
read()          the value of the controls as `refresh` left them, or InvalidInputError; it changes nothing on the page
"""
