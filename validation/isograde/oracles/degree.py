"""How often, and which way, a mesh meets the faces of the lattice that it should meet.

A mesh of k-simplices in n dimensions and a face of the lattice of dimension m = n - k meet in
points. Each has a sign, and their sum is fixed by the samples on the boundary of the face: it is
the degree there of the map whose components are the values minus the isovalues. For m = 1 the face
is a lattice edge and the degree the difference of the sides of its two ends; for m = 2 it is a
square and the degree a winding number round its four corners; for larger m it is asked of the
m-simplices into which Kuhn's split cuts the face. It holds for every interpolant that is linear on
lattice edges (m <= 2), however a cell is filled, and says at once that the mesh passes between
samples where it must, nowhere else, and with its normals the right way.

Counting on faces rather than taking the winding number round a sample, the test also holds for a
mesh that is open at the end of the domain, where it is cut off.

How it is counted
-----------------
Choose the m axes I along which the face runs, and let J be the k others. A simplex meets the flat
{x_J = j} where its projection on the axes J contains j. The mesh's own vertices may stand on the
flat, so it is displaced by an infinitesimal (e, e^2, ..) across, always into the volume (simulation
of simplicity [1]): a vertex or a shared facet is never hit, one of the simplices at it is. Two
simplices that share a facet decide with the same product, so no rounding can lose a crossing or
count it twice. The sign of the point is that of the projection's orientation, times that of the
permutation (I, J) of the axes; where the mesh follows det(-g_1, .., -g_m, t_1, .., t_k) > 0, it is
(-1)^m times the sign of the Jacobian of the m values along I. (Write the rows g and t in the order
of axes I, J. As g.t = 0, the determinant is det g_I det t_J times a positive number.)

What is left undecided are samples excused because of their values: tied ones, and for a lattice of
its own those within its reach of other samples on the other side. For m = 1 the steps before and
after such a sample are added up and judged as one; for m > 1 the faces at it are left out.

References
----------
[1] H. Edelsbrunner and E. P. Muecke, Simulation of simplicity, ACM Trans. Graphics 9, 1990.
[2] J. Milnor, Topology from the differentiable viewpoint, 1965, sections 5 and 6: degree.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations, permutations
from math import prod
from typing import Any

import numpy as np
from isoref.field import Array, Booleans, Floats, Integers

from isograde.oracles.complexes import parity
from isograde.oracles.lattice import Lattice, components

# A surface meets a flat a few times; give up on a mesh that does so very often.
MOST = 200
# Relative size of a product of two rounded differences below which its sign is taken exactly.
Exact = Callable[[int], list[list[Fraction]]]
ROUNDING = 8 * float(np.finfo(np.float64).eps)


class TooWideError(ValueError):
    """The simplices are so wide that no level set of the field is like that."""


@dataclass(frozen=True, eq=False)
class Meetings:
    """Judged faces of the lattice where mesh and samples could disagree.

    Attributes
    ----------
    axes : (r, m) the axes along which each face runs
    corner : (r, n) its lowest sample
    found : (r,) the mesh's signed meetings
    wanted : (r,) (-1)^m times the degree on its boundary; for m = 1, (inside at the start) less
        (inside at the end)
    """

    axes: Integers
    corner: Integers
    found: Integers
    wanted: Integers

    def wrong(self, *, signed: bool = True) -> Booleans:
        """(r,) faces that the mesh does not meet as the samples say."""
        if signed:
            return np.asarray(self.found != self.wanted)
        return np.asarray(np.abs(self.found) != np.abs(self.wanted))

    @property
    def reversed(self) -> Booleans:
        """(r,) faces that it meets as often as it should, the wrong way round."""
        return np.asarray((self.found == -self.wanted) & (self.wanted != 0))


def meetings(lattice: Lattice, places: Floats, simplices: Integers) -> Meetings:
    """Every judged face that the mesh meets or should meet.

    Parameters
    ----------
    lattice : samples and sides
    places : (V, n) vertices in index coordinates
    simplices : (S, k + 1) with k = n - m

    Raises
    ------
    TooWideError
        for simplices that lie across far more flats than those of a level set
    """
    n, m = lattice.n, len(lattice.isovalues)
    out = excused_samples(lattice) | ~_within_domain(lattice)
    tops = np.floor(lattice.last + 1).astype(np.int64).tolist()
    sizes = tuple(map(min, lattice.shape, tops))
    wraps = [end.end == "periodic" for end in lattice.ends]
    spans = [_span(*one, simplices) for one in zip(places.T, sizes, wraps, strict=True)]
    parts = [
        _along(lattice, places, simplices, axes, out, sizes, spans)
        for axes in combinations(range(n), m)
    ]
    return Meetings(
        np.concatenate(
            [
                np.broadcast_to(axes, (len(part[1]), m))
                for axes, part in zip(combinations(range(n), m), parts, strict=True)
            ]
        ),
        np.concatenate([part[0] for part in parts]),
        np.concatenate([part[1] for part in parts]),
        np.concatenate([part[2] for part in parts]),
    )


def excused_samples(lattice: Lattice) -> Booleans:
    """(N1, .., Nn) samples whose side need not be told: tied, or within an own lattice's reach."""
    excused = lattice.tied.copy()
    if lattice.declared.vertices == "own":
        steps = int(np.ceil(lattice.declared.reach))
        for side in lattice.sides:
            # Beyond a closed end there is nothing inside.
            wide = side
            for axis, end in enumerate(lattice.ends):
                rim = [(steps * (a == axis),) * 2 for a in range(lattice.n)]
                mode = {"closed": "constant", "periodic": "wrap"}.get(end.end, "edge")
                wide = np.pad(wide, rim, mode=mode)  # type: ignore[call-overload]
            near = _spread_out(wide, steps) & _spread_out(~wide, steps)
            excused |= near[tuple(slice(steps, size + steps) for size in side.shape)]
    return excused


def _spread_out(marked: Booleans, steps: int) -> Booleans:
    """Samples within so many steps along each axis of a marked one."""
    wide = marked.copy()
    for axis in range(marked.ndim):
        for _ in range(steps):
            low, high = [slice(None)] * marked.ndim, [slice(None)] * marked.ndim
            low[axis], high[axis] = slice(None, -1), slice(1, None)
            grown = wide.copy()
            grown[tuple(low)] |= wide[tuple(high)]
            grown[tuple(high)] |= wide[tuple(low)]
            wide = grown
    return wide


def _along(
    lattice: Lattice,
    places: Floats,
    simplices: Integers,
    axes: tuple[int, ...],
    out: Booleans,
    sizes: tuple[int, ...],
    spans: Sequence[Span],
) -> tuple[Integers, Integers, Integers]:
    """Corners, meetings found and wanted of the faces along these axes.

    Parameters
    ----------
    out : (N1, .., Nn) samples whose side need not be told
    sizes, spans : along each axis the samples within the domain's ends, and what `_span` says
    """
    n, m = lattice.n, len(axes)
    others = tuple(a for a in range(n) if a not in axes)
    turned = (*axes, *others)
    shape = tuple(lattice.shape[a] for a in turned)
    periodic = [lattice.ends[a].end == "periodic" for a in turned]
    sign = _parity_of(turned)

    # Find the points in which the mesh meets the flats of the domain.
    within_ends = tuple(sizes[a] for a in turned)
    met = _candidates([spans[a] for a in others], within_ends[m:], len(simplices))
    where, flat, turn = _met(places[:, turned], simplices, within_ends, m, periodic[m:], met)
    face = np.ceil(where).astype(np.int64) - 1
    for a in range(m):
        if periodic[a]:
            face[:, a] %= shape[a]
        else:
            # What lies in the plane of the last samples, such as a cap, is beyond them.
            face[where[:, a] == shape[a] - 1, a] = shape[a] - 1
    steps = [n - 1 + p for n, p in zip(shape[:m], periodic, strict=False)]
    within = ((face >= 0) & (face < steps)).all(axis=1)
    corner = np.concatenate([face, flat], axis=1)[within]
    seen = np.ravel_multi_index(tuple(corner.T), shape)

    # Lay them beside what the samples say.
    sides = lattice.sides.transpose(0, *(1 + a for a in turned))
    if m == 1:
        key, wanted = _changes(sides[0], periodic[0])
    else:
        values = [component.transpose(turned) for component in components(lattice.field)]
        key, wanted = _degrees(values, lattice.isovalues, sides, m, periodic)
    listed = np.zeros(out.size, bool)
    listed[seen] = listed[key] = True
    every = np.flatnonzero(listed)
    found, due = np.zeros((2, len(every)), np.int64)
    np.add.at(found, every.searchsorted(seen), sign * turn[within])
    due[every.searchsorted(key)] = wanted

    # Leave out, or bridge, what need not be told.
    out = out.transpose(turned)
    if m == 1:
        every, found, due = _bridged(every, found, due, out, shape, periodic[0])
    else:
        corner = np.stack(np.unravel_index(every, shape), 1)
        keep = ~_any_corner(out, corner, m)
        every, found, due = every[keep], found[keep], due[keep]
    start = np.stack(np.unravel_index(every, shape), 1)
    return start[:, np.argsort(turned)], found, due


@cache
def _parity_of(turned: tuple[int, ...]) -> int:
    """The parity of one permutation."""
    return int(parity(np.array([turned]))[0])


def _within_domain(lattice: Lattice) -> Booleans:
    """Samples that are in the domain."""
    inside = np.ones(lattice.shape, bool)
    for axis, size in enumerate(lattice.shape):
        index = np.arange(size)
        along = (index >= lattice.first[axis]) & (index <= lattice.last[axis])
        view = [1] * lattice.n
        view[axis] = -1
        inside &= along.reshape(view)
    return inside


# --- what the samples say ------------------------------------------------------------------------


def _changes(inside: Booleans, periodic: bool) -> tuple[Integers, Integers]:
    """Steps along the first axis whose ends differ, and (inside at the start) - (.. at the end)."""
    after = np.roll(inside, -1, axis=0)
    differs = inside != after
    if not periodic:
        differs[-1] = False
    key = np.flatnonzero(differs)
    return key, 2 * inside.reshape(-1)[key].astype(np.int64) - 1


def _degrees(
    values: Sequence[Array],
    isovalues: Sequence[float],
    sides: Booleans,
    m: int,
    periodic: Sequence[bool],
) -> tuple[Integers, Integers]:
    """Faces along the first m axes on which every component has both sides; (-1)^m their degree."""
    shape = sides.shape[1:]
    corners = list(np.ndindex((2,) * m))
    both = np.ones(shape, bool)
    for side in sides:
        some, every = np.zeros(shape, bool), np.ones(shape, bool)
        for offset in corners:
            moved = np.roll(side, tuple(-o for o in offset), axis=tuple(range(m)))
            some |= moved
            every &= moved
        both &= some & ~every
    for axis in range(m):
        if not periodic[axis]:
            both[(slice(None),) * axis + (-1,)] = False
    key = np.flatnonzero(both)
    place = np.stack(np.unravel_index(key, shape), 1)
    table = np.empty((len(key), 2**m, m), object if m > 2 else np.float64)
    for c, offset in enumerate(corners):
        at = place.copy()
        at[:, :m] = (at[:, :m] + offset) % shape[:m]
        for i, (component, level) in enumerate(zip(values, isovalues, strict=True)):
            table[:, c, i] = np.asarray(component[tuple(at.T)], np.float64) - level
    if m == 2:
        exact = _exact_corners(values, isovalues, place, shape)
        return key, winding(table[:, [0, 2, 3, 1]], exact)
    return key, (-1) ** m * np.array([_simplex_degree(one, m) for one in table], np.int64)


def _exact_corners(
    values: Sequence[Array], isovalues: Sequence[float], place: Integers, shape: tuple[int, ...]
) -> Exact:
    """What takes the values of a square exactly, corner by corner round it."""

    def exact(row: int) -> list[list[Fraction]]:
        rows = []
        for offset in ((0, 0), (1, 0), (1, 1), (0, 1)):
            at = place[row].copy()
            at[:2] = (at[:2] + offset) % shape[:2]
            rows.append(
                [
                    Fraction(component[tuple(at)].item()) - Fraction(level)
                    for component, level in zip(values, isovalues, strict=True)
                ]
            )
        return rows

    return exact


def winding(corners: Floats, exact: Exact | None = None) -> Integers:
    """(r,) how often a closed chain of pairs winds round zero, counterclockwise.

    Parameters
    ----------
    corners : (r, c, 2) pairs of values, joined by straight segments, the last to the first
    exact : the corners of a row as fractions, for signs that rounding leaves open

    >>> square = np.array([[[1.0, 1], [-1, 1], [-1, -1], [1, -1]]])
    >>> winding(square), winding(square[:, ::-1])
    (array([1]), array([-1]))
    """
    ahead = np.roll(corners, -1, axis=1)
    f, g, f2, g2 = corners[..., 0], corners[..., 1], ahead[..., 0], ahead[..., 1]
    one, two = f * g2, f2 * g
    side = one - two
    unsure = np.abs(side) <= ROUNDING * (np.abs(one) + np.abs(two))
    upwards, downwards = (g < 0) & (g2 >= 0), (g >= 0) & (g2 < 0)
    sign = np.sign(side)
    if exact is not None:
        for row in np.flatnonzero((unsure & (upwards | downwards)).any(axis=1)):
            corner = exact(int(row))
            for c, (a, b) in enumerate(zip(corner, corner[1:] + corner[:1], strict=True)):
                cross = a[0] * b[1] - b[0] * a[1]
                sign[row, c] = (cross > 0) - (cross < 0)
    turns = (upwards & (sign > 0)).sum(axis=1) - (downwards & (sign < 0)).sum(axis=1)
    return np.asarray(turns, np.int64)


def _simplex_degree(corners: Array, m: int) -> int:
    """The degree of a face whose map is linear on each simplex of Kuhn's split."""
    total = 0
    for order in permutations(range(m)):
        corner, rows = 0, [corners[0]]
        for axis in order:
            corner += 1 << (m - 1 - axis)
            rows.append(corners[corner])
        total += int(parity(np.array([order]))[0]) * _holds_zero(rows)
    return total


def _holds_zero(rows: Sequence[Array]) -> int:
    """+1 or -1, its orientation, where the simplex of these m + 1 points holds zero; else 0."""
    points = [[Fraction(x) for x in row] for row in rows]
    whole = _sign([[a - b for a, b in zip(p, points[0], strict=True)] for p in points[1:]])
    for left_out in range(len(points)):
        facet = [p for i, p in enumerate(points) if i != left_out]
        if (-1) ** left_out * _sign(facet) != whole:
            return 0
    return whole


def _sign(rows: list[list[Fraction]]) -> int:
    """The sign of a determinant, by exact elimination."""
    rows, sign = [list(row) for row in rows], 1
    for i in range(len(rows)):
        pivot = next((r for r in range(i, len(rows)) if rows[r][i]), None)
        if pivot is None:
            return 0
        if pivot != i:
            rows[i], rows[pivot], sign = rows[pivot], rows[i], -sign
        for r in range(i + 1, len(rows)):
            share = rows[r][i] / rows[i][i]
            rows[r] = [a - share * b for a, b in zip(rows[r], rows[i], strict=True)]
        sign *= 1 if rows[i][i] > 0 else -1
    return sign


# --- what the mesh does --------------------------------------------------------------------------


def crossings(
    places: Floats,
    simplices: Integers,
    shape: tuple[int, ...],
    m: int = 1,
    periodic: Sequence[bool] = (),
) -> tuple[Floats, Integers, Integers]:
    """Where the simplices meet the displaced flats along the first m axes.

    Parameters
    ----------
    places : (V, n) vertices, the m axes of the flats first
    simplices : (S, k + 1)
    shape : number of samples along each axis
    periodic : whether each of the last k axes is

    Returns
    -------
    where : (r, m) coordinates along the flat
    flat : (r, k) the flat's other index coordinates
    sign : (r,) the orientation of the simplex across the flat
    """
    k = places.shape[1] - m
    wraps = list(periodic) or [False] * k
    axes = zip(places.T[m:], shape[m:], wraps, strict=True)
    met = _candidates([_span(*one, simplices) for one in axes], shape[m:], len(simplices))
    return _met(places, simplices, shape, m, wraps, met)


def _met(
    places: Floats,
    simplices: Integers,
    shape: tuple[int, ...],
    m: int,
    wraps: Sequence[bool],
    met: tuple[Integers, Integers],
) -> tuple[Floats, Integers, Integers]:
    """`crossings` among these simplices and flats, of `_candidates`."""
    k = places.shape[1] - m
    which, flat = met
    if not k:
        return (
            places[simplices[:, 0]],
            np.empty((len(simplices), 0), np.int64),
            np.ones(len(simplices), np.int64),
        )
    rows = simplices[which]
    corners = places[rows]
    # On a last plane the flat is displaced downwards: mirror it, and downwards is upwards.
    last = (flat == np.subtract(shape[m:], 1)) & ~np.array(wraps)
    mirror = np.where(last, -1, 1)
    across = (corners[:, :, m:] - flat[:, None]) * mirror[:, None]
    if k == 2:
        turns, weights = _in_triangles(across)
    else:
        turns, weights = _in_simplices(across, rows)
    hit = np.flatnonzero(turns)
    along, weights = corners[hit, :, :m], weights[hit]
    where = (along * weights[..., None]).sum(axis=1) / weights.sum(axis=1)[:, None]
    where = np.minimum(np.maximum(where, along.min(axis=1)), along.max(axis=1))
    return where, flat[hit], turns[hit] * mirror[hit].prod(axis=1)


def _in_triangles(across: Floats) -> tuple[Integers, Floats]:
    """How often each triangle turns round the displaced zero, and weights of its corners.

    The zero is displaced by (e, e * e); a side that crosses the axis above it is decided by one
    product, which the triangle beyond that side takes with the same numbers.
    """
    py, pz = across[..., 0], across[..., 1]
    qy, qz = py[:, [1, 2, 0]], pz[:, [1, 2, 0]]
    side = py * qz - pz * qy
    turns = ((pz <= 0) & (qz > 0) & (side > 0)).sum(1) - ((pz > 0) & (qz <= 0) & (side < 0)).sum(1)
    return turns, side[:, [1, 2, 0]]


def _in_simplices(across: Floats, rows: Integers) -> tuple[Integers, Floats]:
    """The orientation of each simplex that holds the displaced zero, else 0; corners' weights.

    The zero's place beside a facet is the sign of a determinant. It is expanded in powers of the
    displacement, its first coefficient that is not zero decides, and the facet's vertices are
    taken in the order of their names, so that both simplices at a facet compute the same numbers.
    """
    count, k = across.shape[1], across.shape[2]
    signs, weights = np.zeros((len(rows), count), np.int64), np.zeros((len(rows), count))
    for left_out in range(count):
        keep = [i for i in range(count) if i != left_out]
        order = np.argsort(rows[:, keep], axis=1)
        turned = parity(rows[:, keep]) * (-1) ** left_out
        facet = np.take_along_axis(across[:, keep], order[..., None], axis=1)
        sign, size = _determinant_signs(facet)
        for axis in range(k):
            open_rows = np.flatnonzero(sign == 0)
            if not len(open_rows):
                break
            sign[open_rows] = _derivative_signs(facet[open_rows], axis)
        signs[:, left_out] = turned * sign
        weights[:, left_out] = turned * size
    inside = (signs == signs[:, :1]).all(axis=1)
    return np.where(inside, signs[:, 0], 0), weights


def _determinant_signs(rows: Floats) -> tuple[Integers, Floats]:
    """The exact signs of the determinants of (r, k, k) numbers, and their rounded values."""
    value = np.linalg.det(rows)
    k = rows.shape[1]
    bound = 4 * k**2 * np.finfo(np.float64).eps * np.linalg.norm(rows, axis=2).prod(axis=1)
    sign = np.sign(value).astype(np.int64)
    # A row of zeros is a vertex on the flat: most determinants are exactly zero by it.
    empty = np.asarray(~rows.any(axis=2)).any(axis=1)
    sign[empty] = 0
    unsure = np.flatnonzero(~empty & (np.abs(value) <= bound))
    if len(unsure):
        exact = _determinants(_whole_numbers(rows[unsure]))
        sign[unsure] = np.asarray(exact > 0, np.int64) - np.asarray(exact < 0, np.int64)
    return sign, np.where(empty, 0.0, value)


def _whole_numbers(rows: Floats) -> Array:
    """The numbers times one power of two, as Python's integers."""
    mantissa, exponent = np.frexp(rows)
    least = int(exponent[rows != 0].min(initial=0))
    whole = (mantissa * 2.0**53).astype(np.int64).astype(object)
    return np.asarray(whole << np.maximum(exponent - least, 0).astype(object))


def _determinants(rows: Array) -> Array:
    """The determinants of (r, k, k) integers, by minors of the first rows, each computed once."""
    k = rows.shape[1]
    minors: dict[tuple[int, ...], Any] = {(): np.ones(len(rows), object)}
    for size in range(1, k + 1):
        minors = {
            columns: sum(
                (-1) ** (size - 1 - i)
                * rows[:, size - 1, c]
                * minors[columns[:i] + columns[i + 1 :]]
                for i, c in enumerate(columns)
            )
            for columns in combinations(range(k), size)
        }
    return np.asarray(minors[tuple(range(k))])


def _derivative_signs(facet: Floats, axis: int) -> Integers:
    """The signs of the derivative of det(p_1 - z, .., p_k - z) as z moves along an axis from zero.

    It is the determinant with a column of ones, k of them, in the place of that axis, negated.
    """
    moved = facet.copy()
    moved[:, :, axis] = 1.0
    return -_determinant_signs(moved)[0]


Span = tuple[Integers, Integers]
"""Of each simplex the first of the displaced samples along an axis that it spans, and how many."""


def _span(along: Floats, size: int, wraps: bool, simplices: Integers) -> Span:
    """What each simplex spans along an axis, from its vertices' places (V,) along it.

    A flat at j + e is within [low, high] exactly when low <= j < high, one at j - e when
    low < j <= high.
    """
    at = np.ceil(along).astype(np.int64)[simplices]
    low = np.maximum(at.min(axis=1), 0)
    high = np.minimum(at.max(axis=1), size - (0 if wraps else 1))
    if not wraps:
        # A simplex that reaches the last plane also meets the flat there, unless it lies in it.
        top = size - 1
        reaches = np.flatnonzero(high == top)
        levels = along[simplices[reaches]]
        reaches = reaches[(levels.max(1) >= top) & (levels.min(1) < top)]
        high[reaches] += 1
    return low, np.maximum(high - low, 0)


def _candidates(
    spans: Sequence[Span], shape: tuple[int, ...], simplices: int
) -> tuple[Integers, Integers]:
    """Simplices and flats whose projections' boxes meet: (r,) simplices and (r, k) flats.

    Parameters
    ----------
    spans, shape : along each axis of the flats' index, as in `_span`, and the number of samples
    simplices : how many there are
    """
    if not spans:
        return np.arange(simplices), np.empty((simplices, 0), np.int64)
    total = np.prod(np.array([count for _, count in spans], np.float64), axis=0)
    met = np.flatnonzero(total > 0)
    flats = prod(map(float, shape))
    if float(total.sum()) > MOST * (simplices + flats):
        raise TooWideError(f"{simplices} simplices lie across {total.sum():.0f} lines of samples")
    return _spread(met, [low[met] for low, _ in spans], [count[met] for _, count in spans])


def _spread(
    which: Integers, first: list[Integers], count: list[Integers]
) -> tuple[Integers, Integers]:
    """Each simplex once for each of its flats from `first` on."""
    total = np.prod(np.array(count), axis=0)
    if (total == 1).all():
        return which, np.stack(first, axis=1)
    repeated = np.repeat(np.arange(len(which)), total)
    rank = np.arange(len(repeated)) - np.repeat(np.cumsum(total) - total, total)
    flats = []
    for low, width in zip(reversed(first), reversed(count), strict=True):
        rank, along = np.divmod(rank, width[repeated])
        flats.append(low[repeated] + along)
    return which[repeated], np.stack(flats[::-1], axis=1)


def _any_corner(marked: Booleans, corner: Integers, m: int) -> Booleans:
    """(r,) some corner of the face, whose lowest is given, is marked."""
    found = np.zeros(len(corner), bool)
    for offset in np.ndindex((2,) * m):
        at = corner.copy()
        at[:, :m] = (at[:, :m] + offset) % marked.shape[:m]
        found |= marked[tuple(at.T)]
    return found


def _bridged(
    key: Integers,
    found: Integers,
    wanted: Integers,
    excused: Booleans,
    shape: tuple[int, ...],
    periodic: bool,
) -> tuple[Integers, Integers, Integers]:
    """The steps with those that meet at an excused sample added up, end to end.

    A run of steps that starts or ends on the border at an excused sample says nothing and is
    dropped; on a periodic axis so is the step that closes the period, where an end is excused.
    """
    if not excused.any():
        return key, found, wanted
    lines = int(np.prod(shape[1:]))
    flat = excused.reshape(-1)
    closing = key >= flat.size - lines
    ends = flat[key] | flat[(key + lines) % flat.size]
    keep = ~(closing & ends) if periodic else ~closing
    key, found, wanted = key[keep], found[keep], wanted[keep]
    # Take up the empty steps next to excused samples, so that runs are complete.
    sample = np.flatnonzero(excused)
    beside = np.concatenate([sample[sample >= lines] - lines, sample[sample < flat.size - lines]])
    every = np.union1d(key, beside)
    place = np.searchsorted(every, key)
    both = np.zeros((2, len(every)), np.int64)
    both[0, place], both[1, place] = found, wanted
    # Order by line, then along it; a step continues the run before it when its start is excused.
    order = np.lexsort((every // lines, every % lines))
    start = every[order]
    head = ~flat[start]
    head[:1] = True
    loose = flat[start] & (start < lines)
    run = np.cumsum(head | loose) - 1
    sums = np.zeros((2, run[-1] + 1 if len(run) else 0), np.int64)
    for total, part in zip(sums, both, strict=True):
        np.add.at(total, run, part[order])
    first = np.flatnonzero(head | loose)
    last = np.append(first[1:], len(start)) - 1
    ends_excused = flat[(start[last] + lines) % flat.size] if len(last) else np.zeros(0, bool)
    keep = ~(flat[start[first]] | ends_excused)
    return start[first][keep], sums[0][keep], sums[1][keep]
