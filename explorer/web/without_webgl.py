"""A browser without WebGL (a remote desktop, a locked-down school machine) still gets plots, controls and verdict.

viser 1.1.1 handles its messages inside the 3-D picture, so that without WebGL its page stays empty. A script at the
beginning of the page (without_webgl.js) gives such a browser a picture that draws nothing, and says what to do. Another
one (labels.js) gives the labels of the picture the colours of a dark page: it too must run before viser's own scripts.
"""

import gzip
from functools import lru_cache
from pathlib import Path

from websockets.http11 import Response

SENTENCE = (
    "<b>This browser cannot draw the 3-D picture: it has no WebGL.</b> Plots, controls and verdict work without it. "
    "To see the picture, switch on graphics acceleration in the settings of the browser and start the browser anew, or "
    "open this address in another browser."
)
HEAD = b"<head>"


def add_script(response: Response) -> None:
    """Put both scripts at the beginning of the page; any other answer stays as it is."""
    body, packed = response.body, response.headers.get("Content-Encoding") == "gzip"
    if response.status_code != 200 or not response.headers.get("Content-Type", "").startswith("text/html") or not body:
        return
    response.body = _with_script(bytes(body), packed)
    del response.headers["Content-Length"]
    response.headers["Content-Length"] = str(len(response.body))


@lru_cache(maxsize=2)
def _with_script(body: bytes, packed: bool) -> bytes:
    page = gzip.decompress(body) if packed else body
    without = Path(__file__).with_suffix(".js").read_text(encoding="utf-8").replace("SENTENCE", SENTENCE)
    labels = Path(__file__).with_name("labels.js").read_text(encoding="utf-8")
    scripts = "".join(f"<script>{source}</script>" for source in (without, labels))
    page = page.replace(HEAD, HEAD + scripts.encode(), 1)
    return gzip.compress(page) if packed else page
