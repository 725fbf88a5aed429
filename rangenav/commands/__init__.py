"""The commands of the command line, one file each: a function whose arguments tyro reads from its signature."""
