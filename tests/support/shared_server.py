"""What sessions share, for servers that tests make themselves."""

import viser

from explorer.shared import House
from explorer.storage.files import Store
from explorer.warming import Warming
from explorer.web.identity import Slots, connected
from rangenav import preset


def house(server: viser.ViserServer, warming: Warming, first: str = "paper-slow") -> House:
    """Shipped presets, and a store where tests/conftest.py has put it."""
    slots = Slots(lambda tab: connected(server, tab))
    return House(shipped=preset.shipped(), first=first, asked=False, warming=warming, store=Store(), slots=slots)
