"""DICONEX: contours of a 2-D field, grown from the edges of pixels.

A sample stands at the centre of a pixel, and a pixel is *active* when its value is at least the
isovalue. The edges between active and inactive pixels already enclose the active ones without a
gap. DICONEX orients these edges, connects each to the one that follows it, and only then moves
their middles to where the field takes the isovalue. No table, and no 2 x 2 cell: the contour is
the enclosure that was there from the start, pushed into place.

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
1. B. R. Schlei, "Volume-Enclosing Surface Extraction", section II.A and Fig. 1 (contours),
   section II.B and Fig. 2c (displacement), section III.B (the average at a POA).
2. B. R. Schlei, "A New Computational Framework for 2D Shape-Enclosing Contours", Image and
   Vision Computing 27 (2009).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import (
    Array,
    Booleans,
    Field,
    FieldError,
    Floats,
    Integers,
    check_isovalue,
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
        follow = self.successor.tolist()
        begun = np.ones(len(follow), np.bool_)
        begun[self.successor[self.successor >= 0]] = False
        seen: set[int] = set()
        walks = []
        for start in [*np.flatnonzero(begun).tolist(), *range(len(follow))]:
            if start not in seen:
                walk = _walk(follow, start)
                seen.update(walk)
                walks.append(self.points[walk])
        return walks


def _walk(follow: list[int], start: int) -> list[int]:
    """The indices from `start` on, to the end of an open contour or back to `start`."""
    walk = [start]
    while (following := follow[walk[-1]]) >= 0:
        walk.append(following)
        if following == start:
            break
    return walk


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
    mode : at a point of ambiguity, keep the active pixels apart, join them, or (``"mixed"``)
        join them where the average of the four pixels is active
    border : ``"open"`` ends contours at the outermost samples; ``"closed"`` takes everything
        outside the image as inactive, and leaves the points between a border pixel and the
        outside where they are, half a pixel out
    displaced : False leaves every point in the middle of its pixel edge

    Returns
    -------
    Contours
        in the coordinates of the field.

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
    field, alpha, active = framed(values, isovalue, 2, mode, border)
    vectors = initial_contour_vectors(active)
    successor = successors(vectors, active, poa_joined(field.values, alpha, mode))
    outer = _reaches_outside(vectors, field.shape)
    index = vectors[:, :2] - 1 + 0.5 * np.asarray(DIRECTIONS)[vectors[:, 2]]
    if displaced:
        inner = np.flatnonzero(~outer)
        index[inner] = _displaced(field.values, alpha, vectors[inner])
    contours = Contours(field.position(index), successor)
    return contours if border == "closed" else _without(contours, outer)


def framed(
    values: ArrayLike | Field, isovalue: float, dimension: int, mode: str, border: str
) -> tuple[Field, float, Booleans]:
    """The field, the isovalue, and which samples are active, in a frame of inactive ones.

    The frame, one sample wide, gives every pixel or voxel its neighbours. Raises as `diconex`.
    """
    field = as_field(values, dimension)
    alpha = check_isovalue(isovalue)
    check_choice("mode", mode, get_args(Mode))
    check_choice("border", border, get_args(Border))
    return field, alpha, np.pad(inside_samples(field, alpha), 1)


def initial_contour_vectors(active: Booleans) -> Integers:
    """(N, 3) rows (i, j, r): active pixels and the directions of their inactive neighbours.

    `active` is framed by inactive pixels. Rows are sorted. See Figs. 1b and 1c.
    """
    neighbour = np.stack([np.roll(active, (-i, -j), (0, 1)) for i, j in DIRECTIONS], axis=-1)
    return np.argwhere(active[..., None] & ~neighbour)


def successors(vectors: Integers, active: Booleans, joined: Booleans) -> Integers:
    """(N,) the row of the vector that follows each vector, as in Fig. 1d.

    `joined` tells of each corner of the framed image, at [i, j] the one between pixels (i, j) and
    (i + 1, j + 1), whether a point of ambiguity there connects.
    """
    move = np.asarray(DIRECTIONS)
    v, r = vectors[:, :2], vectors[:, 2]
    d = (r + 1) % 4
    p, q = v + move[d], v + move[d] + move[r]
    p_active, q_active = active[tuple(p.T)], active[tuple(q.T)]
    # Turn right where both pixels ahead are active, and at a point of ambiguity that connects.
    corner = np.minimum(v, q)
    right = q_active & (p_active | joined[tuple(corner.T)])
    straight = p_active & ~q_active
    pixel = np.where(right[:, None], q, np.where(straight[:, None], p, v))
    direction = np.where(right, (d + 2) % 4, np.where(straight, r, d))
    return np.searchsorted(_keys(vectors, active), _keys(np.c_[pixel, direction], active))


def _keys(vectors: Integers, active: Booleans) -> Integers:
    """One number a row (i, j, r), in the order of the rows."""
    keys: Integers = (vectors[:, 0] * active.shape[1] + vectors[:, 1]) * 4 + vectors[:, 2]
    return keys


def poa_joined(values: Array, alpha: float, mode: Mode) -> Booleans:
    """(N1 + 1, N2 + 1) booleans: whether a point of ambiguity at that corner connects.

    In mixed mode it does where the average of the four pixels is active (section III.B). Corners
    on the border of the image are never ambiguous and stay False.
    """
    joined = np.zeros((values.shape[0] + 1, values.shape[1] + 1), np.bool_)
    inside = joined[1:-1, 1:-1]
    if mode == "mixed":
        grey = values.astype(np.float64) - alpha
        inside[:] = average_is_active(grey[:-1, :-1], grey[1:, 1:], grey[1:, :-1], grey[:-1, 1:])
    else:
        inside[:] = mode == "connect"
    return joined


def average_is_active(v: Floats, q: Floats, w: Floats, p: Floats) -> Booleans:
    """Whether the average of four values round a point is at least the isovalue.

    Values are relative, minus the isovalue; v and q stand opposite each other, and so do w and p.
    Opposite ones are added first, so that rounding cannot tell which corner came first.

    >>> average_is_active(*np.array([[2.0, 2.0], [1.0, 1.0], [-1.0, -2.0], [-2.0, -2.0]]))
    array([ True, False])
    """
    return np.greater_equal((v + q) + (w + p), 0)


def _displaced(values: Array, alpha: float, vectors: Integers) -> Floats:
    """(N, 2) indices of the points at the isovalue, between each pixel and its neighbour."""
    v, step = vectors[:, :2] - 1, np.asarray(DIRECTIONS)[vectors[:, 2]]
    return between(values, alpha, np.minimum(v, v + step), np.abs(step))


def between(values: Array, alpha: float, lower: Integers, step: Integers) -> Floats:
    """(N, n) where linear interpolation meets `alpha` between samples `lower` and lower + step.

    >>> between(np.array([133, 0]), 100, np.array([[0]]), np.array([[1]])).round(4)  # Fig. 2c
    array([[0.2481]])
    """
    ends = [values[tuple(i.T)].astype(np.float64) - alpha for i in (lower, lower + step)]
    return np.asarray(lower + crossing_parameter(*ends)[:, None] * step)


def _reaches_outside(vectors: Integers, shape: tuple[int, ...]) -> Booleans:
    """Whether a vector's inactive pixel lies outside the image."""
    w = vectors[:, :2] - 1 + np.asarray(DIRECTIONS)[vectors[:, 2]]
    outside: Booleans = ((w < 0) | (w >= shape)).any(axis=1)
    return outside


def _without(contours: Contours, outer: Booleans) -> Contours:
    """The contours cut open at the vectors marked `outer`."""
    number = np.where(outer, -1, np.cumsum(~outer) - 1)
    return Contours(contours.points[~outer], number[contours.successor[~outer]])


def as_field(values: ArrayLike | Field, dimension: int) -> Field:
    """`values` as a scalar field of that dimension, or a `FieldError` that says what it is."""
    field = values if isinstance(values, Field) else Field.of(values, dimension=dimension)
    if field.dimension != dimension or field.values.ndim != dimension:
        raise FieldError(
            f"a field of {field.components} components on a lattice of dimension "
            f"{field.dimension} is not scalar of dimension {dimension}"
        )
    return field


def check_choice(name: str, given: str, allowed: tuple[str, ...]) -> None:
    """Nothing, where `given` is allowed; a `ValueError` that lists the choices otherwise."""
    if given not in allowed:
        raise ValueError(f"{name} {given!r} is not one of {', '.join(allowed)}")


# The same contours, one vector at a time: for reading, and to hold the arrays above to it.


def diconex_plainly(
    values: ArrayLike | Field, isovalue: float, mode: Mode = "mixed"
) -> list[list[Vector]]:
    """The closed contours as lists of vectors (pixel, r), each begun at its smallest vector.

    >>> len(diconex_plainly([[0, 0], [0, 1]], 0.5)[0])
    4
    """
    field = as_field(values, 2)
    grey = {(int(i), int(j)): float(x) for (i, j), x in np.ndenumerate(field.values)}
    active = {pixel for pixel, x in grey.items() if x >= isovalue}
    waiting = {(v, r) for v in active for r in range(4) if _neighbour(v, r) not in active}
    contours = []
    for vector in sorted(waiting):
        contour = []
        while vector in waiting:
            waiting.remove(vector)
            contour.append(vector)
            vector = _successor(vector, active, grey, isovalue, mode)
        if contour:
            contours.append(contour)
    return contours


def _neighbour(pixel: Pixel, direction: int) -> Pixel:
    """The pixel one step away."""
    i, j = DIRECTIONS[direction]
    return (pixel[0] + i, pixel[1] + j)


def _successor(
    vector: Vector, active: set[Pixel], grey: dict[Pixel, float], isovalue: float, mode: Mode
) -> Vector:
    """The vector that begins where this one ends."""
    v, r = vector
    d = (r + 1) % 4
    w, p = _neighbour(v, r), _neighbour(v, d)
    q = _neighbour(p, r)
    left, straight, right = (v, d), (p, r), (q, (d + 2) % 4)
    if p in active:
        return right if q in active else straight
    if q not in active:
        return left
    # Decide a point of ambiguity.
    joined = connects(mode, *(grey[pixel] - isovalue for pixel in (v, q, w, p)))
    return right if joined else left


def connects(mode: Mode, v: float, q: float, w: float, p: float) -> bool:
    """Whether a point of ambiguity connects, the values round it as in `average_is_active`."""
    return (v + q) + (w + p) >= 0 if mode == "mixed" else mode == "connect"
