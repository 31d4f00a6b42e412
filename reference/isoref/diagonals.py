r"""Which diagonal: the triangles of a cell, turned by a criterion on the values.

Marching cubes cuts a polygon of four or more points into triangles by a table, which does not look
at where the points lie. Nielson and Hamann remark that the diagonal of a quadrilateral could be
"switched", that whether this is desirable "depends on the values F_ijk and exactly where the
vertices lie on the edges", and name Choi's criterion. Here are three, each applied edge by edge::

        a                 a         the edge a b has the triangles a b c and b a d; the other
       /|\               / \        diagonal of the quadrilateral is c d, with the triangles
      c | d      or     c---d       c d b and d c a
       \|/               \ /
        b                 b

`smooth`    the two triangles whose normals make the smaller angle (Choi and others, as Dyn, Levin
            and Rippa describe it)
`angle`     the two triangles whose smallest angle is the larger (Delaunay's, in the plane)
`near`      the diagonal whose middle is nearer to the level set of the trilinear interpolant, by
            one step of Newton's method: as many triangles as before, nearer to what they stand for.
            Cells with a point of the rule's own inside stay as they are: there turned triangles
            could cross others

Only edges inside a cell are turned: what is drawn on the faces between cells stays as the rule has
decided it, and so does the topology.

Glossary
--------
worth       of two triangles: what the criterion wants large
inner       of an edge: not on a face of its cell; only such edges may come or go

Invariants
----------
Vertices are those of the rule, in the same order; each cell has as many triangles as before, with
the same boundary; no new edge lies on a face of the cell, or joins ends that are joined already.
Each edge is turned at most once, in an order that depends on the mesh alone.

References
----------
[1] Nielson, Hamann, Visualization 1991, section 3, configuration 3.
[2] Choi, Shin, Yoon, Lee, "Triangulation of scattered data in 3D space", CAD 20(5), 1988. Its text
    was not at hand; the criterion is given as [3] gives it.
[3] Dyn, Levin, Rippa, "Data dependent triangulations for piecewise linear interpolation", IMA J.
    Numer. Anal. 10, 1990: the angle between normals.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, get_args

import numpy as np

from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh, in_space
from isoref.rule import Rule

Criterion = Literal["smooth", "angle", "near"]
Triangle = tuple[int, int, int]
Worth = Callable[[Floats], float]


@in_space
def extract(rule: Rule, field: Field, isovalue: float, criterion: Criterion = "smooth") -> Mesh:
    """The rule's surface with its diagonals chosen by the criterion.

    Parameters
    ----------
    rule : a cube rule
    field, isovalue : as of `isoref.sweep.sweep`
    criterion : ``smooth``, ``angle`` or ``near``

    Raises
    ------
    ValueError
        for a criterion that is none of these
    FieldError
        for a field or an isovalue that cannot be swept

    >>> from isoref.asymptotic_decider import RULE
    >>> field = Field.of(np.indices((3, 3, 3)).sum(axis=0) - 2.5)
    >>> extract(RULE, field, 0.0)
    Mesh(15 vertices in R^3, 16 simplices of dimension 2)
    """
    if criterion not in get_args(Criterion):
        raise ValueError(f"no criterion {criterion!r}; there are {', '.join(get_args(Criterion))}")
    mesh = sweep(rule, field, isovalue, provenance=True)
    cells = mesh.traced().cells
    if not len(cells):
        return mesh
    triangles = mesh.simplices.copy()
    place = field.index(mesh.vertices)
    worth = partial(nearness, field, isovalue) if criterion == "near" else WORTH[criterion]
    starts = np.flatnonzero(np.r_[True, cells[1:] != cells[:-1]])
    lattice = tuple(n - 1 for n in field.shape)
    for start, stop in zip(starts, [*starts[1:], len(cells)], strict=True):
        if stop - start > 1:
            low = np.array(np.unravel_index(cells[start], lattice))
            own = _Cell(mesh.vertices, place - low, triangles[start:stop])
            if criterion != "near" or not own.has_points_inside():
                triangles[start:stop] = own.turned(worth)
    return Mesh(mesh.vertices, triangles)


def smoothness(corners: Floats) -> float:
    """The cosine between the right-hand normals of two triangles (2, 3, 3); -1 without area.

    >>> smoothness(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]]))
    1.0
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    return float(normals[0] @ normals[1] / sizes.prod()) if sizes.all() else -1.0


def smallest_angle(corners: Floats) -> float:
    """The smallest angle of two triangles (2, 3, 3), in radians; 0 without area.

    >>> corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> bool(np.isclose(smallest_angle(corners), np.pi / 4))
    True
    """
    least = np.pi
    for c in range(3):
        u = corners[:, (c + 1) % 3] - corners[:, c]
        v = corners[:, (c + 2) % 3] - corners[:, c]
        across = np.linalg.norm(np.cross(u, v), axis=1)
        least = min(least, float(np.arctan2(across, (u * v).sum(axis=1)).min()))
    return least


def nearness(field: Field, isovalue: float, corners: Floats) -> float:
    """Minus how far the middle of the side that two triangles (2, 3, 3) share is off the level set.

    The side runs from the first corner of the first triangle to its second. The distance is that
    of one Newton step in the cell the middle lies in.

    >>> field = Field.of(np.indices((2, 2, 2)).sum(axis=0) - 1.0)
    >>> side = np.array([[0.5, 0, 0], [0.5, 0, 0], [1, 1, 1]])
    >>> round(nearness(field, 0.0, np.array([side, side])) * 3**0.5, 9)
    -0.5
    """
    middle = field.index(corners[0, :2].mean(axis=0))
    low = np.clip(np.floor(middle).astype(int), 0, np.array(field.shape) - 2)
    values = field.values[tuple(slice(i, i + 2) for i in low)].astype(np.float64) - isovalue
    t = middle - low
    weights = np.stack([1 - t, t])

    # Interpolate along all axes, or all but one and take the difference along that.
    value = float(np.einsum("ijk,i,j,k", values, *weights.T))
    slope = [
        np.einsum("ijk,i,j,k", values, *(np.array([-1.0, 1]) if a == axis else weights[:, a]
                                         for a in range(3)))
        for axis in range(3)
    ]  # fmt: skip
    steepness = float(np.linalg.norm(np.array(slope) / field.spacing))
    return -abs(value) / steepness if steepness else -np.inf


WORTH: dict[str, Worth] = {"smooth": smoothness, "angle": smallest_angle}


class _Cell:
    """The triangles of one cell.

    points : (V, 3) the vertices of the mesh
    place : (V, 3) where they stand in coordinates of the cell, 0 .. 1 for its own
    triangles : (t, 3)
    """

    def __init__(self, points: Floats, place: Floats, triangles: np.ndarray) -> None:
        self.points, self.place = points, place
        self.triangles: list[Triangle] = [tuple(row) for row in triangles.tolist()]

    def has_points_inside(self) -> bool:
        """Whether a corner of a triangle lies on no face of the cell."""
        own = self.place[sorted({corner for t in self.triangles for corner in t})]
        return bool((np.abs(own[:, :, None] - [0.0, 1.0]) >= 1e-9).all(axis=(1, 2)).any())

    def turned(self, worth: Worth) -> list[Triangle]:
        """The triangles after every inner edge was looked at once, in ascending order."""
        for edge in sorted({tuple(sorted(pair)) for t in self.triangles for pair in _sides(t)}):
            self._turn(edge[0], edge[1], worth)
        return self.triangles

    def _turn(self, a: int, b: int, worth: Worth) -> None:
        """The edge a b replaced by the other diagonal, where that is allowed and worth more."""
        at = [i for i, t in enumerate(self.triangles) if a in t and b in t]
        if len(at) != 2 or self._on_a_face(a, b):
            return
        # Name the corners so that the first triangle runs a, b, c and the second b, a, d.
        first, second = (self.triangles[i] for i in at)
        if (a, b) not in _sides(first):
            a, b = b, a
        (c,), (d,) = set(first) - {a, b}, set(second) - {a, b}
        here = any({c, d} <= set(t) for t in self.triangles)
        if (b, a) not in _sides(second) or c == d or here or self._on_a_face(c, d):
            return
        # Compare both ways to cut the quadrilateral a, d, b, c.
        now, then = [(a, b, c), (b, a, d)], [(c, d, b), (d, c, a)]
        if worth(self.points[then]) > worth(self.points[now]):
            self.triangles[at[0]], self.triangles[at[1]] = then

    def _on_a_face(self, p: int, q: int) -> bool:
        """Whether both points lie on one face of the cell."""
        near = np.abs(self.place[[p, q]][:, :, None] - [0.0, 1.0]) < 1e-9
        return bool(near.all(axis=0).any())


def _sides(triangle: Triangle) -> list[tuple[int, int]]:
    """The directed sides of a triangle."""
    a, b, c = triangle
    return [(a, b), (b, c), (c, a)]
