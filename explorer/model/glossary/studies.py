"""Terms of the maps of two parameters."""

from explorer.model.glossary.term import Term

STUDIES = {
    "map": Term(
        label="map of two parameters",
        meaning="One metric at each point of a grid of two parameters, with everything else as it is on the page.",
    ),
    "across": Term(
        label="across",
        meaning="The parameter along the horizontal axis of the map: any number of the preset, or of the path's scale.",
        advice="Type a part of its name to find it.",
    ),
    "upwards": Term(
        label="upwards",
        meaning="The parameter along the vertical axis of the map.",
        advice="Type a part of its name to find it.",
    ),
    "lowest": Term(label="lowest", meaning="The least value of the parameter on this axis, in its SI unit."),
    "highest": Term(label="highest", meaning="The largest value of the parameter on this axis, in its SI unit."),
    "points": Term(
        label="points",
        meaning="How many values the parameter takes on this axis.",
        advice="25 on both axes are 625 points; 65 are 4225, which take seven times as long.",
    ),
    "spacing": Term(
        label="spacing",
        meaning="Whether neighbouring values differ by equal steps or by equal factors.",
        advice="Equal factors suit gains, noise and sizes.",
    ),
    "metric": Term(
        label="metric",
        meaning="The number that the map shows at each point.",
        advice="Metrics of the same kind are computed together: choosing another one of them needs no new run.",
    ),
    "seeds per point": Term(
        label="seeds per point",
        meaning="Runs with different noise at each point, the same ones at all points; the map shows their mean, of a "
        "settling time their median, and of a yes or no the share that says yes.",
        advice="Only errors and settling times need runs.",
    ),
    "share": Term(
        label="share that meets the requirement",
        unit="%",
        meaning="How many of the computed points meet the requirement of the metric and keep the vehicle's limits.",
    ),
    "contour": Term(
        label="contour at the requirement",
        meaning="The line where the metric has the value that the preset requires, or the vehicle's limit.",
    ),
}
