"""How a Crazyflie flies a looped export: three trajectories from one upload, the middle one again and again."""

import math
from string import Template

from rangenav.formats.hover_ramps import LOW, HoverRamps, Place
from rangenav.inputs import Vec3
from rangenav.results import result

ROUNDING = 1e-9
PIECE = 132
"""Bytes of a piece (cflib's Poly4D) in the Crazyflie's trajectory memory."""
CLIMB, ABOVE = 0.5, 0.5
"""m/s at which the program takes off and lands, and m that it keeps below the lowest point of a path that it flies from
where the Crazyflie hovers."""

PROGRAM = '''"""Fly $file with a Crazyflie: take off, ramp in, the loop as often as asked, ramp out, land.

    pip install cflib
    python THIS_FILE URI --loops $loops               the flight begins where the Crazyflie hovers
    python THIS_FILE URI --loops $loops --absolute    the file's axes are those of your positioning system

URI is that of your Crazyflie, such as radio://0/80/2M/E7E7E7E7E7.

The file's axes have z up; all numbers in metres. The certificate holds with the anchor at ANCHOR of these axes only,
for the loop that is flown again and again without a pause. It does not cover the ramps.
"""

import argparse
import csv
import time

from cflib.crazyflie.mem import MemoryElement, Poly4D

FIRST = $first_point  # the first point of the flight
LAST = $last_point  # where the ramp out ends, and the Crazyflie hovers and then lands
LOWEST = $lowest  # the lowest z of the flight
ROOM = $room  # the sides of the box that holds the flight
ANCHOR = $anchor
FLOOR = $floor  # an absolute flight must stay above it
LEAST_LOOPS = $least  # the certified window of $window s is as long
HOVER = $hover  # the height above the floor of the hover before a relative flight$why


def upload(cf, file="$file"):
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
    """Fly the loop so many times, at least LEAST_LOOPS.

    relative=False: the file's axes are those of your positioning system. Go to FIRST before, and hover there.
    relative=True: the path begins where the Crazyflie hovers. From there the anchor must stand at ANCHOR - FIRST, and
    there must be room below: the path goes down by FIRST[2] - LOWEST. Each loop then begins at the place that the
    Crazyflie is to have when the computer's command arrives: a command that is 20 ms late or early at 1 m/s moves the
    path, and the anchor in its axes, by 2 cm, and the shifts of all loops add up. relative=False does not shift.
    """
    if loops < LEAST_LOOPS:
        raise ValueError(f"{loops} loops are shorter than the certified window: fly at least {LEAST_LOOPS}")
    if not relative and LOWEST < FLOOR:
        raise ValueError(f"the path comes down to z = {LOWEST} m: hover higher up and fly it with relative=True")
    commander = cf.high_level_commander
$entry$define$leaving$ramp_in    begin = time.monotonic()
    for k in range(loops):
        commander.start_trajectory(2, 1.0, relative)  # the next loop begins where this one ends: start it in time
        time.sleep(max(0.0, begin + (k + 1) * $period - time.monotonic()))
$ramp_out

def flight(cf, loops, relative, height):
    """Take off to a height (m), fly the loops, and land. Whatever goes wrong in the air, the Crazyflie lands."""
    upload(cf)
    commander = cf.high_level_commander
    climb = max(height / $climb, 2.0)
    commander.takeoff(height, climb)
    try:
        time.sleep(climb + 1.0)
        if not relative:
            commander.go_to(*FIRST, 0.0, 4.0)
            time.sleep(5.0)
        fly(cf, loops, relative)
    finally:
        commander.land(0.0, climb)
        time.sleep(climb + 1.0)
        commander.stop()


def main(arguments=None):
    """Read the command line, connect, and fly."""
    parser = argparse.ArgumentParser(description="Fly $file with a Crazyflie.")
    parser.add_argument("uri", help="of the Crazyflie, such as radio://0/80/2M/E7E7E7E7E7")
    parser.add_argument("--loops", type=int, default=LEAST_LOOPS, help=f"at least {LEAST_LOOPS}")
    parser.add_argument("--absolute", action="store_true", help="the file's axes are those of the positioning system")
    parser.add_argument("--height", type=float, default=None, help="m, of the hover before the flight")
    asked = parser.parse_args(arguments)
    if asked.loops < LEAST_LOOPS:
        parser.error(f"--loops {asked.loops}: the certified window lasts {LEAST_LOOPS} loops, fly at least as many")
    if asked.absolute and LOWEST < FLOOR:
        parser.error(f"--absolute: the path comes down to z = {LOWEST} m; fly it from where the Crazyflie hovers")
    height = asked.height if asked.height is not None else FIRST[2] if asked.absolute else HOVER
    if not asked.absolute and height - (FIRST[2] - LOWEST) < FLOOR:
        parser.error(f"--height {height}: the path goes down by {FIRST[2] - LOWEST:.2f} m from there; hover higher")
    from cflib import crtp
    from cflib.crazyflie import Crazyflie
    from cflib.crazyflie.syncCrazyflie import SyncCrazyflie
    from cflib.utils.reset_estimator import reset_estimator

    crtp.init_drivers()
    with SyncCrazyflie(asked.uri, cf=Crazyflie(rw_cache="./cache")) as link:
        reset_estimator(link)
        link.cf.platform.send_arming_request(True)
        time.sleep(1.0)
        flight(link.cf, asked.loops, not asked.absolute, height)


if __name__ == "__main__":
    main()
'''
"""The program, with $names for what differs between files."""


@result
class Loop:
    """The loop in a file of pieces."""

    ramp: float
    """s of either ramp."""
    period: float
    """s of one loop."""
    first: int
    """Number of the loop's first piece, from 0; as many pieces are a ramp."""
    count: int
    """Number of its pieces."""
    window: float
    """s: the window that the motion is judged by."""

    @property
    def least(self) -> int:
        """As many loops last as long as the window: a shorter flight holds no window that was judged."""
        return max(1, math.ceil(self.window / self.period - ROUNDING))


def loop_of(course: HoverRamps, first: int, count: int, window: float) -> Loop:
    """The loop of pieces `first` (from 0) to `first` + `count`; window (s): the one that the motion is judged by."""
    begin, end = course.steady
    return Loop(ramp=course.ramp, period=end - begin, first=first, count=count, window=window)


def looping(loop: Loop) -> str:
    """Which pieces are the loop, and how they are flown, as one sentence."""
    first, count = loop.first, loop.count
    if first == 0:
        pieces = f"all {count} pieces are one loop of {loop.period:.6g} s, which begins and ends at rest"
    else:
        pieces = (
            f"pieces 1 to {first} are the ramp in ({loop.ramp:g} s), {first + 1} to {first + count} are one loop "
            f"({loop.period:.6g} s), the last {first} are the ramp out"
        )
    how = f"at least {loop.least} times, because one window of {loop.window:.4g} s lasts as long"
    return f"{pieces}: fly the loop {how if loop.least > 1 else 'as often as you like'}"


def script(file: str, loop: Loop, place: Place) -> str:
    """A program in Python with cflib that takes off, uploads the file, flies the loop and lands.

    cflib's third argument of start_trajectory is whether a trajectory begins where the Crazyflie is; its name has
    changed between versions, so it is passed by its position.
    """
    ramp, first, count, after = loop.ramp, loop.first, loop.count, loop.first + loop.count
    on_floor = place.first[2] - place.anchor[2]
    return Template(PROGRAM).substitute(
        file=file,
        loops=max(loop.least, 2),
        first_point=_numbers(place.first),
        last_point=_numbers(place.last),
        lowest=f"{place.lowest:.4g}",
        room=_numbers(place.room),
        anchor=_numbers(place.anchor),
        floor=LOW,
        least=loop.least,
        window=f"{loop.window:.4g}",
        hover=f"{_hover(place):.4g}",
        why=", with the anchor on the floor" if _hover(place) == on_floor else "",
        climb=CLIMB,
        entry=f"    commander.define_trajectory(1, 0, {first})\n" if first else "",
        define=f"    commander.define_trajectory(2, {first} * {PIECE}, {count})\n",
        leaving=f"    commander.define_trajectory(3, {after} * {PIECE}, {first})\n" if first else "",
        ramp_in=_ramp(1, ramp) if first else "",
        period=f"{loop.period:.9g}",
        ramp_out=_ramp(3, ramp) if first else "",
    )


def _ramp(name: int, seconds: float) -> str:
    return f"    commander.start_trajectory({name}, 1.0, relative)\n    time.sleep({seconds:.9g})\n"


def _hover(place: Place) -> float:
    """m above the floor: where the anchor stands on the floor, if that is high enough; else clear of the floor."""
    on_floor, least = place.first[2] - place.anchor[2], place.first[2] - place.lowest + ABOVE
    return on_floor if on_floor >= least else least


def _numbers(point: Vec3) -> str:
    """A point as Python writes it, to a tenth of a millimetre."""
    return f"({', '.join(f'{value:.4f}' for value in point)})"
