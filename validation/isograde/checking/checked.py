"""What a check found: verdicts with a sentence of advice each, and the declaration to paste."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from dataclasses import field as fresh
from html import escape

from isograde.declaration import Declaration, declaration_json
from isograde.model import Verdict

# Advice is in no particular language, but for words like <: simplices.astype(int)>.
ONLY_PYTHON = re.compile(r"<([:;,][^<>]*)>")
Advice = tuple[Verdict, str]

# How a verdict is called here.
SAID = {Verdict.PASS: "right", Verdict.FAIL: "wrong", Verdict.SKIP: "note"}


@dataclass
class Checked:
    """What was found: verdicts with a sentence each, and the declaration to paste.

    started : the implementation did
    known : there is one of this name
    python : the implementation is a function in Python, and its author is advised in Python
    """

    started: bool = True
    advice: list[Advice] = fresh(default_factory=list)
    paste: str = ""
    known: bool = True
    python: bool = True

    @property
    def right(self) -> bool:
        """Nothing is to be mended."""
        return all(verdict in (Verdict.PASS, Verdict.SKIP) for verdict, _ in self.advice)

    @property
    def told(self) -> list[tuple[str, str]]:
        """What is right, wrong or to be noted, with a sentence each."""
        return [(SAID.get(verdict, verdict.value), said) for verdict, said in self.advice]

    def __str__(self) -> str:
        """A line a finding, then the declaration to paste."""
        lines = [f"{word:>11}  {said}" for word, said in self.told]
        return "\n".join([*lines, *([self.paste] if self.paste else [])])

    def _repr_html_(self) -> str:
        """The findings as a table, then the declaration to paste."""
        rows = "".join(
            f'<tr><td>{word}</td><td style="text-align:left">{escape(said)}</td></tr>'
            for word, said in self.told
        )
        pasted = f"<p>The declaration to paste:</p><pre>{escape(self.paste)}</pre>"
        return f"<table>{rows}</table>{pasted if self.paste else ''}"

    def add(self, found: Iterable[Advice], what: str) -> None:
        """Take in advice; what is raised on the way is told, and ends nothing."""
        try:
            for one in found:
                self.advice.append((one[0], in_words(one[1], python=self.python)))
        except Exception as error:  # noqa: BLE001 - told to who asked, as one more finding
            told = f"{what} could not be finished: {type(error).__name__}: {error}"
            self.advice.append((Verdict.ERROR, told))


def in_words(sentence: str, *, python: bool) -> str:
    """The advice, with what is in angle brackets, for Python alone, or without it.

    >>> in_words("reverse each row<, simplices[:, ::-1]>", python=False)
    'reverse each row'
    """
    return ONLY_PYTHON.sub(lambda found: found[1] if python else "", sentence)


def paste(declaration: Declaration) -> str:
    """The declaration as JSON, without what goes without saying.

    >>> paste(Declaration("mine", vertices="cells", level=1))
    '{"name": "mine", "level": 1, "vertices": "cells"}'
    """
    said, usual = declaration_json(declaration), declaration_json(Declaration("", version=""))
    for name in ("conventions", "limits"):
        said[name] = {k: v for k, v in said[name].items() if v != usual[name][k]}
    kept = {k: v for k, v in said.items() if v != usual[k] and v != {}}
    if "domain" in kept:
        ends = [one["end"] if not one["inset"] else one for one in kept["domain"]]
        kept["domain"] = ends[0] if len(ends) == 1 else ends
    return json.dumps(kept)
