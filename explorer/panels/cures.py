"""What the buttons of the verdict change on the page: a slower flight, sensors that the observer models."""

from collections.abc import Callable

import msgspec

from explorer.model import slower
from explorer.widgets.page import Page
from rangenav.sensors import MODELLED


def slow_down(page: Page, notify: Callable[[str, str], None]) -> None:
    """Fly the motion as much slower as its vehicle's limits need. `notify` shows a title and a sentence."""
    settings = page.read()
    k = slower.factor(settings)
    if k:
        page.write(slower.slowed(settings, k))
    else:
        notify("Slower does not help", "No speed that was tried keeps every limit: choose another vehicle.")


def switch_effects_off(page: Page) -> None:
    """Switch off what the sensors do and the observer does not model."""
    settings = page.read()
    sensing = msgspec.structs.replace(settings.preset.sensors, unmodelled=MODELLED)
    preset = msgspec.structs.replace(settings.preset, sensors=sensing)
    page.write(msgspec.structs.replace(settings, preset=preset))
