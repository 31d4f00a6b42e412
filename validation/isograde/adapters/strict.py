"""JSON as its standard has it (RFC 8259), read and written.

Python's own reader takes ``NaN`` and ``Infinity``, which no other language need take, and its
errors do not say what to write instead. Here a number that is not finite is `null` where it is a
coordinate, and one of the texts `"NaN"`, `"Infinity"`, `"-Infinity"` where it is an isovalue.
"""

from __future__ import annotations

import json
import math
import re
from typing import Any

from isograde.adapters.texts import clean

# A text, or a word outside any text that is no JSON.
TEXT_OR_WORD = re.compile(r'"(?:\\.|[^"\\])*"|-?(?:NaN|Infinity)')
WORD = re.compile(r"[^\s,:\[\]{}]{1,24}|.", re.DOTALL)
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity|1\.#\w+)(?:\(\w*\))?", re.IGNORECASE)
WORDS = {"true": "true", "false": "false", "none": "null", "null": "null", "undefined": "null"}


class NotJSON(ValueError):  # noqa: N818 - named for what the text is
    """A text is not JSON; the message says where, what stands there, and what to write."""


def parse(text: str | bytes | bytearray) -> Any:
    """What a text of JSON says; raises `NotJSON`.

    >>> parse('{"vertices": [[0.5, 1, nan]]}')
    Traceback (most recent call last):
    isograde.adapters.strict.NotJSON: not JSON at column 24: nan; write null
    >>> parse('[1, -Infinity]')
    Traceback (most recent call last):
    isograde.adapters.strict.NotJSON: not JSON at column 5: -Infinity; write null
    """
    try:
        decoded = text if isinstance(text, str) else bytes(text).decode("utf-8")
    except UnicodeDecodeError as error:
        raise NotJSON(f"not UTF-8 at byte {error.start + 1}") from None
    try:
        return json.loads(decoded, parse_constant=_refuse)
    except _ConstantError:
        words = (one for one in TEXT_OR_WORD.finditer(decoded) if one[0][0] != '"')
        raise NotJSON(_told(decoded, next(words).start())) from None
    except json.JSONDecodeError as error:
        raise NotJSON(_told(decoded, error.pos, error.msg)) from None
    except RecursionError:
        raise NotJSON("not JSON that can be read: nested too deeply") from None
    except ValueError as error:
        raise NotJSON(f"not JSON that can be read: {error}") from None


class _ConstantError(Exception):
    """A bare NaN or Infinity."""


def _refuse(word: str) -> Any:
    """Nothing: no such word is JSON."""
    raise _ConstantError(word)


def _told(text: str, at: int, why: str = "") -> str:
    """Where a text is no JSON, what stands there, and what to write."""
    if at > 0 and text[at - 1] in "+-":
        at -= 1
    place = f"column {at - text.rfind(chr(10), 0, at)}"
    if line := text.count("\n", 0, at):
        place = f"line {line + 1}, {place}"
    found = WORD.match(text, at)
    if found is None:
        return f"not JSON at {place}: it ends there; {why[:1].lower()}{why[1:]}"
    word = clean(found[0])
    hint = why[:1].lower() + why[1:]
    if NOT_FINITE.fullmatch(word):
        hint = "write null"
    elif word.lower() in WORDS:
        hint = f"write {WORDS[word.lower()]}"
    elif word[0] == "'":
        hint = 'texts stand in double quotes: "'
    elif word in ("]", "}"):
        hint = "is there a comma too many before it?"
    return f"not JSON at {place}: {word}; {hint}"


def written(message: Any, indent: int | None = None) -> str:
    """The message as JSON without a bare NaN or Infinity; raises `ValueError` for one."""
    return json.dumps(message, allow_nan=False, ensure_ascii=False, indent=indent)


def isovalue(value: float) -> float | str:
    """An isovalue as messages have it.

    >>> isovalue(0.5), isovalue(float("nan")), isovalue(-float("inf"))
    (0.5, 'NaN', '-Infinity')
    """
    number = float(value)
    if math.isfinite(number):
        return number
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"
