"""Formats that cannot keep a motion persistently exciting, and why: not written, because nothing could certify them.

A Crazyflie's compressed Bézier curve rounds every control point to a millimetre and each length to a millisecond: on
one gentle path λ_min of the excitation went from 804 to 15 649, all of it rounding. A ground-control plan keeps places
and speeds but no times; the autopilot decides when to be where, and excitation is a matter of time.
"""

REFUSED = {
    "bezier": "compressed Bézier curves round control points to a millimetre, which replaces the path's snap by "
    "rounding (an excitation of 804 became 15 649): nothing about it can be certified; export it as polynomial instead",
    "qgc": "a QGroundControl plan keeps waypoints but not when to pass them, and excitation is a matter of time: "
    "nothing about it can be certified; export it as reference or polynomial instead",
}
