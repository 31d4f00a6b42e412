"""What an implementation says, made fit for reports: cut, and without what breaks a file or a page.

Lone surrogates are no text, most control characters are no XML, and marks that turn the direction
of writing make a line say something else than it holds: all of them are spelt out.
"""

from __future__ import annotations

import re

LONGEST = 2000
# What a worker sends has room for a name and a place beside it.
SENT = 1500
LONGEST_NAME = 120
# Controls but tab and line feed, surrogates, what turns the direction of writing, no characters.
UNFIT = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff\ufffe\uffff]"
)


def clean(text: object, longest: int = LONGEST) -> str:
    r"""The text, cut, with unfit characters spelt out.

    >>> clean("red \x1b[31m and \ud800"), clean("abcdef", 3)
    ('red \\x1b[31m and \\ud800', 'abc.. (6 characters)')
    """
    whole = str(text)
    shown = UNFIT.sub(lambda found: ascii(found[0])[1:-1], whole[:longest])
    if max(len(whole), len(shown)) <= longest:
        return shown
    return f"{shown[:longest]}.. ({len(whole):,} characters)"


def clean_name(text: object) -> str:
    """A name on one line, cut."""
    return clean(" ".join(str(text)[: 4 * LONGEST_NAME].split()), LONGEST_NAME)
