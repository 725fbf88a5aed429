"""What the commands print for a person: one file for each report, all of them laid out by `layout`."""
