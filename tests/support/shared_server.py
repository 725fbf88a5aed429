"""What sessions share, for servers that tests make themselves."""

import viser

from explorer.shared import Compilation, Shared
from explorer.storage.work_files import WorkFiles
from explorer.web.identity import Slots, connected
from rangenav import preset


def shared(server: viser.ViserServer, compilation: Compilation, first: str = "paper-slow") -> Shared:
    """Shipped presets, and work files in the folder that tests/conftest.py has set."""
    slots = Slots(lambda tab: connected(server, tab))
    return Shared(
        shipped=preset.shipped(),
        first=first,
        requested=False,
        compilation=compilation,
        work_files=WorkFiles(),
        slots=slots,
    )
