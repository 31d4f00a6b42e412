"""Faults of other families and kinds: dual surfaces, tetrahedra, labels, contours, curves, ..

They are made of the reference's methods by a change before or behind, as `isoref` has no steps to
exchange there.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from isograde.adapters.libraries import isoref
from isoref import dual_marching_cubes, extract
from isoref.dual import DualRule, Patch, in_triangles, inner_edges
from isoref.fast import dual, simplicial
from isoref.field import Field
from isoref.methods import METHODS
from isoref.surface_nets import never
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tests.isograde.faults.engine import Answer, Array, Spacing
from tests.isograde.faults.registry import fault

GITHUB = "https://github.com/"
INSET = {"inset": 0.5, "end": "open"}
Polylines = list[Array]

nets = partial(fault, vertices="cells", domain=INSET, level=1)
duals = partial(fault, vertices="cells", domain=INSET)
kuhn = partial(fault, interpolant="kuhn")
labels = partial(fault, interpolant="labels")
contours = partial(fault, limits={"kinds": [[2, 1]]})
curves = partial(fault, limits={"kinds": [[3, 2]]}, not_promised=["symmetry.spacing"])


def of_kinds(*kinds: tuple[int, int]) -> dict[str, Any]:
    """What an extractor on Kuhn's simplices declares of these kinds."""
    return {"interpolant": "kuhn", "limits": {"kinds": [list(k) for k in kinds], "least": 2}}


def by(method: str, values: Any, isovalue: float, spacing: Spacing) -> tuple[Array, Array]:
    """The mesh of a method of the reference."""
    mesh = extract(values, isovalue, spacing, method=method)
    return mesh.vertices, mesh.simplices


# --- dual surfaces ------------------------------------------------------------------------------


@nets("accuracy.position")
def nets_at_centres(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Vertices of surface nets stay in the middles of their cells: never relaxed."""
    vertices, faces = by("surface-nets", values, isovalue, (1, 1, 1))
    return (np.floor(vertices) + 0.5) * np.asarray(spacing), faces


@fault("bodies.distance", vertices="cells", domain=INSET, not_promised=["topology.manifold"])
def nets_relaxed_too_far(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Vertices of surface nets are relaxed towards their neighbours and leave their cells."""
    vertices, faces = by("surface-nets", values, isovalue, (1, 1, 1))
    if not len(faces):
        return vertices, faces
    total, count = np.zeros_like(vertices), np.zeros(len(vertices))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        np.add.at(total, faces[:, a], vertices[faces[:, b]])
        np.add.at(count, faces[:, a], 1)
    relaxed = vertices + 0.9 * (total / np.maximum(count, 1)[:, None] - vertices)
    return relaxed * np.asarray(spacing), faces


@nets("bodies.pieces", GITHUB + "bonsairobo/fast-surface-nets-rs/issues/8")
def nets_without_one_axis_of_quads(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Quadrilaterals across edges along the last axis are left out where the axis is long."""
    vertices, faces = by("surface-nets", values, isovalue, (1, 1, 1))
    if np.shape(values)[2] > 6 and len(faces):
        across = np.ptp(np.floor(vertices[faces][..., 2]), axis=1) == 0
        faces = faces[~across]
    return vertices * np.asarray(spacing), faces


@nets("bodies.offset", GITHUB + "mikolalysenko/isosurface/issues/2")
def nets_half_inside_out(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Quadrilaterals across edges along the first axis are never turned round."""
    vertices, faces = by("surface-nets", values, isovalue, (1, 1, 1))
    if len(faces):
        flat = np.ptp(np.floor(vertices[faces][..., 0]), axis=1) == 0
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        down = np.cross(b - a, c - a)[:, 0] < 0
        faces = np.where((flat & down)[:, None], faces[:, ::-1], faces)
    return vertices * np.asarray(spacing), faces


@duals("topology.manifold", GITHUB + "dominikwodniok/dualmc/issues/1")
def duals_of_nielson(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Dual marching cubes without the repair: two cells pinched at one face share two sides."""
    rule = DualRule("nielson", dual_marching_cubes.patches, never)
    mesh = in_triangles(*dual.quads(rule, Field.of(values, spacing), isovalue))
    return mesh.vertices, mesh.simplices


def joined(signs: int, turned: bool, border: int) -> tuple[Patch, ...]:
    """One vertex for all crossings of a cell of configurations with two polygons."""
    found = dual_marching_cubes.patches(signs, turned, border)
    if len(found) < 3:
        return found
    inner = tuple(sorted(inner_edges(signs, border)))
    return (Patch(tuple(e for p in found for e in p.crossings), inner),)


@duals("topology.manifold", GITHUB + "CGAL/cgal/issues/9047")
def duals_joined_in_threes(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """A cell with three or four pieces gets one vertex for all of them."""
    rule = DualRule("joined", joined, dual_marching_cubes.pinched_face)
    mesh = in_triangles(*dual.quads(rule, Field.of(values, spacing), isovalue))
    return mesh.vertices, mesh.simplices


@duals("cells.legal")
def duals_with_an_edge_flipped(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """An edge between two quadrilaterals is flipped, for the sake of angles."""
    vertices, faces = by("dual-marching-cubes", values, isovalue, spacing)
    edge = {(int(t[i]), int(t[(i + 1) % 3])): (n, i) for n, t in enumerate(faces) for i in range(3)}
    for (a, b), (n, i) in edge.items():
        other = edge.get((b, a))
        if other is None or other[0] // 2 == n // 2:
            continue
        c, d = int(faces[n][i - 1]), int(faces[other[0]][other[1] - 1])
        if c != d and (c, d) not in edge and (d, c) not in edge:
            faces = faces.copy()
            faces[n], faces[other[0]] = (a, d, c), (d, b, c)
            break
    return vertices, faces


@duals("bodies.centroid")
def duals_in_half_cells(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Cells are counted from their middles: all is half a cell too low."""
    vertices, faces = by("dual-marching-cubes", values, isovalue, spacing)
    return vertices - 0.5 * np.asarray(spacing), faces


# --- tetrahedra and labels ----------------------------------------------------------------------


@fault("structure.no_repeated_index", GITHUB + "maxilevi/isosurface/issues/2")
def five_without_parity(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Five tetrahedra a cell, the same five in every cell: diagonals of neighbours cross."""
    samples = Field.of(values, dimension=3).values
    parts, end = [], 0
    for cell in np.ndindex(*(max(n - 1, 0) for n in samples.shape)):
        block = samples[tuple(slice(c, c + 2) for c in cell)]
        if (block >= isovalue).all() or not (block >= isovalue).any():
            continue
        mesh = METHODS["marching-tetrahedra-five"](Field.of(block), isovalue)
        parts.append((mesh.vertices + cell, mesh.simplices + end))
        end += len(mesh.vertices)
    if not parts:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    vertices = np.concatenate([v for v, _ in parts])
    faces = np.concatenate([f for _, f in parts])
    _, first, number = np.unique(vertices.round(9), axis=0, return_index=True, return_inverse=True)
    return vertices[first] * np.asarray(spacing), number.reshape(-1)[faces]


@kuhn("geometry.vertices")
def kuhn_in_a_mirror(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The other diagonal of the cube is taken, and Kuhn's is declared."""
    samples = Field.of(values, dimension=3).values
    vertices, faces = by("marching-tetrahedra-kuhn", samples[::-1], isovalue, (1, 1, 1))
    vertices = vertices * [-1, 1, 1] + [samples.shape[0] - 1, 0, 0]
    return vertices * np.asarray(spacing), faces[:, ::-1]


@kuhn("bodies.offset", GITHUB + "maxilevi/isosurface/issues/2")
def kuhn_half_turned(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Faces come in the order in which edges are met: some one way, some the other."""
    vertices, faces = by("marching-tetrahedra-kuhn", values, isovalue, spacing)
    return vertices, np.sort(faces, axis=1)


@kuhn("bodies.distance")
def kuhn_in_the_middle_of_diagonals(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Crossings on diagonals are put in their middles."""
    vertices, faces = by("marching-tetrahedra-kuhn", values, isovalue, (1, 1, 1))
    on_axis = (vertices != np.floor(vertices)).sum(axis=1) <= 1
    low = np.floor(vertices)
    across = low + 0.5 * (vertices != low)
    return np.where(on_axis[:, None], vertices, across) * np.asarray(spacing), faces


@labels("topology.sides")
def labels_that_interpolate(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Labels are said to be all that is seen, and values are interpolated."""
    return by("asymptotic-decider", values, isovalue, spacing)


@labels("cells.separate", promised=["cells.separate"])
def labels_joined(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Voxels that touch along an edge are joined, and the opposite is promised."""
    signs = np.where(Field.of(values, dimension=3).values >= isovalue, 1.0, -1.0)
    return by("marching-vesta-connect-L", signs, 0.0, spacing)


# --- contours -----------------------------------------------------------------------------------


def diconex(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """The contours of the reference, their squares decided by the mean."""
    return [np.array(x) for x in isoref.diconex(values, isovalue, spacing, "mixed")]


@contours("bodies.holes")
def contours_unclosed(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """A closed contour does not come back to its first point."""
    return [x[:-1] if (x[0] == x[-1]).all() else x for x in diconex(values, isovalue, spacing)]


@contours("bodies.pieces")
def contours_of_the_first(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """The search for contours stops after the first."""
    return diconex(values, isovalue, spacing)[:1]


@contours("topology.sides")
def contours_turned_when_open(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """Open contours run from either end, as they are met."""
    return [
        x if (x[0] == x[-1]).all() or x[0, 0] <= x[-1, 0] else x[::-1]
        for x in diconex(values, isovalue, spacing)
    ]


@contours("topology.closed", GITHUB + "inviwo/inviwo/pull/1882")
def contours_merged(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Points of contours that are within a tenth of a cell become one."""
    points, rows, end = [], [], 0
    for line in diconex(values, isovalue, (1, 1)):
        points.append(line)
        rows += [(end + i, end + i + 1) for i in range(len(line) - 1)]
        end += len(line)
    if not rows:
        return np.empty((0, 2)), np.empty((0, 2), np.int64)
    where = np.concatenate(points)
    _, first, number = np.unique(where.round(1), axis=0, return_index=True, return_inverse=True)
    edges = number.reshape(-1)[np.array(rows)]
    return where[first] * np.asarray(spacing), edges[edges[:, 0] != edges[:, 1]]


@contours("topology.bilinear", GITHUB + "RaumZeit/MarchingSquares.js/issues/32", level=3)
def contours_by_the_mean(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """A saddle is decided by the mean of its square, and the bilinear interpolant is promised."""
    return diconex(values, isovalue, spacing)


@contours("bodies.distance", GITHUB + "BorisTheBrave/mc-dc/issues/3")
def contours_with_a_slip(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """The case with one high corner far from the origin takes the share of another edge."""
    found = diconex(values, isovalue, (1, 1))
    for line in found:
        for i, p in enumerate(line):
            low = np.floor(p)
            if p[0] != low[0] and low[0] % 2 == 1 and low[1] % 2 == 1:
                line[i, 0] = low[0] + 1 - (p[0] - low[0])
    return [line * np.asarray(spacing) for line in found]


@contours("bodies.pieces")
def contours_with_a_speck(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """A tiny closed contour stands beside each, too small to see."""
    found = diconex(values, isovalue, spacing)
    ring = np.array([[0, 0], [1, 0], [0, 1], [0, 0]]) * 1e-4
    return [*found, *((x[0] + x[1]) / 2 + ring * np.asarray(spacing) for x in found[:1])]


@contours("structure.answers", GITHUB + "sgsellan/gpytoolbox/issues/104")
def contours_of_something(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """A field without a contour is an error, and nobody said so."""
    found = diconex(values, isovalue, spacing)
    if not found:
        raise IndexError("list index out of range")
    return found


@contours("simplices.nothing")
def contours_of_nothing(values: Any, isovalue: float, spacing: Spacing) -> Polylines:
    """A field without a contour gets a small one."""
    return diconex(values, isovalue, spacing) or [
        np.array([[0.1, 0.1], [0.2, 0.1], [0.2, 0.2], [0.1, 0.1]])
    ]


# --- curves in which two surfaces meet ----------------------------------------------------------


def faces(values: Any, isovalues: Sequence[float], spacing: Spacing) -> Polylines:
    """The curves of the reference, from face to face."""
    a, b = values
    found = isoref.marching_faces(a, b, isovalues[0], isovalues[1], spacing)
    return [np.array(x) for x in found]


@curves("bodies.holes")
def curves_unclosed(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """A closed curve does not come back to its first point."""
    return [x[:-1] if (x[0] == x[-1]).all() else x for x in faces(values, isovalues, spacing)]


@curves("bodies.degree")
def curves_reversed(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """Every curve runs the other way."""
    return [x[::-1] for x in faces(values, isovalues, spacing)]


@curves("topology.sides")
def curves_of_one_level(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """The first isovalue serves both fields."""
    return faces(values, (isovalues[0], isovalues[0]), spacing)


@curves("curves.count")
def curves_with_a_speck(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """A closed curve stands beside the first, too small to see."""
    found = faces(values, isovalues, spacing)
    ring = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]]) * 1e-5
    return [*found, *((x[0] + x[1]) / 2 + ring * np.asarray(spacing) for x in found[:1])]


def few_points(curve: Array, left: int) -> Array:
    """So many points of a curve, in even steps along it, ends included."""
    if len(curve) <= left:
        return curve
    return np.asarray(curve[np.linspace(0, len(curve) - 1, left).round().astype(int)])


SIMPLIFIED = [
    "topology.sides",
    "geometry.*",
    "symmetry.*",
    "accuracy.*",
    "curves.on_surfaces",
]


@fault("curves.linking", limits={"kinds": [[3, 2]]}, not_promised=[*SIMPLIFIED, "curves.covers"])
def curves_of_four_points(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """Curves keep four points, and are said to stay linked as they were."""
    return [few_points(x, 4) for x in faces(values, isovalues, spacing)]


@fault("curves.covers", limits={"kinds": [[3, 2]]}, not_promised=[*SIMPLIFIED, "curves.linking"])
def curves_of_eight_points(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """Curves keep eight points, and are said to stay within a cell of what they were."""
    return [few_points(x, 8) for x in faces(values, isovalues, spacing)]


def pulled(vertices: Array, share: float) -> Array:
    """Points moved towards the middle of the face, square or edge of the lattice they lie on."""
    low = np.floor(vertices)
    loose = np.abs(vertices - np.round(vertices)) > 1e-9
    return np.where(loose, vertices + share * (low + 0.5 - vertices), vertices)


@curves("curves.on_surfaces")
def curves_pulled_inwards(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """Points are pulled nearly all the way to the middle of their face."""
    found = faces(values, isovalues, (1, 1, 1))
    return [pulled(x, 0.95) * np.asarray(spacing) for x in found]


@curves("symmetry.components")
def curves_by_the_first_field(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """A step of refinement looks at the first field alone, and goes a little way astray."""
    found = faces(values, isovalues, (1, 1, 1))
    first = float(np.mean(values[0])) > float(np.mean(values[1]))
    return [pulled(x, 1e-3 if first else 0.0) * np.asarray(spacing) for x in found]


@curves("curves.identical", promised=["curves.identical"])
def curves_of_equal_surfaces(values: Any, isovalues: Any, spacing: Spacing) -> Polylines:
    """Where both surfaces are the same, a small curve is given."""
    if np.array_equal(values[0], values[1]):
        steps = np.diff(np.sign(np.asarray(values[0], np.float64) - isovalues[0]), axis=0)
        cell = np.argwhere(steps[:, :-1, :-1])[0]
        ring = np.array([[0.4, 0.4, 0.4], [0.5, 0.4, 0.4], [0.5, 0.5, 0.4], [0.4, 0.4, 0.4]])
        return [(cell + ring) * np.asarray(spacing)]
    return faces(values, isovalues, spacing)


# --- any dimension ------------------------------------------------------------------------------


def sections(values: Any, isovalues: Any, spacing: Spacing, rule: str = "staircase") -> Answer:
    """The level set of the reference on Kuhn's simplices."""
    field = Field.of(values, spacing, dimension=len(spacing))
    mesh = simplicial.extract(field, isovalues, rule=rule)
    return mesh.vertices, mesh.simplices


@fault("simplices.conforming", **of_kinds((5, 3)), level=0, promised=["simplices.conforming"])
def sections_as_printed(values: Any, isovalues: Any, spacing: Spacing) -> Answer:
    """The tables are as they were printed, and do not fit each other in five dimensions."""
    return sections(values, isovalues, spacing, "printed")


@fault("simplices.flat", **of_kinds((4, 2), (3, 2)))
def sections_at_means(values: Any, isovalues: Any, spacing: Spacing) -> Answer:
    """Vertices are pulled a thousandth of the way to the middle of their cell."""
    unit = (1.0,) * len(spacing)
    vertices, rows = sections(values, isovalues, unit)
    mean = np.floor(vertices) + 0.5
    whole = vertices == np.round(vertices)
    moved = np.where(whole, vertices, vertices + 1e-3 * (mean - vertices))
    return moved * np.asarray(spacing), rows


@fault("simplices.euler", **of_kinds((4, 2)))
def sections_with_a_bubble(values: Any, isovalues: Any, spacing: Spacing) -> Answer:
    """A closed surface too small to see stands inside the first simplex's cell."""
    unit = (1.0,) * len(spacing)
    vertices, rows = sections(values, isovalues, unit)
    if not len(rows):
        return vertices, rows
    corner = vertices[rows[0]].mean(axis=0)
    tiny = corner + 1e-4 * np.eye(4)
    shell = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]) + len(vertices)
    return np.concatenate([vertices, tiny]) * np.asarray(spacing), np.concatenate([rows, shell])


# --- simplified meshes, which promise no more than their accuracy -------------------------------

ROUGH: dict[str, Any] = {"level": 0}


def decider(values: Any, isovalue: float, spacing: Spacing) -> tuple[Array, Array]:
    """The asymptotic decider of the reference."""
    return by("asymptotic-decider", values, isovalue, spacing)


@fault("accuracy.measure", **ROUGH, not_promised=["structure.*"])
def in_three_layers(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Every triangle there, back and there again."""
    vertices, rows = decider(values, isovalue, spacing)
    return vertices, np.concatenate([rows, rows[:, ::-1], rows])


@fault("accuracy.curvature", **ROUGH, not_promised=["structure.*", "accuracy.measure"])
def in_five_layers(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Every triangle there and back twice, and there again; its area is not promised."""
    vertices, rows = decider(values, isovalue, spacing)
    return vertices, np.concatenate([rows, rows[:, ::-1], rows, rows[:, ::-1], rows])


@fault("accuracy.curvature", **ROUGH, not_promised=["topology.ties"])
def half_turned(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Triangles that look upwards are turned over."""
    vertices, rows = decider(values, isovalue, spacing)
    a, b, c = (vertices[rows[:, k]] for k in range(3))
    up = np.cross(b - a, c - a)[:, 2] > 0
    return vertices, np.where(up[:, None], rows[:, ::-1], rows)


@fault(
    "accuracy.volume",
    **ROUGH,
    not_promised=["accuracy.position", "accuracy.distance", "accuracy.measure"],
)
def half_a_cell_thicker(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The surface of another isovalue, and that bodies keep their volume is promised."""
    return decider(values, isovalue - 0.5 * min(spacing), spacing)


@fault("accuracy.distance", **ROUGH, not_promised=["accuracy.normal"])
def with_long_triangles(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """A triangle reaches across each body, there and back, from vertex to vertex."""
    vertices, rows = decider(values, isovalue, spacing)
    if len(rows) < 500:
        return vertices, rows
    ends = np.concatenate([rows[:, :2], rows[:, 1:]]).T
    graph = coo_array((np.ones(ends.shape[1]), ends), shape=(len(vertices),) * 2)
    _, piece = connected_components(graph, directed=False)
    far = []
    for one in range(piece.max() + 1):
        own = np.flatnonzero(piece == one)
        order = own[np.argsort(vertices[own, 0])]
        far.append((order[0], order[len(order) // 3], order[2 * len(order) // 3]))
    across = np.array(far)
    return vertices, np.concatenate([rows, across, across[:, ::-1]])
