r"""Known bodies: smooth closed sets of any dimension whose every number is known.

A body is the common zero set of m functions phi_1 .. phi_m on a lattice of dimension n, in index
coordinates: a cell has side 1. The functions are distances, so that near the body ::

    |grad phi_i| = 1,    grad phi_i . grad phi_j = 0,    distance = sqrt(phi_1^2 + .. + phi_m^2)

and the second derivative of phi_i along a unit vector is at most 1/R_i on the body. That makes the
distance exact, and the bounds below short.

Glossary
--------
n, m, k   dimension of the lattice, number of functions, k = n - m
R_i       least radius of curvature of the hypersurface phi_i = 0; infinite where it is flat
K         bound of the second derivatives where an implementation interpolates
delta     largest distance between a mesh and the body
c         what K is multiplied by: half the largest variance of points that are averaged

How far a right mesh may be from its body
-----------------------------------------
*One function.* Let x_1, x_2, .. be points with weights mu_j that sum to 1 and have the mean p. By
Taylor's formula at p,  |sum mu_j phi(x_j) - phi(p)| <= K/2 sum mu_j |x_j - p|^2, which is K/2 times
the sum over the axes of the variance of that coordinate. A vertex at the linear crossing of an
edge, at the fraction t, is off by K/2 t (1 - t) at most: the average of the two ends, with the
variance t (1 - t). Averages of averages add up: a point of a simplex whose vertices are such
crossings is an average of corners of the cell, and a coordinate that takes only the values 0 and 1
has the variance p (1 - p) <= 1/4. So whatever a mesh averages inside one cell,

    |phi(p)| <= K/2 sum over axes of p_a (1 - p_a) <= n K / 8                            (edges)

the chord of the cell's diagonal: 3/(8R) for surfaces in space. The multilinear interpolant and the
linear one of a split are such averages too, so vertices inside cells, on the one's zero set or
averages of crossings, are covered, and a split over blocks of b cells an axis has n b^2 K / 8.

*cells.* A simplex of a dual mesh joins cells around one edge, a block of 2 x .. x 2 x 1 cells. A
coordinate between 0 and 2 has a variance of at most 1, so |phi(p)| <= K/2 (n - 1 + 1/4)
= (4 n - 3) K / 8: the chord of the block's diagonal, 3 cells long for surfaces in space, 9/(8R).

*own.* On its own lattice of steps up to r the same argument gives n r^2 K / 8 (less where it splits
its cells into simplices with edges up to r), and its samples, taken from the multilinear
interpolant, are themselves off by n K / 8.

*labels.* What is known of a crossing is its edge: a vertex in the middle is off by half a cell,
more than its share of the variance. A vertex of `cells` may be anywhere in its cell, through which
the body runs: half the cell's diagonal. For `own`, half a step, and half the diagonal by which the
nearest label is away. The chord is added.

*Rounding.* Samples that are off by epsilon (in cells, as |grad phi| = 1) move every average by
epsilon at most.

*K.* Along a straight line phi'' is (1 - phi'^2) / (R - phi) at most, and a ball attains it. An edge
of length L that meets the ball of radius R reaches rho^2 / r^3 (rho from the centre to the line,
r to the point), which is less than 1 / sqrt(R^2 - 2 L^2) for R >= 2 L. Between points of the mesh
the depth is delta at most and phi'' <= 1 / (R - delta). So with
delta = c / min(sqrt(R^2 - 2 L^2), R - delta), and where the second is smaller
delta = (R - sqrt(R^2 - 4 c)) / 2. L is 1 for edges of the lattice, sqrt(n) b for edges of a split,
r for `own`. Where that has no solution (labels seen through steps of three cells), what is left is
that the body runs through the block that is averaged: delta is the block's diameter.

*Several functions.* Each is off by its own delta_i, the distance by sqrt(sum delta_i^2).

*The other way.* On the disc normal to the body at b the functions are coordinates, and what the
mesh is the zero set of differs from them by delta at most: it has degree 1 on every larger circle
round b, so a zero, at most delta away. The two-sided distance has the same bound.

*Volume.* Over a body point lies a column of height h, |h| <= delta, and of volume
|h| (1 + delta/R)^k at most; a mesh facet covers (1 - delta/R)^-k of its own area at most. So
|difference of volume| / (area of the mesh) <= delta ((1 + delta/R) / (1 - delta/R))^k.

*Degree.* The sum of det(-g_1, .., -g_m, t_1, .., t_k) / k! over the simplices, over the measure of
the body, counts with sign how often the mesh covers the body, up to (1 + delta/R)^k. It is a whole
number blurred, so a right one is nearer to 1 than to any other.

*Centroid.* Within a quarter of a cell, by the design: half of the shift of half a cell that it is
there to catch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import gamma, inf, pi, prod, sqrt
from typing import Any, Literal

import numpy as np
from isoref.field import Floats

Interpolant = Literal["multilinear", "tetrahedra", "labels"]
Vertices = Literal["edges", "cells", "own"]

CENTROID = 0.25
"""Cells by which a centroid may be off."""


@dataclass(frozen=True, eq=False)
class Body:
    """A closed k-manifold in a box of samples, k = n - m, in index coordinates.

    shape : samples along each axis of the box
    phi : positions (P, n) to values (P, m), high inside
    radii : (m) the least radius of curvature of each phi_i = 0, infinite where it is flat
    centroid : of the enclosed set where m = 1, else of the body itself
    pieces, b1 : number of components; first Betti number over Z/2 (loops of curves, twice the
        genus of surfaces, summed)
    measure : k-dimensional volume; the number of points where k = 0
    volume : enclosed, where m = 1 and k > 0
    """

    name: str
    shape: tuple[int, ...]
    phi: Callable[[Floats], Floats]
    radii: tuple[float, ...]
    centroid: Floats
    pieces: int
    b1: int
    measure: float
    volume: float | None = None

    @property
    def n(self) -> int:
        """Dimension of the lattice."""
        return len(self.shape)

    @property
    def m(self) -> int:
        """Number of functions."""
        return len(self.radii)

    def distance(self, points: Floats) -> Floats:
        """(P,) the distance of points (P, n) from the body: exact within its reach, never less."""
        return np.asarray(np.sqrt((self.phi(points) ** 2).sum(axis=1)))

    def function(self, lift: float) -> Callable[..., Any]:
        """The first phi, lifted, of n coordinates: floats, or arrays of one shape.

        >>> at = known_bodies(3, 1, 0)[0].function(0.5)
        >>> at(0.0, 0.0, 0.0) < 0.5, at(np.zeros(2), 0.0, 0.0).shape
        (True, (2,))
        """
        phi = self.phi

        def at(*place: Any) -> Any:
            points = np.stack(np.broadcast_arrays(*place), axis=-1).astype(np.float64)
            values = phi(points.reshape(-1, points.shape[-1]))[:, 0] + lift
            return values.reshape(points.shape[:-1]) if points.ndim > 1 else float(values[0])

        return at

    def gradients(self, points: Floats) -> Floats:
        """(P, m, n) the gradients, by central differences."""
        h = 1e-5
        steps = h * np.eye(self.n)
        parts = [(self.phi(points + s) - self.phi(points - s)) / (2 * h) for s in steps]
        return np.stack(parts, axis=-1)

    def points(self, count: int) -> Floats:
        """(P, n) points of the body, about `count`: points of the box moved along the gradients."""
        rng = np.random.default_rng(11)
        place = rng.uniform(0, np.array(self.shape) - 1.0, (count, self.n))
        for _ in range(3):
            place = place - np.einsum("pm,pmn->pn", self.phi(place), self.gradients(place))
        return np.asarray(place[self.distance(place) < 1e-7])

    def samples(self) -> Floats:
        """(m, N1, .., Nn) the functions on the lattice."""
        grid = np.stack(np.meshgrid(*map(np.arange, self.shape), indexing="ij"), axis=-1)
        values = self.phi(grid.reshape(-1, self.n).astype(np.float64))
        return np.ascontiguousarray(values.T.reshape(self.m, *self.shape))


@dataclass(frozen=True)
class Bounds:
    """How far a right mesh may be off, in cells.

    mean : difference of volume over area where m = 1, else the mean distance
    largest : from the mesh to the body, and from the body to the mesh
    centroid : from centroid to centroid
    """

    mean: float
    largest: float
    centroid: float = CENTROID


def bounds(
    interpolant: Interpolant,
    vertices: Vertices,
    radii: Sequence[float],
    n: int,
    *,
    reach: float = 1.0,
    block: int = 1,
    rounding: float = 0.0,
) -> Bounds:
    """What the derivation above allows.

    Parameters
    ----------
    radii : R_i of each function, in cells
    n : dimension of the lattice
    reach : r, the largest distance between neighbouring samples of an `own` lattice, in cells
    block : b, cells an axis of the block that a split (`tetrahedra`) repeats
    rounding : epsilon, the rounding of the samples over the gradient, in cells

    Raises
    ------
    ValueError
        for a word that is not known

    >>> round(bounds("multilinear", "edges", [600.0], 3).largest * 600, 3)
    0.375
    >>> round(bounds("multilinear", "cells", [600.0], 3).largest * 600, 3)
    1.125
    """
    if interpolant not in ("multilinear", "tetrahedra", "labels"):
        raise ValueError(f"no interpolant {interpolant!r}: multilinear, tetrahedra or labels")
    c, diameter = _block(vertices, n, reach, block)
    length = {"own": reach}.get(vertices, sqrt(n) * block if interpolant == "tetrahedra" else 1.0)
    added = rounding
    if interpolant == "labels":
        added = _mislabelled(vertices, n, reach)
    each = [min(_offset(c, R, length, added), diameter + rounding) for R in radii]
    delta, least = sqrt(sum(one**2 for one in each)), min(radii)
    stretch = 1.0
    if len(radii) == 1:
        near = delta < least
        stretch = ((1 + delta / least) / (1 - delta / least)) ** (n - 1) if near else inf
    return Bounds(delta * stretch, delta)


def _block(vertices: Vertices, n: int, reach: float, block: int) -> tuple[float, float]:
    """c, half the largest variance in the block that is averaged, and the block's diameter."""
    if vertices == "edges":
        return n * block**2 / 8, sqrt(n) * block
    if vertices == "cells":
        return (4 * n - 3) / 8, sqrt(4 * n - 3)
    if vertices == "own":
        return n * (reach**2 + 1) / 8, sqrt(n) * (reach + 1)
    raise ValueError(f"no placing of vertices {vertices!r}: edges, cells or own")


def _mislabelled(vertices: Vertices, n: int, reach: float) -> float:
    """How far a vertex may be from a crossing of which only the labels are known."""
    return {"edges": 0.5, "cells": sqrt(n) / 2, "own": (sqrt(n) + reach) / 2}[vertices]


def _offset(c: float, R: float, length: float, added: float) -> float:
    """The least c K + added that satisfies the bound of K; infinite where there is none."""
    if R == inf:
        return added
    inner, rest = R**2 - 2 * length**2, (R - added) ** 2 - 4 * c
    if R < 2 * length or inner <= 0 or rest <= 0:
        return inf
    return max(c / sqrt(inner) + added, (R + added - sqrt(rest)) / 2)


# -- bodies ----------------------------------------------------------------------------------------

IDENTITY: dict[int, Floats] = {n: np.eye(n) for n in range(1, 7)}
TILTED: dict[int, Floats] = {
    2: np.array([[3, 4], [-4, 3]]) / 5,
    3: np.array([[2, 2, 1], [-2, 1, 2], [1, -2, 2]]) / 3,
}
"""Orthonormal frames, as rows."""


def sphere_measure(d: int, R: float) -> float:
    """The (d-1)-dimensional volume of the sphere of radius R in R^d.

    >>> round(sphere_measure(3, 1.0) / pi, 12), round(sphere_measure(1, 5.0), 12)
    (4.0, 2.0)
    """
    return float(2 * pi ** (d / 2) / gamma(d / 2) * R ** (d - 1))


def ball_volume(d: int, R: float) -> float:
    """The volume of the ball of radius R in R^d."""
    return sphere_measure(d, R) * R / d


def product(
    name: str,
    shape: tuple[int, ...],
    centre: Floats,
    factors: Sequence[tuple[int, float]],
    frame: Floats | None = None,
) -> Body:
    """The product of spheres about `centre`, each in its own axes of the frame.

    A factor (d, R) is the sphere of radius R in the next d axes, phi = R - |y|: two points where
    d = 1. A factor (1, 0) is the plane y = 0. A product of circles is a torus.
    """
    axes = IDENTITY[len(shape)] if frame is None else frame
    ends = np.cumsum([d for d, _ in factors])

    def phi(x: Floats) -> Floats:
        y = (x - centre) @ axes.T
        parts = [y[:, end - d : end] for (d, _), end in zip(factors, ends, strict=True)]
        columns = [
            R - length(part) if R else part[:, 0]
            for part, (_, R) in zip(parts, factors, strict=True)
        ]
        return np.stack(columns, axis=1)

    pieces = 2 ** sum(d == 1 and R > 0 for d, R in factors)
    return Body(
        name,
        shape,
        phi,
        tuple(R if d > 1 else inf for d, R in factors),
        centre,
        pieces,
        pieces * sum(d == 2 for d, _ in factors),
        prod(sphere_measure(d, R) if R else 1.0 for d, R in factors),
        ball_volume(*factors[0]) if len(factors) == 1 < len(shape) else None,
    )


def balls(
    name: str, shape: tuple[int, ...], centres: Sequence[Floats], radii: Sequence[float]
) -> Body:
    """The spheres round balls that lie apart."""
    n = len(shape)

    def phi(x: Floats) -> Floats:
        depths = [R - length(x - c) for c, R in zip(centres, radii, strict=True)]
        return reduce(np.maximum, depths)[:, None]

    volumes = np.array([ball_volume(n, R) for R in radii])
    return Body(
        name,
        shape,
        phi,
        (min(radii),),
        np.asarray((volumes[:, None] * np.array(centres)).sum(axis=0) / volumes.sum()),
        len(radii),
        len(radii) * (n == 2),
        sum(sphere_measure(n, R) for R in radii),
        float(volumes.sum()),
    )


def shell(name: str, shape: tuple[int, ...], centre: Floats, inner: float, outer: float) -> Body:
    """The two spheres that bound what lies between them: of an annulus in the plane."""
    n = len(shape)

    def phi(x: Floats) -> Floats:
        away = length(x - centre)
        return np.minimum(outer - away, away - inner)[:, None]

    return Body(
        name,
        shape,
        phi,
        (inner,),
        centre,
        2,
        2 * (n == 2),
        sphere_measure(n, inner) + sphere_measure(n, outer),
        ball_volume(n, outer) - ball_volume(n, inner),
    )


def torus(
    name: str, shape: tuple[int, ...], centre: Floats, ring: float, tube: float, frame: Floats
) -> Body:
    """The torus round a circle of radius `ring`, which lies in the frame's first two axes."""

    def phi(x: Floats) -> Floats:
        y = (x - centre) @ frame.T
        ring_distance = length(np.stack([length(y[:, :2]) - ring, y[:, 2]], axis=1))
        return (tube - ring_distance)[:, None]

    area, volume = 4 * pi**2 * ring * tube, 2 * pi**2 * ring * tube**2
    return Body(name, shape, phi, (min(tube, ring - tube),), centre, 1, 2, area, volume)


def pretzel(
    name: str,
    shape: tuple[int, ...],
    centre: Floats,
    thickness: float,
    hole: float,
    frame: Floats,
) -> Body:
    """The surface of genus 2 at the distance `thickness` from a flat plate with two round holes.

    The plate, in the frame's first two axes, is all within `hole` + 1/2 of a segment, without two
    discs of radius `hole` about its ends; they are half a cell apart. The volume is the plate's
    area times twice the thickness, and half tori by Pappus.
    """
    half, wide = hole + 0.25, hole + 0.5
    ends = np.array([[-half, 0.0], [half, 0.0]])

    def phi(x: Floats) -> Floats:
        y = (x - centre) @ frame.T
        across = np.stack([np.maximum(abs(y[:, 0]) - half, 0), y[:, 1]], axis=1)
        outside = np.maximum(length(across) - wide, 0)
        for end in ends:
            outside = np.maximum(outside, hole - length(y[:, :2] - end))
        return (thickness - length(np.stack([outside, y[:, 2]], axis=1)))[:, None]

    r, outline = thickness, 2 * pi * wide + 4 * half
    plate = pi * wide**2 + 4 * half * wide - 2 * pi * hole**2
    # Around a boundary of length l that turns by 2 pi: centres of half circles and half discs.
    turned_length = outline + 2 * (2 * pi * hole) + 2 * pi * (1 - 2) * 2 * r / pi
    turned_area = outline + 2 * (2 * pi * hole) + 2 * pi * (1 - 2) * 4 * r / (3 * pi)
    area = 2 * plate + pi * r * turned_length
    volume = 2 * r * plate + pi * r**2 / 2 * turned_area
    return Body(name, shape, phi, (min(r, hole - r),), centre, 1, 4, area, volume)


def length(y: Floats) -> Floats:
    """(P,) lengths of the rows, squares added from the left: the same bits everywhere."""
    return np.asarray(np.sqrt(reduce(np.add, (y[:, a] * y[:, a] for a in range(y.shape[1])))))


OFFSET = {
    1: (0.4571,),
    2: (0.4571, -0.2713),
    3: (0.4571, -0.0429, -0.4337),
    4: (0.4571, 0.1513, -0.1521, -0.4337),
    5: (0.4571, 0.2213, -0.0129, -0.2377, -0.4519),
    6: (0.4571, 0.2213, -0.0129, -0.2377, -0.4519, 0.1129),
}
"""Cells from the middle of the lattice to a centroid: another along each axis."""


def known_bodies(n: int, m: int, odd: int = 0) -> list[Body]:
    """The bodies of a kind in boxes of 2^e + `odd` samples an axis, e its own for each.

    >>> [body.name for body in known_bodies(3, 1)]
    ['sphere', 'torus', 'two-spheres', 'genus-2']
    """

    def box(*exponents: int) -> tuple[int, ...]:
        return tuple(2**e + odd for e in exponents)

    def middle(shape: tuple[int, ...]) -> Floats:
        return np.asarray((np.array(shape) - 1) / 2 + np.array(OFFSET[n]), np.float64)

    def made(name: str, shape: tuple[int, ...], *factors: tuple[int, float]) -> Body:
        frame = TILTED.get(n) if prod(shape) == shape[0] ** n else None
        return product(name, shape, middle(shape), factors, frame)

    def apart(name: str, shape: tuple[int, ...], *given: tuple[float, ...]) -> Body:
        centre = middle(shape)
        centres = [centre + np.array(one[1:]) for one in given]
        return balls(name, shape, centres, [one[0] for one in given])

    flat, round_ = (1, 0.0), 6.0
    if (n, m) == (2, 1):
        return [
            made("circle", box(4, 4), (2, round_)),
            shell("annulus", box(5, 5), middle(box(5, 5)), 6.0, 13.5),
            apart("three-circles", box(6, 6), (6.0, -15, -12), (7.5, 14, -9), (9.0, -3, 15)),
        ]
    if (n, m) == (3, 1):
        wide = box(6, 6, 6)
        return [
            made("sphere", box(4, 4, 4), (3, round_)),
            torus("torus", wide, middle(wide), 14.0, 7.0, TILTED[3]),
            apart("two-spheres", box(5, 5, 5), (6.0, -7, -6, 5), (7.0, 6, 5, -6)),
            pretzel("genus-2", wide, middle(wide), 6.0, 12.0, TILTED[3]),
        ]
    if (n, m) == (3, 2):
        return [
            made("circle", box(4, 4, 4), (2, round_), flat),
            made("two-circles", box(5, 5, 5), (2, 8.0), (1, 6.0)),
        ]
    if (n, m) == (4, 1):
        long = box(5, 4, 4, 4)
        return [
            made("three-sphere", box(4, 4, 4, 4), (4, round_)),
            apart("two-three-spheres", long, (6.0, -8, 0, 0, 0), (6.0, 8, 0, 0, 0)),
        ]
    if (n, m) == (4, 2):
        return [
            made("sphere", box(4, 4, 4, 3), (3, round_), flat),
            made("clifford-torus", box(4, 4, 4, 4), (2, round_), (2, round_)),
        ]
    if (n, m) == (4, 3):
        return [
            made("circle", box(4, 4, 3, 3), (2, round_), flat, flat),
            made("two-circles", box(4, 4, 4, 3), (2, round_), (1, 5.0), flat),
        ]
    if (n, m) == (5, 3):
        return [
            made("sphere", box(4, 4, 4, 2, 2), (3, round_), flat, flat),
            made("clifford-torus", box(4, 4, 4, 4, 2), (2, round_), (2, round_), flat),
        ]
    if (n, m) == (5, 4):
        return [
            made("circle", box(4, 4, 3, 2, 2), (2, round_), flat, flat, flat),
            made("two-circles", box(4, 4, 3, 2, 2), (2, round_), (1, 2.0), flat, flat),
        ]
    if (n, m) == (6, 5):
        return [
            made("circle", box(4, 4, 2, 2, 2, 2), (2, round_), *[flat] * 4),
            made("two-circles", box(4, 4, 3, 2, 2, 2), (2, round_), (1, 2.0), *[flat] * 3),
        ]
    if n == m and n <= 3:
        side = box(*[4] * n)
        return [
            made("point", side, *[flat] * n),
            made("points", side, *[(1, 3.0)] * n),
        ]
    if n == m and n <= 6:
        thin = box(4, 3, *[2] * (n - 2))
        return [
            made("point", thin, *[flat] * n),
            made("points", thin, (1, 3.0), (1, 2.0), *[flat] * (n - 2)),
        ]
    raise ValueError(f"no bodies are known for {m} functions on a lattice of dimension {n}")


KINDS = (
    (1, 1),
    *((2, m) for m in (1, 2)),
    *((3, m) for m in (1, 2, 3)),
    *((4, m) for m in (1, 2, 3, 4)),
    *((5, m) for m in (3, 4, 5)),
    *((6, m) for m in (5, 6)),
)
"""Every (n, m) with known bodies. Of the others a sphere of radius six alone has very many
simplices: of (6, 4) 434 thousand, of (5, 2) over two million, two gigabytes to judge."""
