"""One signal on the page: the menu of families, and the editor of the family in use.

The editors of the other families are hidden, and their text and values stay as they were typed."""

from collections.abc import Mapping

from explorer.model.conversion import converted
from explorer.panels.motion.families import BY_NAME, FROM_FILE, FROM_FILE_LABEL, family_name
from explorer.panels.motion.families.editor import Editor, SignalSlot
from explorer.panels.motion.families.from_file import FileSignalEditor
from explorer.panels.motion.families.points import PointsEditor
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.inputs import Vec3
from rangenav.signals import AngularVelocity, Multisine, Waypoint


class SignalEditor:
    """A menu of families, and below it the editor of the chosen family. An editor is created at its first use."""

    def __init__(
        self, form: Form, slot: SignalSlot, labels: Mapping[str, str], *, hint: str, visible: bool = True
    ) -> None:
        self._form, self._slot, self._labels, self._visible = form, slot, labels, visible
        self._section = section = Section(form)
        with section:
            self.family_menu = Choice(section, slot.menu, labels, hint=hint)
        self.editors: dict[str, Editor] = {}
        self._last_valid: dict[str, AngularVelocity] = {}
        """The last valid signal of each family."""
        self._base: AngularVelocity | None = None
        self._current_family: str = next(iter(labels))
        self._signal: AngularVelocity = Multisine()

    def refresh(self, duration: float) -> None:
        """Show the editor of the family chosen. One that was just chosen starts from its own draft, or from the signal
        converted over the duration (s). Raises InvalidInputError after showing the reason below the control."""
        with self._section.catching():
            family = self.family_menu.read()
        if family != self._current_family:
            self._switch(family, duration)
        self.editors[family].refresh()
        self._signal = self._last_valid[family] = self.editors[family].read()

    def read(self) -> AngularVelocity:
        """The signal in the editor on the page. Raises InvalidInputError."""
        return self.editors[self._current_family].read()

    def write(
        self, signal: AngularVelocity, base: AngularVelocity | None, drafts: tuple[AngularVelocity, ...] = ()
    ) -> None:
        """Show a signal, and store drafts of other families."""
        self._base = base
        self._last_valid = {self._family_name(draft): draft for draft in drafts}
        family = self._family_name(signal)
        self._offer_families(family, family if base is None else self._family_name(base), *self._last_valid)
        self.family_menu.write(family, None if base is None else self._family_name(base))
        for other, valid in self._last_valid.items():
            if other != family and other in self.editors:
                self.editors[other].write(valid, self._base_of(other))
        self._show_editor(family, signal)

    def drafts(self) -> tuple[AngularVelocity, ...]:
        """The last valid signals of the families not in use, without those that would come back as another family."""
        used = self._current_family, self._family_name(self._signal)
        return tuple(
            valid
            for family, valid in self._last_valid.items()
            if family not in used and family == self._family_name(valid)
        )

    def replace(self, signal: AngularVelocity) -> None:
        """Show another signal; what the controls are reset to stays as it was."""
        self.write(signal, self._base, self.drafts())

    @property
    def signal(self) -> AngularVelocity:
        """The signal as it was when `refresh` or `write` was called last."""
        return self._signal

    @property
    def visible(self) -> bool:
        """Whether it is on the page."""
        return self._visible

    @property
    def points(self) -> tuple[Waypoint, ...]:
        """The waypoints, if the family has any."""
        editor = self.editors.get(self._current_family)
        return editor.points if isinstance(editor, PointsEditor) else ()

    def move(self, index: int, value: Vec3) -> None:
        """Move a waypoint, if the family has any."""
        editor = self.editors.get(self._current_family)
        if isinstance(editor, PointsEditor):
            editor.move(index, value)

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._section.show(visible)
        if visible and not self._visible:
            self._visible = True
            self._show_editor(self._current_family, self._signal)
        self._visible = visible

    def _switch(self, family: str, duration: float) -> None:
        draft = self._last_valid.get(family)
        if draft is None:
            with self._section.catching():
                try:
                    draft = converted(self._signal, BY_NAME[family].convert, duration)
                except ValueError as error:
                    self.family_menu.show(self._current_family)
                    raise ValueError(f"it cannot be converted into {self._labels[family]}: {error}") from None
        if family in self.editors and family in self._last_valid:
            self.editors[self._current_family].show(False)  # the other editor keeps what was typed, valid or not
            self.editors[family].show(True)
            self._current_family = family
        else:
            self._show_editor(family, draft)

    def _show_editor(self, family: str, signal: AngularVelocity) -> None:
        """Show the editor of a family and hide the others; while the whole is hidden, only remember the family."""
        self._current_family, self._signal = family, signal
        self._last_valid[family] = signal
        if not self._visible:
            return
        for other, editor in self.editors.items():
            if other != family:
                editor.show(False)
        if family not in self.editors:
            with self._section:
                self.editors[family] = self._new_editor(family)
        self.editors[family].write(signal, self._base_of(family))
        self.editors[family].show(True)

    def _new_editor(self, family: str) -> Editor:
        if family == FROM_FILE:
            return FileSignalEditor(self._form)
        return BY_NAME[family].editor(self._form, self._slot)

    def _base_of(self, family: str) -> AngularVelocity | None:
        """The preset's signal, if it is of this family."""
        return self._base if self._base is not None and self._family_name(self._base) == family else None

    def _family_name(self, signal: AngularVelocity) -> str:
        """The family that the menu shows for a signal: a Multisine of nothing but an offset is a constant where the
        menu offers constants, and a signal whose family the menu does not offer is one from a file."""
        constant = isinstance(signal, Multisine) and not signal.tones and signal.drift == (0.0, 0.0, 0.0)
        name = "constant" if constant and "constant" in self._labels else family_name(signal)
        return name if name in self._labels else FROM_FILE

    def _offer_families(self, *names: str) -> None:
        """Offer the families of the menu and, if one of the names is that of a signal from a file, that as well."""
        self.family_menu.offer({**self._labels, FROM_FILE: FROM_FILE_LABEL} if FROM_FILE in names else self._labels)
