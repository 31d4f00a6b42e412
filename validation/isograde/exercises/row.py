"""What judges one submission: ``python -m isograde.exercises.row NUMBER FILE SECONDS``.

Reads a secret from its input, and prints one line of JSON: the secret, the result and what is told.
The submission itself runs in a worker process of its own, started after the secret was read.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from isograde.adapters import open_adapter
from isograde.bounds import GivenUp, at_most
from isograde.declaration import Declaration
from isograde.exercises import EXERCISES, told_through
from isograde.model import Adapter, AdapterError, Limits, Outcome, Request, Status

MEGABYTES = 2048
# A file may take so long to be imported, however short its calls must be.
START = 30.0


class Budgeted:
    """An adapter whose calls together may take so long; after that none is made."""

    def __init__(self, adapter: Adapter, seconds: float) -> None:
        self.adapter = adapter
        self.seconds = seconds
        self.spent = 0.0

    def open(self, limits: Limits) -> Declaration:
        """The implementation started."""
        return self.adapter.open(limits)

    def run(self, request: Request) -> Outcome:
        """The outcome of a call, or that there is no time left for it."""
        if self.spent >= self.seconds:
            told = f"the {self.seconds:g} s that all its calls may take are used up"
            return Outcome(Status.TIMEOUT, detail=told)
        start = time.monotonic()
        try:
            return self.adapter.run(request)
        finally:
            self.spent += time.monotonic() - start

    def close(self) -> None:
        """The implementation stopped."""
        self.adapter.close()


def said_of(number: int, path: Path, seconds: float) -> dict[str, Any]:
    """The result of a submission and what is told of it, as JSON has it."""
    adapter = Budgeted(open_adapter(f"python:{path}:extract"), seconds)
    start = max(seconds, START)
    try:
        with at_most(start):
            declared = adapter.open(Limits(seconds, MEGABYTES))
        found = told_through(EXERCISES[number], adapter, declared)
    except AdapterError as error:
        return {"result": "no answer", "told": [str(error)]}
    except GivenUp:
        return {"result": "no answer", "told": [f"its import took more than {start:g} s"]}
    finally:
        adapter.close()
    told = [f"{one.hint} ({one.case}: {one.detail})" if one.case else one.hint for one in found]
    return {"result": "still wrong" if found else "mended", "told": told}


def main() -> None:
    """One line of JSON."""
    number, path, seconds = sys.argv[1:]
    secret = sys.stdin.readline().strip()
    said = said_of(int(number), Path(path), float(seconds))
    print(json.dumps({"secret": secret, **said}), flush=True)


if __name__ == "__main__":
    main()
