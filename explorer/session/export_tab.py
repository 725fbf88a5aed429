"""The Export tab: plots, scene, handout; what can be saved of what is on the page."""

from collections.abc import Callable
from functools import partial

import viser

from explorer.charts import TITLES, Charts
from explorer.model.playback import Playback
from explorer.panels.dock import Dock
from explorer.panels.export import ExportActions, ExportPanel
from explorer.panels.handout import HandoutPanel
from explorer.panels.scene_file import SceneFilePanel
from explorer.scene import Scene
from explorer.session.outgoing import Outgoing


def add_export_tab(
    client: viser.ClientHandle,
    dock: Dock,
    charts: Charts,
    scene: Scene,
    playback: Playback,
    outgoing: Outgoing,
    go_to: Callable[[str], None],
) -> ExportPanel:
    """Add the tab to the dock. `go_to` brings the control with a label into sight."""
    named_settings = partial(outgoing.named_settings, dock)
    with dock.tabs.add_tab("Export"):
        exports = ExportActions(
            plan_plot=charts.file_writer, settings=named_settings, download=outgoing.download, go_to=go_to
        )
        exporting = ExportPanel(dock.form, TITLES, exports)
        dock.belonging.append(exporting)
        dock.following.append(exporting.draw)
        scene_file = SceneFilePanel(
            dock.form,
            client,
            playback,
            stem=lambda: named_settings()[0].removesuffix(".toml"),
            download=outgoing.download,
            instruct=scene.instruct,
        )
        dock.following.append(scene_file.draw)
        HandoutPanel(dock.form, settings=named_settings, lesson=lambda: dock.learn.lesson, download=outgoing.download)
    return exporting
