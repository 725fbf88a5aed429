"""`rangenav explain` for a person."""

from rangenav.analysis import Analysis
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json, headline
from rangenav.number_format import UNBROKEN, quantity, shortened
from rangenav.observability.horizon import STARTS
from rangenav.preset import Preset

ROTATING = ("turned axes", "axes that do not rotate")
"""How the library's sentence names the axes of the gyro-integrated frame, and how this report names them."""


def report(preset: Preset, analysis: Analysis, explanation: Json, *, name: str, window: float | None = None) -> Report:
    """Why a preset's motion is observable or not; `explanation` is the command's JSON object.

    name, window (s): as the person typed them.
    """
    sign, answer = headline(preset, analysis)
    typed = layout.argument(name)
    same = "" if window is None else f" --window {window:g}"
    twin = (f"explain {typed}{same} --save twin.toml",) if explanation["twin"]["kind"] else ()
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=answer,
        title=preset.title,
        groups=(
            *group("how long to fly", _horizon(explanation["horizon"], preset)),
            *group("what coincides", _functions(explanation["functions"])),
            *group("excitation", shortened(explanation["excitation"]["words"])),
            *group("evil twin", explanation["twin"]["words"]),
            *group("as printed", shortened(explanation["printed"]["words"])),
            *group("frozen in time", explanation["frozen"]["words"].replace(*ROTATING)),
            *layout.next_commands(f"analyze {typed}{same}", *twin),
        ),
    )


def _horizon(horizon: Json, preset: Preset) -> list[str]:
    """From the start of the flight; and in every window, or for the rank at the worst of several starts."""
    needed = quantity(preset.requirement.position_sigma, "m")
    return [
        _lasting("rank 13", horizon["full_rank"], f"at the worst of {STARTS + 1} starts"),
        _lasting(f"an error below {needed}", horizon["accurate"], "in every window"),
    ]


def _lasting(what: str, lengths: Json, where: str) -> str:
    start, worst = lengths["from_start"], lengths["worst"]
    if start is None and worst is None:
        return f"✗ {what}: no window of the flight is long enough"
    from_start = f"{quantity(start, 's')} from the start" if start is not None else "not from the start"
    if worst is None:
        return f"! {what}: {from_start}; {where} no length is enough"
    return f"✓ {what}: {from_start}, {quantity(worst, 's')} {where}"


def _functions(functions: Json) -> list[str]:
    """Which of the 13 functions of a window depend on each other, and what therefore cannot be distinguished."""
    at = quantity(functions["at"], "s")
    if not functions["relations"]:
        return [f"nothing: the 13 functions of the window from {at} are independent"]
    relations, unseen = (
        separator.join(one.replace(" ", UNBROKEN) for one in functions[key])
        for key, separator in (("relations", ", "), ("unseen", "; "))
    )
    return [f"in the window from {at}: {relations}", *([f"unseen: {unseen}"] if unseen else [])]
