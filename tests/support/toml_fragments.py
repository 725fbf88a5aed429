"""Pieces of text that damage a TOML file: numbers out of range, brackets, quotes, headers, a date."""

TOML_FRAGMENTS = (
    "nan",
    "-inf",
    "0",
    "-1",
    "1e999",
    "9" * 30,
    "[",
    "]",
    "{",
    '"',
    "=",
    "\n",
    "true",
    "[path]",
    "1979-05-27",
)
