"""Who may come in, when the page answers to other machines: a teacher by a link, students by a code or a link.

    teacher   http://ADDRESS/enter#token=…    256 random bits, never in a request's address
    students  http://ADDRESS/enter#key=…      128 random bits, in the QR code; or a code of six letters, typed
    both      a cookie of 256 random bits     HttpOnly, SameSite=Strict; required by every answer and every websocket

The secrets after # stay in the browser: a script sends them in a header, so that no log and no Referer ever holds them.
"""
