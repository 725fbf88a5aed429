"""The Presets tab: browse, read what a preset teaches, keep one's own, reproduce the paper's figures, download."""

import html
from typing import Protocol

import msgspec

from explorer.compute import Picture
from explorer.library import slug
from explorer.panels.card import card
from explorer.panels.controls import Choice, Text
from explorer.panels.gallery import Gallery
from explorer.panels.notes import NOTE
from explorer.panels.sheet import Action, Refused, Section, Sheet
from explorer.received import Received, preset_in
from explorer.settings import Settings, effective
from explorer.shelf import MINE, Shelf, bare, titled
from explorer.uploads import Uploads
from rangenav.preset import MAX_TITLE, Preset

ALSO = (
    "The first puts every control back to what the preset says. The second loads the paper's own scenario and shows "
    "the errors of position, velocity and gravity (fig. 3) and of attitude (fig. 4), and both paths (fig. 5)."
)
DOWNLOAD = "A TOML file of what is on the page now; its first lines state the verdict, computed from the file itself."
PICK = "Every shipped motion with its sensors, gains and requirement; ★ are yours. Ctrl+Z brings back what was there."
BROWSE = "Opens the one before or after it in the menu, or shows all of them as small pictures (and hides them again)."
TITLE = "Any letters will do; a new file's name is made of it."
KEEP = (
    "“save” writes what is on the page, under the title above, over your preset's file; “save as” keeps it as a new "
    "one; “duplicate” copies the preset as it was opened."
)
TIDY = (
    "Of the preset chosen above, if it is yours. “rename” changes title and file name. What is deleted goes to a "
    "trash, and “undo delete” brings back the last of it, also after a reload."
)
UPLOAD = "A preset file (.toml), or a zip with one as this page packs it; it joins your library and is opened."
LONGEST_TYPED = 4 * MAX_TITLE


class Page(Protocol):
    """What these panels need of the dock."""

    def read(self) -> Settings: ...
    def write(self, settings: Settings) -> None: ...


class PresetsPanel:
    """Picker, card and buttons."""

    def __init__(
        self,
        sheet: Sheet,
        shelf: Shelf,
        page: Page,
        uploads: Uploads,
        *,
        again: Action,
        paper: Action,
        download: Action,
    ) -> None:
        self._sheet, self._shelf, self._page = sheet, shelf, page
        self._section = section = Section(sheet)
        self._shown, self._changed = "", False
        self._deleted: list[str] = []
        self._words: dict[str, str] = {}
        with section:
            self._choice = Choice(section, "preset", shelf.words(next(iter(shelf.presets))), hint=PICK)
            browse = {"‹ previous": self._previous, "next ›": self._next, "see all": self._all}
            sheet.buttons("browse", browse, hint=BROWSE)
            self._card = sheet.gui.add_html("")
        self._gallery = Gallery(sheet, shelf, self.open)
        self._keeping = section = Section(sheet)  # its complaints stay until the next thing is asked for
        with section:
            self._title = Text(section, "title", hint=TITLE, longest=LONGEST_TYPED)
            keep = {"save": self._save, "save as": self._save_as, "duplicate": self._duplicate}
            sheet.buttons("keep", self._guarded(keep), hint=KEEP)
            tidy = {"rename": self._rename, "delete": self._delete, "undo delete": self._restore}
            sheet.buttons("tidy", self._guarded(tidy), hint=TIDY)
            self._said = sheet.gui.add_html("", visible=False)
            uploads.button("Upload a preset", self._upload, section.complaint.say, hint=UPLOAD)
            sheet.button("Download this preset", download, hint=DOWNLOAD)
            sheet.buttons("also", {"start this preset again": again, "the paper's figures 3–5": paper}, hint=ALSO)
        for label, action in (
            ("Download this preset", download),
            ("Start this preset again", again),
            ("The paper's figures 3–5", paper),
        ):
            sheet.command(label, action)
        sheet.command("Save the preset", self._guarded({"": self._save})[""])

    def read(self) -> str:
        """The name of the chosen preset. Raises Refused if the browser sent another."""
        with self._section.catching():
            return self._choice.read()

    def write(self, settings: Settings) -> None:
        """Show a preset's name, story and badge."""
        name = self._shown = settings.origin
        self._offer()
        self._choice.write(name, name)
        self._title.write(settings.preset.title, self._shelf.presets[name].title)
        self._draw_card()

    def draw(self, picture: Picture) -> None:
        """Say whether what is on the page is what the preset says."""
        settings = picture.settings
        self._changed = settings.time_scale != 1.0 or settings.preset != self._shelf.presets[settings.origin]
        self._draw_card()

    def refresh(self) -> None:
        """Show what other pages have done to the library, and certificates that have come."""
        self._shelf.refresh_now_and_then()
        self._offer()
        self._draw_card()

    def open(self, name: str) -> None:
        """Put a preset on the page. Raises Refused, and what is there stays, if its file cannot be read any more."""
        try:
            with self._keeping.catching():
                settings = self._shelf.open(name)
        except Refused:
            self._choice.show(self._shown)
            raise
        self._page.write(settings)

    def _previous(self) -> None:
        self._step(-1)

    def _next(self) -> None:
        self._step(1)

    def _step(self, by: int) -> None:
        """Open a neighbour in the menu; after the last comes the first."""
        names = list(self._shelf.words(self._shown))
        self.open(names[(names.index(self._shown) + by) % len(names)])

    def _all(self) -> None:
        self._gallery.toggle(self._shown)

    def _offer(self) -> None:
        """Bring the menu up to date; what is chosen there may be called otherwise now."""
        words = self._shelf.words(self._shown)
        if words != self._words:
            self._words = words
            self._choice.offer(words)
            self._choice.show(self._shown)

    def _draw_card(self) -> None:
        shown, found = self._shelf.presets[self._shown], self._shelf.badge(self._shown, self._sheet.note)
        content = card(shown, found, changed=self._changed)
        if self._shelf.complaint:
            content += NOTE.format(f"⚠ {html.escape(self._shelf.complaint)}")
        if content != self._card.content:
            self._card.content = content
        self._gallery.draw(self._shown)

    def _guarded(self, actions: dict[str, Action]) -> dict[str, Action]:
        """Actions that say beside the buttons why they failed."""

        def guard(action: Action) -> Action:
            def guarded() -> None:
                self._said.visible = False
                with self._keeping.catching():
                    action()

            return guarded

        return {label: guard(action) for label, action in actions.items()}

    def _save(self) -> None:
        settings = self._page.read()
        new = retitled(effective(settings), self._title.read())
        self._keep(settings, self._shelf.save(settings.origin, new, edition=settings.edition))
        self._say(f"saved as {self._name()}")

    def _save_as(self) -> None:
        settings = self._page.read()
        new = retitled(effective(settings), self._title.read())
        self._keep(settings, self._shelf.add(new))
        self._say(f"saved as {self._name()}{_instead(self._shown, new.title)}")

    def _duplicate(self) -> None:
        opened = self._shelf.presets[self._shown]
        copy = self._shelf.add(retitled(opened, f"{opened.title[: MAX_TITLE - 7]}, copy"))
        if self._changed:
            self._offer()
            self._say(f"kept as {file_of(copy.origin)}; the page still shows your changes to {self._name()}")
        else:
            self._page.write(copy)
            self._say(f"kept as {self._name()}, which is open now")

    def _rename(self) -> None:
        settings, title = self._page.read(), titled(self._title.read())
        opened = self._shelf.presets[settings.origin]
        renamed = self._shelf.rename(settings.origin, retitled(opened, title), edition=settings.edition)
        shown = msgspec.structs.replace(settings.preset, title=title)
        self._page.write(
            msgspec.structs.replace(settings, origin=renamed.origin, edition=renamed.edition, preset=shown)
        )
        self._say(f"renamed to {self._name()}{_instead(self._shown, title)}")

    def _delete(self) -> None:
        settings = self._page.read()
        self._deleted.append(self._shelf.delete(settings.origin, edition=settings.edition))
        self._say(f"{self._name()} is in the trash; what is on the page stays, and “undo delete” brings it back")
        self.refresh()

    def _restore(self) -> None:
        marks = self._deleted or self._shelf.deleted()[:1]  # this page's own first, then what went before it came
        if not marks:
            raise ValueError("nothing was deleted: the trash is empty")
        restored = self._shelf.restore(marks.pop())
        settings = self._page.read()
        if settings.origin == restored.origin:
            self.write(settings)
        else:
            self._offer()
        self._say(f"{file_of(restored.origin)} is back")

    def _upload(self, name: str, content: bytes) -> None:
        self._said.visible = False
        with self._keeping.catching():
            self._page.write(self._shelf.add(preset_in(Received(name, content))))
            self._say(f"{name} joined your library as {self._name()}")

    def _keep(self, settings: Settings, now: Settings) -> None:
        """What was saved is open now; what was entered beside it stays."""
        printed = msgspec.structs.replace(settings.printed, initial_values=False)  # they are in the path by now
        self._page.write(msgspec.structs.replace(now, printed=printed, drafts=settings.drafts))

    def _name(self) -> str:
        return file_of(self._shown)

    def _say(self, sentence: str) -> None:
        self._said.content = NOTE.format(f"✓ {html.escape(sentence)}")
        self._said.visible = True


def retitled(shown: Preset, title: str) -> Preset:
    """The same under another title. Raises ValueError if it is none."""
    return msgspec.structs.replace(shown, title=titled(title))


def _instead(name: str, title: str) -> str:
    """Says so if another file has the name that the title would make."""
    usual = slug(title)
    return "" if bare(name) == usual else f", beside {usual}.toml, which is left as it was"


def file_of(name: str) -> str:
    """The file of a preset on the shelf, for reading."""
    return f"{bare(name)}.toml" if name.startswith(MINE) else name
