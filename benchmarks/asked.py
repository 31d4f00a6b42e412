"""The goals of all benchmarks in one table, from what their pages measured.

``python benchmarks/asked.py``; `everything.py` does it after its last program. The rows are those
that were asked for when the work on speed began; each benchmark notes what it found for a row
(`Page.ask`), and nothing here is typed but the question.
"""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from pages import Goal, table_of

REPORTS = Path("reports/benchmarks")

#: What was asked, in the order in which it was: a short name of the row, and the question. A ratio
#: is a peer's time over ours unless the question says otherwise, ours the asymptotic decider's.
ROWS: Mapping[str, str] = {
    "flying-spheres": "VTK flying edges: sphere 64^3, 128^3, 256^3, 384^3",
    "flying-folded": "VTK flying edges: gyroid 256^3, dense noise 128^3",
    "flying-scans": "VTK flying edges: sphere 256^3 uint8, bunny CT, the angiography eight times",
    "open3d": "Open3D: spheres, gyroid, noise",
    "libraries": "scikit-image, PyMCubes, MeshLib, zmesh, VTK's contour filter",
    "comparison": "ours over one pass that compares all samples, 384^3",
    "rules": "trilinear-cubes and marching VESTA over the decider, on real volumes and noise",
    "mixed-H": "VESTA mixed H over the decider, on real volumes and noise",
    "families": "nearest peer over marching tetrahedra, over dual marching cubes",
    "vesta": "original VESTA over marching",
    "joining": "joining of curves over Marching Faces",
    "faces": "VTK's contour, contour, strip over Marching Faces",
    "checks": "mesh checks: a library's part over ours",
    "crossings": "our exact self-intersections over pymeshlab's inexact ones",
    "five": "5-D, three fields, N = 128, tree and mesh: time over that of the first version",
    "tracing": "GUDHI's manifold tracing over ours, the same sphere",
    "memory": "extra peak memory of an extraction less its output, MiB",
    "grade": "the default grade of scikit-image, seconds; judging's share of it",
    "adapter": "an adapter's call: ms more than a direct one; from 64^3 on, ratio to it",
    "bricks": "many isovalues: plain extraction over that by the index of bricks, once it is built",
    "past-memory": "2048^3 bytes by slabs: peak of the process, GB",
}

INTRODUCTION = """\
Every goal that was set for speed and memory, beside what `make benchmarks` found the last time it
ran. Ratios are medians over rounds in which the contestants took turns, with their quartiles in
brackets, of processor time, one thread. A goal is met where the median is on its right side; what
is not met has its profile and the reason on the page it links to. This page is written by
`benchmarks/asked.py` from the numbers that the pages keep in `reports/benchmarks/goals`."""


def read(folder: Path) -> list[tuple[str, bool, Goal]]:
    """Page, whether the machine was quiet, goal: of all pages in this folder."""
    found = []
    for path in sorted((folder / "goals").glob("*.json")):
        told = json.loads(path.read_text(encoding="utf-8"))
        for one in told["goals"]:
            numbers = one["found"] and tuple(one["found"])
            found.append((told["page"], told["quiet"], Goal(**{**one, "found": numbers})))
    return found


def anchor(heading: str) -> str:
    """The part of an address that leads to a heading, as the usual readers of Markdown make it.

    >>> anchor("Where the time goes, and why it is not less")
    'where-the-time-goes-and-why-it-is-not-less'
    """
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def counted(goals: Iterable[Goal]) -> str:
    """How many goals are met, not met, not measured, in words.

    >>> one = Goal("checks", "a", 1.0, False, (2.0, 2.0, 2.0))
    >>> counted([one, Goal("checks", "b", 1.0, True, (2.0, 2.0, 2.0))])
    '1 of 2 met'
    >>> counted([one, Goal("checks", "b", 1.0, True, None, "no such library")])
    '1 of 2 met, 1 not measured'
    >>> counted([])
    'not measured'
    """
    every = list(goals)
    if not every:
        return "not measured"
    unknown = sum(one.met is None for one in every)
    met = sum(one.met is True for one in every)
    return f"{met} of {len(every)} met" + (f", {unknown} not measured" if unknown else "")


def page(found: list[tuple[str, bool, Goal]]) -> str:
    """The page, in Markdown."""
    if unknown := {one.row for _, _, one in found} - ROWS.keys():
        raise ValueError(f"rows that nobody asked for: {', '.join(sorted(unknown))}")
    short, long = [], []
    for row, question in ROWS.items():
        own = [(where, quiet, one) for where, quiet, one in found if one.row == row]
        pages = list(dict.fromkeys(where for where, _, _ in own))
        links = ", ".join(f"[{Path(where).stem}]({where})" for where in pages)
        loud = "" if all(quiet for _, quiet, _ in own) else "; **on a busy machine**"
        short.append([question, counted(one for _, _, one in own) + loud, links])
        if own:
            rows = [_row(where, one) for where, _, one in own]
            heads = ["", "goal", "found (quartiles)", "", "profile", "reason"]
            long += [f"## {question[:1].upper()}{question[1:]}", table_of(heads, rows)]
    total = counted(one for _, _, one in found)
    parts = ["# What was asked of speed, and what was found", INTRODUCTION, f"In all: {total}."]
    parts += [table_of(["asked", "found", "pages"], short), *long]
    return "\n\n".join(parts) + "\n"


def _row(where: str, one: Goal) -> list[str]:
    """One goal; where it is not met with the reason, and the place of the profile."""
    why = "" if one.met else f"[{Path(where).stem}]({where}#{anchor(one.why)})"
    reason = (one.reason or "**none is given**") if one.met is False else ""
    return [*one.cells(), why, reason]


def write(folder: Path = REPORTS) -> Path:
    """The page stands in the folder, beside those it is made of."""
    from isograde.report import write_whole

    return write_whole(folder / "goals.md", page(read(folder)))


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--folder", type=Path, default=REPORTS)
    print(write(parser.parse_args().folder))


if __name__ == "__main__":
    main()
