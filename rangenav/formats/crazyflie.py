"""How a Crazyflie flies a looped export: three trajectories from one upload, the middle one again and again."""

import math

from rangenav.formats.hover_ramps import LOW, HoverRamps, Place
from rangenav.inputs import Vec3

ROUNDING = 1e-9
PIECE = 132
"""Bytes of a piece (cflib's Poly4D) in the Crazyflie's trajectory memory."""


def looping(course: HoverRamps, first: int, count: int, window: float) -> str:
    """Which pieces are the loop (`first` from 0), and how they are flown, as one sentence; window (s): the one that the
    motion is judged by."""
    begin, end = course.steady
    if first == 0:
        pieces = f"all {count} pieces are one loop of {end - begin:.6g} s, which begins and ends at rest"
    else:
        pieces = (
            f"pieces 1 to {first} are the ramp in ({course.ramp:g} s), {first + 1} to {first + count} are one loop "
            f"({end - begin:.6g} s), the last {first} are the ramp out"
        )
    loops = max(1, math.ceil(window / (end - begin) - ROUNDING))
    least = f"at least {loops} times, because one window of {window:.4g} s lasts as long" if loops > 1 else "as often"
    return f"{pieces}: fly the loop {least}{'' if loops > 1 else ' as you like'}"


def script(file: str, course_ramp: float, period: float, first: int, count: int, place: Place) -> str:
    """Lines of Python with cflib that upload the file and fly the loop; `cf` is a connected Crazyflie.

    cflib's third argument of start_trajectory is whether a trajectory begins where the Crazyflie is; its name has
    changed between versions, so it is passed by its position.
    """
    ramp_in = f"    commander.start_trajectory(1, 1.0, relative)\n    time.sleep({course_ramp:.9g})\n" if first else ""
    ramp_out = f"    commander.start_trajectory(3, 1.0, relative)\n    time.sleep({course_ramp:.9g})\n" if first else ""
    entry = f"    commander.define_trajectory(1, 0, {first})\n" if first else ""
    leaving = f"    commander.define_trajectory(3, {first + count} * {PIECE}, {first})\n" if first else ""
    return f'''"""Fly {file}: ramp in, the loop as often as asked, ramp out; with cflib, and a Crazyflie in the air.

The file's axes have z up; all numbers in metres. The certificate holds with the anchor at ANCHOR of these axes only.
"""

import csv
import time

from cflib.crazyflie.mem import MemoryElement, Poly4D

FIRST = {_numbers(place.first)}  # the first point of the path
LAST = {_numbers(place.last)}  # where the ramp out ends, and the Crazyflie hovers
LOWEST = {place.lowest:.4g}  # the lowest z of the path
ANCHOR = {_numbers(place.anchor)}
FLOOR = {LOW}  # an absolute flight must stay above it


def upload(cf, file="{file}"):
    """Write all pieces into the trajectory memory."""
    with open(file, newline="") as lines:
        rows = [[float(value) for value in row] for row in list(csv.reader(lines))[1:]]
    memory = cf.mem.get_mems(MemoryElement.TYPE_TRAJ)[0]
    memory.trajectory = [
        Poly4D(row[0], *(Poly4D.Poly(row[k : k + 8]) for k in (1, 9, 17, 25))) for row in rows
    ]
    if not memory.write_data_sync():
        raise RuntimeError("the pieces did not arrive in the Crazyflie's memory")


def fly(cf, loops, relative):
    """Fly the loop so many times.

    relative=False: the file's axes are those of your positioning system. Go to FIRST before, and hover there.
    relative=True: the path begins where the Crazyflie hovers. From there the anchor must stand at ANCHOR - FIRST, and
    there must be room below: the path goes down by FIRST[2] - LOWEST.
    """
    if not relative and LOWEST < FLOOR:
        raise ValueError(f"the path comes down to z = {{LOWEST}} m: hover higher up and fly it with relative=True")
    commander = cf.high_level_commander
{entry}    commander.define_trajectory(2, {first} * {PIECE}, {count})
{leaving}{ramp_in}    begin = time.monotonic()
    for k in range(loops):
        commander.start_trajectory(2, 1.0, relative)  # the next loop begins where this one ends: start it in time
        time.sleep(max(0.0, begin + (k + 1) * {period:.9g} - time.monotonic()))
{ramp_out}'''


def _numbers(point: Vec3) -> str:
    """A point as Python writes it, to a tenth of a millimetre."""
    return f"({', '.join(f'{value:.4f}' for value in point)})"
