"""The JSON object of `rangenav log`, part by part; null always has its reason beside it."""

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # imported when used: they take long
    from rangenav.flight_summary import ObserverSummary, WindowSummary
    from rangenav.formats import Flight, ImportResult
    from rangenav.logs import Informative, WholeRecord


def file_report(imported: "ImportResult", flight: "Flight", world_source: str) -> dict[str, Any]:
    """Format, rate, frame and findings of the file; the source of the world is one more finding.

    `rows` are those of the file, `imu_rows` those of the IMU in the part that is used.
    """
    return {
        "file": imported.source,
        "format": imported.format,
        "rows": imported.rows,
        "imu_rows": len(flight.time),
        "rate": imported.rate,
        "duration": float(flight.time[-1] - flight.time[0]),
        "frame": imported.frame,
        "findings": [*imported.findings, *([world_source] if world_source else [])],
        "columns_not_used": [name for name, use in imported.columns if not use],
    }


def ranges_report(source: str) -> dict[str, Any]:
    """The ranges that the record is judged with, and where their anchor comes from; null without ranges."""
    return {"ranges_source": source} if source else {"ranges_source": None, "ranges_source_reason": "null: no ranges"}


def verdict_report(whole: "WholeRecord") -> dict[str, Any]:
    """The verdict on the whole record; null with the reason where it is not judged, or has too few ranges."""
    if whole.verdict in ("observable", "weak", "blind"):
        return {"verdict": whole.verdict}
    reason = whole.restriction or f"{whole.verdict}: {whole.ranges} of the 13 that are needed"
    return {"verdict": None, "verdict_reason": f"null: {reason}"}


def whole_report(whole: "WholeRecord") -> dict[str, Any]:
    """What the whole record determines, and the windows that suffice for it."""
    report: dict[str, Any] = {
        "begin": whole.begin,
        "end": whole.end,
        "rank": whole.rank,
        "motion_rank": whole.motion_rank,
        "ranges": whole.ranges,
        "position": whole.position,
        "window_suffices": whole.suffices,
        "window_shortest": whole.shortest,
        "words": whole.summary,
    }
    if whole.position is None:
        report["position_reason"] = f"null: {whole.verdict}"
    if whole.suffices is None:
        report["window_suffices_reason"] = "null: no window that was tried is observable everywhere"
    if whole.shortest is None:
        report["window_shortest_reason"] = "null: no window that was tried is observable"
    return report


def windows_report(windows: "WindowSummary", informative: "Informative") -> dict[str, Any]:
    """Observability of the record's windows. No window is called "rank 13" any more; the key is kept."""
    report: dict[str, Any] = {
        "window": windows.window,
        "windows": {**windows.counts, "rank 13": 0},
        "verdict": informative.verdict,
        "at": windows.worst_start,
        "rank": windows.worst_rank,
        "motion_rank": windows.motion_rank,
        "ranges": windows.worst_ranges,
        "eigenvalues": list(windows.worst_eigenvalues),
        "position": windows.worst_position,
        "position_median": windows.median_position,
        "words": informative.summary,
    }
    if windows.worst_position is None:
        report["reason"] = "null: blind there, or with too few ranges"
    return report


def observer_report(observer: "ObserverSummary", *, blind: bool, failure: str | None) -> dict[str, Any]:
    """The observers' estimates; errors by quarters where the file has the true motion. blind: see `WholeRecord`.

    failure: why the observer failed, if it did; see `flight_summary.failure`.
    """
    report: dict[str, Any] = {
        "final_position": list(observer.final_position),
        "innovation_rms": observer.innovation_rms,
        "diverged": observer.diverged is not None,
        "fit": observer.fit.report(blind=blind),
        "range_residual": observer.range_residual if math.isfinite(observer.range_residual) else None,
    }
    for name, errors in (("position", observer.position), ("attitude_deg", observer.attitude)):
        if errors is None:
            report[name], report[f"{name}_reason"] = None, "null: no truth in the file"
            continue
        report[name] = {"quarters_rmse": list(errors.quarters), "median": errors.median}
        if not errors.complete:
            report[name]["reason"] = "null: the estimate overflowed, or no truth there"
    if not math.isfinite(observer.range_residual):
        report["range_residual_reason"] = "null: the estimate overflowed"
    if observer.diverged is not None:
        report["diverged_reason"] = observer.diverged
    if failure is not None:
        report["failure"] = failure
    if not observer.complete:
        report["reason"] = "null: the estimate overflowed"
    return report
