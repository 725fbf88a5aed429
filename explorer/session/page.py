"""What one visitor's page is made of: the controls, the plots, the scene, the door and the part in a class; built once.

The session's loop reads the page and draws on it. A part that the loop asks for is an attribute without underscore.
"""

import time
from collections.abc import Callable
from functools import partial

import viser

from explorer.charts import GROUP_TITLES, Charts, markup
from explorer.charts.plot_size import plot_size
from explorer.model.glossary import COMPARE
from explorer.model.history import History
from explorer.model.playback import Playback
from explorer.panels.address import Address
from explorer.panels.camera import CameraPanel
from explorer.panels.commands import Commands
from explorer.panels.dock import Dock
from explorer.panels.session_actions import SessionActions
from explorer.panels.timeline import TimelinePanel
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from explorer.session.appearance import Appearance, set_theme
from explorer.session.display import Display
from explorer.session.export_tab import add_export_tab
from explorer.session.in_class import Alone, Part, Visit, part_in_class
from explorer.session.interaction import Interaction
from explorer.session.outgoing import Outgoing
from explorer.shared import Shared
from explorer.storage.catalog import Catalog
from explorer.web import connection, places
from explorer.web.access.visitors import Visitor
from explorer.web.door import Door
from explorer.web.frames import Frames
from explorer.widgets.form import Action, Form

PAPER, FIRST_LESSON = "paper", 1
"""The preset of the paper's figures, and the lesson that a new visitor is led to."""


class VisitorPage:
    """The page of one browser tab. It is empty until `build`, which takes a second."""

    def __init__(
        self, client: viser.ClientHandle, shared: Shared, visitor: Visitor | None, wake: Callable[[], None]
    ) -> None:
        """visitor: who has come in; None at this machine's own page. wake: called from any thread after a change."""
        self._client, self._shared, self._visitor, self._wake = client, shared, visitor, wake
        self.catalog = Catalog(shared.shipped, shared.library_of(visitor), shared.certifier)
        number = 0 if visitor is None else visitor.number
        self.form = Form(client.gui, wake, shared.share_of(visitor), number)
        self.jobs = self.form.new_jobs()
        self.in_class: Part = Alone()
        self.built = False
        """Whether the page is complete; it stays incomplete if the tab disconnects while the page is being built."""
        self.history = History()
        self.outgoing = Outgoing(client, self.catalog)
        self.playback = Playback(shared.shipped[shared.first].duration)

    def build(self, disconnected: Callable[[], bool]) -> None:
        """Build the page, or the dock alone if the tab has disconnected by then."""
        connection.send_in_large_batches(self._client)
        with self._client.atomic():  # a browser draws the page once, and not once more with each part that comes
            self._build_parts(disconnected)

    def _build_parts(self, disconnected: Callable[[], bool]) -> None:
        client, shared = self._client, self._shared
        set_theme(client, dark=False)
        client.gui.set_panel_label("rangenav")
        self.door = Door(client, self._wake, welcome=self._is_welcomed, style=markup.STYLE)
        self._actions = self._session_actions()
        self.dock = Dock(self.form, self.catalog, shared.first, self._actions, self.jobs, self.history)
        if disconnected():
            return
        self._build_pictures()
        self._join_class()
        self.appearance = Appearance(
            client, self.dock, self.charts, self._scene, self.display, in_class=self._visitor is not None
        )
        self.address = Address(
            client,
            self.dock,
            self.catalog,
            self.outgoing.notify,
            lesson=shared.lesson,
            record=lambda settings: self.history.record(settings, time.monotonic(), separate=True),
        )
        self._collect_actions()
        self.form.command("Copy a link to this page", self.address.copy_link, step=False)
        self._add_commands()
        places.install(client, first=self.in_class.first_tab)
        self.built = True

    @property
    def _is_welcomed(self) -> bool:
        """Whether a new visitor gets the card. In a class the teacher sees its tab at once, and leads the students."""
        return not (self._shared.requested or self._shared.lesson or self._visitor is not None)

    def _session_actions(self) -> SessionActions:
        """What the panels offer as buttons of the parts that are built after them."""
        return SessionActions(
            restart_preset=lambda: self.open(self.dock.origin),
            show_paper_figures=self._show_paper_figures,
            show_side_by_side=lambda: self.charts.show_side_by_side(),
            download_preset=lambda: self.outgoing.download_preset(self.dock),
            send=self.outgoing.download,
            go_to=lambda label: self._commands.go_to_control(label),
            go_to_place=lambda place: self._commands.go_to_place(place),
            rewind=lambda: self.playback.seek(0.0),
            notify=self.outgoing.notify,
        )

    def _build_pictures(self) -> None:
        """Build the timeline, the plots, the Export tab, the scene, and what a hand does in them."""
        client, dock, playback = self._client, self.dock, self.playback
        self._timeline = TimelinePanel(self.form, playback)
        camera = client.camera
        first_size = plot_size(camera.image_width, camera.image_height)  # until the browser has reported its window
        self.charts = Charts(client, first_size, wake=self._wake)
        self._scene = scene = Scene(client, self._wake)
        self._exporting = add_export_tab(client, dock, self.charts, scene, playback, self.outgoing, self._actions.go_to)
        self.form.command("Show all curves", self.charts.show_all_curves)
        self._camera = CameraPanel(self.form, scene)
        handles = DragHandles(client.scene, scene.labels, self._wake)
        self.form.command("Close the large plot, let go of the handle", partial(self._escape, handles), key="escape")
        self.interaction = Interaction(dock, self.charts, scene, handles, playback)
        self.display = Display(client, dock, self.charts, scene, handles, self._timeline, playback, Frames(client))

    def _join_class(self) -> None:
        visit = Visit(
            client=self._client,
            visitor=self._visitor,
            dock=self.dock,
            scene=self._scene,
            playback=self.playback,
            history=self.history,
            catalog=self.catalog,
            actions=self._actions,
            wake=self._wake,
        )
        self.in_class = part_in_class(visit, self._shared)
        self.dock.studies.follows = lambda: self.in_class.following

    def _collect_actions(self) -> None:
        self.actions: dict[str, Action] = self.dock.actions | self._timeline.actions | self.charts.actions
        """What the page's own buttons do, by the names that they send."""
        for part in (self._exporting, self._camera, self.in_class, self.address):
            self.actions |= part.actions
        self.actions |= {
            "learn": lambda: self.dock.learn.open_number(FIRST_LESSON),
            "go-tune": lambda: self._actions.go_to(COMPARE["tries"].caption),
        }

    def _add_commands(self) -> None:
        """Add the palette of commands."""
        self._commands = commands = Commands(
            self._client, self.form, self.outgoing.notify, in_class=self._visitor is not None
        )
        commands.add_plots(GROUP_TITLES)
        commands.add_presets({name: p.title for name, p in self._shared.shipped.items()}, self.open)
        commands.add_lessons(self.dock.learn.titles, self.dock.learn.open_number)

    def open(self, name: str) -> None:
        """Open a preset by its name."""
        self.dock.presets.open(name)

    def _show_paper_figures(self) -> None:
        self.open(PAPER)
        self.charts.show_paper_figures()

    def _escape(self, handles: DragHandles) -> None:
        self.charts.close_large()
        handles.deselect()

    def follow_window(self) -> None:
        """Take what the browser has reported last of its window."""
        self.appearance.follow(self.door.window, guest=self.in_class.following)
