"""Exercises of the course: broken extractors to find and mend, judged by the grader.

An exercise is a file that is given, wrong in one or two places, and a few claims of the grader,
each with the sentence that the lesson would say where the claim fails. The sentences say what is
still wrong, and never what to write. The lessons, and the solutions apart from them, are in the
folder ``docs/course`` of the source.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

import numpy as np
from isoref.field import Floats

from isograde.adapters import open_adapter
from isograde.declaration import Declaration
from isograde.exercises import fields
from isograde.model import BAD, Adapter, Case, Finding, Limits, Verdict
from isograde.runner import Evidence, Judged, Task, Worker, claims_for

ANSWERS = "structure.answers"
SHAPES = "structure.shapes"
# Asked of every exercise: an answer that says nothing is closed, and on no sample's right side.
SIDES = "topology.sides"


@dataclass(frozen=True)
class Exercise:
    """An exercise.

    hints : by claim, what is said where it fails; asked in this order
    cases : what it is judged on
    apart : by claim and by how the names of some cases begin, what is said on those instead:
        one claim, and cases that only one of the faults can fail
    between : what is said instead of the hint of `topology.closed` where every open edge lies on
        a face of a cell: each cell is right by itself, or lacks a whole polygon
    """

    number: int
    title: str
    hints: Mapping[str, str]
    cases: Callable[[], Sequence[Case]]
    apart: Mapping[tuple[str, str], str] = field(default_factory=dict)
    between: str = ""

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"exercise_{self.number}.py"

    @property
    def text(self) -> str:
        """The file that is given."""
        return (files("isograde.exercises") / "given" / self.file).read_text(encoding="utf-8")

    def hint(self, claim: str, case: str, otherwise: str, evidence: Evidence | None = None) -> str:
        """What is said where the claim fails on the case; `otherwise` where it has no hint."""
        if claim == CLOSED and self.between and evidence and lie_on_faces(open_edges(evidence)):
            return self.between
        for (name, beginning), said in self.apart.items():
            if name == claim and case.startswith(f"exercise/{beginning}"):
                return said
        return self.hints.get(claim, otherwise)


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
        return told_through(exercise, adapter, adapter.open(Limits(20.0, 2048)))
    finally:
        adapter.close()


def told_through(exercise: Exercise, adapter: Adapter, declared: Declaration) -> list[Told]:
    """The hints of the claims that fail through an open adapter, each with its smallest case."""
    cases = {case.id: case for case in exercise.cases()}
    worker = Worker(adapter, declared, cases, claims_for(declared))
    first = (ANSWERS, SHAPES, *exercise.hints, SIDES)
    wanted = [name for name in dict.fromkeys(first) if name in worker.claims]
    bad: dict[str, list[tuple[int, str, Judged]]] = {}
    asked: dict[str, int] = {}
    for case in worker.cases.values():
        claims = tuple(name for name in wanted if worker.claims[name].applies_to(case))
        one = worker.judge(Task(case.id, claims))
        for name, found in one.findings.items():
            asked[name] = asked.get(name, 0) + (found.verdict in (Verdict.PASS, *BAD))
            if found.verdict in BAD:
                bad.setdefault(name, []).append((case.samples, case.id, one))
    told = []
    for name in (name for name in wanted if name in bad):
        _, smallest, one = min(bad[name], key=lambda found: found[:2])
        hint = exercise.hint(name, smallest, worker.claims[name].rule, one.evidence)
        detail = one.findings[name].detail + corners_told(one.findings[name], one.evidence)
        told.append(Told(name, hint, smallest, detail, len(bad[name]), asked[name]))
    # What could not fail anywhere is no success.
    idle = [name for name in wanted if not asked.get(name)]
    if not told and idle:
        hint = "It answers none of the fields, or with nothing."
        if (other := _another(exercise, declared)) is not None:
            hint += f" Its declaration says that it is of exercise {other.number}."
        told.append(Told(idle[0], hint, "", "", 0, 0))
    return told


def _another(exercise: Exercise, declared: Declaration) -> Exercise | None:
    """The other exercise whose name the declaration bears, if it does."""
    names = {f"exercise {one.number}": one for one in EXERCISES.values() if one is not exercise}
    return names.get(declared.name)


def corners_told(found: Finding, evidence: Evidence | None) -> str:
    """The values at the four corners of the face at fault, as one walks round it."""
    if evidence is None or not {"cell", "face"} <= set(found.numbers):
        return ""
    values = evidence.field.values - evidence.isovalues[0]
    places = _walk(found.numbers["cell"], int(found.numbers["face"]))
    round_it = ", ".join(f"{values[at]:.4g} at {list(at)}" for at in places)
    return f"; its corners, minus the isovalue: {round_it}"


def _walk(cell: Sequence[int], face: int) -> list[tuple[int, ...]]:
    """The corners of a square, or of face 2 axis + side of a cell, in the order of a walk."""
    across = {face // 2: face % 2} if len(cell) == 3 else {}
    s, t = (axis for axis in range(len(cell)) if axis not in across)
    steps = [{s: x, t: y, **across} for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return [tuple(int(at) + step[axis] for axis, at in enumerate(cell)) for step in steps]


def open_edges(evidence: Evidence) -> Floats:
    """(r, 2, 3) The ends, in samples, of the edges of a surface that an odd number share.

    Those on the border of the field are left out.
    """
    mesh = evidence.outcomes["plain"]
    if mesh.vertices is None or mesh.simplices is None or not len(mesh.simplices):
        return np.empty((0, 2, 3))
    corners = np.sort(np.asarray(mesh.simplices)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
    edges, uses = np.unique(corners, axis=0, return_counts=True)
    samples = np.asarray(mesh.vertices, np.float64) / evidence.field.spacing
    places: Floats = samples[edges[uses % 2 == 1]]
    last = np.subtract(evidence.field.values.shape, 1)
    border = ((places == 0) | (places == last)).all(axis=1).any(axis=1)
    return np.asarray(places[~border])


def lie_on_faces(edges: Floats) -> bool:
    """Whether there are edges (r, 2, 3), and each lies in a plane of samples."""
    whole = np.rint(edges)
    flat = (np.abs(edges - whole) < 1e-9).all(axis=1) & (whole[:, 0] == whole[:, 1])
    return len(edges) > 0 and bool(flat.any(axis=1).all())


CLOSED = "topology.closed"
ORIENTED = "topology.oriented"
MANIFOLD = "topology.manifold"
BILINEAR = "topology.bilinear"
TRILINEAR = "topology.trilinear"
CROSSING = "geometry.crossing"
VERTICES = "geometry.vertices"
MISPLACED = (
    "A vertex on a lattice edge is not where the straight line between its two samples takes the "
    "value (lesson 1)."
)
WRONG_SIDE = (
    "The surface does not part an inside corner from an outside one, or faces the wrong way there."
)
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
                CROSSING: "A point is not where the straight line between its two "
                "samples takes the value. How far along is it, when one sample is much nearer to "
                "the value than the other?",
            },
            fields.lines,
        ),
        Exercise(
            2,
            "Squares and their saddle",
            {
                CLOSED: "A contour ends inside the field.",
                SIDES: "A contour has a sample on its wrong side.",
                BILINEAR: "An ambiguous square is joined otherwise than the bilinear "
                "interpolant's own contour joins it. Which value of the square tells whether its "
                "hyperbola passes between one pair of corners or the other? And which of its "
                "corners are inside?",
                CROSSING: MISPLACED,
            },
            fields.squares,
        ),
        Exercise(
            3,
            "The cube and its fifteen configurations",
            {
                CLOSED: "A pattern leaves a hole: one of its polygons is not filled. An edge "
                "inside the cell that only one triangle has shows where.",
                ORIENTED: f"{SAME_WAY}: one of them is turned over.",
                SIDES: WRONG_SIDE,
            },
            fields.cells,
            between="Two cells do not fit each other: an open edge lies on the face that they "
            "share, where one has it and the other does not. On a face with two opposite inside "
            "corners every row of this table cuts both off.",
        ),
        Exercise(
            4,
            "The hole of 1987",
            {
                CLOSED: "There is a hole between two cells. Find the face they share: it has two "
                "opposite inside corners. One cell cuts both off, and the other joins them. What "
                "decided, in each?",
                ORIENTED: f"{SAME_WAY}.",
                SIDES: WRONG_SIDE,
                CROSSING: MISPLACED,
            },
            fields.noise,
        ),
        Exercise(
            5,
            "The asymptotic decider",
            {
                CLOSED: "There is a hole: the two cells at a face do not decide it alike. Does it "
                "matter to your arithmetic at which corner it begins?",
                BILINEAR: "An ambiguous face is decided otherwise than its bilinear "
                "interpolant says. Which corners of the face are inside, and on which side is the "
                "way between them?",
            },
            fields.faces,
        ),
        Exercise(
            6,
            "Polygons and triangles without a table",
            {
                CLOSED: "The surface has a hole. Follow the segments of one of its cells by hand: "
                "how many polygons are there, and how many come out?",
                ORIENTED: f"{SAME_WAY}.",
                SIDES: "Between an inside and an outside sample no polygon passes.",
                MANIFOLD: "Two sheets meet where they should not: an edge has four triangles, or a "
                "vertex more than one fan. Think of a chord that lies on the face that two cells "
                "share: both may cut a polygon along it.",
                CROSSING: MISPLACED,
            },
            fields.noise,
        ),
        Exercise(
            7,
            "The proof",
            {
                CLOSED: "There is a hole: the two cells at a face have different segments there. "
                "Is every cell that has an ambiguous face asked?",
                BILINEAR: "An ambiguous face is decided otherwise than its bilinear interpolant "
                "says, or is not decided at all.",
            },
            fields.saddles,
            {
                (CLOSED, "saddle-"): "There is a hole: the two cells at a face have different "
                "segments there. Do both come to the same decision where the saddle is as near to "
                "the isovalue as two floats can be?",
            },
        ),
        Exercise(
            8,
            "Inside the cell: tunnels",
            {
                CLOSED: "There is a hole.",
                TRILINEAR: "A cell has not the topology of its trilinear interpolant.",
            },
            fields.tunnels,
            {
                (TRILINEAR, "none-"): "A cell has a tunnel, and its trilinear interpolant has "
                "none. What else does a tunnel need?",
                (TRILINEAR, "tunnel-"): "The trilinear interpolant has a tunnel in a cell, and "
                "your surface has none there, or one that joins the wrong corners. Which point "
                "tells what goes through the waist?",
            },
        ),
        Exercise(
            9,
            "VESTA",
            {
                SIDES: "Between an active and an inactive voxel no cycle passes.",
                CLOSED: "The cycles do not close. Four paths end at a point of ambiguity, and all "
                "four must turn the same way: what do they have in common? If they ask the same "
                "of the same voxels, do they also round alike?",
                CROSSING: "A support point is moved along its range vector, but not to "
                "where the line between the two voxels takes the isovalue. From which end is the "
                "way measured?",
                "cells.mean": "A point of ambiguity connects its active voxels where the mean of "
                "the four voxels round it is inactive, or separates them where it is active.",
            },
            fields.voxels,
        ),
        Exercise(
            10,
            "Any dimension",
            {
                CLOSED: "A facet has one simplex. Two simplices that share a face of more than "
                "three corners have cut it in two ways: in which order do they see its vertices?",
                ORIENTED: "Two simplices that share a facet give it the same orientation.",
                SIDES: "The second component is cut in the wrong place. What is its value at a "
                "vertex that the first cut has made?",
                CROSSING: MISPLACED,
            },
            fields.dimensions,
        ),
        Exercise(
            11,
            "Where two surfaces meet",
            {
                CLOSED: "A curve ends inside the field. What two triangles have in common is no "
                "longer than what either has of the common line: where does a segment begin, and "
                "where does it end?",
                ORIENTED: "Two segments begin at one node, or end there: they do not run the same "
                "way along the curve.",
                SIDES: "The curve does not pass a face of the lattice as often, or not in the "
                "direction, that the samples say.",
                VERTICES: "A node is not in a cell that both surfaces pass.",
            },
            fields.pairs_of_fields,
            {
                (SIDES, "between-"): "The curve passes a face of the lattice that it should not, "
                "or does not pass one that it should: a segment is longer than what both "
                "triangles have of the common line.",
                (SIDES, "direction-"): "The curve passes a face of the lattice the other way than "
                "the samples say: it has a direction, and something has taken it away.",
            },
        ),
        Exercise(
            12,
            "Dual methods",
            {
                ORIENTED: f"{SAME_WAY}. Look along each of the three axes: is the walk round its "
                "edges counterclockwise?",
                SIDES: "The surface faces the wrong way.",
                MANIFOLD: "Two pieces of surface meet in a vertex, or in an edge of four "
                "triangles: they pass through one cell, and it gave them one vertex between them.",
                VERTICES: "A vertex is outside its cell.",
            },
            fields.islands,
        ),
        Exercise(
            13,
            "How to judge an extractor",
            {
                "robustness.input_unmodified": "The samples are not what they were before the "
                "call. Whose are they?",
                ANSWERS: "A field gets an error and no answer. Look at its numbers: are they "
                "whole, and does one of them equal the isovalue?",
                CLOSED: "A contour ends inside the field, beside a sample that equals the "
                "isovalue.",
                "structure.no_repeated_index": "A segment begins and ends in the same point. Two "
                "crossings were taken for one because they are near each other; is being near the "
                "same as being the same?",
                CROSSING: "A point is not where the straight line between its two "
                "samples takes the value: it was kept away from a sample that it is close to.",
                MANIFOLD: "Two contours meet in a point. Two crossings were taken for one because "
                "they are near each other; is being near the same as being the same?",
                SIDES: "A contour passes where the samples say it should not, or does not pass "
                "where it should: of two crossings near each other one is lost.",
                "symmetry.spacing": "With another spacing the contour has other pieces, though "
                "nothing but the length of a step has changed.",
                "symmetry.layout": "The same samples, laid out otherwise in memory or not to be "
                "written to, have another answer.",
                "symmetry.type": "The same numbers in another type have another answer.",
            },
            fields.posed,
        ),
    )
}
