"""What a repaired motion is to be exported as, so that nothing is accepted that cannot be flown from a file."""

from dataclasses import dataclass, field

import msgspec

from rangenav import formats
from rangenav.certificate import certified_export
from rangenav.formats import ExportOptions
from rangenav.preset import Preset
from rangenav.signals import Flown


@dataclass(frozen=True, kw_only=True)
class ExportTarget:
    """A format and how a motion is written in it."""

    format_name: str
    options: ExportOptions = field(default_factory=ExportOptions)

    def searched(self, preset: Preset) -> Preset:
        """The preset with the attitude of its file, which is flown along the path, where that has an answer."""
        motion = formats.row(self.format_name).certified_as == "motion" and self.options.attitude == "flown"
        if not motion or isinstance(preset.angular_velocity, Flown):
            return preset
        try:
            return msgspec.structs.replace(preset, angular_velocity=Flown())
        except ValueError:
            return preset

    def refusal(self, preset: Preset) -> str | None:
        """Why a preset cannot be exported so with a certificate, one clause; None if it can."""
        design = msgspec.structs.replace(preset, expect="observable")
        refused = certified_export.refusal(design, self.format_name, self.options)
        return None if refused is None else str(refused)
