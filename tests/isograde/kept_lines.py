"""Every snippet of every kept report, run on the accused and on a reference: ``make lines``.

The lines of a page must fail on the implementation that the page is about, and say nothing of one
that is right. So each program is run twice, in a process of its own: as it stands, and with
`extract` replaced by a method of the reference that answers in the conventions of the accused.
Which method that is follows from the claim and from the family; where none of ours can hold the
claim, which is said in `NONE`, the program is run on the accused alone. A report of a library that
is not installed here, or of the league's and not built, is left out and counted.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import io
import multiprocessing
import os
import pickle
import re
import signal
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from isograde.adapters.registry import READY_MADE
from isograde.declaration import Declaration, declaration_from
from isograde.model import CONTOURS, CURVES, SURFACES, Kind
from isograde.report.lines import lines as records
from isograde.report.reading import Report, read
from isograde.report.snippet import UNSTEADY, snippet
from isograde.runner import processors
from isoref import extract
from isoref.fast.surface_intersection import intersection_curves
from isoref.field import Field

from tests.isograde import accused

KEPT = Path(__file__).resolve().parents[2] / "reports"
FOLDERS = ("implementations", "league")
SECONDS = 120
# The method of the reference that holds these claims, where ties are inside; the other way round
# where they are outside, since then the negated field is extracted.
CHOICES = {
    "cells.join": "marching-vesta-connect-L",
    "cells.separate": "marching-vesta-disconnect-L",
    "cells.mean": "marching-vesta-mixed-L",
}
TURNED = {"cells.join": "cells.separate", "cells.separate": "cells.join"}
# Claims on meshes at ties: of a mesh without its double vertices and flat simplices.
TIDIED = {
    "structure.apart", "structure.with_measure", "structure.no_duplicate", "topology.raw",
}  # fmt: skip
# Of these, what holds at some ties with its double vertices holds at others without.
EITHER = {"topology.raw"}
# Claims that no method of ours holds, and why.
NONE = {
    "cells.perfect": "triangles as thin as doubles allow stand in the meshes of all our methods",
}


@dataclass(frozen=True)
class Ran:
    """How the lines on one claim of one report ended: "fails", "silent", or another error."""

    report: str
    claim: str
    case: str
    on_accused: tuple[str, str]
    on_reference: tuple[str, str] | None
    unsteady: bool = False

    @property
    def wrong(self) -> list[str]:
        """What is wrong with the lines, a sentence each."""
        here = f"{self.report}, {self.claim} ({self.case})"
        found = []
        # Who answers otherwise each time may be right once; the lines say so.
        if self.on_accused[0] not in ("fails", *["silent"] * self.unsteady):
            found.append(f"{here}: on the accused {': '.join(self.on_accused)}")
        if self.on_reference is not None and self.on_reference[0] != "silent":
            found.append(f"{here}: on the reference {': '.join(self.on_reference)}")
        return found


# --- references ---------------------------------------------------------------------------------


def tidied(vertices: Any, rows: Any) -> tuple[Any, Any]:
    """The mesh, vertices at one place made one, without simplices that then have no measure."""
    points, name = np.unique(np.round(vertices, 9) + 0.0, axis=0, return_inverse=True)
    rows = name.reshape(-1)[rows]
    ordered = np.sort(rows, axis=1)
    whole = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
    corners = points[ordered]
    sides = corners[:, 1:] - corners[:, :1]
    whole &= np.linalg.det(sides @ sides.swapaxes(1, 2)) > 1e-15
    _, first = np.unique(ordered[whole], axis=0, return_index=True)
    used, rows = np.unique(rows[whole][first], return_inverse=True)
    return points[used], rows.reshape(-1, ordered.shape[1])


def reference(
    declared: Declaration, claim: str, kind: Kind, *, tidy: bool = True
) -> Callable[..., Any] | None:
    """A method of ours that holds the claim, called and answering as the accused does.

    tidy : without its double vertices, where the claim is of `TIDIED`
    """
    # No method of ours has its vertices on a lattice of its own, and so no border where they end.
    if declared.vertices == "own":
        return None
    # The lines weld a soup; the sheets that touch at a tie are then joined, in ours too.
    if claim in NONE or (claim in EITHER and declared.soup is not None):
        return None
    said = declared.conventions
    outside = said.tie == "outside"
    turned = outside != (said.normals == "to_high")
    asked = TURNED.get(claim, claim) if outside else claim

    def posed(values: Any, isovalue: float) -> tuple[Any, float]:
        if not outside:
            return values, isovalue
        return -np.asarray(values, np.float64), -float(isovalue)

    def method() -> str:
        if claim == "topology.scan":  # Every family is measured by the trilinear interpolant.
            return "trilinear-cubes"
        if declared.vertices == "cells":
            return "dual-marching-cubes"
        if asked in CHOICES and declared.interpolant in ("multilinear", "labels"):
            return CHOICES[asked]
        other = {"labels": "label-cubes", "tetrahedra": "marching-tetrahedra-kuhn"}
        return other.get(declared.interpolant, "trilinear-cubes")

    def surface(values: Any, isovalue: float, spacing: Any, **_: Any) -> Any:
        values, isovalue = posed(values, isovalue)
        spacing = spacing if said.units == "world" else (1.0, 1.0, 1.0)
        mesh = extract(values, isovalue, spacing, method=method())
        vertices, rows = mesh.vertices, mesh.simplices
        if claim in TIDIED and tidy:
            vertices, rows = tidied(vertices, rows)
        rows = rows[:, ::-1] if turned else rows
        return (vertices[:, ::-1] if said.axes == "reversed" else vertices), rows

    def contours(values: Any, isovalue: float, spacing: Any, **_: Any) -> Any:
        values, isovalue = posed(values, isovalue)
        how = {"cells.join": accused.contours_joined, "cells.separate": accused.contours_apart}
        vertices, rows = how.get(asked, accused.contours)(values, isovalue, spacing)
        if claim in TIDIED:
            vertices, rows = tidied(vertices, rows)
        return vertices, rows[:, ::-1] if turned else rows

    def curves(*given: Any, **_: Any) -> Any:
        *several, spacing = given
        (a, b), isovalues = several if len(several) == 2 else (several[:2], several[2:])
        fields = Field.of(a, spacing), Field.of(b, spacing)
        lines = [one.polyline for one in intersection_curves(*fields, tuple(isovalues))]
        if claim not in TIDIED or not lines:
            return lines
        start = np.cumsum([0, *map(len, lines)])
        rows = [np.arange(a, b)[:, None] + [0, 1] for a, b in pairwise(start)]
        return tidied(np.concatenate(lines), np.concatenate([part[:-1] for part in rows]))

    return {SURFACES: surface, CONTOURS: contours, CURVES: curves}.get(kind)


# --- programs -----------------------------------------------------------------------------------


def ended(program: str, given: dict[str, Any]) -> tuple[str, str]:
    """How a program ends in a process of its own: "fails" by its assertion, "silent", or else."""
    with tempfile.TemporaryDirectory() as place:
        return _ended(program, given, place)


def _ended(program: str, given: dict[str, Any], place: str) -> tuple[str, str]:
    """The same; the program is run at the root, and what it leaves in this place is removed."""
    read_end, write_end = os.pipe()
    child = os.fork()
    if not child:
        os.close(read_end)
        os.chdir(KEPT.parent)
        tempfile.tempdir = place
        signal.alarm(SECONDS)
        told = io.StringIO()
        try:
            with contextlib.redirect_stdout(told), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                exec(compile(program, "lines", "exec"), given)
            found = ("silent", "")
        except AssertionError:
            found = ("fails", told.getvalue().strip()[-500:])
        except BaseException as error:  # noqa: BLE001  (whatever it was is told)
            found = (type(error).__name__, str(error)[:500])
        os.write(write_end, pickle.dumps(found))
        os._exit(0)
    os.close(write_end)
    with os.fdopen(read_end, "rb") as file:
        said = file.read()
    _, status = os.waitpid(child, 0)
    return pickle.loads(said) if said else ("ended", f"with status {status}")


def with_reference(program: str) -> str:
    """The program, with `extract` replaced behind the lines that define it."""
    # A program is slow to start, and not asked: an echo answers its greeting.
    program = re.sub("^command = .*$", "command = 'cat'", program, flags=re.MULTILINE)
    for start in ("\n\ndef arrays(", "\nvalues = ", "\n# A "):
        at = program.find(start)
        if at >= 0:
            return f"{program[:at]}\nextract = REFERENCE\n{program[at:]}"
    raise ValueError(f"nothing begins the lines behind `extract` in:\n{program}")


def programs(report: Report) -> Iterator[tuple[str, str, str, Kind]]:
    """Claim, case, program and kind of each snippet of a report."""
    for summary in report.summaries.values():
        if summary.failure is None:
            continue
        program = snippet(report, summary)
        if program is not None:
            case = report.evidence.get(summary.id, report.cases.get(summary.failure.case, {}))
            yield summary.id, summary.failure.case, program, Kind(*case["kind"])


def run(path: Path) -> list[Ran]:
    """How each snippet of a kept report ends."""
    report = read(path)
    for module in READY_MADE[report.spec].imports if report.spec in READY_MADE else ():
        importlib.import_module(module)
    said = dict(report.declaration)
    declared = declaration_from(said, said.pop("name"))
    found = []
    for claim, case, program, kind in programs(report):
        instead = reference(declared, claim, kind)
        second = None
        if instead is not None:
            second = ended(with_reference(program), {"REFERENCE": instead})
            if second[0] != "silent" and claim in EITHER:
                other = reference(declared, claim, kind, tidy=False)
                second = ended(with_reference(program), {"REFERENCE": other})
        unsteady = program.startswith(UNSTEADY)
        found.append(Ran(path.name, claim, case, ended(program, {}), second, unsteady))
    return found


def installed(path: Path) -> bool:
    """Whether the lines can be run here: the library is installed, or the program is built."""
    spec = str(next(iter(records(path)))["spec"])
    if spec.startswith("exec:"):
        return (KEPT.parent / spec.removeprefix("exec:").split()[0]).exists()
    ready = READY_MADE.get(spec)
    names = () if ready is None else ready.imports
    return bool(names) and all(importlib.util.find_spec(name.split(".")[0]) for name in names)


def kept() -> list[Path]:
    """The kept reports."""
    return [path for folder in FOLDERS for path in sorted((KEPT / folder).glob("*.jsonl.gz"))]


def main(names: list[str]) -> int:
    """1 where lines do not show what they are there for, else 0."""
    paths = [path for path in kept() if not names or any(name in path.name for name in names)]
    here = [path for path in paths if installed(path)]
    with multiprocessing.get_context("fork").Pool(processors(), maxtasksperchild=1) as pool:
        ran = [one for found in pool.imap(run, here, chunksize=1) for one in found]
    wrong = [line for one in ran for line in one.wrong]
    twice = sum(one.on_reference is not None for one in ran)
    print(*wrong, sep="\n")
    print(
        f"{len(ran)} programs of {len(here)} reports, {twice} of them on a reference too; "
        f"{len(wrong)} do not show what they should; {len(paths) - len(here)} reports are of "
        "what is not installed here"
    )
    return int(bool(wrong) or not ran)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
