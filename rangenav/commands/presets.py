"""`rangenav presets`: what is shipped."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rangenav import preset as presets
from rangenav.commands.output import print_json


def list_presets(*, json: bool = False) -> None:
    """List the shipped presets: name, title, expectation.

    Args:
        json: Print one JSON object.
    """
    shipped = presets.shipped()
    if json:
        rows = {name: {"title": p.title, "story": p.story, "expect": p.expect} for name, p in shipped.items()}
        return print_json({"presets": rows})
    table = Table("preset", "title", "expected")
    for name, p in shipped.items():
        table.add_row(name, Text(p.title), p.expect)
    return Console().print(table)
