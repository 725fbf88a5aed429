"""The preset itself: a TOML file with every input of one run, read again without loss by `rangenav.preset.load`."""

from pathlib import Path

from rangenav import preset
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.preset import Preset


def write(chosen: Preset, path: Path) -> OutputFile:
    """Write the preset."""
    write_text(path, preset.dumps(chosen))
    return OutputFile(files=(path,), frame="as the preset has it")
