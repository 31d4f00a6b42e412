"""The truth about a cell: the topology of the trilinear level set.

Idea
----
Between its eight samples a cell holds the trilinear interpolant F. Sweep the cell with the plane
x0 = t. In the plane, F is bilinear, and its four corner values are linear in t; so the slice
changes its topology only where a line of the cell crosses zero, or where the saddle of the slice
does, which is a root of the quadratic q(t) = w0 w3 - w1 w2. Between such events high and low
parts of the slices are products, and along any axis-parallel line F is monotone, so each part of a
slice holds a corner of that slice and has no holes. The high region is therefore, up to homotopy,
a graph: one node for each part of each open interval, one edge for each part of each event slice.

    high components = components of the graph
    Euler(high)     = parts of intervals - parts of inner event slices

The same holds for the low region, and the level set S between the two has

    components(S) = components(high) + components(low) - 1
    Euler(S)      = Euler(high) + Euler(low) - 1

because the cell is simply connected: every sheet of S separates it, and sheets are the edges of a
tree whose nodes are the high and low components. A sheet is thus named by one component on each
side of it, and a closed boundary curve by one component on each side on the cell's skin.

Everything is decided by signs of polynomials in the samples. No root is ever computed: what is
asked of q on an interval is read off its Bernstein coefficients there. Each sign is tried in
floating point with a running error bound, and cells with an undecided sign are read again in
integers.

Ties
----
No single truth exists where a corner, the saddle of an ambiguous face, or a saddle inside the
cell lies exactly on the isovalue. Such cells are reported (`CORNER`, `FACE`, `BODY`). Events that
merely coincide are no ties: the level set is smooth there, and the answer is the same on all axes.

Where the corners' distances from the isovalue are no doubles, as 0.4 - 0.05 is none, a program that
is exact on rounded distances and one that is exact on the samples may differ in a cell with an
undecided sign, and both are right. Such a cell is reported too (`CLOSE`).

Glossary
--------
corner          C-order index 4 i0 + 2 i1 + i2 of the sample at (i0, i1, i2) of the cell
face            2 * axis + side
line            one of the four cell edges along axis 0, by 2 i1 + i2
f, g            values at the start and at the end of a line
w0 .. w3        values of the four lines in a slice; 0 and 3 are diagonal, so are 1 and 2
rim, body       for each corner, the name of its component on the cell's skin and in the cell
sheet, curve    component of the level set, and of its boundary on the cell's skin

References
----------
1. G. M. Nielson, B. Hamann: The asymptotic decider. Visualization '91 (the faces).
2. E. V. Chernyaev: Marching Cubes 33. CERN CN 95-17, 1995 (tunnels inside cells).
3. A. Lopes, K. Brodlie: Improving the robustness and accuracy of the marching cubes algorithm for
   isosurfacing. IEEE TVCG 9(1), 2003 (body saddles).
4. T. Etiene and others: Topology verification for isosurface extraction. IEEE TVCG 18(6), 2012.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cmp_to_key
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isograde.oracles.bounded import Bounded, Ints, Numbers, integers, rounded
from isograde.oracles.rows import distinct

NONE, CORNER, FACE, BODY, CLOSE = 0, 1, 2, 3, 4
TIES = (
    "none",
    "a corner on the isovalue",
    "a face saddle on it",
    "a body saddle on it",
    "a saddle nearer to it than the corners' distances are rounded",
)

EDGES = tuple((a, b) for a, b in combinations(range(8), 2) if (a ^ b) in (1, 2, 4))
"""The twelve cell edges as pairs of corners, lower index first."""

FACES = tuple(
    tuple(side << (2 - axis) | u << (2 - b) | v << (2 - c) for u in (0, 1) for v in (0, 1))
    for axis, (b, c) in enumerate(((1, 2), (0, 2), (0, 1)))
    for side in (0, 1)
)
"""The four corners of each face; the first and the last are diagonal."""


# --- what the numbers say -----------------------------------------------------------------------

PAIRS = tuple(combinations(range(4), 2))
SEQUENCES: tuple[tuple[int, ...], ...] = (
    (),
    (1,),
    (-1,),
    (1, -1),
    (-1, 1),
    (1, -1, 1),
    (-1, 1, -1),
)
"""What q can do on an interval in which the slices are ambiguous: its signs in order."""


@dataclass(frozen=True)
class _Reading:
    """All that topology needs of n cells, as small integers, with the cells still undecided.

    rows : (n, 22) signs of 8 corners, order of 6 pairs of lines, sequences of q while lines
        0 and 3 (then 1 and 2) are the high ones, joined high corners on 6 faces
    """

    rows: Ints
    ties: Ints
    unsure: NDArray[np.bool_]


def _read(corners: Bounded) -> _Reading:
    """The reading of (n, 8) relative corner values."""
    signs, unsure = corners.sign(), corners.unsure().any(axis=1)
    ties = np.where((signs == 0).any(axis=1), CORNER, NONE)
    faces, tied, open_faces = _faces(corners, signs)
    ties = np.where((ties == NONE) & tied, FACE, ties)
    f, g = corners[:, :4], corners[:, 4:]
    order, open_order = _order(f, g, signs)
    unsure |= open_faces | open_order
    sequences = []
    for high in ((0, 3), (1, 2)):
        sequence, tied, open_q = _saddles(f, g, signs, order, high)
        unsure |= open_q
        ties = np.where((ties == NONE) & tied, BODY, ties)
        sequences.append(sequence)
    rows = np.column_stack([signs, *(order[a, b] for a, b in PAIRS), *sequences, faces])
    return _Reading(rows, ties, unsure)


def _faces(corners: Bounded, signs: Ints) -> tuple[Ints, NDArray[np.bool_], NDArray[np.bool_]]:
    """(n, 6) the joined high corners on each face; where a saddle is tied; where unsure."""
    a, b, c, d = np.array(FACES).T
    ambiguous = (signs[:, d] == signs[:, a]) & (signs[:, b] == signs[:, c])
    ambiguous &= signs[:, a] * signs[:, b] == -1
    saddle = corners[:, a] * corners[:, d] - corners[:, b] * corners[:, c]
    sign = saddle.sign()
    tied, unsure = ambiguous & (sign == 0), ambiguous & saddle.unsure()
    return ambiguous * sign * signs[:, a], tied.any(axis=1), unsure.any(axis=1)


def _order(f: Bounded, g: Bounded, signs: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """order[a, b]: -1 where line a crosses zero before line b, 1 after, 0 together or not at all.

    A line crosses at t = |f| / (|f| + |g|), so that a is first where |f_a| |g_b| < |f_b| |g_a|.
    """
    crosses = signs[:, :4] * signs[:, 4:] < 0
    a, b = np.array(PAIRS).T
    both = crosses[:, a] & crosses[:, b]
    f, g = (Bounded(abs(x.value), x.error) for x in (f, g))
    gap = f[:, a] * g[:, b] - f[:, b] * g[:, a]
    order = np.zeros((4, 4, len(signs)), np.int64)
    order[a, b] = (both * gap.sign()).T
    order[b, a] = -order[a, b]
    return order, np.asarray((both & gap.unsure()).any(axis=1))


def _saddles(
    f: Bounded, g: Bounded, signs: Ints, order: Ints, high: tuple[int, int]
) -> tuple[Ints, NDArray[np.bool_], NDArray[np.bool_]]:
    """What q does while exactly the lines of `high` are high; where it is tied; where unsure.

    Most cells have a line that is never as wanted, and q does nothing.
    """
    wanted = np.array([1 if line in high else -1 for line in range(4)])
    early, late = signs[:, :4] == wanted, signs[:, 4:] == wanted
    sequence = np.zeros(len(signs), np.int64)
    tied, unsure = np.zeros((2, len(signs)), bool)
    rows = np.flatnonzero((early | late).all(axis=1))
    if len(rows):
        sequence[rows], tied[rows], unsure[rows] = _saddles_while(
            f[rows], g[rows], order[:, :, rows], early[rows], late[rows]
        )
    return sequence, tied, unsure


def _saddles_while(
    f: Bounded, g: Bounded, order: Ints, early: NDArray[np.bool_], late: NDArray[np.bool_]
) -> tuple[Ints, NDArray[np.bool_], NDArray[np.bool_]]:
    """The same, where each line is as wanted at t = 0 (early) or at t = 1 (late).

    It is so on one interval that touches that end, and all four are on one interval: from the last
    of the lines that become so to the first that cease to be.
    """
    rows = np.arange(len(early))
    begin, end = np.full((2, len(early)), -1)
    for line in range(4):
        begins, ends = ~early[:, line] & late[:, line], early[:, line] & ~late[:, line]
        later = (begin < 0) | (order[line, begin, rows] > 0)
        sooner = (end < 0) | (order[line, end, rows] < 0)
        begin, end = np.where(begins & later, line, begin), np.where(ends & sooner, line, end)
    ordered = (begin < 0) | (end < 0) | (order[begin, end, rows] < 0)
    return _signs_of_q(_slice_values(f, g, begin, f), _slice_values(f, g, end, g), ordered)


def _slice_values(f: Bounded, g: Bounded, root: Ints, default: Bounded) -> Bounded:
    """(n, 4) values of the lines where the line `root` is zero, times a positive number.

    Where `root` is -1, they are `default`. F on a line at that t is
    (f_l g_r - g_l f_r) / (g_r - f_r).
    """
    rows = np.arange(len(root))
    fr, gr = f[rows, root], g[rows, root]
    value = f * gr[:, None] - g * fr[:, None]
    flip = np.where(gr.value > fr.value, 1, -1)
    at_root = (root >= 0)[:, None]
    return Bounded(
        np.where(at_root, value.value * flip[:, None], default.value),
        np.where(at_root, value.error, default.error),
    )


def _signs_of_q(
    p: Bounded, r: Bounded, there: NDArray[np.bool_]
) -> tuple[Ints, NDArray[np.bool_], NDArray[np.bool_]]:
    """Index into `SEQUENCES` for q between slices p and r; where tied; where unsure.

    With Bernstein coefficients b0, b1 / 2, b2 there are two roots inside iff b0 and b2 have one
    sign, b1 the other, and b1^2 > 4 b0 b2; a double root is a body saddle on the isovalue.
    """
    one, other = p[:, :2], p[:, [3, 2]]
    ahead, beside = r[:, :2], r[:, [3, 2]]
    b0, b2 = (_difference(products) for products in (one * other, ahead * beside))
    b1 = _difference(one * beside + ahead * other)
    product = b0 * b2
    twice = b1 * b1 - (product + product) - (product + product)
    s0, s1, s2 = b0.sign(), b1.sign(), b2.sign()
    first = np.where(s0 != 0, s0, np.where(s1 != 0, s1, s2))
    last = np.where(s2 != 0, s2, np.where(s1 != 0, s1, s0))
    dips = there & (first == last) & (s1 == -first)
    two = dips & (twice.sign() > 0)
    tied = there & ((first == 0) | (dips & (twice.sign() == 0)))
    one_root = np.where(first > 0, 1, 2)
    sequence = np.where(first != last, one_root + 2, np.where(two, one_root + 4, one_root))
    maybe = b1.unsure() | twice.unsure()
    unsure = there & (b0.unsure() | b2.unsure() | ((s0 == s2) & (s1 != s0) & maybe))
    return np.where(there, sequence, 0), tied, unsure


def _difference(products: Bounded) -> Bounded:
    """(n,) the first of each two, less the second."""
    return products[:, 0] - products[:, 1]


# --- what follows from it -----------------------------------------------------------------------


class _Names:
    """Union-find over hashable things."""

    def __init__(self) -> None:
        self.parent: dict[Any, Any] = {}

    def find(self, x: Any) -> Any:
        self.parent.setdefault(x, x)
        while self.parent[x] != x:
            x = self.parent[x]
        return x

    def join(self, x: Any, y: Any) -> None:
        a, b = sorted((self.find(x), self.find(y)))
        self.parent[b] = a


Slice = tuple[tuple[int, ...], int, bool]
"""Signs of the four lines, sign of q, whether the slice stands for an open interval."""


def _slices(row: tuple[int, ...]) -> list[Slice]:
    """The slices of a reading in order: intervals and, between them, events."""
    state, ends = list(row[:4]), row[4:8]
    order = dict(zip(PAIRS, row[8:14], strict=True))
    order |= {(b, a): -sign for (a, b), sign in order.items()}

    def by_time(a: int, b: int) -> int:
        return order.get((a, b), 0)

    crossing = [line for line in range(4) if state[line] != ends[line]]
    crossing.sort(key=cmp_to_key(by_time))
    slices = _interval(state, row[14:16])
    while crossing:
        now = [line for line in crossing if order.get((crossing[0], line), 0) == 0]
        crossing = crossing[len(now) :]
        event = [0 if line in now else state[line] for line in range(4)]
        slices.append((tuple(event), 0, False))
        state = [ends[line] if line in now else state[line] for line in range(4)]
        slices += _interval(state, row[14:16])
    return slices


def _interval(state: list[int], sequences: tuple[int, ...]) -> list[Slice]:
    """The slices of an open interval without crossings, split at the roots of q."""
    signs = tuple(state)
    if signs[0] != signs[3] or signs[1] != signs[2] or signs[0] == signs[1]:
        return [(signs, 0, True)]
    q = SEQUENCES[sequences[0 if signs[0] > 0 else 1]]
    slices: list[Slice] = [(signs, q[0], True)]
    for sign in q[1:]:
        slices += [(signs, 0, False), (signs, sign, True)]
    return slices


def _links(part: Slice) -> list[tuple[int, int]]:
    """Pairs of lines whose corners lie in one part of the slice."""
    signs, q, _ = part
    links = [(a, b) for a, b in ((0, 1), (0, 2), (1, 3), (2, 3)) if signs[a] == signs[b] != 0]
    for (a, b), (c, d), wanted in (((0, 3), (1, 2), 1), ((1, 2), (0, 3), -1)):
        if signs[a] == signs[b] != 0 and (signs[c] * signs[d] == 0 or q == wanted):
            links.append((a, b))
    return links


@cache
def topology(row: tuple[int, ...]) -> tuple[tuple[int, ...], tuple[int, ...], int]:
    """(rim, body, Euler characteristic of the level set) of a reading without ties."""
    slices, names, euler = _slices(row), _Names(), {1: 0, -1: 0}
    for s, part in enumerate(slices):
        signs, _, is_interval = part
        alone = _Names()
        for a, b in _links(part):
            alone.join(a, b)
            names.join((s, a), (s, b))
        for line in (line for line in range(4) if signs[line]):
            if alone.find(line) == line:
                euler[signs[line]] += 1 if is_interval else -1
            if s and slices[s - 1][0][line]:
                names.join((s - 1, line), (s, line))
    last = len(slices) - 1
    body = [names.find((0 if c < 4 else last, c % 4)) for c in range(8)]
    empty = len(set(row[:8])) == 1
    total = 0 if empty else euler[1] + euler[-1] - 1
    return rim_of(row[:8], row[16:]), tuple(body.index(name) for name in body), total


def rim_of(signs: tuple[int, ...], faces: tuple[int, ...]) -> tuple[int, ...]:
    """For each corner the first corner of its part of the cell's skin."""
    names = _Names()
    for a, b in EDGES:
        if signs[a] == signs[b]:
            names.join(a, b)
    for joined, (a, b, c, d) in zip(faces, FACES, strict=True):
        if joined:
            names.join(*((a, d) if signs[a] == joined else (b, c)))
    return tuple(names.find(corner) for corner in range(8))


@dataclass(frozen=True, eq=False)
class Truths:
    """The topology of the level set in each of n cells.

    Attributes
    ----------
    high : (n, 8) bool, the corner is above the isovalue
    faces : (n, 6) int, 1 where the high corners of an ambiguous face are joined on it, -1 where
        the low ones are, 0 where the face is not ambiguous
    rim, body : (n, 8) int, the least corner of the part of the skin, of the cell, this one is in
    euler : (n,) int, Euler characteristic of the level set
    ties : (n,) int, `NONE`, `CORNER`, `FACE`, `BODY` or `CLOSE`; nothing else holds where it is
        not `NONE`
    exact : (n,) bool, decided in integers
    """

    high: NDArray[np.bool_]
    faces: Ints
    rim: Ints
    body: Ints
    euler: Ints
    ties: Ints
    exact: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.euler)

    def __getitem__(self, where: Any) -> Truths:
        return Truths(*(getattr(self, name)[where] for name in self.__dataclass_fields__))

    @property
    def components(self) -> Ints:
        """(n,) number of sheets: components of the level set."""
        return _count_pairs(self.high, self.body)

    @property
    def curves(self) -> Ints:
        """(n,) number of closed curves in which the level set meets the cell's skin."""
        return _count_pairs(self.high, self.rim)

    @property
    def tunnels(self) -> Ints:
        """(n,) number of times curves share a sheet: curves less sheets."""
        return self.curves - self.components


def _count_pairs(high: NDArray[np.bool_], names: Ints) -> Ints:
    """Number of boundaries between parts: the parts form a tree, so one less than there are."""
    return np.asarray((names == np.arange(8)).sum(axis=1) - 1)


def cells(values: ArrayLike, isovalue: float = 0.0) -> Truths:
    """The truth about each cell of an (n, 2, 2, 2) array.

    Integers of any size, floats and Fractions (dtype object) are taken as they are, without
    rounding.

    >>> one = cells([[[[1, -1], [-1, -1]], [[-1, -1], [-1, 1]]]])
    >>> int(one.components[0]), int(one.euler[0])
    (2, 2)
    """
    return _cells(values, isovalue, skip_plain=True)


def _cells(values: ArrayLike, isovalue: float, *, skip_plain: bool) -> Truths:
    """`cells`; with `skip_plain` no arithmetic is spent where signs alone decide."""
    raw = np.asarray(values)
    raw = raw.reshape(-1, 8)
    reading, exact = _read_all(raw, isovalue, skip_plain)
    first, back = distinct(reading.rows)
    rows = reading.rows[first]
    answers = [topology(tuple(row)) if all(row[:8]) else None for row in rows.tolist()]
    rim, body, euler = (
        np.array([a[part] if a else blank for a in answers], np.int64)[back]
        if answers
        else np.zeros((0, 8) if part < 2 else 0, np.int64)
        for part, blank in ((0, (0,) * 8), (1, (0,) * 8), (2, 0))
    )
    high, faces = reading.rows[:, :8] > 0, reading.rows[:, 16:]
    return Truths(high, faces, rim, body, euler, reading.ties, exact)


def _read_all(
    raw: Numbers, isovalue: float, skip_plain: bool
) -> tuple[_Reading, NDArray[np.bool_]]:
    """The reading of every cell, in floats where they decide and in integers where not."""
    n = len(raw)
    rows, ties = np.zeros((n, 22), np.int64), np.zeros(n, np.int64)
    exact, close = np.ones(n, bool), np.zeros(n, bool)
    if raw.dtype.kind in "biuf" and raw.dtype.itemsize <= 8:
        relative = raw.astype(np.float64) - isovalue
        representable = (raw == raw.astype(np.float64)).all(axis=1)
        error = 2 * np.finfo(float).eps * abs(relative)
        rows[:, :8] = np.where(relative > 0, 1, -1)
        plain = (relative != 0).all(axis=1) & _plain(relative > 0) & skip_plain & representable
        rest = np.flatnonzero(~plain)
        with np.errstate(over="ignore", invalid="ignore"):
            reading = _read(Bounded(relative[rest], error[rest]))
        rows[rest], ties[rest] = reading.rows, reading.ties
        exact = ~plain
        exact[rest] = reading.unsure | ~representable[rest]
        near = rest[reading.unsure & representable[rest]]
        close[near] = rounded(raw[near], isovalue)
    again = np.flatnonzero(exact)
    if len(again):
        exact_values = integers(raw[again], isovalue)
        reading = _read(Bounded(exact_values, exact_values * 0))
        rows[again], ties[again] = reading.rows, reading.ties
    ties[close & (ties == NONE)] = CLOSE
    return _Reading(rows, ties, np.zeros(n, bool)), exact


def _plain(high: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether the signs alone decide: along edges both sides are connected."""
    codes = high @ (1 << np.arange(8))
    return _PLAIN[codes]


def _derive_plain() -> NDArray[np.bool_]:
    """For each of the 256 signs (bit c is corner c), whether edges connect each side."""
    plain = np.zeros(256, bool)
    for code in range(256):
        signs = tuple(1 if code >> c & 1 else -1 for c in range(8))
        plain[code] = len(set(rim_of(signs, (0,) * 6))) == len(set(signs))
    return plain


_PLAIN = _derive_plain()
