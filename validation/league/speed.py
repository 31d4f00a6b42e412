"""Speed and memory of the league's methods, as ratios to one peer measured in turn with each.

``python validation/league/speed.py [METHOD ..]``. The peer is `PEER`. It and the method answer the
same protocol, each in its own process; the service inside measures the call alone, from samples in
C order to arrays: conversions that the method needs are included, the protocol's files and text are
not. A round asks one and then the other, and who comes first changes; the ratio is of the same
round. Seconds are the processor's, of all threads, which others on the machine disturb less than
those of the clock; both are kept. Memory is what the first call on a field of this size adds at its
highest to a process that has answered a small one.

The result, `reports/league/speed.json`, has every number with the load of the machine; the page to
choose by shows it. Methods that are there in this version are left alone, unless ``--again`` is
said.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import league
import numpy as np
import versions
from isograde.adapters import open_adapter
from isograde.model import Adapter, AdapterError, Limits, Request, Status
from isograde.report.speed import BUSY
from isograde.stopwatch import Cost, in_turn
from isoref import Field

PEER = ("skimage", "skimage:lewiner")
RESULT = league.SPEED
ROUNDS = 7
LIMITS = Limits(120.0, 8192)
# Asked first, so that libraries are loaded before anything is measured.
SMALL = 8


def fields() -> dict[str, np.ndarray[Any, Any]]:
    """What is asked of each: a ball, of which few cells are crossed, and waves, of which many."""
    places = np.indices((96, 96, 96)) - 47.3
    ball = 38.4 - np.sqrt((places**2).sum(axis=0))
    x, y, z = np.indices((64, 64, 64)) * 0.4
    waves = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    return {"ball, 96 x 96 x 96": ball.astype("f4"), "waves, 64 x 64 x 64": waves.astype("f4")}


class Asked:
    """A method in its process, with what each call cost."""

    def __init__(self, package: league.Package, method: str, folder: Path) -> None:
        self.path = folder / f"{package.name}-{method}".replace(":", "-")
        # The process takes the environment with it when it starts.
        os.environ["ISOGRADE_COST"] = str(self.path)
        self.adapter: Adapter = open_adapter(f"exec:{package.command(method)}")
        self.adapter.open(LIMITS)

    def cost(self, values: np.ndarray[Any, Any]) -> tuple[float, float, float]:
        """Seconds of the clock, seconds of the processor, megabytes; raises `LeagueError`."""
        self.path.write_text("", encoding="ascii")
        field = Field(values, (1.0,) * 3, (0.0,) * 3)
        outcome = self.adapter.run(Request("cost", "", field, (0.1,)))
        told = self.path.read_text(encoding="ascii").split()
        if outcome.status is not Status.OK or len(told) != 3:
            raise league.LeagueError(f"no cost: {outcome.status} {outcome.detail}")
        seconds, processor, kilobytes = map(float, told)
        return seconds, processor, kilobytes / 1024

    def close(self) -> None:
        """The process ends."""
        self.adapter.close()


def measured(package: league.Package, method: str, rounds: int) -> dict[str, Any]:
    """What the method and the peer cost; raises `LeagueError` where one of them does not answer."""
    peer = versions.versions(PEER[0])[-1]
    with tempfile.TemporaryDirectory() as folder:
        first, second = Path(folder) / "own", Path(folder) / "peer"
        first.mkdir()
        second.mkdir()
        both: list[Asked] = []
        try:
            both.append(Asked(package, method, first))
            both.append(Asked(peer, PEER[1], second))
            return _in_turn(both, rounds)
        finally:
            for one in both:
                one.close()


def _in_turn(both: Sequence[Asked], rounds: int) -> dict[str, Any]:
    """The costs of the method and of the peer on each field."""
    small = np.indices((SMALL,) * 3).sum(axis=0).astype("f4") - 9.3
    for one in both:
        one.cost(small)
    loads, found = [os.getloadavg()[0]], {}
    for name, values in fields().items():
        memory = [one.cost(values)[2] for one in both]
        own, peer = (partial(_asked, one, values) for one in both)
        costs = {
            timing.name: [
                [round(seconds, 6), round(processor, 6)]
                for seconds, processor in zip(timing.seconds, timing.processor, strict=True)
            ]
            for timing in in_turn({"own": own, "peer": peer}, rounds)
        }
        loads.append(os.getloadavg()[0])
        found[name] = {**costs, "megabytes": memory}
    return {"fields": found, "loads": loads}


def _asked(one: Asked, values: np.ndarray[Any, Any]) -> Cost:
    """What one call costs."""
    return Cost(*one.cost(values)[:2])


def asked(names: Sequence[str]) -> Iterator[tuple[league.Package, str, str]]:
    """Package, method, and the name it is known by: those of recipes, then the ready-made ones."""
    for package, method in league.rows(league.packages(), ()):
        if not names or method in names:
            yield package, method, method
    for library in versions.libraries():
        package = versions.versions(library)[-1]
        for method, said in package.said["methods"].items():
            kinds = said["declaration"].get("limits", {}).get("kinds", [[3, 1]])
            name = said["declaration"]["name"]
            if [3, 1] in kinds and (not names or name in names):
                yield package, method, name


def one(package: league.Package, method: str, name: str, rounds: int) -> dict[str, Any]:
    """The record of one method: its costs, or why there are none."""
    said = {
        "version": package.said["version"],
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": {"processor": platform.machine(), "processors": os.cpu_count() or 1},
    }
    try:
        if not (package.built / "ready").exists():
            league.build(package)
        return {**said, **measured(package, method, rounds)}
    except (league.LeagueError, AdapterError) as error:
        return {**said, "failed": f"{name}: {error}".splitlines()[0]}


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where every method asked for has its costs, 1 where one has none."""
    parser = argparse.ArgumentParser(description="Measure speed and memory beside a peer.")
    parser.add_argument("names", nargs="*", help="methods; all unless said")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="rounds a field")
    parser.add_argument("--again", action="store_true", help="measure anew")
    given = parser.parse_args(arguments)
    kept = read()
    kept["peer"] = PEER[1]
    rows = list(asked(given.names))
    if unknown := set(given.names) - {name for _, _, name in rows}:
        print(f"no {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    for package, method, name in rows:
        before = kept["methods"].get(name, {})
        if not given.again and "fields" in before and before["version"] == package.said["version"]:
            continue
        if os.getloadavg()[0] > BUSY * (os.cpu_count() or 1):
            print(f"{name}: a busy machine, the ratios are rough", flush=True)
        kept["methods"][name] = one(package, method, name, given.rounds)
        RESULT.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        print(name, kept["methods"][name].get("failed", "measured"), flush=True)
    return int(any("failed" in kept["methods"][name] for _, _, name in rows))


def read() -> dict[str, Any]:
    """What was measured until now."""
    if not RESULT.exists():
        return {"methods": {}}
    found: dict[str, Any] = json.loads(RESULT.read_text(encoding="utf-8"))
    return found


if __name__ == "__main__":
    os.chdir(league.ROOT)  # The programs are named from here.
    sys.exit(main())
