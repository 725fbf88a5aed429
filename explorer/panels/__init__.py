"""The docks of the page, one file each: `read()` gives what the visitor has chosen, `write(value)` shows a choice."""
