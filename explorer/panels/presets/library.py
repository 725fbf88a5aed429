"""The visitor's own presets: save, save as, duplicate, rename, delete, restore, upload; a sentence says the outcome."""

import html
from collections.abc import Callable

import msgspec
import viser

from explorer.model.settings import Settings, effective
from explorer.storage.catalog import MINE, Catalog, checked_title, display_name
from explorer.storage.import_file import ImportFile, preset_in
from explorer.storage.library import slug
from explorer.web.uploads import Uploads
from explorer.widgets.controls import Text
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE
from explorer.widgets.page import Page
from explorer.widgets.section import Section
from rangenav.preset import MAX_TITLE, Preset

TITLE_HINT = "Any letters will do; a new file's name is made of it."
SAVE_HINT = (
    "“save” writes what is on the page, under the title above, over your preset's file; “save as” keeps it as a new "
    "one; “duplicate” copies the preset as it was opened."
)
MANAGE_HINT = (
    "Of the preset chosen above, if it is yours. “rename” changes title and file name. What is deleted goes to a "
    "trash, and “undo delete” brings back the last of it, also after a reload."
)
UPLOAD_HINT = "A preset file (.toml), or a zip with one as this page packs it; it joins your library and is opened."
MAX_TYPED_TITLE = 4 * MAX_TITLE


class LibraryPanel:
    """A title, two rows of buttons and an upload."""

    def __init__(
        self,
        form: Form,
        catalog: Catalog,
        page: Page,
        uploads: Uploads,
        is_changed: Callable[[], bool],
        refresh_catalog: Action,
    ) -> None:
        """`is_changed`: whether the page differs from its preset. `refresh_catalog` reads the library's files again."""
        self._catalog, self._page, self._is_changed, self._refresh_catalog = catalog, page, is_changed, refresh_catalog
        self._open_name = ""
        self._trash_marks: list[str] = []
        self.section = section = Section(form)  # an error stays until the next button is pressed
        with section:
            self._title = Text(section, "title", hint=TITLE_HINT, longest=MAX_TYPED_TITLE)
            save_actions = {"save": self._save, "save as": self._save_as, "duplicate": self._duplicate}
            form.buttons("keep", self._guarded(save_actions), hint=SAVE_HINT)
            manage_actions = {"rename": self._rename, "delete": self._delete, "undo delete": self._restore}
            form.buttons("tidy", self._guarded(manage_actions), hint=MANAGE_HINT)
            self._message = form.gui.add_html("", visible=False)
        self._files = section = Section(form)
        with section:
            uploads.button("Upload a preset", self._upload, section.complaint.say, hint=UPLOAD_HINT)
            self._upload_message = form.gui.add_html("", visible=False)
        form.command("Save the preset", self._guarded({"": self._save})[""])

    def write(self, settings: Settings) -> None:
        """Show the title to save under."""
        self._open_name = settings.origin
        self._title.write(settings.preset.title, self._catalog.presets[settings.origin].title)

    def forget_preset(self) -> None:
        """Drop what was said of a preset that is not on the page any more."""
        self._message.visible = self._upload_message.visible = False

    def _guarded(self, actions: dict[str, Action]) -> dict[str, Action]:
        """The same actions, with the reason below the buttons if one fails."""

        def guard(action: Action) -> Action:
            def guarded() -> None:
                self._message.visible = False
                with self.section.catching():
                    action()

            return guarded

        return {label: guard(action) for label, action in actions.items()}

    def _save(self) -> None:
        settings = self._page.read()
        new = retitled(effective(settings), self._title.read())
        self._show_saved(settings, self._catalog.save(settings.origin, new, edition=settings.edition))
        self._confirm(f"saved as {self._name()}")

    def _save_as(self) -> None:
        settings = self._page.read()
        new = retitled(effective(settings), self._title.read())
        self._show_saved(settings, self._catalog.add(new))
        self._confirm(f"saved as {self._name()}{_other_file_note(self._open_name, new.title)}")

    def _duplicate(self) -> None:
        opened = self._catalog.presets[self._open_name]
        copy = self._catalog.add(retitled(opened, f"{opened.title[: MAX_TITLE - 7]}, copy"))
        if self._is_changed():
            self._refresh_catalog()
            self._confirm(f"kept as {file_text(copy.origin)}; the page still shows your changes to {self._name()}")
        else:
            self._page.write(copy)
            self._confirm(f"kept as {self._name()}, which is open now")

    def _rename(self) -> None:
        settings, title = self._page.read(), checked_title(self._title.read())
        opened = self._catalog.presets[settings.origin]
        renamed = self._catalog.rename(settings.origin, retitled(opened, title), edition=settings.edition)
        shown = msgspec.structs.replace(settings.preset, title=title)
        self._page.write(
            msgspec.structs.replace(settings, origin=renamed.origin, edition=renamed.edition, preset=shown)
        )
        self._confirm(f"renamed to {self._name()}{_other_file_note(self._open_name, title)}")

    def _delete(self) -> None:
        settings = self._page.read()
        self._trash_marks.append(self._catalog.delete(settings.origin, edition=settings.edition))
        self._confirm(f"{self._name()} is in the trash; what is on the page stays, and “undo delete” brings it back")
        self._refresh_catalog()

    def _restore(self) -> None:
        marks = self._trash_marks or self._catalog.deleted()[:1]  # first what this page has deleted, then older files
        if not marks:
            raise ValueError("nothing was deleted: the trash is empty")
        restored = self._catalog.restore(marks.pop())
        self._refresh_catalog()
        self._confirm(f"{file_text(restored.origin)} is back")

    def _upload(self, name: str, content: bytes) -> None:
        self._upload_message.visible = False
        with self._files.catching():
            self._page.write(self._catalog.add(preset_in(ImportFile(name, content))))
            _show_message(self._upload_message, f"{name} joined your library as {self._name()}")

    def _show_saved(self, settings: Settings, now: Settings) -> None:
        """Show the saved preset; drafts and switches stay as they are."""
        printed = msgspec.structs.replace(settings.printed, initial_values=False)  # the saved path includes them
        self._page.write(msgspec.structs.replace(now, printed=printed, drafts=settings.drafts))

    def _name(self) -> str:
        return file_text(self._open_name)

    def _confirm(self, sentence: str) -> None:
        _show_message(self._message, sentence)


def retitled(shown: Preset, title: str) -> Preset:
    """The same preset under another title. Raises ValueError for a title that is empty or too long."""
    return msgspec.structs.replace(shown, title=checked_title(title))


def _show_message(line: viser.GuiHtmlHandle, sentence: str) -> None:
    line.content = NOTE.format(f"✓ {html.escape(sentence)}")
    line.visible = True


def _other_file_note(name: str, title: str) -> str:
    """A remark if the file has another name than its title suggests, because another file has that name."""
    suggested = slug(title)
    return "" if display_name(name) == suggested else f", beside {suggested}.toml, which is left as it was"


def file_text(name: str) -> str:
    """The name of a preset's file, for a sentence."""
    return f"{display_name(name)}.toml" if name.startswith(MINE) else name
