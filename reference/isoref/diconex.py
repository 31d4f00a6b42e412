"""DICONEX: contours of a 2-D field, grown from the edges of pixels.

A sample stands at the centre of a pixel, and a pixel is *active* when its value is at least the
isovalue. The edges between active and inactive pixels already enclose the active ones without a
gap. DICONEX orients these edges, connects each to the one that follows it, and only then moves
their middles to where the field takes the isovalue. No table, and no 2 x 2 cell: the contour is
the enclosure that was there from the start, pushed into place. `isoref.fast.diconex` is the
vectorised twin: the same numbers.

Glossary
--------
pixel       the unit square round a sample
r           range direction: from an active pixel to its inactive neighbour, 0 .. 3 for
            +i, +j, -i, -j, counterclockwise when axis 0 points right and axis 1 up
ICV         initial contour vector: the edge between the two, with the active pixel on its left;
            it points along d = r + 1 (mod 4)
juncture    the corner of a pixel where one ICV ends and the next begins
POA         point of ambiguity: a juncture where two active pixels meet corner to corner, so that
            two ICVs end and two begin
support     the point of the contour that an ICV carries: the middle of its pixel edge, later
point       moved along the range vector

At the head of an ICV four pixels meet: v (active) and w = v + r (inactive) behind it, p = v + d
and q = w + d ahead::

      p | q        straight on    p active, q inactive    (p, r)
     ---+---       left turn      neither active          (v, d)
      v ^ w        right turn     both active             (q, -d)
     d up, r ->    POA            q active, p inactive    left to disconnect, right to connect

Invariants
----------
Each ICV has one successor and is the successor of one: contours never branch and never cross.
A shape is enclosed counterclockwise, its holes clockwise. Contours are closed, or, with an open
border, end on the outermost samples' lines.

References
----------
[1] B. R. Schlei, "Volume-Enclosing Surface Extraction", section II.A and Fig. 1 (contours),
    section II.B and Fig. 2c (displacement), section III.B (the average at a POA).
[2] B. R. Schlei, "A New Computational Framework for 2D Shape-Enclosing Contours", Image and
    Vision Computing 27 (2009).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref.curves import follow
from isoref.field import (
    Booleans,
    Field,
    FieldError,
    Floats,
    Integers,
    check_isovalue,
    check_straight,
    inside_samples,
)
from isoref.mesh import Mesh
from isoref.sweep import crossing_parameter

Mode = Literal["disconnect", "connect", "mixed"]
Border = Literal["open", "closed"]
Pixel = tuple[int, int]
Vector = tuple[Pixel, int]

DIRECTIONS: tuple[Pixel, ...] = ((1, 0), (0, 1), (-1, 0), (0, -1))


@dataclass(frozen=True, eq=False)
class Contours:
    """Support points and the order in which contours visit them.

    Attributes
    ----------
    points : (N, 2) positions, one an initial contour vector
    successor : (N,) index of the next point, -1 where an open contour ends
    """

    points: Floats
    successor: Integers

    @property
    def mesh(self) -> Mesh:
        """The contours as segments, the active side on their left."""
        start = np.flatnonzero(self.successor >= 0)
        return Mesh.of(self.points, np.stack([start, self.successor[start]], axis=1))

    def polygons(self) -> list[Floats]:
        """The contours one by one, (n, 2) each; a closed one ends where it began.

        Open contours come first, then closed ones, each kind in the order of its first point.
        """
        return [
            self.points[np.append(walk, walk[0]) if closed else walk]
            for walk, closed in follow(self.successor)
        ]


def diconex(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    border: Border = "open",
    displaced: bool = True,
) -> Contours:
    """The contours round the pixels whose value is at least `isovalue`.

    Parameters
    ----------
    values : (N1, N2) array or a `Field` of dimension 2
    isovalue : in the unit of the samples
    mode : at a point of ambiguity, keep the active pixels apart, join them, or (``"mixed"``)
        join them where the average of the four pixels is active
    border : ``"open"`` ends contours at the outermost samples; ``"closed"`` takes everything
        outside the image as inactive, and leaves the points between a border pixel and the
        outside where they are, half a pixel out
    displaced : False leaves every point in the middle of its pixel edge

    Returns
    -------
    Contours
        in the coordinates of the field, one point a vector, in the order of pixels and directions.

    Raises
    ------
    FieldError
        for a field that is not scalar and two-dimensional, or an isovalue that is not finite.
    ValueError
        for an unknown mode or border.

    >>> import numpy as np
    >>> diconex(np.eye(2), 0.5, mode="connect", border="closed").polygons()[0].tolist()[:3]
    [[0.5, 0.0], [1.0, 0.5], [1.5, 1.0]]
    >>> [len(diconex(np.eye(2), 0.5, mode=m, border="closed").polygons())
    ...  for m in ("disconnect", "connect")]
    [2, 1]
    """
    # Find the initial contour vectors, Figs. 1b and 1c.
    field, alpha = as_field(values, 2), check_isovalue(isovalue)
    check_choice("mode", mode, get_args(Mode))
    check_choice("border", border, get_args(Border))
    inside = inside_samples(field, alpha)
    grey = {(i, j): float(field.values[i, j]) - alpha for i, j in np.ndindex(field.shape)}
    active = {v for v in grey if inside[v]}
    vectors = sorted((v, r) for v in active for r in range(4) if neighbour(v, r) not in active)

    # Connect each to the one that follows it, Fig. 1d.
    following = {vector: successor(vector, active, grey, mode) for vector in vectors}

    # Leave out the vectors between the image and its outside.
    if border == "open":
        vectors = [vector for vector in vectors if neighbour(*vector) in grey]

    # Move their middles to the isovalue, and number the vectors.
    places = [place(vector, grey, displaced) for vector in vectors]
    number = {vector: n for n, vector in enumerate(vectors)}
    return Contours(
        field.position(np.array(places).reshape(-1, 2)),
        np.array([number.get(following[vector], -1) for vector in vectors], np.int64),
    )


def neighbour(v: Pixel, d: int) -> Pixel:
    """The pixel one step from v in direction d.

    >>> neighbour((4, 4), 3)
    (4, 3)
    """
    i, j = DIRECTIONS[d]
    return (v[0] + i, v[1] + j)


def successor(vector: Vector, active: set[Pixel], grey: dict[Pixel, float], mode: Mode) -> Vector:
    """The vector (v, r) that begins where this one ends; see the table in the module's text.

    `grey` has the values minus the isovalue.
    """
    # Look at the four pixels at the vector's head.
    v, r = vector
    d = (r + 1) % 4
    w, p = neighbour(v, r), neighbour(v, d)
    q = neighbour(p, r)

    # Turn, or go straight on.
    left, straight, right = (v, d), (p, r), (q, (d + 2) % 4)
    if p in active:
        return right if q in active else straight
    if q not in active:
        return left

    # Decide the point of ambiguity.
    joined = connects(mode, *(grey[pixel] for pixel in (v, q, w, p)))
    return right if joined else left


def place(vector: Vector, grey: dict[Pixel, float], displaced: bool) -> Floats:
    """(2,) the index of a vector's support point, where the field takes the isovalue (Fig. 2c).

    A vector on the border of the image has no value on its outer side, and keeps its middle.
    """
    v, r = vector
    w = neighbour(v, r)
    lower, upper = min(v, w), max(v, w)
    if not displaced or w not in grey:
        return np.asarray(np.add(v, w) / 2)
    t = crossing_parameter(np.array([grey[lower]]), np.array([grey[upper]]))
    return np.asarray(np.array(lower) + t * np.subtract(upper, lower))


def connects(mode: Mode, v: float, q: float, w: float, p: float) -> bool:
    """Whether a point of ambiguity connects, the values round it as in `average_is_active`."""
    if mode == "mixed":
        return bool(average_is_active(*np.array([v, q, w, p])))
    return mode == "connect"


def average_is_active(v: Floats, q: Floats, w: Floats, p: Floats) -> Booleans:
    """Whether the average of four values round a point is at least the isovalue.

    Values are relative, minus the isovalue; v and q stand opposite each other, and so do w and p.
    Opposite ones are added first, so that rounding cannot tell which corner came first.

    >>> average_is_active(*np.array([[2.0, 2.0], [1.0, 1.0], [-1.0, -2.0], [-2.0, -2.0]]))
    array([ True, False])
    """
    return np.greater_equal((v + q) + (w + p), 0)


def as_field(values: ArrayLike | Field, dimension: int) -> Field:
    """`values` as a scalar field of that dimension, or a FieldError that says what they are."""
    field = values if isinstance(values, Field) else Field.of(values, dimension=dimension)
    if field.dimension != dimension or field.values.ndim != dimension:
        raise FieldError(
            f"a field of {field.components} components on a lattice of dimension "
            f"{field.dimension} is not scalar of dimension {dimension}"
        )
    check_straight(field)
    return field


def check_choice(name: str, given: str, allowed: tuple[str, ...]) -> None:
    """Raise ValueError, with the choices, unless `given` is one of those allowed."""
    if given not in allowed:
        raise ValueError(f"{name} {given!r} is not one of {', '.join(allowed)}")
