"""What the paper does not model: a folder of controls, and a sentence for each effect that is on."""

import html
from typing import Any

from explorer.widgets.controls import Control, Dial, Number, Vector
from explorer.widgets.form import Form, Section
from rangenav.sensors import Effects

STYLE = "font-size:0.85em;line-height:1.4;padding:0 0.9em 0.6em"


class EffectsFolder:
    """Biases, outliers, drop-outs, the lever arm; all off in the paper."""

    def __init__(self, form: Form) -> None:
        self._words = form.gui.add_html("", visible=False)  # outside: a closed folder must not hide what is on
        self._section = section = Section(form, "Not in the paper", expanded=False)
        with section:
            hint = "b_ω (rad/s, body axes): added to the gyro. Not in the paper: its observer has no state for it."
            gyro = Vector(section, "gyro bias (rad/s)", step=0.001, hint=hint)
            hint = (
                "b_a (m/s², body axes): added to the accelerometer. Not in the paper: the observer has no state for it."
            )
            accel = Vector(section, "accel bias (m/s²)", step=0.01, hint=hint)
            hint = "b_d (m): added to every range, as antenna delays do. Not in the paper; either sign."
            too_long = Number(section, "range bias (m)", step=0.01, hint=hint)
            hint = "The share of ranges that come out too long. Not in the paper: its observer has no gate."
            outliers = Dial(section, "outliers (%)", (0.0, 50.0), step=0.1, hint=hint, scale=100.0)
            hint = "e (m): the mean excess of an outlier, exponential and never negative, as behind an obstacle."
            size = Number(section, "outlier size (m)", step=0.1, hint=hint)
            hint = "The share of ranges that do not arrive, each by itself. The paper has a range at all times."
            lost = Dial(section, "drop-outs (%)", (0.0, 90.0), step=0.1, hint=hint, scale=100.0)
            hint = "s: from here on no range arrives, for as long as the next box says."
            start = Number(section, "silent from (s)", step=0.5, hint=hint)
            hint = "s: how long no range arrives; 0 for no such burst. The paper has a range at all times."
            length = Number(section, "silent for (s)", step=0.5, hint=hint)
            hint = "r (m, body axes): from the IMU to the antenna; the range is |p + R r − anchor|. In the paper r = 0."
            arm = Vector(section, "lever arm (m)", step=0.01, hint=hint)
        self._controls: dict[str, Control[Any]] = {
            "gyro_bias": gyro,
            "accel_bias": accel,
            "range_bias": too_long,
            "outlier_probability": outliers,
            "outlier_size": size,
            "dropout_probability": lost,
            "burst_start": start,
            "burst_length": length,
            "lever_arm": arm,
        }

    def read(self) -> Effects:
        """The effects chosen. Raises Refused after saying why beside the controls."""
        with self._section.catching():
            return Effects(**{name: control.read() for name, control in self._controls.items()})

    def write(self, unmodelled: Effects, base: Effects) -> None:
        """Show effects."""
        for name, control in self._controls.items():
            control.write(getattr(unmodelled, name), getattr(base, name))

    def show(self, unmodelled: Effects) -> None:
        """Show effects; what the preset says stays what it was."""
        for name, control in self._controls.items():
            control.show(getattr(unmodelled, name))

    def tell(self, sentences: tuple[str, ...]) -> None:
        """Show what the observer makes of what is on."""
        said = "".join(f"<div>▲ {html.escape(sentence)}</div>" for sentence in sentences)
        content = f'<div style="{STYLE}">{said}</div>'
        if content != self._words.content:
            self._words.content = content
            self._words.visible = bool(sentences)
