"""The log as lines of JSON, each whole, also with a traceback."""

import json
import logging
import sys

from explorer.web.logs import JsonLines


def _record(message: str, *arguments: object, error: bool = False) -> logging.LogRecord:
    said = sys.exc_info() if error else None
    return logging.LogRecord("explorer.session", logging.ERROR, "file.py", 1, message, arguments, said)


def test_a_line_of_the_log_is_one_json_object_with_time_level_and_message() -> None:
    line = json.loads(JsonLines().format(_record("session %s\nends", 3)))
    assert line["level"] == "ERROR"
    assert line["from"] == "explorer.session"
    assert line["message"] == "session 3\nends"
    assert line["time"].endswith("Z")


def test_a_traceback_is_a_field_of_the_same_line() -> None:
    try:
        raise ZeroDivisionError("of a test")
    except ZeroDivisionError:
        text = JsonLines().format(_record("session 3", error=True))
    assert "\n" not in text
    assert "ZeroDivisionError: of a test" in json.loads(text)["traceback"]
