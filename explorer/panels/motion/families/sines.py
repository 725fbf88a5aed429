"""Sines: A sin(w t + φ₀) on an axis, as many as wanted, on an offset that drifts."""

from collections.abc import Callable
from functools import partial

import msgspec

from explorer.panels.motion.families.editor import SignalSlot
from explorer.widgets.controls import Vector
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from rangenav.number_format import significant
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import LETTERS, Axis

NEW = (0.25, 4.0)
"""Amplitude and frequency (rad/s) of a new tone."""


class SinesEditor:
    """All tones of one signal, which are added and removed one by one."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._form, self._slot = form, slot
        self._tones: list[_ToneSection] = []
        self._base: Multisine | None = None
        self._list = Section(form)
        self._bottom = Section(form)
        with self._bottom:
            actions = {f"+ {axis}": partial(self._add, axis) for axis in LETTERS}
            form.buttons("add a tone", actions, hint="One more sine on this axis.")
        self._offset_and_drift = _OffsetAndDrift(form, slot)

    def refresh(self) -> None:
        """Show each tone in its label. Raises InvalidInputError after showing the reason below the control."""
        for tone in self._tones:
            tone.refresh()
        with complaining(self._bottom, self._offset_and_drift.section):
            self.read()

    def read(self) -> Multisine:
        """The signal that the sliders show. Raises InvalidInputError."""
        tones = tuple(tone.read() for tone in self._tones)
        with self._bottom.checking():
            return self._offset_and_drift.read(Multisine(tones=tones))

    def write(self, signal: Multisine, base: Multisine | None) -> None:
        """Show a signal; if its tones are on other axes, their sections are built anew."""
        self._base = base
        if [tone.axis for tone in signal.tones] != [tone.axis for tone in self._tones]:
            for tone in self._tones:
                tone.section.remove()
            self._tones = [
                self._new_section(axis.axis, expanded=i < self._slot.open_tones) for i, axis in enumerate(signal.tones)
            ]
        bases = base.tones if base is not None else ()
        for i, (editor, tone) in enumerate(zip(self._tones, signal.tones, strict=True)):
            editor.write(tone, bases[i] if i < len(bases) and bases[i].axis == tone.axis else None)
        self._offset_and_drift.write(signal, base)

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        for section in (self._list, self._bottom, self._offset_and_drift.section):
            section.show(visible)

    def _new_section(self, axis: Axis, *, expanded: bool) -> "_ToneSection":
        with self._list:
            return _ToneSection(self._form, self._slot, axis, self._remove, expanded=expanded)

    def _add(self, axis: Axis) -> None:
        with self._bottom.answering():
            tones = tuple(tone.read() for tone in self._tones)
            added = Tone(axis=axis, amplitude=NEW[0], frequency=NEW[1])
            Multisine(tones=(*tones, added))  # refuses one too many
        self._tones.append(self._new_section(axis, expanded=True))
        self._tones[-1].write(added, None)

    def _remove(self, tone: "_ToneSection") -> None:
        if tone in self._tones:  # a second click may come for one that is gone
            self._tones.remove(tone)
            tone.section.remove()


class _ToneSection:
    """A sin(w t + φ₀) on one axis."""

    def __init__(
        self, form: Form, slot: SignalSlot, axis: Axis, remove: Callable[["_ToneSection"], None], *, expanded: bool
    ) -> None:
        self.axis: Axis = axis
        self.section = section = Section(form, axis, expanded=expanded)
        with section:
            hint = f"A ({slot.unit}): adds A sin(w t + φ₀) to the {axis} component; its fourth derivative is A w⁴."
            self._amplitude = Dial(section, f"A ({slot.unit})", slot.amplitude, step=0.001, hint=hint)
            hint = "w (rad/s): the tone's frequency at s = 1; it must stay below the IMU's Nyquist frequency."
            self._frequency = Dial(section, "w (rad/s)", slot.frequency, step=0.01, hint=hint)
            hint = "φ₀ (rad): the tone's phase at t = 0; π/2 makes it a cosine."
            self._phase = Dial(section, "φ₀ (rad)", (-3.142, 3.142), step=0.001, hint=hint)
            form.buttons("", {"− remove this tone": partial(remove, self)}, hint="Ctrl+Z brings it back.")

    def refresh(self) -> None:
        with self.section.catching():
            tone = self.read()
        self._update_label(tone)

    def read(self) -> Tone:
        with self.section.checking():
            return Tone(
                axis=self.axis,
                amplitude=self._amplitude.read(),
                frequency=self._frequency.read(),
                phase=self._phase.read(),
            )

    def write(self, tone: Tone, base: Tone | None) -> None:
        self._amplitude.write(tone.amplitude, base and base.amplitude)
        self._frequency.write(tone.frequency, base and base.frequency)
        self._phase.write(tone.phase, base and base.phase)
        self._update_label(tone)

    def _update_label(self, tone: Tone) -> None:
        self.section.caption(
            f"{tone.axis}: {significant(tone.amplitude)} sin({significant(tone.frequency)} t {tone.phase:+.3g})"
        )


class _OffsetAndDrift:
    """Offset and drift of a signal; a line or a hover has nothing else."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self.section = section = Section(form, "Offset and drift", expanded=False)
        with section:
            hint = f"{slot.unit}: added to the tones. It moves a path against the anchor; the excitation stays."
            self._offset = Vector(section, f"offset ({slot.unit})", step=0.01, hint=hint)
            hint = f"{slot.unit}/s: a constant rate added to the tones. It has no snap, so it excites nothing."
            self._drift = Vector(section, f"drift ({slot.unit}/s)", step=0.01, hint=hint)

    def read(self, signal: Multisine) -> Multisine:
        with self.section.checking():
            return msgspec.structs.replace(signal, offset=self._offset.read(), drift=self._drift.read())

    def write(self, signal: Multisine, base: Multisine | None) -> None:
        self._offset.write(signal.offset, base and base.offset)
        self._drift.write(signal.drift, base and base.drift)
