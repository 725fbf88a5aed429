"""The sections of a certificate on the motion: extremes, vehicle, jumps, source file and frame."""

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import continuity, provenance, record, vehicle
from rangenav.certificate import schema
from rangenav.certificate.schema import figure
from rangenav.observability import blindness
from rangenav.preset import Preset
from rangenav.signals import Flown
from rangenav.vehicle import THRUST_MARGIN


def limits_section(preset: Preset) -> tuple[schema.Extremes, schema.Flyability]:
    """The motion's extremes on the IMU's samples, and whether the preset's vehicle can fly it."""
    motion = record.simulated(record.truth_inputs(preset)).motion
    demands = vehicle.demands(motion, world=preset.world)
    broken = tuple(one.summary for one in vehicle.broken(motion, preset.vehicle, world=preset.world))
    jump = continuity.discontinuity(preset.path, preset.duration)
    limits = schema.Extremes(
        speed=_most(demands.speed),
        acceleration=_most(demands.acceleration),
        jerk=_most(demands.jerk),
        snap=_most(demands.snap),
        thrust_to_weight=_most(demands.thrust_to_weight),
        tilt_deg=_most(np.degrees(demands.tilt)),
        body_rate=_most(demands.body_rate),
        height_min=figure(float(demands.height.min())),
        height_max=_most(demands.height),
        anchor_distance_min=figure(float(demands.anchor_distance.min())),
        rate=preset.sensors.imu_rate,
    )
    flying = schema.Flyability(
        name=preset.vehicle.name,
        flyable=not broken and jump is None,
        thrust_margin=THRUST_MARGIN,
        broken=broken if jump is None else (jump, *broken),
    )
    return limits, flying


def _most(values: Float[Array, "n"]) -> float:
    return figure(float(values.max()))


def jumps_section(preset: Preset) -> schema.Jumps:
    """The largest jumps at knots strictly inside the flight."""
    jumps = continuity.flight_jumps(preset.path, preset.duration)
    position, velocity, acceleration, jerk, snap = jumps.sizes
    return schema.Jumps(
        knots=jumps.knots, position=position, velocity=velocity, acceleration=acceleration, jerk=jerk, snap=snap
    )


def source_section(preset: Preset) -> schema.SourceFile | msgspec.UnsetType:
    """The file that the path was imported from."""
    imported_from = preset.source
    if imported_from is None:
        return msgspec.UNSET
    return schema.SourceFile(
        file=imported_from.file,
        sha256=imported_from.sha256,
        format=imported_from.format,
        derivatives=imported_from.derivatives,
        fitted=imported_from.fitted,
        edited=provenance.edited(imported_from, preset.path),
    )


def frame_section(preset: Preset) -> schema.Frame:
    """Which way is up, and where the attitude comes from."""
    gravity = np.asarray(preset.world.gravity)
    up = -gravity / np.linalg.norm(gravity)
    k = int(np.argmax(np.abs(up)))
    axis = ("-" if up[k] < 0 else "+") + "xyz"[k]
    return schema.Frame(
        gravity=preset.world.gravity,
        up=axis if abs(up[k]) > 1 - 1e-12 else blindness.name(up),
        body="flown along the path" if isinstance(preset.angular_velocity, Flown) else "angular velocity of its own",
    )
