"""Sines: A sin(ω t + φ₀) on an axis, as many as wanted, on an offset that drifts."""

from collections.abc import Callable
from functools import partial

import msgspec

from explorer.model.glossary import MOTION
from explorer.panels.motion.families.editor import SignalSlot
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from explorer.widgets.vector import Vector
from rangenav.inputs import Vec3
from rangenav.number_format import MINUS, significant, vector
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import LETTERS, Axis

NEW_AMPLITUDE = 0.6
NEW_FREQUENCIES = (4.0, 6.0, 3.0, 5.0, 2.0, 7.0, 3.5, 4.5, 5.5, 8.0)
"""rad/s; a new tone has the first that no other tone has: tones of one frequency make an ellipse, which is blind."""
OFFSET_AND_DRIFT = "Offset and drift"
SAME_FREQUENCY = 0.05
"""Relative: two frequencies closer than this count as one."""


class SinesEditor:
    """All tones of one signal, which are added and removed one by one."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._form, self._slot = form, slot
        self._tones: list[_ToneSection] = []
        self._base: Multisine | None = None
        self._top = Section(form)
        with self._top:
            actions = {f"+ {axis}": partial(self._add, axis) for axis in LETTERS}
            form.buttons("add a tone along", actions, hint="One more sine along this axis, of another frequency.")
        self._list = Section(form)
        self._offset_and_drift = _OffsetAndDrift(form, slot)

    def refresh(self) -> None:
        """Show each tone in its label. Raises InvalidInputError after showing the reason below the control."""
        for tone in self._tones:
            tone.refresh()
        with complaining(self._top, self._offset_and_drift.section):
            self._offset_and_drift.describe(self.read())

    def read(self) -> Multisine:
        """The signal that the sliders show. Raises InvalidInputError."""
        tones = tuple(tone.read() for tone in self._tones)
        with self._top.checking():
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
        for section in (self._list, self._top, self._offset_and_drift.section):
            section.show(visible)

    def _new_section(self, axis: Axis, *, expanded: bool) -> "_ToneSection":
        with self._list:
            return _ToneSection(self._form, self._slot, axis, self._remove, expanded=expanded)

    def _add(self, axis: Axis) -> None:
        with self._top.answering():
            tones = tuple(tone.read() for tone in self._tones)
            added = Tone(axis=axis, amplitude=NEW_AMPLITUDE, frequency=new_frequency(tones))
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
            amplitude, frequency, phase = (MOTION[name] for name in ("amplitude", "frequency", "phase"))
            label = f"{amplitude.label} {axis} ({slot.unit})"
            self._amplitude = Dial(section, label, slot.amplitude, step=0.001, hint=amplitude.hint)
            self._frequency = Dial(section, frequency.caption, slot.frequency, step=0.01, hint=frequency.hint)
            self._phase = Dial(section, phase.caption, (-3.142, 3.142), step=0.001, hint=phase.hint)
            form.buttons("", {"− remove this tone": partial(remove, self)}, hint="Ctrl+Z brings it back.")
        self._unit = slot.unit

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
        self.section.caption(tone_caption(tone, self._unit))


class _OffsetAndDrift:
    """Offset and drift of a signal; a line or a hover has nothing else."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._unit = slot.unit
        self.section = section = Section(form, OFFSET_AND_DRIFT, expanded=False)
        with section:
            hint = "Added to the tones. A path is then elsewhere, seen from the anchor, with the same excitation."
            self._offset = Vector(section, f"offset ({slot.unit})", hint=hint)
            hint = "A constant rate added to the tones. It has no snap, so it excites nothing."
            self._drift = Vector(section, f"drift ({slot.unit}/s)", hint=hint)

    def read(self, signal: Multisine) -> Multisine:
        with self.section.checking():
            return msgspec.structs.replace(signal, offset=self._offset.read(), drift=self._drift.read())

    def describe(self, signal: Multisine) -> None:
        self.section.caption(offset_caption(signal.offset, signal.drift, self._unit))

    def write(self, signal: Multisine, base: Multisine | None) -> None:
        self._offset.write(signal.offset, base and base.offset)
        self._drift.write(signal.drift, base and base.drift)
        self.describe(signal)


def tone_caption(tone: Tone, unit: str) -> str:
    """What a tone is, for its folded heading: x: 0.25 m · sin(4 t + 1.57)."""
    phase = f" {'+' if tone.phase > 0 else MINUS} {significant(abs(tone.phase))}" if tone.phase else ""
    return f"{tone.axis}: {significant(tone.amplitude)} {unit} · sin({significant(tone.frequency)} t{phase})"


def offset_caption(offset: Vec3, drift: Vec3, unit: str) -> str:
    """What offset and drift are, for their folded heading."""
    parts = [f"offset {vector(offset)} {unit}"] if any(offset) else []
    parts += [f"drift {vector(drift)} {unit}/s"] if any(drift) else []
    return f"{OFFSET_AND_DRIFT}: {', '.join(parts) or 'none'}"


def new_frequency(tones: tuple[Tone, ...]) -> float:
    """A frequency (rad/s) that no tone has; the first one if all of them are taken."""
    taken = [abs(tone.frequency) for tone in tones]
    return next(
        (f for f in NEW_FREQUENCIES if all(abs(f - other) > SAME_FREQUENCY * f for other in taken)), NEW_FREQUENCIES[0]
    )
