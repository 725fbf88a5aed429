"""The Presets tab: browse presets, read their stories, save your own, reproduce the paper's figures, download."""

import html
from contextlib import suppress

from explorer.model.compute import Picture
from explorer.model.settings import Settings, effective
from explorer.panels.presets.card import card, card_of_changed
from explorer.panels.presets.gallery import Gallery
from explorer.panels.presets.library import LibraryPanel
from explorer.panels.session_actions import SessionActions
from explorer.storage.catalog import Catalog
from explorer.web.uploads import Uploads
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE
from explorer.widgets.page import Page
from explorer.widgets.section import Section
from rangenav.preset import Preset

MORE_HINT = (
    "The first puts every control back to what the preset says. The second loads the paper's own scenario and shows "
    "the errors of position, velocity and gravity (fig. 3) and of attitude (fig. 4), and both paths (fig. 5)."
)
DOWNLOAD_HINT = (
    "A TOML file of what is on the page now; its first lines state the verdict, computed from the file itself."
)
PRESET_HINT = (
    "Every shipped motion with its sensors, gains and requirement; ★ are yours. Ctrl+Z brings back what was there."
)
BROWSE_HINT = (
    "Opens the one before or after it in the menu, or shows all of them as small pictures (and hides them again)."
)


class PresetsPanel:
    """A menu of presets, the summary of the chosen one, and buttons."""

    def __init__(
        self,
        form: Form,
        catalog: Catalog,
        page: Page,
        uploads: Uploads,
        session_actions: SessionActions,
    ) -> None:
        self._form, self._catalog, self._page = form, catalog, page
        self._section = section = Section(form)
        self._shown, self._changed = "", False
        self._on_page: Preset | None = None
        """What the page shows, if that is not what the preset says; it follows once the visitor's hand rests."""
        self._labels: dict[str, str] = {}
        with section:
            self._choice = Choice(section, "preset", catalog.labels(next(iter(catalog.presets))), hint=PRESET_HINT)
            browse = {"‹ previous": self._previous, "next ›": self._next, "see all": self._toggle_gallery}
            form.buttons("browse", browse, hint=BROWSE_HINT)
            self._card = form.gui.add_html("")
        self._gallery = Gallery(form, catalog, self.open)
        self._library = LibraryPanel(
            form, catalog, page, uploads, is_changed=lambda: self._changed, refresh_catalog=self.refresh
        )
        with Section(form):
            form.button("Download this preset", session_actions.download_preset, hint=DOWNLOAD_HINT)
            form.buttons(
                "also",
                {
                    "start this preset again": session_actions.restart_preset,
                    "the paper's figures 3–5": session_actions.show_paper_figures,
                },
                hint=MORE_HINT,
            )
        for label, action in (
            ("Download this preset", session_actions.download_preset),
            ("Start this preset again", session_actions.restart_preset),
            ("The paper's figures 3–5", session_actions.show_paper_figures),
        ):
            form.command(label, action)

    def read(self) -> str:
        """The name of the chosen preset. Raises InvalidInputError if the browser sent a name that is not offered."""
        with self._section.checking():
            return self._choice.read()

    def write(self, settings: Settings) -> None:
        """Show a preset's name, story and badge."""
        name = self._shown = settings.origin
        self._update_menu()
        self._choice.write(name, name)
        self._library.write(settings)
        self._draw_card()

    def draw(self, picture: Picture) -> None:
        """Say whether what is on the page is what the preset says."""
        settings, before = picture.settings, self._changed
        self._changed = settings.time_scale != 1.0 or settings.preset != self._catalog.presets[settings.origin]
        if self._changed and not before:
            self._library.forget_preset()  # what was saved is not on the page any more
        if not self._changed:
            self._on_page = None
        self._draw_card()

    def draw_details(self, picture: Picture) -> None:
        """Show the motion of a picture in the summary, if the preset was changed."""
        self._on_page = effective(picture.settings) if self._changed else None
        self._draw_card()

    def forget_preset(self) -> None:
        """Drop what was said of saving the preset."""
        self._library.forget_preset()

    def refresh(self) -> None:
        """Show what other pages have changed in the library, certificates that are ready, and why a name is refused."""
        with suppress(InvalidInputError), self._section.catching():
            self.read()
        self._catalog.refresh_if_due()
        self._update_menu()
        self._draw_card()

    def open(self, name: str) -> None:
        """Show a preset. Raises InvalidInputError, and the page stays as it is, if its file cannot be read."""
        try:
            with self._library.section.catching():
                settings = self._catalog.open(name)
        except InvalidInputError:
            self._choice.show(self._shown)
            raise
        self._page.write(settings)

    def _previous(self) -> None:
        self._step(-1)

    def _next(self) -> None:
        self._step(1)

    def _step(self, by: int) -> None:
        """Open a neighbour in the menu; after the last comes the first."""
        names = list(self._catalog.labels(self._shown))
        self.open(names[(names.index(self._shown) + by) % len(names)])

    def _toggle_gallery(self) -> None:
        self._gallery.toggle(self._shown)

    def _update_menu(self) -> None:
        """Update the menu; the label of the chosen preset may have changed."""
        labels = self._catalog.labels(self._shown)
        if labels != self._labels:
            self._labels = labels
            self._choice.offer(labels)
            self._choice.show(self._shown)

    def _draw_card(self) -> None:
        shown = self._catalog.presets[self._shown]
        certificate_or_reason = self._catalog.badge(self._shown, shown, self._form.wake)
        content = (
            card_of_changed(self._on_page or shown, shown, certificate_or_reason)
            if self._changed
            else card(shown, certificate_or_reason)
        )
        if self._catalog.complaint:
            content += NOTE.format(f"⚠ {html.escape(self._catalog.complaint)}")
        if content != self._card.content:
            self._card.content = content
        self._gallery.draw(self._shown)
