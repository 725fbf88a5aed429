"""What the paper does not model: a folder of controls, and a sentence for each effect that is on."""

import html

import viser

from explorer.panels.controls import Complaint, Dial, Note, Number, Vector
from rangenav.sensors import Unmodelled

STYLE = "font-size:0.85em;line-height:1.4;padding:0 0.9em 0.6em"


class UnmodelledFolder:
    """Biases, outliers, drop-outs, the lever arm; all off in the paper."""

    def __init__(self, gui: viser.GuiApi, note: Note) -> None:
        self._words = gui.add_html("", visible=False)  # outside: a closed folder must not hide what is on
        with gui.add_folder("Not in the paper", expand_by_default=False):
            hint = "b_ω (rad/s, body axes): added to the gyro. Not in the paper: its observer has no state for it."
            self._gyro = Vector(gui, "gyro bias (rad/s)", step=0.001, hint=hint, note=note)
            hint = (
                "b_a (m/s², body axes): added to the accelerometer. Not in the paper: the observer has no state for it."
            )
            self._accel = Vector(gui, "accel bias (m/s²)", step=0.01, hint=hint, note=note)
            hint = "b_d (m): added to every range, as antenna delays do. Not in the paper; either sign."
            self._range = Number(gui, "range bias (m)", step=0.01, hint=hint, note=note)
            hint = "The share of ranges that come out too long. Not in the paper: its observer has no gate."
            self._outliers = Dial(gui, "outliers (%)", (0.0, 50.0), step=0.1, hint=hint, note=note, scale=100.0)
            hint = "e (m): the mean excess of an outlier, exponential and never negative, as behind an obstacle."
            self._size = Number(gui, "outlier size (m)", step=0.1, hint=hint, note=note)
            hint = "The share of ranges that do not arrive, each by itself. The paper has a range at all times."
            self._lost = Dial(gui, "drop-outs (%)", (0.0, 90.0), step=0.1, hint=hint, note=note, scale=100.0)
            hint = "s: from here on no range arrives, for as long as the next box says."
            self._start = Number(gui, "silent from (s)", step=0.5, hint=hint, note=note)
            hint = "s: how long no range arrives; 0 for no such burst. The paper has a range at all times."
            self._length = Number(gui, "silent for (s)", step=0.5, hint=hint, note=note)
            hint = "r (m, body axes): from the IMU to the antenna; the range is |p + R r − anchor|. In the paper r = 0."
            self._arm = Vector(gui, "lever arm (m)", step=0.01, hint=hint, note=note)
            self._complaint = Complaint(gui)

    def read(self) -> Unmodelled:
        """The effects chosen. Raises Refused after saying why beside the controls."""
        with self._complaint.catching():
            return Unmodelled(
                gyro_bias=self._gyro.read(),
                accel_bias=self._accel.read(),
                range_bias=self._range.read(),
                outlier_probability=self._outliers.read(),
                outlier_size=self._size.read(),
                dropout_probability=self._lost.read(),
                burst_start=self._start.read(),
                burst_length=self._length.read(),
                lever_arm=self._arm.read(),
            )

    def write(self, unmodelled: Unmodelled) -> None:
        """Show effects."""
        self._gyro.write(unmodelled.gyro_bias)
        self._accel.write(unmodelled.accel_bias)
        self._range.write(unmodelled.range_bias)
        self._outliers.write(unmodelled.outlier_probability)
        self._size.write(unmodelled.outlier_size)
        self._lost.write(unmodelled.dropout_probability)
        self._start.write(unmodelled.burst_start)
        self._length.write(unmodelled.burst_length)
        self._arm.write(unmodelled.lever_arm)

    def tell(self, sentences: tuple[str, ...]) -> None:
        """Show what the observer makes of what is on."""
        said = "".join(f"<div>▲ {html.escape(sentence)}</div>" for sentence in sentences)
        content = f'<div style="{STYLE}">{said}</div>'
        if content != self._words.content:
            self._words.content = content
            self._words.visible = bool(sentences)
