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
    spec : how the implementation was named
    known : there is one of this name
    python : the implementation is a function in Python, and its author is advised in Python
    """

    started: bool = True
    advice: list[Advice] = fresh(default_factory=list)
    paste: str = ""
    spec: str = ""
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
        return "\n".join([*lines, *self.to_paste])

    @property
    def to_paste(self) -> list[str]:
        """Where the declaration goes, and the declaration as it is written there."""
        if self.paste == "{}":
            return ["Nothing has to be declared."]
        in_module = self.spec.startswith("python:")
        shown = f"declaration = {self.paste}" if in_module else self.paste
        return [place_of(self.spec), shown] if self.paste else []

    def _repr_html_(self) -> str:
        """The findings as a table, then the declaration to paste."""
        rows = "".join(
            f'<tr><td>{word}</td><td style="text-align:left">{escape(said)}</td></tr>'
            for word, said in self.told
        )
        pasted = "".join(f"<pre>{escape(line)}</pre>" for line in self.to_paste)
        return f"<table>{rows}</table>{pasted}"

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


# Where a declaration goes, by how an implementation is named.
PLACES = {
    "python": "put it into the module of the function (isograde explain python)",
    "exec": 'answer "start" with it (isograde explain exec)',
    "dir": "put it beside the meshes (isograde explain dir)",
}


def place_of(spec: str) -> str:
    """Where the declaration to paste goes.

    >>> place_of("exec:./mine")
    'The declaration to paste: answer "start" with it (isograde explain exec):'
    """
    known = PLACES.get(spec.split(":")[0], "isograde explain declaration tells of its words")
    return f"The declaration to paste: {known}:"


def paste(declaration: Declaration, spec: str = "") -> str:
    """The declaration as JSON, without what goes without saying, as a name that is `spec` does.

    >>> paste(Declaration("mine", vertices="cells", level=1))
    '{"name": "mine", "level": 1, "vertices": "cells"}'
    >>> paste(Declaration("python:mine:f", level=1), "python:mine:f")
    '{"level": 1}'
    """
    said, usual = declaration_json(declaration), declaration_json(Declaration("", version=""))
    for name in ("conventions", "limits"):
        said[name] = {k: v for k, v in said[name].items() if v != usual[name][k]}
    kept = {k: v for k, v in said.items() if v != usual[k] and v != {}}
    if "domain" in kept:
        ends = [one["end"] if not one["inset"] else one for one in kept["domain"]]
        kept["domain"] = ends[0] if len(ends) == 1 else ends
    if kept.get("name") == spec:
        del kept["name"]
    return json.dumps(kept)
