"""One signal on the page: its family, and that family's editor. Families not in use keep what was entered."""

from collections.abc import Callable, Mapping
from typing import Any

from explorer.model.conversion import FamilyName, converted, family_of
from explorer.panels.motion.families import Editor, SignalSlot, from_file
from explorer.panels.motion.families.constant import ConstantEditor
from explorer.panels.motion.families.formulas import FlownEditor, FormulaEditor
from explorer.panels.motion.families.from_file import FileSignalEditor
from explorer.panels.motion.families.points import PointsEditor, minimum_snap_editor, waypoints_editor
from explorer.panels.motion.families.polynomials import PolynomialsEditor
from explorer.panels.motion.families.sines import SinesEditor
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form, Section
from rangenav.inputs import Vec3
from rangenav.signals import Multisine, Turning, Waypoint

EDITORS: dict[FamilyName, Callable[[Form, SignalSlot], Any]] = {
    "multisine": SinesEditor,
    "formula": FormulaEditor,
    "waypoints": waypoints_editor,
    "minimum-snap": minimum_snap_editor,
    "polynomials": PolynomialsEditor,
    "constant": ConstantEditor,
    "flown": FlownEditor,
    "given": FileSignalEditor,
}


class SignalEditor:
    """A dropdown of families, and below it the editor of the chosen one; the others are made when first needed."""

    def __init__(
        self, form: Form, place: SignalSlot, words: Mapping[FamilyName, str], *, hint: str, shown: bool = True
    ) -> None:
        self._form, self._place, self._words, self._shown = form, place, words, shown
        self._section = section = Section(form)
        with section:
            self._family = Choice(section, "family", words, hint=hint)
        self._editors: dict[FamilyName, Editor] = {}
        self._held: dict[FamilyName, Turning] = {}
        """The last good signal of each family."""
        self._base: Turning | None = None
        self._kind: FamilyName = next(iter(words))
        self._signal: Turning = Multisine()

    def read(self, duration: float) -> Turning:
        """The signal; another family just chosen starts from its own draft, or from what was there."""
        with self._section.catching():
            kind = self._family.read()
        if kind != self._kind:
            self._switch(kind, duration)
        self._signal = self._held[kind] = self._editors[kind].read()
        return self._signal

    def write(self, signal: Turning, base: Turning | None, drafts: tuple[Turning, ...] = ()) -> None:
        """Show a signal, and keep drafts of others."""
        self._base = base
        self._held = {self._shown_as(draft): draft for draft in drafts}
        kind = self._shown_as(signal)
        self._offer(kind, kind if base is None else self._shown_as(base), *self._held)
        self._family.write(kind, None if base is None else self._shown_as(base))
        for other, held in self._held.items():
            if other != kind and other in self._editors:
                self._editors[other].write(held, self._base_of(other))
        self._show(kind, signal)

    def drafts(self) -> tuple[Turning, ...]:
        """The last good signals of the families not in use, as far as they can be told from constants again."""
        used = self._kind, self._shown_as(self._signal)
        return tuple(held for kind, held in self._held.items() if kind not in used and kind == self._shown_as(held))

    def put(self, signal: Turning) -> None:
        """Show a signal in place of the one that is there; what the preset says stays what it was."""
        self.write(signal, self._base, self.drafts())

    @property
    def signal(self) -> Turning:
        """As last read or written."""
        return self._signal

    @property
    def points(self) -> tuple[Waypoint, ...]:
        """The waypoints, if the family has any."""
        editor = self._editors.get(self._kind)
        return editor.points if isinstance(editor, PointsEditor) else ()

    def move(self, index: int, value: Vec3) -> None:
        """Put a waypoint elsewhere."""
        editor = self._editors.get(self._kind)
        if isinstance(editor, PointsEditor):
            editor.move(index, value)

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._section.show(visible)
        if visible and not self._shown:
            self._shown = True
            self._show(self._kind, self._signal)
        self._shown = visible

    def _switch(self, kind: FamilyName, duration: float) -> None:
        draft = self._held.get(kind)
        if draft is None:
            with self._section.catching():
                try:
                    draft = converted(self._signal, kind, duration)
                except ValueError as error:
                    self._family.show(self._kind)
                    raise ValueError(f"cannot be drawn up as {self._words[kind]}: {error}") from None
        if kind in self._editors and kind in self._held:
            self._editors[self._kind].show(False)  # what was typed in the other is still there, right or wrong
            self._editors[kind].show(True)
            self._kind = kind
        else:
            self._show(kind, draft)

    def _show(self, kind: FamilyName, signal: Turning) -> None:
        """Bring a family's editor forward; while nothing is shown, only note which it will be."""
        self._kind, self._signal = kind, signal
        self._held[kind] = signal
        if not self._shown:
            return
        for other, editor in self._editors.items():
            if other != kind:
                editor.show(False)
        if kind not in self._editors:
            with self._section:
                self._editors[kind] = EDITORS[kind](self._form, self._place)
        self._editors[kind].write(signal, self._base_of(kind))
        self._editors[kind].show(True)

    def _base_of(self, kind: FamilyName) -> Turning | None:
        """What the preset says, if the editor of this family can show it."""
        return self._base if self._base is not None and self._shown_as(self._base) == kind else None

    def _shown_as(self, signal: Turning) -> FamilyName:
        """A Multisine without tones or drift is a constant, where constants can be chosen."""
        still = isinstance(signal, Multisine) and not signal.tones and signal.drift == (0.0, 0.0, 0.0)
        kind = "constant" if still and "constant" in self._words else family_of(signal)
        return kind if kind in self._words else "given"

    def _offer(self, *kinds: FamilyName) -> None:
        """The families there are, and what a file brought if it is none of them."""
        self._family.offer({**self._words, "given": from_file.WORDS} if "given" in kinds else self._words)
