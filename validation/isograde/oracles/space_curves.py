"""Curves that are known: where two surfaces meet by formula, and how such curves are linked.

Each `KnownCurves` holds two functions of position and the curves on which both vanish, as dense
polylines from a parametrisation, not from samples. Linking numbers and knot determinants are
computed from polylines, the first in two unrelated ways.

Glossary
--------
u, v        coordinates of the three-sphere, ``|u|^2 + |v|^2 = 1``, by stereographic projection
M           the largest second derivatives of a function near a curve
link        linking number of two closed curves: how often one winds through the other
determinant |Alexander polynomial at -1| of a knot: 1 for the unknot, 3 for the trefoil

References
----------
[1] M. V. Berry, Knotted zeros in the quantum states of hydrogen, Found. Phys. 31, 2001.
[2] K. Brauner, 1928; M. R. Dennis et al., Isolated optical vortex knots, Nature Phys. 6, 2010:
    ``u^2 - v^n`` vanishes on a torus link.
[3] T. F. Banchoff, Self-linking numbers of space polygons, 1976: Gauss's integral over two segments
    is the solid angle of a spherical quadrilateral.
[4] R. H. Fox, Metacyclic invariants of knots and links, 1970: colourings of a knot; here the
    determinant, from the crossings of a projection.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Function = Callable[[Points, Points, Points], Points]

TINY = float(np.finfo(np.float64).tiny)
# Points of a known curve; its polyline is then closer than 1e-5 of its radius.
DENSE = 1000


@dataclass(frozen=True)
class KnownCurves:
    """Two functions and the curves in a cube on which both vanish.

    Attributes
    ----------
    name : a word
    first, second : functions of (x, y, z), 0 on the surfaces
    half : the cube is ``[-half, half]^3``
    curves : dense polylines (N, 3); a closed one repeats its first point
    transversal : False where the surfaces touch; curves may then be joined in several ways
    links : linking numbers of the pairs of closed curves, without sign, in ascending order
    determinants : of the closed curves, ascending
    levels : what is added to either function where it is sampled; the isovalues of the samples
    """

    name: str
    first: Function
    second: Function
    half: float
    curves: tuple[Points, ...]
    transversal: bool = True
    links: tuple[int, ...] = ()
    determinants: tuple[int, ...] = ()
    levels: tuple[float, float] = (0.0, 0.0)

    @property
    def closed(self) -> int:
        """How many curves are closed."""
        return sum(is_closed(curve) for curve in self.curves)

    @property
    def length(self) -> float:
        """Total length."""
        return sum(length(curve) for curve in self.curves)

    def sample(self, shape: tuple[int, int, int]) -> tuple[Points, Points, Points]:
        """Both functions, raised to their levels, on so many samples an axis; the spacing (3,)."""
        axes = [np.linspace(-self.half, self.half, n) for n in shape]
        grid = np.meshgrid(*axes, indexing="ij")
        spacing = 2 * self.half / (np.array(shape) - 1.0)
        one, two = self.levels
        return self.first(*grid) + one, self.second(*grid) + two, spacing

    def bend(self, reach: float) -> tuple[float, float]:
        """M of the two functions: the largest second derivatives within `reach` of the curves.

        The Frobenius norm of the Hessian by second differences, at points of the curves shifted
        by `reach` in every diagonal direction.
        """
        points = np.concatenate([curve[:: max(len(curve) // 60, 1)] for curve in self.curves])
        shifts = reach * np.array(
            [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
        )
        around = (points[:, None] + shifts).reshape(-1, 3)
        return _hessian_norm(self.first, around), _hessian_norm(self.second, around)

    def directions(self, points: Points) -> tuple[Points, Points]:
        """(N, 3) the cross product of the unit gradients, and (2, N) the lengths of the gradients.

        Its length is the sine of the angle between the gradients: the confidence in its direction.
        """
        gradients = [_gradient(function, points) for function in (self.first, self.second)]
        sizes = np.array([np.linalg.norm(one, axis=1) for one in gradients])
        one, other = (
            g / np.maximum(s, TINY)[:, None] for g, s in zip(gradients, sizes, strict=True)
        )
        return np.cross(one, other), sizes


def _gradient(function: Function, points: Points, step: float = 1e-5) -> Points:
    """(N, 3) the gradient at these points, by central differences."""
    shifts = step * np.eye(3)
    parts = [function(*(points + s).T) - function(*(points - s).T) for s in shifts]
    return np.stack(parts, axis=1) / (2 * step)


def _hessian_norm(function: Function, points: Points, step: float = 1e-3) -> float:
    """The largest Frobenius norm of the Hessian at these points, by central differences."""
    unit = step * np.eye(3)
    square = np.zeros(len(points))
    for i in range(3):
        for j in range(3):
            corners = [
                a * b * function(*(points + a * unit[i] + b * unit[j]).T)
                for a, b in product((1, -1), repeat=2)
            ]
            square += (np.sum(corners, axis=0) / (4 * step**2)) ** 2
    return float(np.sqrt(square.max()))


def is_closed(curve: Points) -> bool:
    """Whether a polyline ends where it starts."""
    return len(curve) > 2 and bool((curve[0] == curve[-1]).all())


def length(curve: Points) -> float:
    """Length of a polyline."""
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())


# --- the curves ----------------------------------------------------------------------------------


def _loop(*coordinates: Points) -> Points:
    """The closed polyline through these coordinates, the first point repeated exactly."""
    points = np.empty((DENSE, 3), np.float64)
    for axis, values in enumerate(coordinates):
        points[:, axis] = values
    return np.concatenate([points, points[:1]])


def _angles() -> Points:
    """`DENSE` angles once around."""
    return np.linspace(0, 2 * np.pi, DENSE, endpoint=False)


def two_spheres() -> KnownCurves:
    """Unit spheres at x = -0.31 and 0.31, shifted off the lattice: one circle."""
    centre, shift = np.array([0.013, 0.027, -0.019]), 0.31

    def sphere(side: float) -> Function:
        def value(x: Points, y: Points, z: Points) -> Points:
            dx, dy, dz = x - centre[0] - side * shift, y - centre[1], z - centre[2]
            return np.asarray(1 - dx**2 - dy**2 - dz**2)

        return value

    t, radius = _angles(), np.sqrt(1 - shift**2)
    circle = _loop(
        np.array(centre[0]), centre[1] + radius * np.cos(t), centre[2] + radius * np.sin(t)
    )
    return KnownCurves("two-spheres", sphere(-1), sphere(1), 1.5, (circle,), determinants=(1,))


def two_cylinders() -> KnownCurves:
    """A thin cylinder along z through a thicker one along x: two closed curves, above and below."""
    r, wide, x0, y0, z0 = 0.6, 0.9, 0.011, 0.017, 0.023
    t = _angles()
    height = np.sqrt(wide**2 - (r * np.sin(t)) ** 2)
    curves = tuple(
        _loop(x0 + r * np.cos(t), y0 + r * np.sin(t), z0 + side * height) for side in (1, -1)
    )
    return KnownCurves(
        "two-cylinders",
        lambda x, y, z: r**2 - (x - x0) ** 2 - (y - y0) ** 2 + 0 * z,
        lambda x, y, z: wide**2 - (y - y0) ** 2 - (z - z0) ** 2 + 0 * x,
        1.4,
        curves,
        links=(0,),
        determinants=(1, 1),
    )


def two_isovalues() -> KnownCurves:
    """The two cylinders again, as isosurfaces of two different isovalues."""
    return replace(two_cylinders(), name="two-isovalues", levels=(0.7, -1.3))


def villarceau() -> KnownCurves:
    """A torus and a plane that touches it twice: two circles that cross where they touch.

    The plane through the centre, tilted by ``asin(r / R)``, meets the torus in two circles of
    radius R. The surfaces touch in the two points where the circles cross, so how the curves are
    joined there is nobody's fault.
    """
    big, small = 1.0, 0.45
    sine = small / big
    cosine = np.sqrt(1 - sine**2)

    def torus(x: Points, y: Points, z: Points) -> Points:
        return 4 * big**2 * (x**2 + y**2) - (x**2 + y**2 + z**2 + big**2 - small**2) ** 2

    t = _angles()
    # In the plane, with axes y and (cosine, 0, sine): circles of radius R about y = -r and r.
    curves = tuple(
        _loop(cosine * big * np.sin(t), side * small + big * np.cos(t), sine * big * np.sin(t))
        for side in (-1, 1)
    )
    return KnownCurves(
        "villarceau",
        torus,
        lambda x, y, z: cosine * z - sine * x + 0 * y,
        1.7,
        curves,
        transversal=False,
    )


def hydrogen_ring() -> KnownCurves:
    """The states n = 2, mixed: ``(2 - r) + i c z`` vanishes on a ring of radius 2 [1]."""

    def real(x: Points, y: Points, z: Points) -> Points:
        r = np.sqrt(x**2 + y**2 + z**2)
        return (2 - r) * np.exp(-r / 2)

    def imaginary(x: Points, y: Points, z: Points) -> Points:
        return 0.8 * (z - 0.02) * np.exp(-np.sqrt(x**2 + y**2 + z**2) / 2)

    t, height = _angles(), 0.02
    radius = np.sqrt(4 - height**2)
    ring = _loop(radius * np.cos(t), radius * np.sin(t), np.array(height))
    return KnownCurves("hydrogen-ring", real, imaginary, 3.0, (ring,), determinants=(1,))


def hydrogen_axis() -> KnownCurves:
    """The states n = 3, m = 1, mixed: ``(x + i y)(6 - r + i c z)``: the axis, and a ring around it.

    Lengths are scaled by one sixth.
    """
    x0, y0, z0 = 0.013, -0.007, 0.011

    def wave(x: Points, y: Points, z: Points) -> NDArray[np.complex128]:
        x, y, z = x - x0, y - y0, z - z0
        r = np.sqrt(x**2 + y**2 + z**2)
        value: NDArray[np.complex128] = (x + 1j * y) * (1 - r + 0.9j * z) * np.exp(-r)
        return value

    t = _angles()
    ring = _loop(x0 + np.cos(t), y0 + np.sin(t), np.array(z0))
    axis = np.stack([np.full(DENSE, x0), np.full(DENSE, y0), np.linspace(-1.6, 1.6, DENSE)], axis=1)
    return KnownCurves(
        "hydrogen-axis",
        lambda x, y, z: wave(x, y, z).real,
        lambda x, y, z: wave(x, y, z).imag,
        1.6,
        (ring, axis),
        determinants=(1,),
    )


def _torus_link(name: str, n: int, half: float, links: tuple[int, ...], knot: int) -> KnownCurves:
    """The link of ``u^2 - v^n`` [2], turned and shifted off the lattice.

    On it ``|v| = beta`` with ``beta^n + beta^2 = 1``; for n = 3 it is one curve, for n = 2 two.
    """
    turn = _rotation(0.3, 0.7)
    shift = np.array([0.021, -0.034, 0.012])

    def wave(x: Points, y: Points, z: Points) -> NDArray[np.complex128]:
        p = np.tensordot(turn.T, np.stack([x - shift[0], y - shift[1], z - shift[2]]), axes=1)
        r2 = (p**2).sum(axis=0)
        u, v = (r2 - 1 + 2j * p[2]) / (r2 + 1), 2 * (p[0] + 1j * p[1]) / (r2 + 1)
        value: NDArray[np.complex128] = u**2 - v**n
        return value

    beta = np.sqrt(max(r.real for r in np.roots(_beta_squared(n)) if abs(r.imag) < 1e-12))
    t = _angles()
    strands = [(2 * t, n * t)] if n % 2 else [(t, n // 2 * t + s * np.pi) for s in (0, 1)]
    curves = []
    for v_angle, u_angle in strands:
        u, v = beta ** (n / 2) * np.exp(1j * u_angle), beta * np.exp(1j * v_angle)
        p = np.stack([v.real, v.imag, u.imag]) / (1 - u.real)
        curves.append(_loop(*((turn @ p).T + shift).T))
    return KnownCurves(
        name,
        lambda x, y, z: wave(x, y, z).real,
        lambda x, y, z: wave(x, y, z).imag,
        half,
        tuple(curves),
        links=links,
        determinants=(knot,) * len(curves),
    )


def _beta_squared(n: int) -> list[float]:
    """Coefficients of a polynomial in ``b = beta^2`` that vanishes where ``beta^n + b = 1``."""
    # b^(n/2) = 1 - b, squared: b^n - (1 - b)^2 = 0; its root in (0, 1) is the one wanted.
    coefficients = [0.0] * (n + 1)
    coefficients[0] += 1
    for power, value in ((2, -1), (1, 2), (0, -1)):
        coefficients[n - power] += value
    return coefficients


def _rotation(a: float, b: float) -> Points:
    """A rotation about z by a, then about x by b."""
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return np.asarray(about_x @ about_z)


def hopf_link() -> KnownCurves:
    """``u^2 - v^2``: two circles, each through the other, as every two Villarceau circles are."""
    return _torus_link("hopf-link", 2, 3.0, (1,), 1)


def trefoil() -> KnownCurves:
    """``u^2 - v^3``: one curve, the trefoil knot."""
    return _torus_link("trefoil", 3, 3.2, (), 3)


KNOWN: tuple[Callable[[], KnownCurves], ...] = (
    two_spheres,
    two_cylinders,
    two_isovalues,
    villarceau,
    hydrogen_ring,
    hydrogen_axis,
    hopf_link,
    trefoil,
)


# --- linking, two ways ---------------------------------------------------------------------------


def linking_by_area(one: Points, two: Points) -> float:
    """Gauss's linking integral of two closed polylines, exact for polylines up to rounding [3].

    Two segments contribute the signed area of the spherical quadrilateral that the directions
    from one to the other sweep; the sum over all pairs is 4 pi times the linking number.
    """
    a, b = one[:-1, None], one[1:, None]
    c, d = two[None, :-1], two[None, 1:]
    area = _triangle_area(c - a, d - b, d - a) + _triangle_area(c - a, c - b, d - b)
    return float(area.sum() / (4 * np.pi))


def _triangle_area(u: Points, v: Points, w: Points) -> Points:
    """Signed area of spherical triangles with corners along u, v, w (Van Oosterom, Strackee)."""
    lu, lv, lw = (np.linalg.norm(x, axis=-1) for x in (u, v, w))
    top = np.einsum("...i,...i->...", u, np.cross(v, w))
    dots = [np.einsum("...i,...i->...", p, q) for p, q in ((u, v), (v, w), (w, u))]
    return np.asarray(
        2 * np.arctan2(top, lu * lv * lw + dots[0] * lw + dots[1] * lu + dots[2] * lv)
    )


def linking_by_crossings(one: Points, two: Points) -> float:
    """Half the sum of the signed crossings of two closed polylines in a projection."""
    return float(sum(sign for *_, sign in crossings(one, two)) / 2)


def crossings(one: Points, two: Points) -> list[tuple[float, float, bool, int]]:
    """Where two polylines cross, seen along a generic direction.

    Returns
    -------
    list of (place on one, place on two, whether one is above, sign), places as segment + fraction.
    """
    view = _rotation(0.5437, 1.1319)
    p, q = one @ view.T, two @ view.T
    a, da = p[:-1, None], np.diff(p, axis=0)[:, None]
    b, db = q[None, :-1], np.diff(q, axis=0)[None]
    det = da[..., 0] * db[..., 1] - da[..., 1] * db[..., 0]
    gap = b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (gap[..., 0] * db[..., 1] - gap[..., 1] * db[..., 0]) / det
        t = (gap[..., 0] * da[..., 1] - gap[..., 1] * da[..., 0]) / det
    found = []
    for i, j in np.argwhere((s >= 0) & (s < 1) & (t >= 0) & (t < 1)).tolist():
        above = p[i, 2] + s[i, j] * da[i, 0, 2] > q[j, 2] + t[i, j] * db[0, j, 2]
        found.append(
            (i + s[i, j], j + t[i, j], bool(above), int(np.sign(det[i, j]) * (2 * above - 1)))
        )
    return found


def linking_numbers(curves: Sequence[Points]) -> list[int]:
    """Linking numbers of all pairs of the closed curves, without sign, ascending."""
    loops = [curve for curve in curves if is_closed(curve)]
    return sorted(
        abs(round(linking_by_area(loops[i], loops[j]))) for i in range(len(loops)) for j in range(i)
    )


def knot_determinant(curve: Points) -> int:
    """Determinant of the knot that a closed polyline is: 1 unknot, 3 trefoil [4].

    Arcs run from undercrossing to undercrossing. Each crossing of the over arc with two under
    arcs is the row (2, -1, -1); the determinant is any first minor.
    """
    n = len(curve) - 1
    met = [
        (s, t)
        for s, t, above, _ in crossings(curve, curve)
        if above and 1e-9 < abs(s - t) % n < n - 1e-9 and not _adjacent(s, t, n)
    ]
    if len(met) < 3:
        return 1
    under = np.sort([t for _, t in met])
    rows = np.zeros((len(met), len(met)))
    for row, (over, place) in enumerate(met):
        into = int(np.searchsorted(under, place))
        for arc, weight in (
            (int(np.searchsorted(under, over)) % len(met), 2),
            (into, -1),
            ((into + 1) % len(met), -1),
        ):
            rows[row, arc] += weight
    return abs(round(float(np.linalg.det(rows[1:, 1:]))))


def _adjacent(s: float, t: float, n: int) -> bool:
    """Whether two places are on the same segment of a closed polyline or on neighbours."""
    return (int(s) - int(t)) % n in (0, 1, n - 1)


# --- phase ---------------------------------------------------------------------------------------


def phase_winding(phase: Points, axis: int) -> NDArray[np.int64]:
    """How often the phase turns around each lattice face across `axis`, counterclockwise.

    The sum of the four differences around the face, each wrapped to half a turn either way. A
    nodal line of the wave passes the face as often, net of those that pass the other way.
    """
    u, v = (axis + 1) % 3, (axis + 2) % 3

    def corner(i: int, j: int) -> Points:
        cut = [slice(None)] * 3
        cut[u] = slice(i, phase.shape[u] - 1 + i)
        cut[v] = slice(j, phase.shape[v] - 1 + j)
        return phase[tuple(cut)]

    walk = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), corner(0, 0)]
    steps = [(b - a + np.pi) % (2 * np.pi) - np.pi for a, b in pairwise(walk)]
    return np.asarray(np.rint(np.sum(steps, axis=0) / (2 * np.pi)), np.int64)


# --- distance ------------------------------------------------------------------------------------


def distances(points: Points, curves: Sequence[Points]) -> Points:
    """The distance of each point (N, 3) to the nearest of some polylines, segments included."""
    nearest = np.full(len(points), np.inf)
    for curve in curves:
        a = curve[:-1] if len(curve) > 1 else curve
        d = np.diff(curve, axis=0) if len(curve) > 1 else np.zeros_like(curve)
        square = np.maximum((d**2).sum(axis=1), 1e-300)
        for start in range(0, len(points), 500):
            p = points[start : start + 500, None]
            t = np.clip(((p - a) * d).sum(axis=2) / square, 0, 1)
            gap = np.linalg.norm(p - a - t[..., None] * d, axis=2).min(axis=1)
            nearest[start : start + 500] = np.minimum(nearest[start : start + 500], gap)
    return nearest
