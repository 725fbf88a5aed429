"""The gains in physical words: noise, boxes around the start, factors, a time constant, a weight (rangenav.physical).

The words are made of gains that are kept as they are. Only what a visitor moves is turned back into gains; and when the
path, the world or the rates change, the same gains are put into other words.
"""

from collections.abc import Callable

from msgspec.structs import asdict, replace

from explorer.model.gain_units import GAIN_LABELS, GainContext, in_paper_units, in_physical_units, with_page_labels
from explorer.widgets.controls import LogDial
from explorer.widgets.form import Form, InvalidInputError, Section
from rangenav.gains import Gains
from rangenav.physical_gains import PhysicalGains

NOISE = ("range_sigma", "accel_sigma", "gyro_sigma")
FACTORS = ("position_factor", "velocity_factor")
PRIOR = ("position_box", "velocity_box", "gravity_box", "xi_factor")
ATTITUDE = ("attitude_time", "gravity_weight")


class PhysicalDials:
    """A dial for each word."""

    def __init__(self, form: Form) -> None:
        self._dials: dict[str, LogDial] = {}
        self._sections: dict[str, Section] = {}
        self._noise = Section(form, "Noise the gains are made for: q and V")
        self._add(self._noise, NOISE)
        with self._noise:
            factors = Section(form, "Factors on V", expanded=False)
        self._add(factors, FACTORS)
        self._prior = Section(form, "How wrong the start may be: P₀", expanded=False)
        self._add(self._prior, PRIOR)
        self._place: GainContext | None = None
        """Where the words shown were made; None while what was written is not shown yet."""

    def _add(self, section: Section, names: tuple[str, ...]) -> None:
        with section:
            for name in names:
                word = GAIN_LABELS[name]
                self._dials[name] = LogDial(section, word.label, word.limits, hint=word.hint, unit=word.unit)
                self._sections[name] = section

    def add_attitude(self, form: Form) -> None:
        """The dials of the attitude filter, in the folder that is being made."""
        self._attitude = Section(form)
        self._add(self._attitude, ATTITUDE)

    def write(self, gains: Gains, base: Gains) -> None:
        """Take in gains; they are shown when they are read, where the path can be judged."""
        self._gains, self._base, self._place = gains, base, None

    def show(self, visible: bool, *, noise: bool) -> None:
        """Whether they are on the page, and among them those that noise-matched gains leave unused."""
        self._noise.show(visible and noise)
        self._prior.show(visible)
        self._attitude.show(visible)

    def read(self, place_now: Callable[[], GainContext]) -> Gains:
        """The gains as written, or as moved, of constant mode and without a schedule. Raises Refused after saying why.

        Where there are no words for them the gains stay as they are.
        """
        entered = {} if self._place is None else self._entered()
        moved = {name: value for name, value in entered.items() if value != self._taken[name]}
        try:
            place = place_now()
        except ValueError as error:
            return self._wordless(f"the path's typical {error}", error, moved)
        if place != self._place:
            try:
                self._put_into_words(place, moved)
            except ValueError as error:
                return self._wordless(with_page_labels(str(error)), error, moved)
            entered = self._entered()
        self._gains = self._understood(entered, place)
        self._taken = entered
        return self._gains

    def _wordless(self, why: str, error: ValueError, moved: dict[str, float]) -> Gains:
        """The gains as they are, said to have no words here; a word that was moved is refused."""
        self._noise.complaint.say(f"no physical words: {why}")
        if moved:
            raise InvalidInputError from error
        return self._gains

    def _entered(self) -> dict[str, float]:
        """What the dials say."""
        entered = {}
        for name, dial in self._dials.items():
            with self._sections[name].catching():
                entered[name] = dial.read()
        return entered

    def _put_into_words(self, place: GainContext, moved: dict[str, float]) -> None:
        """Show the gains there, but for words that have just been moved; of these, what was put back to the preset's
        goes on saying what the preset says."""
        before = None if self._place is None else self._base_words
        words = (
            in_physical_units(self._gains, place),
            in_physical_units(self._base, place),
        )  # all or, where there are none, nothing
        self._place, self._start, (self._words, self._base_words) = place, self._gains, words
        for name, dial in self._dials.items():
            value, base, said = getattr(self._words, name), getattr(self._base_words, name), moved.get(name)
            if said is not None:
                value = base if said == getattr(before, name) else said
            dial.write(value, base)

    def _understood(self, entered: dict[str, float], place: GainContext) -> Gains:
        changed = [name for name, value in entered.items() if value != getattr(self._words, name)]
        if not changed:
            return self._start
        try:
            words: PhysicalGains = replace(self._words, **entered)
            return in_paper_units(words, place, (self._base, self._start))
        except ValueError as error:
            sentence = str(error)
            cause = next((name for name in changed if name in sentence), changed[0])
            self._sections[cause].complaint.say(with_page_labels(sentence))
            raise InvalidInputError from ValueError(with_page_labels(sentence))


def tabled(gains: Gains, place: GainContext) -> list[tuple[str, float, str]]:
    """All words with their values and units."""
    values = asdict(in_physical_units(gains, place))
    return [(word.label, values[name], word.unit) for name, word in GAIN_LABELS.items()]
