"""Every configuration of a cell, asked alone: which row of a table is wrong, and how.

A cell of 2 x 2 x 2 samples has 254 configurations with a surface. Of the triangles that come for
one, this is asked, of their combinatorics alone:

1. each vertex stands on a crossed lattice edge, where the linear interpolant crosses, or inside;
2. each crossed edge has a vertex;
3. an edge of one triangle lies in a face of the cell, every other belongs to two triangles, which
   pass it in opposite directions;
4. on each face the segments join crossings whose inside ends are on the same side of them;
5. that side is the right of who walks along the segment and sees the cell from outside.

Nothing is taken from any table, ours or others'; which crossings an ambiguous face joins is left
open, for one cell alone does not know it.

Glossary
--------
row     a configuration, and what a table has for it
corner  (0, 0, 0) .. (1, 1, 1), in the order of the array's axes
share   where between the two ends of its edge a crossing stands, 0 at the lower
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from dataclasses import field as fresh
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from isoref.field import Field, Floats
from numpy.typing import NDArray

from isograde.checking.checked import Advice
from isograde.model import Outcome, Status, Verdict

Corner = tuple[int, int, int]
Answer = Callable[[Field, tuple[float, ...]], Outcome]
CORNERS: tuple[Corner, ...] = tuple((x, y, z) for x, y, z in product((0, 1), repeat=3))
# The order in which most published tables number the corners of a cell.
USUAL: tuple[Corner, ...] = (
    (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
)  # fmt: skip
ISOVALUE = 0.5
# A coordinate this near to 0 or 1 is there; a share this near to another is the same.
NEAR, SHARE = 1e-4, 0.02
NO_CELL = "a cell alone, of 2 x 2 x 2 samples, gets no triangles, whatever its samples are"
# Tell so many rows by name.
TOLD = 4


class LatticeEdge(NamedTuple):
    """An edge of the cell, from its lower end."""

    low: Corner
    axis: int

    @property
    def high(self) -> Corner:
        """The other end."""
        a, b, c = (x + (k == self.axis) for k, x in enumerate(self.low))
        return a, b, c


@dataclass
class Row:
    """What is wrong with the answer to one configuration; nothing where `fault` is empty."""

    inside: frozenset[Corner]
    fault: str = ""
    detail: str = ""
    used: frozenset[LatticeEdge] = frozenset()
    shares: list[tuple[LatticeEdge, float, float]] = fresh(default_factory=list)


FAULTS = {
    "nothing": "gives no triangles",
    "entry": "names an edge that is not crossed",
    "not finite": "has a vertex that is not finite: is an edge used that is not crossed, or a "
    "difference of 0 divided by?",
    "unused": "leaves a crossed edge without a vertex",
    "missing": "lacks a triangle: an edge inside the cell belongs to one triangle only",
    "doubled": "has an edge that belongs to more than two triangles",
    "flipped": "is turned over: its triangles face the other way",
    "one flipped": "has a triangle that faces another way than its neighbours",
    "same way": "has two triangles that pass an edge in the same direction",
    "crossed": "joins crossings across a face so that inside and outside corners mix",
    "loose": "does not end at each crossing of a face exactly once",
    "elsewhere": "has a vertex outside the cell",
}


def rows_told(
    answer: Answer, order: tuple[int, ...] = (0, 1, 2), *, halfway: bool = False
) -> Iterator[Advice]:
    """What is wrong with the answers to single cells, by row and by lattice edge.

    `order` says which of the array's axes the implementation calls its first, second and third;
    `halfway`, that crossings stand in the middle of their edges.
    """
    rows, declined = [], 0
    for inside in configurations():
        field = cell(inside)
        outcome = answer(field, (ISOVALUE,))
        declined += outcome.status is Status.DECLINED
        if outcome.status is Status.OK:
            rows.append(judged(inside, outcome, field))
        elif outcome.status is not Status.DECLINED:
            rows.append(Row(inside, outcome.status.value, outcome.detail))
    if not rows:
        yield Verdict.SKIP, "a cell alone is outside its limits: rows of a table were not looked at"
        return
    wrong = [row for row in rows if row.fault]
    if all(row.fault == "nothing" for row in rows):
        yield Verdict.FAIL, NO_CELL
        return
    if (axis := mirrored(rows)) is not None:
        yield Verdict.FAIL, f"the samples are read from the other end along axis {axis}: mirrored"
        return
    for fault in dict.fromkeys(row.fault for row in wrong):
        yield _of_one_fault(fault, [row for row in wrong if row.fault == fault], len(rows), order)
    placed = [one for row in rows for one in row.shares]
    shares = [] if halfway else list(_interpolation(placed))
    yield from shares
    if not wrong and not shares:
        yield Verdict.PASS, f"each of {len(rows)} configurations of one cell is answered rightly"


def mirrored(rows: list[Row]) -> int | None:
    """The axis along which mirrored configurations explain nearly all answers, or None."""
    if sum(row.fault == "entry" for row in rows) < 0.5 * len(rows):
        return None
    for axis in range(3):
        explained = 0
        for row in rows:
            inside = frozenset(_other_end(corner, axis) for corner in row.inside)
            explained += row.used == {e for e in _edges() if _is_crossed(e, Row(inside))}
        if explained > 0.9 * len(rows):
            return axis
    return None


def _other_end(corner: Corner, axis: int) -> Corner:
    """The corner at the other end of its edge along this axis."""
    x, y, z = (1 - at if k == axis else at for k, at in enumerate(corner))
    return x, y, z


def configurations() -> list[frozenset[Corner]]:
    """The sets of inside corners, all but none and all."""
    return [
        frozenset(corner for bit, corner in enumerate(CORNERS) if number >> bit & 1)
        for number in range(1, 255)
    ]


def cell(inside: frozenset[Corner]) -> Field:
    """The cell with these inside corners, its values at random distances from the isovalue."""
    number = sum(1 << bit for bit, corner in enumerate(CORNERS) if corner in inside)
    # No two are alike: who interpolates on a wrong edge shall not divide by zero.
    distance = (20 + np.random.default_rng(number).permutation(80)[:8].reshape(2, 2, 2)) / 100
    signs = np.array([1.0 if corner in inside else -1.0 for corner in CORNERS]).reshape(2, 2, 2)
    return Field.of(ISOVALUE + signs * distance)


def judged(inside: frozenset[Corner], outcome: Outcome, field: Field) -> Row:
    """What is wrong with the mesh for this configuration."""
    row = Row(inside)
    points, triangles = outcome.vertices, outcome.simplices
    assert points is not None
    assert triangles is not None
    if not len(triangles):
        row.fault = "nothing"
        return row
    places = _places(points.astype(float), row)
    if row.fault:
        return row
    _crossings(places, triangles, row)
    _positions(points.astype(float), places, field, row)
    if not row.fault and not _any_flat(points.astype(float)[triangles]):
        _combinatorics(places, triangles, points.astype(float), row)
    return row


def _any_flat(corners: Floats) -> bool:
    """Whether a triangle lies in a face of the cell: how it counts, its neighbours decide."""
    at_side = (np.abs(corners) < NEAR).all(axis=1) | (np.abs(corners - 1) < NEAR).all(axis=1)
    return bool(at_side.any())


def _places(points: Floats, row: Row) -> list[Any]:
    """For each vertex its lattice edge, or a place of its own where it is inside the cell."""
    places: list[Any] = []
    for point in points:
        if not np.isfinite(point).all():
            row.fault = "not finite"
            return places
        between = [k for k in range(3) if min(abs(point[k]), abs(point[k] - 1)) > NEAR]
        if len(between) == 1:
            low = [round(float(x)) for x in point]
            low[between[0]] = 0
            places.append(LatticeEdge((low[0], low[1], low[2]), between[0]))
        else:
            places.append(tuple(np.round(point, 4).tolist()))
        outside = (point < -NEAR).any() or (point > 1 + NEAR).any()
        if outside and (len(between) > 1 or _is_crossed(places[-1], row)):
            row.fault, row.detail = "elsewhere", f"at {_spoken(point)}"
    return places


def _is_crossed(edge: LatticeEdge, row: Row) -> bool:
    """Whether the edge has one end inside and one outside."""
    return (edge.low in row.inside) != (edge.high in row.inside)


def _crossings(places: list[Any], triangles: NDArray[Any], row: Row) -> None:
    """The row knows of an edge that is used and not crossed, or crossed and not used."""
    used = {places[v] for v in triangles.reshape(-1).tolist()}
    edges = {place for place in used if isinstance(place, LatticeEdge)}
    row.used = frozenset(edges)
    crossed = {edge for edge in _edges() if _is_crossed(edge, row)}
    if edges - crossed:
        row.fault, row.detail = "entry", _edge_told(min(edges - crossed))
    elif crossed - edges:
        row.fault, row.detail = "unused", _edge_told(min(crossed - edges))


def _positions(points: Floats, places: list[Any], field: Field, row: Row) -> None:
    """The row has the shares at which its crossings stand, beside the right ones."""
    for point, edge in zip(points, places, strict=True):
        if not isinstance(edge, LatticeEdge):
            continue
        low, high = float(field.values[edge.low]), float(field.values[edge.high])
        if _is_crossed(edge, row):
            right = (ISOVALUE - low) / (high - low)
            row.shares.append((edge, float(point[edge.axis]), right))


def _combinatorics(places: list[Any], triangles: NDArray[Any], points: Floats, row: Row) -> None:
    """The row knows of holes, of edges of many triangles, and of triangles turned over."""
    passed: Counter[tuple[Any, Any]] = Counter()
    where = dict(zip(places, points, strict=True))
    for triangle in triangles.tolist():
        corners = [places[v] for v in triangle]
        passed.update(zip(corners, corners[1:] + corners[:1], strict=True))
    segments = []
    for (start, end), count in passed.items():
        back = passed.get((end, start), 0)
        face = _face(where[start], where[end])
        if count + back > 2 and face is None:
            row.fault, row.detail = "doubled", _segment_told(where[start], where[end])
        elif count == 2:
            if row.fault != "one flipped":
                row.detail = _both_told(places, triangles, (start, end), where)
            row.fault = "one flipped"
        elif count + back == 1 and face is None:
            row.fault = row.fault or "missing"
            row.detail = row.detail or _segment_told(where[start], where[end])
        elif count + back == 1:
            segments.append((start, end, face))
    if not row.fault:
        _on_faces(segments, where, row)
    elif row.fault == "one flipped":
        _mended(places, triangles, points, row)


def _both_told(
    places: list[Any], triangles: NDArray[Any], segment: tuple[Any, Any], where: dict[Any, Floats]
) -> str:
    """The two triangles that pass a segment in the same direction."""
    passing = []
    for number, triangle in enumerate(triangles.tolist(), start=1):
        corners = [places[v] for v in triangle]
        if segment in zip(corners, corners[1:] + corners[:1], strict=True):
            passing.append(str(number))
    start, end = (where[one] for one in segment)
    both = f"triangles {' and '.join(passing)} of {len(triangles)} both pass"
    return f"{both} {_segment_told(start, end)}"


def _mended(places: list[Any], triangles: NDArray[Any], points: Floats, row: Row) -> None:
    """The row knows whether turning one triangle over, or else changing one corner, mends it."""
    if any(_right(places, one, points, row) for one in _one_turned(triangles)):
        return
    row.fault = "same way"
    mends = []
    for i, k in product(range(len(triangles)), range(3)):
        for v in np.unique(triangles).tolist():
            other = triangles.copy()
            other[i, k] = v
            if v not in triangles[i].tolist() and _right(places, other, points, row):
                corner, old = (_place_told(places[n]) for n in (v, triangles[i, k]))
                mends.append((f"{corner} in place of {old} in triangle {i + 1}", other))
    if mends:
        told = ", or ".join(told for told, _ in mends)
        row.detail += f"; it is right with {told}; its boundary is then "
        row.detail += _boundary_told(places, mends[0][1])


def _one_turned(triangles: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """The triangles with each of them turned over in turn."""
    for i in range(len(triangles)):
        other = triangles.copy()
        other[i] = other[i, ::-1]
        yield other


def _right(places: list[Any], triangles: NDArray[Any], points: Floats, row: Row) -> bool:
    """Whether these triangles have no fault; `_combinatorics` of what is mended does not recur."""
    tried = Row(row.inside, fault="")
    _crossings(places, triangles, tried)
    passed: Counter[tuple[Any, Any]] = Counter()
    for triangle in triangles.tolist():
        corners = [places[v] for v in triangle]
        passed.update(zip(corners, corners[1:] + corners[:1], strict=True))
    if tried.fault or max(passed.values()) > 1:
        return False
    _combinatorics(places, triangles, points, tried)
    return not tried.fault


def _boundary_told(places: list[Any], triangles: NDArray[Any]) -> str:
    """The lattice edges round the triangles, in their order; of each ring, where there are more."""
    passed = {
        (places[row[k]], places[row[(k + 1) % 3]]) for row in triangles.tolist() for k in range(3)
    }
    after = {start: end for start, end in passed if (end, start) not in passed}
    rings = []
    while after:
        start, at = after.popitem()
        ring = [start]
        while at != start and at in after:
            ring.append(at)
            at = after.pop(at)
        rings.append(", ".join(map(_place_told, ring)))
    return "; ".join(rings)


def _place_told(place: Any) -> str:
    """A lattice edge by its ends, or a place inside the cell."""
    return f"{place.low}-{place.high}" if isinstance(place, LatticeEdge) else str(place)


def _on_faces(segments: list[Any], where: dict[Any, Floats], row: Row) -> None:
    """The row knows of faces whose segments are wrong."""
    ends = Counter((place, face) for start, end, face in segments for place in (start, end))
    for edge in where:
        if isinstance(edge, LatticeEdge):
            for face in _faces_of(edge):
                if ends[edge, face] != 1:
                    row.fault, row.detail = "loose", _edge_told(edge)
                    return
    sides = []
    for start, end, face in segments:
        if not isinstance(start, LatticeEdge) or not isinstance(end, LatticeEdge):
            continue
        along = _turned(where[end] - where[start], face)
        both = [float((_inner(edge, row) - where[edge]) @ along) for edge in (start, end)]
        if both[0] * both[1] < 0:
            row.fault, row.detail = "crossed", _segment_told(where[start], where[end])
            return
        sides.append(both[0] < 0)
    if sides and not any(sides):
        row.fault = "flipped"
    elif not all(sides):
        row.fault = "one flipped"


def _edges() -> list[LatticeEdge]:
    """The twelve edges of the cell."""
    return [LatticeEdge(corner, k) for corner in CORNERS for k in range(3) if not corner[k]]


def _faces_of(edge: LatticeEdge) -> list[tuple[int, int]]:
    """The two faces of the cell, (axis, side), that an edge belongs to."""
    return [(axis, edge.low[axis]) for axis in range(3) if axis != edge.axis]


def _face(start: Floats, end: Floats) -> tuple[int, int] | None:
    """The face of the cell that holds both points, or None."""
    for axis, side in product(range(3), (0, 1)):
        if abs(start[axis] - side) < NEAR and abs(end[axis] - side) < NEAR:
            return axis, side
    return None


def _turned(step: Floats, face: tuple[int, int]) -> Floats:
    """The left of who walks this step in the face, seen from outside the cell."""
    outward = np.zeros(3)
    outward[face[0]] = 2 * face[1] - 1
    return np.cross(outward, step)


def _inner(edge: LatticeEdge, row: Row) -> Floats:
    """The inside end of a crossed edge."""
    return np.array(edge.low if edge.low in row.inside else edge.high, float)


def _of_one_fault(fault: str, rows: list[Row], asked: int, order: tuple[int, ...]) -> Advice:
    """One sentence on the rows that have this fault."""
    told = FAULTS.get(fault, f"ends in {fault}")
    if len(rows) == asked:
        return Verdict.FAIL, f"every row of the table {told}{_detail(rows[0])}"
    named = "; ".join(row_told(row.inside, order) + _detail(row) for row in rows[:TOLD])
    more = f"; and {len(rows) - TOLD} more" if len(rows) > TOLD else ""
    if len(rows) == 1:
        return Verdict.FAIL, fault_told(rows[0], order, alone=True)
    count = f"{len(rows)} rows of the table have this fault: the row {told}"
    return Verdict.FAIL, f"{count}: {named}{more}"


def fault_told(row: Row, order: tuple[int, ...] = (0, 1, 2), *, alone: bool = False) -> str:
    """What is wrong with one row, or nothing; `alone` where no other row is wrong."""
    if not row.fault:
        return ""
    told = FAULTS.get(row.fault, f"ends in {row.fault}")
    named = row_told(row.inside, order) + _detail(row)
    return f"{'1' if alone else 'a'} row of the table {told}: {named}"


def _detail(row: Row) -> str:
    """Where the fault is."""
    return f" ({row.detail})" if row.detail else ""


def row_told(inside: frozenset[Corner], order: tuple[int, ...] = (0, 1, 2)) -> str:
    """A row by its inside corners, and by its number in the usual order of corners.

    >>> row_told(frozenset({(0, 0, 0), (1, 0, 0)}))
    'inside corners (0, 0, 0) (1, 0, 0), in the usual order of corners row 3, or 252 by the outside'
    """
    corners = " ".join(map(str, sorted(inside)))
    bits = [(corner[order[0]], corner[order[1]], corner[order[2]]) for corner in inside]
    number = sum(1 << USUAL.index(corner) for corner in bits)
    usual = f"in the usual order of corners row {number}, or {255 - number} by the outside"
    return f"inside corners {corners}, {usual}"


def _interpolation(shares: list[tuple[LatticeEdge, float, float]]) -> Iterator[Advice]:
    """What is wrong with where crossings stand on their edges, by the edges it is wrong on."""
    states: dict[LatticeEdge, Counter[str]] = {}
    for edge, share, right in shares:
        if abs(right - 0.5) > SHARE:  # Near the middle right and swapped look alike.
            states.setdefault(edge, Counter())[_state(share, right)] += 1
    swapped = [edge for edge, found in states.items() if _mostly(found, "swapped")]
    if swapped:
        where = "on every edge" if len(swapped) == len(states) else _edges_told(swapped)
        yield (
            Verdict.FAIL,
            f"the interpolation is swapped {where}: crossings stand at 1 - t instead of t, "
            "t = (isovalue - a) / (b - a) from the end with value a",
        )
    middle = [edge for edge, found in states.items() if _mostly(found, "middle")]
    if middle and len(middle) < len(states):
        yield Verdict.FAIL, f"crossings stand in the middle of the edge {_edges_told(middle)}"
    off = [
        edge for edge, found in states.items() if edge not in (*swapped, *middle) and found["off"]
    ]
    if off:
        where = "on every edge" if len(off) == len(states) else _edges_told(off)
        yield Verdict.FAIL, f"crossings do not stand where the linear interpolant crosses {where}"


def _state(share: float, right: float) -> str:
    """How a crossing's share compares with the right one."""
    if abs(share - right) < SHARE:
        return "right"
    if abs(share - (1 - right)) < SHARE:
        return "swapped"
    return "middle" if abs(share - 0.5) < SHARE else "off"


def _mostly(found: Counter[str], state: str) -> bool:
    """Whether nearly all crossings of an edge that tell anything are so."""
    return found[state] > 0.9 * found.total()


def _edges_told(edges: list[LatticeEdge]) -> str:
    """Some edges by their ends, or by their axis where they are all of one."""
    axes = {edge.axis for edge in edges}
    if len(axes) == 1 and len(edges) == 4:
        return f"on the edges along axis {axes.pop()}"
    named = ", ".join(f"{edge.low}-{edge.high}" for edge in edges[:TOLD])
    return f"on the edges {named}" + (f" and {len(edges) - TOLD} more" if len(edges) > TOLD else "")


def _edge_told(edge: LatticeEdge) -> str:
    """An edge by its ends."""
    return f"edge {edge.low}-{edge.high}"


def _segment_told(start: Floats, end: Floats) -> str:
    """A segment by its ends."""
    return f"from {_spoken(start)} to {_spoken(end)}"


def _spoken(point: Floats) -> str:
    """A point with two digits."""
    return "(" + ", ".join(f"{x:.2g}" for x in point.tolist()) + ")"
