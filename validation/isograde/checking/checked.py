"""What a check found: verdicts with a sentence of advice each, and the declaration to paste."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from dataclasses import field as fresh

from isograde.declaration import Declaration, declaration_json
from isograde.model import Verdict

Advice = tuple[Verdict, str]


@dataclass
class Checked:
    """What was found: verdicts with a sentence each, and the declaration to paste."""

    started: bool = True
    advice: list[Advice] = fresh(default_factory=list)
    paste: str = ""

    @property
    def right(self) -> bool:
        """Nothing is to be mended."""
        return all(verdict in (Verdict.PASS, Verdict.SKIP) for verdict, _ in self.advice)

    def add(self, found: Iterable[Advice], what: str) -> None:
        """Take in advice; what is raised on the way is told, and ends nothing."""
        try:
            for one in found:
                self.advice.append(one)
        except Exception as error:  # noqa: BLE001 - told to who asked, as one more finding
            told = f"{what} could not be finished: {type(error).__name__}: {error}"
            self.advice.append((Verdict.ERROR, told))


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
