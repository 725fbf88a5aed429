"""Settings as a visitor of the page could choose them, drawn by hypothesis; every field of every value is drawn.

A field that is added to a value and not drawn here fails the import, so that no panel can lose it unnoticed.
"""

from typing import Any, TypeVar

import msgspec
from hypothesis import HealthCheck, reject
from hypothesis import strategies as st

from explorer.model.settings import Drafts, Printed, Settings
from explorer.panels.motion.families import ANGULAR_VELOCITY_LABELS, family_name
from rangenav import preset
from rangenav.attitude import AttitudeGains, Schedule
from rangenav.gains import Gains, Guess
from rangenav.motion import World
from rangenav.preset import Preset
from rangenav.riccati import Blocks, RiccatiGains
from rangenav.sensors import MODELLED, Effects, Noise, Sensors
from rangenav.signals import AngularVelocity, Family, Flown, Multisine, Sum
from rangenav.vehicle import CATALOGUE
from tests.support.effect_examples import example
from tests.support.signal_examples import EXAMPLES

S = TypeVar("S", bound=msgspec.Struct)
SHIPPED = preset.shipped()
SLOW_DRAWS = (
    HealthCheck.too_slow,
    HealthCheck.filter_too_much,
    HealthCheck.data_too_large,
    HealthCheck.large_base_example,
    HealthCheck.function_scoped_fixture,
)
"""For tests that draw whole settings: they are drawn slowly, and many are rejected for their rates."""


def _third(value: Any) -> Any:
    """A third of a number or of a vector."""
    return tuple(entry / 3 for entry in value) if isinstance(value, tuple) else value / 3


EVERYTHING = Effects(**{field: _third(example(field)) for field in Effects.__struct_fields__})
"""Every effect that the paper does not model, with digits that no slider shows."""


def every_field(kind: type[S], **fields: st.SearchStrategy[Any]) -> st.SearchStrategy[S]:
    """Values of a Struct. Raises TypeError if a field is left out, or if there is no such field."""
    if set(fields) != set(kind.__struct_fields__):
        raise TypeError(f"{kind.__name__}: {sorted(set(fields) ^ set(kind.__struct_fields__))} not drawn, or no field")
    return st.builds(kind, **fields)


NUMBERS = st.floats(-1e3, 1e3)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
SIZES = st.floats(1e-3, 10.0)
SIGMAS = st.one_of(st.just(0.0), st.floats(1e-6, 1.0))
FAMILIES = st.one_of(
    st.sampled_from([signal for signal in EXAMPLES.values() if isinstance(signal, Family)]),
    st.builds(Multisine, offset=VECTORS),
)
PATHS = st.one_of(FAMILIES, every_field(Sum, base=FAMILIES, wiggle=FAMILIES, offset=VECTORS, drift=VECTORS))
ANGULAR_VELOCITIES = st.one_of(
    FAMILIES.filter(lambda signal: family_name(signal) in ANGULAR_VELOCITY_LABELS),
    every_field(Flown, yaw=st.sampled_from(("0", "sin(t)", "-(t)"))),
)
BLOCKS = every_field(Blocks, xi=SIZES, position=SIZES, velocity=SIZES, gravity=SIZES)
GAINS = every_field(
    Gains,
    mode=st.sampled_from(("constant", "noise-matched")),
    riccati=every_field(RiccatiGains, q=st.floats(1e-3, 1e5), v=BLOCKS, p0=BLOCKS),
    attitude=every_field(
        AttitudeGains,
        k1=st.floats(1e-3, 1e3),
        rho1=SIZES,
        rho2=SIZES,
        schedule=st.none()
        | every_field(Schedule, steady=st.just(1e-3), halfway=st.floats(1e-4, 1.0), memory=st.floats(0.01, 10.0)),
    ),
)
NOISES = every_field(
    Noise, gyro=SIGMAS, accel=SIGMAS, mag=SIGMAS, range=SIGMAS, imu_unit=st.sampled_from(("sample", "density"))
)
SENSORS = every_field(
    Sensors,
    imu_rate=st.floats(200, 900),
    mag_rate=st.floats(20, 200),
    range_rate=st.floats(20, 200),
    noise=NOISES,
    unmodelled=st.sampled_from((MODELLED, EVERYTHING)),
)
GUESSES = every_field(
    Guess,
    state=st.sampled_from(("zero", "truth", "offset")),
    position_offset=VECTORS,
    velocity_offset=st.tuples(*[st.floats(-100, 100)] * 3),
    gravity_offset=st.tuples(*[st.floats(-10, 10)] * 3),
    attitude_axis=st.tuples(st.floats(0.1, 2), NUMBERS, NUMBERS),
    attitude_angle=st.floats(-3.1, 3.1),
)
WORLDS = every_field(
    World,
    anchor=VECTORS,
    gravity=st.sampled_from(((0.0, 0.0, 9.81), (0.0, 0.1, -9.7))),
    magnetic=st.sampled_from(((1.0, 0.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.6, -0.8))),
)
FIELDS: dict[str, st.SearchStrategy[Any]] = {
    "path": PATHS,
    "angular_velocity": ANGULAR_VELOCITIES,
    "initial_rotation": st.tuples(*[st.floats(-3, 3)] * 3),
    "duration": st.floats(16, 30),
    "world": WORLDS,
    "sensors": SENSORS,
    "gains": GAINS,
    "guess": GUESSES,
    "seed": st.integers(0, 2**53 - 1),
    "vehicle": st.sampled_from(CATALOGUE),
}
WITHOUT_CONTROLS = {"version", "title", "story", "expect", "requirement", "source"}
"""Fields of a preset that have no control; only the window of the requirement has one."""
if set(FIELDS) | WITHOUT_CONTROLS != set(Preset.__struct_fields__):
    raise TypeError(f"Preset: {set(FIELDS) ^ set(Preset.__struct_fields__) ^ WITHOUT_CONTROLS} not drawn, or no field")


def _other_drafts(used: AngularVelocity | None, drafts: list[Any]) -> tuple[Any, ...]:
    """Drafts as the page stores them: one for each family that is not in use."""
    each = {family_name(draft): draft for draft in drafts}
    if used is not None:
        each.pop(family_name(used), None)
    return tuple(each.values())


@st.composite
def page_settings(draw: st.DrawFn) -> Settings:
    """Settings of a shipped preset with some fields drawn anew."""
    origin = draw(st.sampled_from(sorted(SHIPPED)))
    fields = draw(st.fixed_dictionaries({}, optional=FIELDS))
    p = SHIPPED[origin]
    try:
        p = msgspec.structs.replace(p, **fields)
    except ValueError:  # such as a path that is too fast for these rates
        reject()
    path, few = p.path, st.lists(FAMILIES, max_size=4)
    base, wiggle = (path.base, path.wiggle) if isinstance(path, Sum) else (path, None)
    drafts = Drafts(
        path=_other_drafts(base, draw(few)),
        wiggle=_other_drafts(wiggle, draw(few)),
        angular_velocity=_other_drafts(p.angular_velocity, draw(st.lists(ANGULAR_VELOCITIES, max_size=4))),
    )
    switches = draw(every_field(Printed, **dict.fromkeys(Printed.__struct_fields__, st.booleans())))
    return Settings(origin=origin, preset=p, time_scale=draw(st.floats(0.1, 10)), printed=switches, drafts=drafts)
