"""The Motion tab: every tone of path and angular velocity, the time scale and the window δ."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import msgspec
import viser

from explorer.panels.controls import Complaint, Dial, LogDial, Note, Vector
from explorer.settings import MAX_TIME_SCALE, MIN_TIME_SCALE, Settings
from rangenav.signals import Multisine, Signal, Tone, Turning


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """What tells the two signals apart on the page."""

    label: str
    unit: str
    amplitude: tuple[float, float]
    frequency: tuple[float, float]
    """Ranges of the sliders; a preset beyond them widens them."""
    expanded: bool
    open_tones: int
    """Tones whose sliders are open at first; the labels of the others show their formula all the same."""


PATH = _Kind(
    label="Path p(t), inertial axes",
    unit="m",
    amplitude=(-3.0, 3.0),
    frequency=(0.05, 20.0),
    expanded=True,
    open_tones=1,
)
TURN = _Kind(
    label="Angular velocity ω(t), body axes",
    unit="rad/s",
    amplitude=(-3.0, 3.0),
    frequency=(0.05, 10.0),
    expanded=False,
    open_tones=0,
)


S = TypeVar("S", bound=Turning)
NO_TONES = "No tones: nothing to move here."
NO_SLIDERS = "This one has no tones: it is used as its preset says, and has no sliders here."


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """What this tab decides."""

    path: Signal
    angular_velocity: Turning
    time_scale: float
    window: float

    @staticmethod
    def of(settings: Settings) -> "Chosen":
        """The part of some settings that this tab shows."""
        p = settings.preset
        return Chosen(
            path=p.path,
            angular_velocity=p.angular_velocity,
            time_scale=settings.time_scale,
            window=p.requirement.window,
        )


class MotionPanel:
    """All controls of the motion."""

    def __init__(self, gui: viser.GuiApi, chosen: Chosen, note: Note) -> None:
        hint = (
            "s: the same path run s times slower. Its snap p⁗ falls as s⁻⁴ and the excitation μ over one period as s⁻⁷ "
            "(paper, PE lemma), while thrust falls towards the weight."
        )
        self._scale = LogDial(gui, "slower s", (MIN_TIME_SCALE, MAX_TIME_SCALE), hint=hint, note=note)
        self._scale_line = gui.add_markdown("")
        hint = (
            "δ (s): the window of the excitation ∫p⁗p⁗ᵀ, of the Gramian (paper, definition of uniform observability)."
        )
        self._window = Dial(gui, "window δ (s)", (0.5, 15.0), step=0.1, hint=hint, note=note)
        self.complaint = Complaint(gui)
        self._path = _SignalFolder(gui, PATH, chosen.path, note)
        self._offsets = _Offsets(gui, note)
        self._turn = _SignalFolder(gui, TURN, chosen.angular_velocity, note)
        self.write(chosen)

    def read(self) -> Chosen:
        """The motion chosen. Raises Refused after saying why beside the control."""
        with self.complaint.catching():
            scale, window = self._scale.read(), self._window.read()
        path = self._offsets.read(self._path.read())
        return Chosen(path=path, angular_velocity=self._turn.read(), time_scale=scale, window=window)

    def write(self, chosen: Chosen) -> None:
        """Show a motion."""
        self._scale.write(chosen.time_scale)
        self._window.write(chosen.window)
        self._path.write(chosen.path)
        self._offsets.write(chosen.path)
        self._turn.write(chosen.angular_velocity)

    def draw(self, time_scale: float) -> None:
        """Say what the time scale does to μ."""
        line = f"μ ∝ s⁻⁷ over one period: × {time_scale**-7:.3g}; over a fixed δ about s⁻⁸: × {time_scale**-8:.3g}"
        if line != self._scale_line.content:
            self._scale_line.content = line


class _SignalFolder(Generic[S]):
    """The tones of one signal; rebuilt when a preset with others is written. Other families are only shown."""

    def __init__(self, gui: viser.GuiApi, kind: _Kind, signal: S, note: Note) -> None:
        self._gui, self._kind, self._note = gui, kind, note
        self._folder = gui.add_folder(kind.label, expand_by_default=kind.expanded)
        with self._folder:
            self._none = gui.add_markdown("", visible=False)
        self._tones: list[_ToneFolder] = []
        self._build(signal)

    def read(self) -> S:
        tones = tuple(tone.read() for tone in self._tones)
        if not isinstance(self._written, Multisine):
            return self._written
        return msgspec.structs.replace(self._written, tones=tones)

    def write(self, signal: S) -> None:
        if [tone.axis for tone in _tones(signal)] != [tone.axis for tone in self._tones]:
            self._build(signal)
        self._written = signal
        self._none.content = NO_TONES if isinstance(signal, Multisine) else NO_SLIDERS
        for folder, tone in zip(self._tones, _tones(signal), strict=True):
            folder.write(tone)

    def _build(self, signal: S) -> None:
        for tone in self._tones:
            tone.remove()
        with self._folder:
            self._tones = [
                _ToneFolder(self._gui, self._kind, tone, self._note, expanded=i < self._kind.open_tones)
                for i, tone in enumerate(_tones(signal))
            ]
        self._written, self._none.visible = signal, not self._tones


def _tones(signal: Turning) -> tuple[Tone, ...]:
    return signal.tones if isinstance(signal, Multisine) else ()


class _ToneFolder:
    """A · sin(w t + phase) on one axis."""

    def __init__(self, gui: viser.GuiApi, kind: _Kind, tone: Tone, note: Note, *, expanded: bool) -> None:
        self._base = tone
        self._folder = gui.add_folder(tone.axis, expand_by_default=expanded)
        with self._folder:
            hint = f"A ({kind.unit}): adds A sin(w t + φ₀) to the {tone.axis} component; its fourth derivative is A w⁴."
            self._amplitude = Dial(gui, f"A ({kind.unit})", kind.amplitude, step=0.001, hint=hint, note=note)
            hint = "w (rad/s): the tone's frequency at s = 1; it must stay below the IMU's Nyquist frequency."
            self._frequency = Dial(gui, "w (rad/s)", kind.frequency, step=0.01, hint=hint, note=note)
            hint = "φ₀ (rad): the tone's phase at t = 0; π/2 makes it a cosine."
            self._phase = Dial(gui, "φ₀ (rad)", (-3.142, 3.142), step=0.001, hint=hint, note=note)
            self._complaint = Complaint(gui)

    def read(self) -> Tone:
        with self._complaint.catching():
            amplitude, frequency, phase = self._amplitude.read(), self._frequency.read(), self._phase.read()
            tone = msgspec.structs.replace(self._base, amplitude=amplitude, frequency=frequency, phase=phase)
        self._caption(tone)
        return tone

    def write(self, tone: Tone) -> None:
        self._amplitude.write(tone.amplitude)
        self._frequency.write(tone.frequency)
        self._phase.write(tone.phase)
        self._caption(tone)

    @property
    def axis(self) -> str:
        return self._base.axis

    def remove(self) -> None:
        self._folder.remove()

    def _caption(self, tone: Tone) -> None:
        label = f"{tone.axis}: {tone.amplitude:.3g} sin({tone.frequency:.3g} t {tone.phase:+.3g})"
        if label != self._folder.label:
            self._folder.label = label


class _Offsets:
    """Where a path starts and how it drifts: a line or a hover has nothing else."""

    def __init__(self, gui: viser.GuiApi, note: Note) -> None:
        with gui.add_folder("Path: offset and drift", expand_by_default=False):
            hint = "m, inertial axes: added to the tones. It moves the path against the anchor; the excitation stays."
            self._offset = Vector(gui, "offset (m)", step=0.01, hint=hint, note=note)
            hint = "m/s, inertial axes: a constant velocity added to the tones. It has no snap, so it excites nothing."
            self._drift = Vector(gui, "drift (m/s)", step=0.01, hint=hint, note=note)
            self._complaint = Complaint(gui)

    def read(self, signal: Signal) -> Signal:
        if not isinstance(signal, Multisine):
            return signal
        with self._complaint.catching():
            return msgspec.structs.replace(signal, offset=self._offset.read(), drift=self._drift.read())

    def write(self, signal: Signal) -> None:
        if isinstance(signal, Multisine):
            self._offset.write(signal.offset)
            self._drift.write(signal.drift)
