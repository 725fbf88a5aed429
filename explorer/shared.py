"""What the sessions of one server share: presets, kept work, the library, and the compiler that warms up."""

from dataclasses import dataclass, field

from explorer.storage.certifier import Certifying
from explorer.storage.files import Store
from explorer.storage.library import Library
from explorer.warming import Warming
from explorer.web.identity import Slots
from rangenav.preset import Preset


@dataclass(frozen=True, kw_only=True)
class House:
    """What all sessions share."""

    shipped: dict[str, Preset]
    first: str
    """The preset that a new visitor sees."""
    asked: bool
    """Whether it was asked for on the command line."""
    warming: Warming
    store: Store
    slots: Slots
    library: Library = field(default_factory=Library)
    certifying: Certifying = field(default_factory=Certifying)
