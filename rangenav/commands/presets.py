"""`rangenav presets`: what is shipped."""

from rangenav import preset as presets
from rangenav.commands.output import print_json
from rangenav.commands.text import layout
from rangenav.commands.text import presets as text


def list_presets(*, json: bool = False) -> None:
    """List the shipped presets by what is expected of them.

    Example: rangenav presets

    Args:
        json: Print one JSON object.
    """
    shipped = presets.shipped()
    if json:
        rows = {name: {"title": p.title, "story": p.story, "expect": p.expect} for name, p in shipped.items()}
        return print_json({"presets": rows})
    return layout.show(text.report(shipped))
