"""What sessions share, for servers that tests make themselves."""

import viser

from explorer.house import House
from explorer.store import Store
from explorer.visitor import Slots, connected
from explorer.warming import Warming
from rangenav import preset


def house(server: viser.ViserServer, warming: Warming, first: str = "paper-slow") -> House:
    """Shipped presets, and a store where tests/conftest.py has put it."""
    slots = Slots(lambda tab: connected(server, tab))
    return House(shipped=preset.shipped(), first=first, asked=False, warming=warming, store=Store(), slots=slots)
