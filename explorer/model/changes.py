"""A change of the preset that a search or a cure has found, put into settings that a visitor may have changed since."""

import msgspec

from explorer.model.settings import Settings, effective
from rangenav.preset import Preset


def with_changes(settings: Settings, before: Preset, after: Preset) -> Settings:
    """The settings with what differs between two presets, and with everything else as the visitor has chosen it.

    The changed path contains the time scale and the printed initial values, so both are switched off.
    """
    changed = {
        name: getattr(after, name) for name in after.__struct_fields__ if getattr(after, name) != getattr(before, name)
    }
    printed = msgspec.structs.replace(settings.printed, initial_values=False)
    preset = msgspec.structs.replace(effective(settings), **changed)
    return msgspec.structs.replace(settings, preset=preset, time_scale=1.0, printed=printed)
