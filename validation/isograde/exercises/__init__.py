"""Exercises of the course: broken extractors to find and mend, judged by the grader.

An exercise is a file that is given, wrong in one or two places, and a few claims of the grader,
each with the sentence that the lesson would say where the claim fails. The sentences say what is
still wrong, and never what to write. The lessons, and the solutions apart from them, are in the
folder ``docs/course`` of the source.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Field

from isograde.adapters import open_adapter
from isograde.model import BAD, CONTOURS, SURFACES, Case, Kind, Limits, Verdict
from isograde.runner import Task, Worker, claims_for

LINE = Kind(1, 1)
ANSWERS = "structure.answers"
SHAPES = "structure.shapes"
# Asked of every exercise: an answer that says nothing is closed, and on no sample's right side.
SIDES = "topology.sides"


@dataclass(frozen=True)
class Exercise:
    """An exercise.

    hints : by claim, what is said where it fails; asked in this order
    cases : what it is judged on
    """

    number: int
    title: str
    hints: Mapping[str, str]
    cases: Callable[[], Sequence[Case]]

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"exercise_{self.number}.py"

    @property
    def text(self) -> str:
        """The file that is given."""
        return (files("isograde.exercises") / "given" / self.file).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Told:
    """What is still wrong: the hint, the case it was seen on, what the grader measured there."""

    claim: str
    hint: str
    case: str
    detail: str
    failed: int
    asked: int


def judged(exercise: Exercise, path: Path) -> list[Told]:
    """What is still wrong in a file, worst first; nothing where it is mended.

    Raises `AdapterError` where the file does not start.
    """
    adapter = open_adapter(f"python:{path}:extract")
    try:
        declared = adapter.open(Limits(20.0, 2048))
        cases = {case.id: case for case in exercise.cases()}
        worker = Worker(adapter, declared, cases, claims_for(declared))
        return _told(exercise, worker)
    finally:
        adapter.close()


def _told(exercise: Exercise, worker: Worker) -> list[Told]:
    """The hints of the claims that fail, each with its smallest case."""
    first = (ANSWERS, SHAPES, *exercise.hints, SIDES)
    wanted = [name for name in dict.fromkeys(first) if name in worker.claims]
    bad: dict[str, list[tuple[int, str, str]]] = {}
    asked: dict[str, int] = {}
    for case in worker.cases.values():
        claims = tuple(name for name in wanted if worker.claims[name].applies_to(case))
        for name, found in worker.judge(Task(case.id, claims)).findings.items():
            asked[name] = asked.get(name, 0) + (found.verdict in (Verdict.PASS, *BAD))
            if found.verdict in BAD:
                bad.setdefault(name, []).append((case.samples, case.id, found.detail))
    told = []
    for name in (name for name in wanted if name in bad):
        _, smallest, detail = min(bad[name])
        hint = exercise.hints.get(name, worker.claims[name].rule)
        told.append(Told(name, hint, smallest, detail, len(bad[name]), asked[name]))
    # What could not fail anywhere is no success.
    idle = [name for name in wanted if not asked.get(name)]
    if not told and idle:
        told.append(Told(idle[0], "It answers none of the fields, or with nothing.", "", "", 0, 0))
    return told


def _case(name: str, values: Any, isovalue: float, kind: Kind, *tags: str) -> Case:
    """A case of the exercises."""
    array = np.asarray(values, np.float64)
    return Case(
        f"exercise/{name}",
        lambda: Field.of(array, dimension=kind.n),
        (isovalue,),
        array.size,
        frozenset({"noise", *tags}),
        kind=kind,
    )


def _lines() -> list[Case]:
    """Lines of samples, some of them equal to the isovalue."""
    rng = np.random.default_rng(1)
    lines = [_case(f"line-{k}", rng.normal(size=6 + k), 0.2, LINE) for k in range(8)]
    ties = [[0, 1, 2, 1, 0], [2, 1, 0, 1, 1, 0], [1, 0, 0, 2]]
    return lines + [_case(f"tie-{k}", line, 1.0, LINE) for k, line in enumerate(ties)]


def _squares() -> list[Case]:
    """Fields of squares with every pattern, many of them ambiguous."""
    rng = np.random.default_rng(2)
    fields = [rng.normal(size=(4 + k % 3, 5)) for k in range(16)]
    saddles = [rng.uniform(0.1, 3, (2, 2)) * [[1, -1], [-1, 1]] * (-1) ** k for k in range(16)]
    return [_case(f"squares-{k}", one, 0.0, CONTOURS) for k, one in enumerate(fields + saddles)]


def _cells() -> list[Case]:
    """Each pattern of inside corners in the middle of outside and of inside samples."""
    found = []
    for signs in range(1, 255):
        for outer in (-1.0, 1.0):
            values = np.full((4, 4, 4), outer)
            for c in range(8):
                at = tuple(1 + (c >> a & 1) for a in range(3))
                values[at] = 1.0 if signs >> c & 1 else -1.0
            # No two values alike, and no sample tied.
            values *= 1 + np.random.default_rng(signs).uniform(0, 0.5, values.shape)
            side = "outside" if outer < 0 else "inside"
            found.append(_case(f"pattern-{signs}-{side}", values, 0.0, SURFACES))
    return found


def _noise() -> list[Case]:
    """Noise: two cells of every pair of patterns meet somewhere."""
    rng = np.random.default_rng(4)
    return [_case(f"noise-{k}", rng.normal(size=(6, 6, 6)), 0.0, SURFACES) for k in range(12)]


def _faces() -> list[Case]:
    """Two cells with an ambiguous face between them, whose mean and saddle often disagree."""
    rng = np.random.default_rng(5)
    found = []
    for k in range(24):
        values = rng.uniform(0.1, 1, (3, 2, 2)) * np.where(rng.random((3, 2, 2)) < 0.5, 1, -1)
        values[1] = rng.uniform(0.1, 4, (2, 2)) * [[1, -1], [-1, 1]]
        found.append(_case(f"face-{k}", values, 0.0, SURFACES))
    return found + _noise()[:2]


CLOSED = "topology.closed"
ORIENTED = "topology.oriented"
SAME_WAY = "Two triangles that share an edge run through it the same way"
EXERCISES = {
    one.number: one
    for one in (
        Exercise(
            1,
            "A line of samples",
            {
                SIDES: "Between an inside and an outside neighbour there is a point, and between "
                "others there is none. That fails here. Which samples count as inside? Look at a "
                "sample that equals the value.",
                "geometry.crossing": "A point is not where the straight line between its two "
                "samples takes the value. How far along is it, when one sample is much nearer to "
                "the value than the other?",
            },
            _lines,
        ),
        Exercise(
            2,
            "Squares and their saddle",
            {
                CLOSED: "A contour ends inside the field.",
                SIDES: "A contour has a sample on its wrong side.",
                "topology.bilinear": "An ambiguous square is joined otherwise than the bilinear "
                "interpolant's own contour joins it. Which value of the square tells whether its "
                "hyperbola passes between one pair of corners or the other?",
            },
            _squares,
        ),
        Exercise(
            3,
            "The cube and its fifteen configurations",
            {
                CLOSED: "A pattern leaves a hole: one of its polygons is not filled. An edge "
                "inside the cell that only one triangle has shows where.",
                ORIENTED: f"{SAME_WAY}: one of them is turned over.",
                SIDES: "The surface does not part an inside corner from an outside one, "
                "or faces the wrong way there.",
            },
            _cells,
        ),
        Exercise(
            4,
            "The hole of 1987",
            {
                CLOSED: "There is a hole between two cells. Find the face they share: it has two "
                "opposite inside corners. One cell cuts both off, and the other joins them. What "
                "decided, in each?",
                ORIENTED: f"{SAME_WAY}.",
            },
            _noise,
        ),
        Exercise(
            5,
            "The asymptotic decider",
            {
                CLOSED: "There is a hole: the two cells at a face do not decide it alike.",
                "topology.bilinear": "An ambiguous face is decided otherwise than its bilinear "
                "interpolant says. A mean of four values knows nothing of where they stand; what "
                "is the value at the point where the asymptotes meet?",
            },
            _faces,
        ),
    )
}
