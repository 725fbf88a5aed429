"""The settings as a piece of text that fits into a link, and back.

    settings → JSON → zlib → base64url          the fragment of a link, #s=…

A browser sends no fragment to a server, so what is shared stays out of its log. Whoever opens a link may have typed
anything: sizes are bounded before and after it is unpacked, and what is no settings gets a sentence.
"""

import base64
import binascii
import zlib

import msgspec

from explorer.model.settings import Drafts, Settings
from rangenav.inputs import require, shortened

KEY = "s"
"""The name before the text in the fragment."""
MAX_LINK, MAX_SETTINGS = 12_000, 400_000
"""Characters of the text, and bytes of what it unpacks to: every browser takes such a link, and most mail programs."""
BROKEN = "The link is damaged: it may have been cut when it was copied. Ask for it once more."


def link_text(settings: Settings) -> str:
    """The text of some settings; drafts of what is not in use stay at home. Raises ValueError if they are too large."""
    shared = msgspec.structs.replace(settings, drafts=Drafts(), edition="")
    text = base64.urlsafe_b64encode(zlib.compress(msgspec.json.encode(shared), 9)).decode().rstrip("=")
    rule = f"this is too large for a link, {len(text)} characters of at most {MAX_LINK}"
    require(len(text) <= MAX_LINK, f"{rule}: send the preset as a file instead (Presets, “Download this preset”)")
    return text


def from_link(text: str) -> Settings:
    """The settings of a link's text. Raises ValueError with one sentence for anything else."""
    require(len(text) <= MAX_LINK, f"The link has {len(text)} characters, and may have {MAX_LINK}.")
    try:
        packed = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        unpacker = zlib.decompressobj()
        content = unpacker.decompress(packed, MAX_SETTINGS)
    except (binascii.Error, ValueError, zlib.error):
        raise ValueError(BROKEN) from None
    require(unpacker.eof and not unpacker.unused_data, BROKEN)
    try:
        return msgspec.json.decode(content, type=Settings)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise ValueError(f"The link holds no settings of this version: {shortened(str(error))}.") from None
