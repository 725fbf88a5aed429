"""Terms of the motion and of the world in which it takes place."""

from explorer.model.glossary.term import Term

MOTION = {
    "speed": Term(
        label="speed (slower ⟷ faster)",
        meaning="How fast the path is run: 0.5 takes twice as long for the same path.",
        formula="over one period μ grows with the 7th power of the speed",
        place="paper, PE lemma",
        fields=("time_scale",),
    ),
    "window": Term(
        label="time window judged δ",
        unit="s",
        meaning="The length of flight over which excitation, rank and accuracy are judged.",
        formula="W = ∫ₜᵗ⁺ᵟ ΦᵀCᵀCΦ dτ",
        place="paper, uniform observability",
        advice="A drag across a plot sets it.",
        fields=("requirement.window",),
    ),
    "duration": Term(
        label="flight duration",
        unit="s",
        meaning="How long the flight is; a longer one takes longer to compute.",
        fields=("duration",),
    ),
    "path family": Term(
        label="path made of",
        meaning="The kind of curve; what you enter in one kind is kept while you use another.",
        fields=("path.kind",),
    ),
    "turning family": Term(
        label="turning made of",
        meaning="The kind of angular velocity ω(t), in body axes; “flown” lets the path decide the attitude.",
        fields=("angular_velocity.kind",),
    ),
    "amplitude": Term(
        label="amplitude",
        meaning="How far the tone swings to each side.",
        formula="A sin(ω t + φ₀), whose fourth derivative is A ω⁴ sin(ω t + φ₀)",
    ),
    "frequency": Term(
        label="frequency ω",
        unit="rad/s",
        meaning="How fast the tone swings at speed 1; twice the frequency has sixteen times the snap.",
    ),
    "phase": Term(
        label="phase φ₀",
        unit="rad",
        meaning="Where in its swing the tone starts; π/2 makes a cosine of a sine.",
    ),
    "second motion": Term(
        label="add a second motion",
        meaning="A second signal is added to the path: a planar path may need only a little of it.",
        fields=("path.wiggle",),
    ),
    "initial attitude": Term(
        label="initial attitude",
        unit="°",
        meaning="The attitude at the start, as a rotation vector about inertial axes: an axis as long as the angle.",
        formula="R(0)",
        fields=("initial_rotation",),
    ),
    "anchor": Term(
        label="anchor position",
        unit="m",
        meaning="Where the one anchor stands; it changes the accuracy, and never the excitation.",
        advice="Drag the beacon in the scene.",
        fields=("world.anchor",),
    ),
    "gravity": Term(
        label="gravity g",
        unit="m/s²",
        meaning="The acceleration of free fall in inertial axes; “up” in the scene is against it.",
        formula="v̇ = g + R a",
        place="paper, eq. 1",
        fields=("world.gravity",),
    ),
    "magnetic": Term(
        label="magnetic direction m",
        meaning="The direction of the magnetic field in inertial axes, of any length; it must not be that of gravity.",
        fields=("world.magnetic",),
    ),
    "vehicle": Term(
        label="vehicle",
        meaning="Whose limits the motion is held against; the path is marked where it breaks one.",
        advice="35 % of the thrust is kept in reserve.",
        fields=("vehicle", "vehicle.name"),
    ),
    "twin turn": Term(
        label="turn of the twin",
        unit="°",
        meaning="Turns the twin's path about the anchor, as dragging it does; its range stays the true one.",
    ),
    "twin axis": Term(
        label="axis of the twin's turn",
        meaning="The axis of the twin's turn in inertial axes, of any length but zero.",
    ),
}
