"""Table 1 of Nielson & Hamann for any volume: how often each configuration of a cell occurs.

A configuration is recognised here by distances: which corners are marked matters only up to
rotation, and the multiset of distances between marked corners (in steps along edges) tells the
classes apart, but for 11 and 14, which are mirror images and told apart by the turn of their path
of three edges. No rotation is taken and no table of the reference is used.

The text of the paper does not say which of the two turns it calls 11; neither do its numbers,
since both analytic examples have none of either. Here 11 is the one whose three steps, in the
order of the path, have a positive determinant in the order of the array's axes.

Glossary
--------
marked      an inside corner, or an outside one where more than four are inside
separated   an ambiguous face whose marked corners the bilinear interpolant does not connect
row         a line of Table 1: a configuration, with the letters of its variants. The table lumps
            variants whose boundary polygons have the same sides: "7B,D", "10A,C", ..

References
----------
[1] G. M. Nielson, B. Hamann, The asymptotic decider, IEEE Visualization 1991, section 4, Table 1.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache
from itertools import combinations, product

import numpy as np
from isoref.field import Array, Booleans, Field, FieldError, Integers, check_isovalue

from isograde.oracles.bilinear import saddle_sign

CORNERS = tuple(product((0, 1), repeat=3))
# Distances between the marked corners of each configuration, sorted.
CONFIGURATIONS = {
    (0, ""): "0", (1, ""): "1", (2, "1"): "2", (2, "2"): "3", (2, "3"): "4", (3, "112"): "5",
    (3, "123"): "6", (3, "222"): "7", (4, "111122"): "8", (4, "111222"): "9", (4, "112233"): "10",
    (4, "111223"): "11 or 14", (4, "112223"): "12", (4, "222222"): "13",
}  # fmt: skip
# The row of a configuration with ambiguous faces, by how many of them are separated.
VARIANTS = {
    "3": ("3B", "3A"),
    "6": ("6A", "6B"),
    "7": ("7B,D", "7C", "7B,D", "7A"),
    "10": ("10A,C", "10B,D", "10A,C"),
    "12": ("12A,C", "12B,D", "12A,C"),
    "13": ("13",) * 7,
}
ROWS = (
    "0", "1", "2", "3A", "3B", "4", "5", "6A", "6B", "7A", "7B,D", "7C", "8", "9",
    "10A,C", "10B,D", "11", "12A,C", "12B,D", "13", "14",
)  # fmt: skip
AMBIGUOUS_ROWS = frozenset(row for rows in VARIANTS.values() for row in rows)


def marked_corners(signs: int) -> list[tuple[int, ...]]:
    """The corners in the minority; the inside ones where there are four and four.

    Bit c of `signs` is set where ``CORNERS[c]`` is inside.
    """
    inside = [corner for bit, corner in enumerate(CORNERS) if signs >> bit & 1]
    return inside if len(inside) <= 4 else [c for c in CORNERS if c not in inside]


@cache
def configuration(signs: int) -> str:
    """The configuration "0" .. "14" of Figure 2 of [1].

    >>> configuration(0b10000001), configuration(0b01111110), configuration(0b10010110)
    ('4', '4', '13')
    """
    marked = marked_corners(signs)
    distances = sorted(distance(a, b) for a, b in combinations(marked, 2))
    name = CONFIGURATIONS[len(marked), "".join(map(str, distances))]
    return name if name != "11 or 14" else ("11" if turn(marked) > 0 else "14")


def distance(a: tuple[int, ...], b: tuple[int, ...]) -> int:
    """Steps along edges from corner to corner.

    >>> distance((0, 0, 0), (1, 0, 1))
    2
    """
    return sum(x != y for x, y in zip(a, b, strict=True))


def turn(path: list[tuple[int, ...]]) -> int:
    """The determinant of the three steps of a path of four corners, the same from either end."""
    start = next(c for c in path if sum(distance(c, other) == 1 for other in path) == 1)
    order = sorted(path, key=lambda c: distance(start, c))
    return round(float(np.linalg.det(np.diff(order, axis=0))))


@dataclass(frozen=True)
class Frequencies:
    """How many cells there are in each row of Table 1."""

    counts: dict[str, int]

    @property
    def cells(self) -> int:
        """All cells."""
        return sum(self.counts.values())

    @property
    def active(self) -> int:
        """Cells with corners on both sides."""
        return self.cells - self.counts["0"]

    @property
    def ambiguous(self) -> int:
        """Cells with an ambiguous face."""
        return sum(self.counts[row] for row in AMBIGUOUS_ROWS)

    def markdown(self) -> str:
        """Table 1 of this volume, with the share of ambiguous cells below.

        >>> field = Field.of([[[1, 0], [0, 0]], [[0, 0], [0, 1]]])
        >>> print(frequencies(field, 0.5).markdown().splitlines()[-1])
        0 of 1 active cells have an ambiguous face (0.000 %).
        """
        lines = ["| configuration | cells | share of active |", "| --- | ---: | ---: |"]
        for row, count in self.counts.items():
            share = "" if row == "0" else f"{percent(count, self.active):.3f} %"
            lines.append(f"| {row} | {count:,} | {share} |")
        lines.append(f"| all | {self.cells:,} | |")
        ambiguous = percent(self.ambiguous, self.active)
        lines += [
            "",
            f"{self.ambiguous:,} of {self.active:,} active cells have an ambiguous face "
            f"({ambiguous:.3f} %).",
        ]
        return "\n".join(lines) + "\n"


def percent(part: int, whole: int) -> float:
    """The part in percent; nothing of nothing is none.

    >>> percent(1, 4), percent(0, 0)
    (25.0, 0.0)
    """
    return 100 * part / whole if whole else 0.0


def frequencies(field: Field, isovalue: float, tie: str = "inside") -> Frequencies:
    """Table 1 of [1] for this volume: every row, those that do not occur with 0.

    Raises
    ------
    FieldError
        for a field that is not one value a sample on a 3-D lattice, or an isovalue that is no
        number.
    """
    if field.dimension != 3 or field.components != 1:
        raise FieldError("frequencies need one value a sample on a 3-D lattice")
    isovalue = check_isovalue(isovalue)
    # Compare in double precision: the samples' own would round the isovalue.
    above = np.greater_equal if tie == "inside" else np.greater
    signs = signs_of(above(field.values, isovalue, signature="dd->?"))
    plain = np.bincount(signs.reshape(-1), minlength=256)
    counts: Counter[str] = Counter()
    for value in range(256):
        if configuration(value) not in VARIANTS:
            counts[configuration(value)] += int(plain[value])
    asked = np.array([configuration(value) in VARIANTS for value in range(256)])
    places = np.argwhere(asked[signs])
    found = rows_of(field, isovalue, signs[tuple(places.T)], places)
    counts.update(dict(zip(ROWS, np.bincount(found, minlength=len(ROWS)).tolist(), strict=True)))
    return Frequencies({row: counts[row] for row in ROWS})


def signs_of(inside: Booleans) -> Array:
    """(N1 - 1, N2 - 1, N3 - 1) uint8: bit c is set where the cell's ``CORNERS[c]`` is inside."""
    size = [max(n - 1, 0) for n in inside.shape]
    signs = np.zeros(size, np.uint8)
    for bit, corner in enumerate(CORNERS):
        window = tuple(slice(x, x + n) for x, n in zip(corner, size, strict=True))
        signs |= inside[window].astype(np.uint8) << np.uint8(bit)
    return signs


def rows_of(field: Field, isovalue: float, signs: Array, places: Integers) -> Integers:
    """(n,) index into `ROWS` of each cell, given by its signs and its lowest corner (n, 3)."""
    corners, bits = _faces()
    a, b, c, d = np.moveaxis(signs.astype(np.uint8)[:, None, None] >> bits & 1, -1, 0)
    cell, face = np.nonzero((a == d) & (b == c) & (a != b))
    i, j, k = np.moveaxis(places[cell, None, :] + corners[face], -1, 0)
    # A saddle on the isovalue joins the inside corners, as a sample there is inside.
    apart = saddle_sign(field.values[i, j, k], isovalue)[0] < 0
    return rows_with(signs, np.bincount(cell[apart], minlength=len(places)))


@cache
def _faces() -> tuple[Integers, Array]:
    """The corners 00, 10, 01, 11 of each face, (6, 4, 3) as offsets and (6, 4) as bits of signs."""
    faces = [face_corners(axis, side) for axis, side in product(range(3), (0, 1))]
    bits = [[CORNERS.index(tuple(c)) for c in face.tolist()] for face in faces]
    return np.array(faces), np.array(bits, np.uint8)


def rows_with(signs: Array, separated: Integers) -> Integers:
    """(n,) index into `ROWS` of cells with these signs and so many separated faces."""
    table: Integers = row_table()[signs, separated]
    return table


@cache
def row_table() -> Integers:
    """(256, 7) index into `ROWS` by signs and separated faces; -1 for more than there are."""
    table = np.full((256, 7), -1)
    for signs in range(256):
        for separated in range(len(VARIANTS.get(configuration(signs), "0"))):
            table[signs, separated] = ROWS.index(row_of(signs, separated))
    return table


def face_corners(axis: int, side: int) -> Integers:
    """(4, 3) offsets of a face's corners 00, 10, 01, 11."""
    corners = [c for c in CORNERS if c[axis] == side]
    return np.array([corners[0], corners[2], corners[1], corners[3]])


def row_of(signs: int, separated: int) -> str:
    """The row of a cell with these signs, `separated` of whose faces cut inside corners apart.

    Where the outside corners are the marked ones, a face separates them if it joins the others.
    """
    name = configuration(signs)
    if name not in VARIANTS:
        return name
    faces = len(VARIANTS[name]) - 1
    return VARIANTS[name][separated if signs.bit_count() <= 4 else faces - separated]
