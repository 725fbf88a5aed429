"""What the palette (Ctrl+K) finds besides the buttons: tabs, plots, presets, exports, every control by its label."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import viser

from explorer.lessons.lesson import Place
from explorer.web import accessibility, cells, inputs, keys, menus
from explorer.web.elements import Step, place_of
from explorer.widgets.form import Form

TABS = ("Learn", "Motion", "World", "Sensors", "Gains", "Presets", "Compare", "Studies", "Export")
KEYS = (
    "Space plays and pauses · ← and → step · Home goes to the start · Ctrl+Z undoes, Ctrl+Shift+Z redoes · "
    "Ctrl+K finds everything · Esc lets go of a handle · on a slider ← and → move the slider"
)


class Commands:
    """The commands of one visitor, and the hints of all labels."""

    def __init__(
        self, client: viser.ClientHandle, form: Form, notify: Callable[[str, str], None], *, in_class: bool = False
    ) -> None:
        """`notify` shows a title and a sentence for a few seconds. in_class: whether there is the tab of a class."""
        self._client, self._form, self._notify = client, form, notify
        hints = {control.name: control.handle.hint for control in self._controls()}
        shown = {label: hint for label, hint in hints.items() if hint}
        inputs.install(client)
        keys.install(client, shown)
        accessibility.install(client, form.hints | shown)
        cells.install(client)
        menus.install(client)
        for tab in (*TABS, *(("Class",) if in_class else ())):
            self._go(f"{tab} tab", [("tab", tab)], "")
        for name in hints:
            form.command(f"Control: {name}", partial(self.go_to_control, name), step=False)
        form.command("Help: keys", partial(notify, "Keys", KEYS), step=False)

    def add_plots(self, groups: Mapping[str, Mapping[str, str]]) -> None:
        """Find plots: the title of each group of plots, and in it the titles of the plots by their names."""
        for group, titles in groups.items():
            self._go(f"{group} tab", [("tab", group)], "")
            for name, title in titles.items():
                self._go(f"Plot: {title}", [("tab", group)], name)
                self._go(f"Export: the plot {title}", [("tab", "Export")], "plot")

    def add_presets(self, titles: Mapping[str, str], open_preset: Callable[[str], None]) -> None:
        """Open a preset; `titles` by their names."""
        for name, title in titles.items():
            self._form.command(f"Preset: {title} ({name})", partial(open_preset, name))

    def add_lessons(self, titles: Mapping[int, str], open_lesson: Callable[[int], None]) -> None:
        """Open a lesson; `titles` by their numbers."""
        for number, title in titles.items():
            self._form.command(f"Lesson {number}: {title}", partial(open_lesson, number))

    def _controls(self) -> list[Any]:
        """The controls of all sections that exist now, the topmost first."""
        return [control for section in self._form.sections for control in section.controls]

    def _go(self, label: str, steps: list[Step], target: str) -> None:
        self._form.command(label, partial(keys.go_to, self._client, steps, target), step=False)

    def go_to_control(self, name: str) -> None:
        """Bring the first control of a name that is on the page into sight, or say that there is none now."""
        places = (place_of(control.handle) for control in self._controls() if control.name == name)
        place = next((steps for steps in places if steps is not None), None)
        if place is None:
            self._notify(f"“{name}” is not shown", "It belongs to a choice that is not made at present.")
        else:
            keys.go_to(self._client, place, name)

    def go_to_place(self, wanted: Place) -> None:
        """Bring the control that a lesson names into sight: one of its label in its folders, or else a button or a row
        of buttons of that name in its tab; the tab at least, if it is not shown now."""
        places = (place_of(control.handle) for control in self._controls() if control.name == wanted.label)
        fitting = (steps for steps in places if steps is not None and wanted.holds(steps, wanted.label))
        around: list[Step] = [("tab", wanted.tab), *(("folder", name) for name in wanted.folders)]
        keys.go_to(self._client, next(fitting, around), wanted.label)
