"""The sentence that the author of an implementation needs, for each claim that failed.

A judge says what it counted, and where. Beside it stands here what that is in the words of a mesh:
which cells draw what on the face between them, which triangle is missing, where the vertices stand
instead. It is read off the smallest case, which a report holds whole, or counted over all of them;
where there is nothing to add, the judge's words are the diagnosis.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from isoref.field import Field, Floats, Integers

from isograde.causes import box
from isograde.checking.rows import CORNERS, fault_told, judged
from isograde.checking.sentences import another_surface, looks_like, open_inside, times
from isograde.claims.evidence import traces_of
from isograde.claims.symmetry import NO_MESH
from isograde.declaration import declaration_from
from isograde.model import SURFACES, Case, Kind, Outcome, Status, Trial, Verdict
from isograde.oracles.bilinear import saddle_sign
from isograde.oracles.complexes import Complex
from isograde.oracles.lattice import Lattice
from isograde.report.headline import anded
from isograde.report.lines import JSON
from isograde.report.misplaced import Placed, misplacement, on_diagonals, shared
from isograde.report.reading import Report, Summary, bad_in, bad_of
from isograde.variants import MAGNITUDES

TRILINEAR, BILINEAR = "topology.trilinear", "topology.bilinear"
FACE, HOLE = "wrong face", "hole"
# The powers of two that the variants multiply samples by.
EXPONENTS = {"scale": 2, **{f"magnitude/{word}": by for word, by in MAGNITUDES.items()}}
# A clause, or one for each of several mistakes; empty where there is nothing to add.
Told = str | tuple[str, ...]
# Chernyaev's cases with a tunnel.
TUNNELS = ("4.2", "6.1.2", "7.4.2", "10.1.2", "12.1.2", "13.5.2")
# Say it of so many cells, errors or cases at most.
TOLD = 3


@dataclass(frozen=True, eq=False)
class Seen:
    """The smallest failed case of a claim with the mesh that came, in index coordinates."""

    record: JSON
    trial: Trial

    @classmethod
    def of(cls, record: JSON, declaration: JSON) -> Seen | None:
        """The same, where the samples and the mesh are kept; else None."""
        came, kind = record["came"], Kind(*record["kind"])
        if "simplices" not in came or not record["values"]:
            return None
        shape = (*([kind.m] if kind.m > 1 else []), *record["shape"])
        values = np.array([float(x) for x in record["values"]]).reshape(shape)
        field = Field.of(values, record["spacing"], record["origin"], dimension=kind.n)
        vertices = np.array(came["vertices"], float).reshape(-1, kind.n)
        rows = np.array(came["simplices"], np.int64).reshape(-1, kind.k + 1)
        levels = tuple(float(x) for x in record["isovalues"])
        case = Case(record["case"], lambda: field, levels, int(np.prod(record["shape"])), kind=kind)
        outcome = Outcome(Status.OK, vertices, rows)
        declared = declaration_from(declaration, "it")
        return cls(record, Trial(case, field, declared, {"plain": outcome}))

    @cached_property
    def lattice(self) -> Lattice:
        """The samples."""
        return Lattice.of(self.trial.field, self.trial.isovalues, self.trial.declaration)

    @cached_property
    def mesh(self) -> Complex:
        """The mesh, vertices of equal coordinates made one, simplices in the order they came."""
        points = self.lattice.index(self.trial.mesh.vertices)
        return Complex(points, self.trial.mesh.simplices).welded()

    @property
    def numbers(self) -> Mapping[str, object]:
        """What the judge found."""
        numbers: Mapping[str, object] = self.record["finding"].get("numbers", {})
        return numbers

    @property
    def first(self) -> Floats | None:
        """(2, n) the least box round what the judge named."""
        return box(self.numbers)

    def around(self) -> list[list[int]]:
        """The cells that hold all that the judge named: one, or those on either side of a face."""
        low, high = self.first if self.first is not None else (None, None)
        if low is None or high is None:
            return []
        return cells_round(np.stack([low, high]), self.lattice.shape)


def cells_round(points: Floats, shape: Sequence[int]) -> list[list[int]]:
    """The cells of a lattice of this shape that hold these points (r, n), borders included."""
    low, high = points.min(axis=0), points.max(axis=0)
    ranges = []
    for a, b, n in zip(low, high, shape, strict=True):
        first = int(np.ceil(b - 1 - 1e-6))
        last = int(np.floor(a + 1e-6))
        ranges.append(range(max(first, 0), min(last, n - 2) + 1))
    grid = np.array(np.meshgrid(*ranges, indexing="ij")).reshape(len(shape), -1).T
    found: list[list[int]] = grid.astype(int).tolist()
    return found


def diagnosis(report: Report, summary: Summary) -> str:
    """What is wrong, in a sentence without a full stop."""
    return "; ".join(diagnoses(report, summary))


def diagnoses(report: Report, summary: Summary) -> tuple[str, ...]:
    """What is wrong: a clause for each mistake."""
    record = report.evidence.get(summary.id)
    seen = None if record is None else Seen.of(record, report.declaration)
    for tell in TELLERS.get(summary.id, ()):
        if told := tell(report, summary, seen):
            return (told,) if isinstance(told, str) else told
    return (_as_judged(summary),)


def _as_judged(summary: Summary) -> str:
    """The judge's own words on the smallest case; of errors, what most of them say."""
    failure = summary.failure
    return "" if failure is None else " ".join(failure.detail.split()).rstrip(".")


# --- how the mesh hangs together ----------------------------------------------------------------


def _crowded(report: Report, summary: Summary, seen: Seen | None) -> str:
    """What the simplices at an edge of too many are."""
    if seen is None or "facets" not in seen.numbers or seen.first is None:
        return ""
    rows = _at_facet(seen)
    if twice := _twice(rows):
        return f"{twice} {_noun(seen)} with the same corners are drawn {_by(seen)}"
    if seen.trial.kind != SURFACES:
        return ""
    return _in_face(seen, rows) or _of_dual(seen, len(rows))


def _at_facet(seen: Seen) -> Integers:
    """The simplices that have the facet which the judge named first."""
    ends = np.array(seen.numbers["first"], float).reshape(-1, seen.trial.kind.n)
    far = np.abs(seen.mesh.points[seen.mesh.simplices][:, :, None] - ends).max(axis=-1)
    rows: Integers = seen.mesh.simplices[(far.min(axis=1) < 1e-4).all(axis=1)]
    return rows


def _twice(rows: Integers) -> int:
    """How many of these simplices have the same vertices as another of them."""
    _, counts = np.unique(np.sort(rows, axis=1), axis=0, return_counts=True)
    return int(counts[counts > 1].sum())


def _noun(seen: Seen) -> str:
    """Simplices of this dimension."""
    return {1: "segments", 2: "triangles"}.get(seen.trial.kind.k, "simplices")


def _by(seen: Seen) -> str:
    """Where: in one cell, or once by each of two."""
    cells = seen.around()
    if len(cells) == 2:
        return f"in the face between the cells {anded(cells)}: each of the two draws them"
    return f"in the cell {cells[0]}" if len(cells) == 1 else "there"


def _in_face(seen: Seen, rows: Integers) -> str:
    """How many triangles lie flat in the face between two cells, and how many are of each."""
    ends, corners = np.array(seen.numbers["first"], float), seen.mesh.points[rows]
    cells = cells_round(ends, seen.lattice.shape)
    if len(cells) != 2:
        return ""
    axis = int(np.argmax(np.subtract(cells[1], cells[0])))
    level = (np.abs(corners[:, :, axis] - ends[0, axis]) < 1e-4).all(axis=1)
    if not level.any():
        return ""
    count, shares = _shares(seen, axis, cells)
    return (
        f"{count or int(level.sum())} triangles lie flat in the face between the cells "
        f"{anded(cells)}{shares}, and share an edge"
    )


def _shares(seen: Seen, axis: int, cells: list[list[int]]) -> tuple[int, str]:
    """How many flat triangles the face between these cells has, and how many are of each."""
    found = traces_of(seen.trial)
    lying = found.lying
    for face in np.flatnonzero(lying.axis == axis):
        rows = int(lying.below[face]), int(lying.above[face])
        if min(rows) < 0 or [found.place[row].tolist() for row in rows] != cells:
            continue
        count = int(lying.count[face])
        values, isovalue = np.asarray(seen.trial.field.values, np.float64), seen.trial.isovalues[0]
        corners = np.moveaxis(values, axis, 0)[cells[1][axis]]
        i, j = np.delete(cells[1], axis)
        sign, _ = saddle_sign(corners[i : i + 2, j : j + 2].T.reshape(1, 4), isovalue)
        wanted = np.full(len(lying), -1)
        wanted[face] = int(sign[0] > 0)
        readings = found.readings.preferring(wanted)
        parts = {int(mask).bit_count() for mask in readings.masks[face]}
        if len(parts) == 1 and count:
            up = parts.pop()
            words = {2: "two of each", 1: "one of each"}.get(up, f"{up} of each")
            shares = words if 2 * up == count else f"{count - up} of the first, {up} of the second"
            return count, f", {shares}"
        return count, ""
    return 0, ""


def _of_dual(seen: Seen, count: int) -> str:
    """Of vertices in cells: the face that the crowded edge passes through is ambiguous."""
    if seen.trial.declaration.vertices != "cells":
        cells = seen.around()
        return f"{count} triangles share one edge in the cell {cells[0]}" if len(cells) == 1 else ""
    ends = np.array(seen.numbers["first"], float)
    cells = [np.floor(end).astype(int).tolist() for end in ends]
    return (
        f"{count} triangles share the edge between the vertices of the cells {anded(cells)}: two "
        "sheets of the surface pass through the face between them, and each cell has one vertex"
    )


def _sheets(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of a vertex in which several sheets meet: where it is."""
    if seen is None or "vertices" not in seen.numbers or seen.first is None:
        return ""
    point, cells = seen.first[0], seen.around()
    if seen.trial.declaration.vertices == "cells" and len(cells) == 1:
        return (
            f"the cell {cells[0]} has one vertex for several sheets of the surface, which meet in "
            "it"
        )
    where = f"in the cell {cells[0]}" if len(cells) == 1 else f"at index {_place(point)}"
    return f"sheets of the surface that no edge joins share one vertex, {where}"


def _place(point: Floats) -> list[float]:
    """Index coordinates for a reader."""
    return [round(float(x), 4) for x in point]


def _unshared(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of a hole that is none once vertices count as one."""
    failure = summary.failure
    if failure is None or seen is None:
        return ""
    failed = _all_numbers(report, summary) or [failure.numbers]
    if told := _seam(failed):
        return told
    # Of a soup in every case: the smallest may be of two triangles.
    rows = seen.trial.mesh.simplices
    alone = len(rows) > 1 and all(one.get("alone") for one in failed)
    start = f"no two {_noun(seen)} share a vertex: " if alone else ""
    if failure.numbers.get("boundary_facets_after_welding") == 0:
        mend = "" if report.declaration["mesh"] != "indexed" else ', or declare "mesh": {"soup": 0}'
        many = "equal vertices are there several times"
        return f"{start or many + ': '}it is closed once equal vertices are one; share them{mend}"
    if "of a cell: the interpolation" in failure.detail:
        mend = failure.detail.split("it is ")[-1]
        return (
            f"{start}equal vertices differ in the last digits: it is {mend}; interpolate from the "
            'same end for every cell, or declare "mesh": {"soup": 1e-5}'
        )
    return ""


def _seam(failed: Sequence[Mapping[str, Any]]) -> str:
    """Of holes in planes across one axis alone, in every case, that equal vertices would close."""
    planes = [one.get("planes") for one in failed]
    closing = all(one.get("boundary_facets_after_welding") == 0 for one in failed)
    if not closing or all(one.get("alone") for one in failed):
        return ""
    if None in planes or len({one["axis"] for one in planes if one}) != 1:
        return ""
    at = sorted({x for one in planes if one for x in one["at"]})
    axis = next(one["axis"] for one in planes if one)
    return (
        f"{open_inside(axis, at)} Equal vertices stand there twice: it is closed once they are one"
    )


def _all_numbers(report: Report, summary: Summary | None) -> Sequence[Mapping[str, Any]]:
    """The numbers of all failures of a claim, if it was judged."""
    if summary is None:
        return []
    return [
        finding.get("numbers", {})
        for result in report.results
        for name, _, finding in bad_of(result)
        if name == summary.id
    ]


def _row(report: Report, summary: Summary, seen: Seen | None) -> str:
    """What is wrong with the row of a table, where one cell alone is at fault."""
    declared = report.declaration
    if seen is None or seen.trial.kind != SURFACES or seen.lattice.shape != (2, 2, 2):
        return ""
    plain = declared["interpolant"], declared["vertices"], declared["domain"]
    if plain != ("multilinear", "edges", [{"inset": 0.0, "end": "open"}]):
        return ""
    if seen.lattice.tied.any() or not len(seen.mesh.simplices):
        return ""
    inside = frozenset(c for c in CORNERS if seen.trial.field.values[c] >= seen.trial.isovalues[0])
    outcome = Outcome(Status.OK, seen.mesh.points, seen.mesh.simplices)
    found = judged(inside, outcome, seen.trial.field)
    order = (2, 1, 0) if declared["conventions"]["axes"] == "reversed" else (0, 1, 2)
    wrong = [n.get("signs") for n in _all_numbers(report, report.summaries.get("cells.legal"))]
    return fault_told(found, order, alone=len(wrong) > 1 and len({*wrong}) == 1)


def _hole(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of a hole: the face that two cells draw differently, or the triangle that is missing."""
    if seen is None or seen.first is None or seen.trial.kind != SURFACES:
        return ""
    if seen.numbers.get("beyond"):
        return f"the surface goes on beyond its domain, and ends at index {_place(seen.first[0])}"
    edges = _ring(seen)
    if not len(edges):  # Once vertices at one place are one, no edge that counts is open.
        return ""
    ring = np.unique(edges)
    cells = cells_round(seen.mesh.points[ring], seen.lattice.shape)
    if len(cells) == 2:
        return _disagree(seen, cells)
    if len(cells) == 1 and len(ring) == 3:
        corners = ", ".join(str(_place(seen.mesh.points[i])) for i in ring)
        return f"the triangle {corners} is missing in the cell {cells[0]}"
    where = f"in the cell {cells[0]}" if len(cells) == 1 else f"at index {_place(seen.first[0])}"
    if len(edges) == 1:
        return f"an edge {where} has one triangle only: the one on its other side is missing"
    return f"a hole of {len(edges)} edges {where}"


def _ring(seen: Seen) -> Integers:
    """(e, 2) the edges of the hole that the judge named first."""
    open_ = seen.mesh.open_facets
    open_ = open_[~seen.lattice.on_border(seen.mesh.points, open_)] if len(open_) else open_
    if not len(open_):
        return open_
    ends = np.array(seen.numbers["first"], float).reshape(-1, 3)
    away = np.abs(seen.mesh.points[:, None] - ends).max(axis=-1)
    ring = {int(away[:, 0].argmin())}
    while more := {int(v) for edge in open_ if ring & set(edge.tolist()) for v in edge} - ring:
        ring |= more
    return np.array([edge for edge in open_.tolist() if ring & set(edge)], np.int64).reshape(-1, 2)


def _disagree(seen: Seen, cells: list[list[int]]) -> str:
    """What two cells make of the face between them."""
    found = traces_of(seen.trial)
    axis = int(np.argmax(np.subtract(cells[1], cells[0])))
    said = []
    for cell, face in zip(cells, (2 * axis + 1, 2 * axis), strict=True):
        rows = np.flatnonzero((found.place == cell).all(axis=1))
        if not len(rows):
            said.append("draws nothing")
        elif not found.ambiguous[rows[0], face]:
            right = found.separated[rows[0], face]
            said.append("is right" if right else "draws segments that the samples do not ask for")
        elif found.separated[rows[0], face]:
            said.append("separates its inside corners")
        else:
            joined = found.joined[rows[0], face]
            said.append("joins its inside corners" if joined else "does neither")
    if said.count("does neither") and seen.lattice.tied.any():
        return (
            f"a hole in the face between the cells {anded(cells)}, at a sample that equals the "
            "isovalue"
        )
    told = "; ".join(f"{cell} {what}" for cell, what in zip(cells, said, strict=True))
    return f"the cells {anded(cells)} disagree on the face between them: {told}"


def _turned(report: Report, summary: Summary, seen: Seen | None) -> str:
    """The triangle that is turned over, where one is enough to mend it."""
    if seen is None:
        return ""
    bad = {tuple(row) for row in seen.mesh.misdirected_facets.tolist()}
    for i, row in enumerate(seen.mesh.simplices.tolist()):
        mine = {tuple(sorted(row[:c] + row[c + 1 :])) for c in range(len(row))}
        if bad and bad <= mine:
            cells = cells_round(seen.mesh.points[row], seen.lattice.shape)
            where = f", in the cell {cells[0]}," if len(cells) == 1 else ""
            return f"{_noun(seen)[:-1]} {i}{where} is turned over"
    return ""


def _reversed(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of sides that are all exchanged."""
    numbers = summary.failure.numbers if summary.failure else {}
    if numbers.get("reversed") and numbers["reversed"] == numbers["faces"] == numbers["judged"]:
        if right := summary.counts[Verdict.PASS]:
            return (
                f"in this field all normals point the other way; in {right:,} others they are right"
            )
        to = report.declaration["conventions"]["normals"]
        other = {"to_low": "to_high", "to_high": "to_low"}.get(to, "none")
        return (
            f"all normals point the other way: turn every {_noun_of(report)} over, or declare "
            f'"normals": "{other}"'
        )
    return ""


def _noun_of(report: Report) -> str:
    """What a simplex of the report's first kind is called."""
    return {1: "segment", 2: "triangle"}.get(report.kinds[0].k, "simplex")


# --- where vertices are -------------------------------------------------------------------------


def _misplaced(report: Report, summary: Summary, seen: Seen | None) -> Told:
    """The map that moves the vertices off the crossings, and the split they are on; if any."""
    placed = None if seen is None else placed_of(seen)
    if placed is None or report.declaration["vertices"] != "edges":
        return ""
    if report.declaration["interpolant"] != "multilinear":
        return ""
    # The smallest answer alone may be explained in several ways: look at all that are kept.
    others = _all_placed(report)
    if (told := shared(placed, others)) is not None:
        if told:
            return told
    elif any(map(on_diagonals, others)):
        told = shared(placed, others, kuhn=True)
        if told is not None:
            return _on_split(others, told)
    vertices, values = placed.vertices, placed.values
    shares = not _crossings_hold(report)
    return misplacement(vertices, values, placed.isovalue, placed.spacing, shares=shares)


def _crossings_hold(report: Report) -> bool:
    """Whether the page says of fields in general position that every crossing is right.

    Vertices that stand on samples, as where a surface is closed at the border, seem to stand on
    crossed edges too: at a wrong share of the way, which that sentence denies.
    """
    summary = report.summaries.get("geometry.crossing")
    return summary is not None and bool(summary.evidence) and not bad_in(summary.general)


def _on_split(answers: Sequence[Placed], told: str) -> Told:
    """That vertices stand on the edges of Kuhn's split; and the map that moves them off these."""
    looks = looks_like("interpolant", "kuhn", "multilinear")
    if told:
        return told, f"beside that, {looks}"
    diagonal = sum(map(on_diagonals, answers))
    count = sum(len(one.vertices) for one in answers)
    return (
        f"{diagonal:,} of {count:,} vertices of the answers shown here stand on diagonals of "
        f'cells, as the split "kuhn" has them: {looks}'
    )


def placed_of(seen: Seen) -> Placed | None:
    """The vertices of an answer with its samples; None of several components, or of no simplex."""
    if seen.trial.kind.m > 1 or not len(seen.mesh.simplices):
        return None
    points = seen.mesh.points[np.unique(seen.mesh.simplices)]
    values = np.asarray(seen.trial.field.values, np.float64)
    return Placed(points, values, seen.trial.isovalues[0], np.asarray(seen.record["spacing"]))


def _all_placed(report: Report) -> list[Placed]:
    """The answers that are kept of all claims that failed."""
    if "placed" not in report.memory:
        kept = (Seen.of(record, report.declaration) for record in report.evidence.values())
        report.memory["placed"] = [
            placed for seen in kept if seen is not None and (placed := placed_of(seen)) is not None
        ]
    found: list[Placed] = report.memory["placed"]
    return found


def _astray(report: Report, summary: Summary, seen: Seen | None) -> str:
    """What holds the vertex that the judge named: an edge, a face, or a cell."""
    if seen is None or seen.first is None or report.declaration["vertices"] != "edges":
        return ""
    point = seen.first[0]
    whole = np.abs(point - np.rint(point)) < 1e-4
    place, n, last = _place(point), len(point), np.subtract(seen.lattice.shape, 1)
    if (point < -1e-4).any() or (point > last + 1e-4).any():
        end = last.tolist()
        return f"a vertex stands at index {place}, beyond the samples, which end at {end}"
    cells = cells_round(point[None], seen.lattice.shape)
    if whole.all():
        return f"a vertex stands on the sample {np.rint(point).astype(int).tolist()}"
    if whole.sum() == n - 1:
        return f"a vertex stands at index {place}, on an edge whose ends are on the same side"
    if whole.any() and len(cells) == 2:
        return f"a vertex stands inside the face between the cells {anded(cells)}, at index {place}"
    return ""


def _crossing(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of simplices that cross: how many pairs, and near which place."""
    numbers = summary.failure.numbers if summary.failure else {}
    try:
        pair = np.asarray(numbers["first"], float)
    except (KeyError, TypeError, ValueError):
        return ""
    if pair.ndim != 3:
        return ""
    name, place = {2: "segments", 3: "triangles"}[pair.shape[1]], _place(pair.mean(axis=(0, 1)))
    count = numbers["pairs"]
    return f"{count:,} pairs of {name} cross, the first near index {place}"


# --- what cells become --------------------------------------------------------------------------


def wrong_by_case(report: Report) -> tuple[Counter[str], Counter[tuple[str, str]]]:
    """Cells judged by Chernyaev's case, and those wrong by case and fault; scans are left out."""
    judged, wrong = Counter[str](), Counter[tuple[str, str]]()
    for result in report.results:
        numbers = result["measured"].get(TRILINEAR) or _numbers_of(result, TRILINEAR)
        if "real" in report.cases[result["case"]]["tags"]:
            continue
        judged.update({name: int(n) for name, n in numbers.get("cases", {}).items()})
        wrong.update({(name, fault): int(n) for name, fault, n in numbers.get("faults", [])})
    return judged, wrong


def _numbers_of(result: JSON, claim: str) -> JSON:
    """The numbers of a claim's finding on a case, where it is no pass."""
    for finding in result["findings"]:
        if finding["claim"] == claim:
            numbers: JSON = finding.get("numbers", {})
            return numbers
    return {}


def _by_case(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Which fault in how many of the cells of which case; the cases that are always wrong first."""
    judged, wrong = wrong_by_case(report)
    if not wrong:
        return ""
    # What another finding tells of faces and holes is not told again; inside the cells it is.
    for claim, fault in ((BILINEAR, FACE), ("topology.closed", HOLE)):
        if (other := report.summaries.get(claim)) is not None and other.bad:
            wrong = Counter({key: n for key, n in wrong.items() if key[1] != fault}) or wrong
    rows = sorted(wrong.items(), key=lambda row: (-row[1] / judged[row[0][0]], row[0]))
    faults: dict[str, list[str]] = {}
    for (name, fault), n in rows:
        share = f"{n:,} of {judged[name]:,} cells of case {name}"
        faults.setdefault(fault, []).append(share)
    said = []
    for fault, shares in faults.items():
        more = len(shares) - TOLD
        rest = [f"{more} more case{'s' if more > 1 else ''}"] if more > 0 else []
        told = anded([*shares[:TOLD], *rest])
        said.append(f"{fault} in {told}")
    return "; ".join(said)


def right_cells(report: Report) -> str:
    """The cells whose topology is right, where some are not; or nothing."""
    judged, wrong = wrong_by_case(report)
    bad = {name for name, _ in wrong}
    good = [name for name in judged if name not in bad]
    if not bad or not good:
        return ""
    tunnels = [name for name in TUNNELS if judged[name]]
    if tunnels and not bad & set(tunnels):
        return f"every cell with a tunnel, and all of {len(good)} cases of {len(judged)}"
    return f"all cells of {len(good)} of the {len(judged)} cases ({_few(good)})"


def _few(names: Sequence[str], most: int = 8) -> str:
    """Names in order, and how many more there are."""
    ordered = sorted(names, key=lambda name: [int(part) for part in name.split(".")])
    more = len(ordered) - most
    return ", ".join(ordered[:most]) + (f" and {more} more" if more > 0 else "")


def _faces(report: Report, summary: Summary, seen: Seen | None) -> str:
    """How many ambiguous faces are decided otherwise, of all."""
    wrong = faces = 0
    for result in report.results:
        numbers = result["measured"].get(summary.id) or _numbers_of(result, summary.id)
        wrong += int(numbers.get("wrong_faces", 0))
        faces += int(numbers.get("faces", 0))
    if not wrong:
        return ""
    return (
        f"{wrong:,} of {faces:,} ambiguous faces are decided otherwise than the bilinear "
        "interpolant decides them"
    )


SCANNED = ("pieces", "pieces_wanted", "handles", "handles_wanted")


def _scanned(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Pieces and handles of all fields that are measured, beside those of the level set."""
    total = dict.fromkeys(SCANNED, 0.0)
    for result in report.results:
        numbers = result["measured"].get(summary.id, {})
        for name in SCANNED:
            total[name] += float(numbers.get(name, 0))
    if not total["pieces_wanted"]:
        return ""
    made, wanted, handles, right = (f"{total[name]:,.0f}" for name in SCANNED)
    return (
        f"{made} pieces with {handles} handles on noise and scans, where the trilinear level sets "
        f"have {wanted} with {right}"
    )


def _entry(report: Report, summary: Summary, seen: Seen | None) -> str:
    """The one configuration of corners that is wrong, where it is one on every case."""
    signs = Counter[int]()
    for result in report.results:
        for name, _, finding in bad_of(result):
            if name == summary.id:
                signs[finding.get("numbers", {}).get("signs", -1)] += 1
    if len(signs) == 1 and -1 not in signs and sum(signs.values()) > 1:
        (corners,) = signs
        width = 8 if report.kinds[0] == SURFACES else 4
        inside = [i for i in range(width) if corners >> i & 1]
        detail = _as_judged(summary).split("; ", 1)[-1]
        return (
            f"one entry of the table is wrong: whenever the corners "
            f"{anded([_corner(i, width) for i in inside])} alone are inside; {detail}"
        )
    return ""


def _corner(number: int, width: int) -> str:
    """A corner of a cell by its offsets along the axes."""
    n = 3 if width == 8 else 2
    return "".join(str(number >> (n - 1 - axis) & 1) for axis in range(n))


# --- how the field is posed ---------------------------------------------------------------------


def _rescaled(report: Report, summary: Summary, seen: Seen | None) -> str:
    """Of another surface for other magnitudes: from which power of two on, in how many fields."""
    first = Counter[int]()
    for result in report.results:
        for name, verdict, finding in bad_of(result):
            if name != summary.id:
                continue
            exponent = EXPONENTS.get(finding.get("numbers", {}).get("variant", ""))
            if verdict != Verdict.FAIL or exponent is None or NO_MESH in finding["detail"]:
                return ""
            first[exponent] += 1
    if not first:
        return ""
    nearest, *farther = sorted(first, key=abs)
    said = [f"So it is in {_fields(first[nearest])}"]
    said += [f"from 2^{one:+d} on in {_fields(first[one])}" for one in farther]
    return f"{another_surface(times(nearest))} {', '.join(said)}"


def _fields(count: int) -> str:
    """A count of fields."""
    return "1 field" if count == 1 else f"{count:,} fields"


# --- answers ------------------------------------------------------------------------------------


def _errors(report: Report, summary: Summary, seen: Seen | None) -> str:
    """What most of the failed calls say."""
    said = Counter[str]()
    for result in report.results:
        for name, verdict, finding in bad_of(result):
            if name == summary.id:
                word = "" if verdict == Verdict.FAIL else f"{verdict}: "
                said[word + " ".join(finding["detail"].split())[:160]] += 1
    if not said:
        return ""
    (most, count), *others = said.most_common()
    more = f", and {len(others)} other messages" if others else ""
    return f"{count:,} {'call' if count == 1 else 'calls'}: {most}{more}"


Teller = Callable[[Report, Summary, "Seen | None"], Told]
TELLERS: Mapping[str, tuple[Teller, ...]] = {
    "structure.answers": (_errors,),
    "topology.closed": (_unshared, _misplaced, _row, _hole),
    "topology.oriented": (_turned, _row),
    "topology.sides": (_reversed, _misplaced),
    "topology.manifold": (_crowded, _sheets),
    "geometry.vertices": (_misplaced, _astray),
    "geometry.crossing": (_misplaced,),
    "geometry.embedded": (_crossing,),
    "cells.legal": (_row, _entry),
    "cells.count": (_entry,),
    BILINEAR: (_faces,),
    TRILINEAR: (_by_case,),
    "topology.scan": (_scanned,),
    "range.scale": (_rescaled,),
    "symmetry.scale": (_rescaled,),
}
