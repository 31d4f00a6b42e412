r"""Ties: samples labelled "equal", so that no triangle is without area and no two points coincide.

Where a sample equals the isovalue, the crossings of up to six lattice edges stand at it. By its
indices the mesh is as good a manifold as ever; by its positions it is none, and triangles between
such crossings have no area. Custodio, Pesco and Silva [1] give such a sample a third label, "=":
it is then itself a vertex of the surface, one for all its edges::

    o - - *=* - - o          o - - - = - - - o        = : sample at the isovalue, o : outside
           *                         |                * : crossings of its edges, drawn a little
           |           ->            |                    off it; a triangle of no area is between
           o                         o                    them, and goes when they are one

That is right where the surface passes the sample once. Where it passes twice (two corners of the
inside meet in a sample, or a plate one sample thick lies at the isovalue), one vertex would join
two sheets that the topology of the samples keeps apart. There, a crossing stays on its lattice edge
and moves off the sample by a small, stated part of the edge, as if the sample were inside by a
little; that is what ``value >= isovalue`` says it is.

"Near" is as good as "equal": what a float puts within a billionth of an edge from a sample makes
triangles as useless. The label is for crossings within `nearness` of the sample, in parts of the
edge. So no vertex on an edge is ever nearer to a sample than that, unless it is the sample; and
greater numbers improve triangles, as in the paper's second half.

Which samples are labelled
--------------------------
All that can be, to begin with: those near which all crossings of their edges lie. Make each one
vertex, look at the quotient, take the label from every sample that has a part in something wrong,
and look again, until nothing is. No order of samples, vertices or triangles comes in. What is wrong
of the quotient is:

- at a labelled sample: the crossings it replaces do not make a disc (V - E + F is not 1), its
  triangles form no fan or several, or none is left;
- at an edge: more than two triangles, or none, or it stands for edges that no strip of triangles
  joins (E - F is not 1);
- two triangles on the same three vertices;
- two edges between labelled samples that have one middle, as the diagonals of a face have, or two
  points inside cells at one place;
- a triangle without area.

Invariants
----------
Where the given mesh is a manifold, the result is one, with the same Euler characteristic: what
becomes one vertex was a disc, what becomes one edge a strip, what becomes one triangle a triangle,
and such a map between surfaces changes nothing (Vietoris and Begle). Each vertex on a lattice edge
is a labelled sample, or at least `nearness` from both ends, so no two of them coincide; nothing has
moved further than `nearness` along its edge. Points inside cells stay, but for those all of whose
neighbours are on edges: they move by the mean of what these do, as a mean of crossings does.

Where all near crossings are ties, no crossing of triangles was found on any field tried with
trilinear cubes (`papers/trilinear/tied.py`); samples that are only nearly tied can make some, since
each crossing moves along its own edge as far, whatever its neighbours do. And a rule may put two of
its own points inside cells at one place: that is not mended here.

Glossary
--------
near        of a crossing: within `nearness` of an end of its edge, in parts of it
group       the crossings near one sample
label       of a sample: its group is one vertex, which stands at the sample; of a vertex: the
            labelled sample whose group it is in, else -1
quotient    the mesh after its groups have become vertices; triangles that lost a corner are gone

References
----------
[1] L. Custodio, S. Pesco, C. Silva, "An extended triangulation to the Marching Cubes 33 algorithm",
    Journal of the Brazilian Computer Society 25:6, 2019. Read in its abstract and introduction: the
    labels are theirs, the rule which samples may have one is ours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from isoref.attributes import only
from isoref.degenerate import degenerate, fans, sides, three_corners
from isoref.field import Booleans, FieldError, Floats, Integers
from isoref.mesh import Mesh, Provenance

#: A thousandth of an edge: far above rounding, far below what is seen.
NEARNESS = 2.0**-10


@dataclass(frozen=True, eq=False)
class Separation:
    """A mesh whose vertices stand apart, and what was done to get it.

    mesh : its provenance names a labelled sample as both ends of its vertex
    labelled : how many samples became vertices
    moved : how many crossings were moved off a sample
    without_area : triangles that still have none; they have a corner inside a cell
    """

    mesh: Mesh
    labelled: int
    moved: int
    without_area: int


def separated(mesh: Mesh, nearness: float = NEARNESS) -> Separation:
    """The mesh with no crossing nearer to a sample than `nearness`, unless it is the sample.

    Parameters
    ----------
    mesh : of triangles, with provenance
    nearness : in parts of a lattice edge, above 0 and at most 1/4

    Raises
    ------
    FieldError
        for other simplices, a mesh without provenance, or another number.

    >>> from isoref import extract
    >>> corner = extract([[[2, 0], [0, -1]], [[0, -1], [-1, -1]]], 0, provenance=True)
    >>> len(corner.vertices), len(corner.simplices), len(np.unique(corner.vertices, axis=0))
    (6, 4, 3)
    >>> separated(corner).mesh.vertices.tolist()
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    """
    if mesh.dimension != 2:
        raise FieldError(f"simplices of dimension {mesh.dimension} are no triangles")
    found = mesh.traced()
    if not 0 < nearness <= 0.25:
        raise FieldError(f"a nearness of {nearness} is not above 0 and at most 1/4 of an edge")

    # See which samples have crossings near, and label all that no other crossing forbids.
    sample = near_samples(found, nearness)
    others = _ends_of_others(found, sample)
    label = np.where(np.isin(sample, others), -1, sample)

    # Take labels away until the quotient is as good as the mesh was.
    while True:
        moved = replace(mesh, vertices=_moved(mesh, sample, label >= 0, nearness))
        target = _representatives(label)
        wrong = np.unique(label[_wrong(moved, target, label)])
        if not (wrong >= 0).any():
            return _separation(moved, sample, label, target, nearness)
        label = np.where(np.isin(label, wrong), -1, label)


def near_samples(found: Provenance, nearness: float) -> Integers:
    """(V,) the sample to which a vertex on an edge is near; -1 where there is none.

    >>> from isoref.field import Field
    >>> row = Field.of([0.0, 1.0, 2.0])
    >>> ends, t = np.array([[0, 1], [1, 2], [0, -1]]), np.array([0.01, 0.5, np.nan])
    >>> near_samples(Provenance(ends, t, np.zeros(0, np.int64), row), 0.1).tolist()
    [0, -1, -1]
    """
    first, second = found.ends.T
    on_edge = second >= 0
    low, high = on_edge & (found.t <= nearness), on_edge & (found.t >= 1 - nearness)
    return np.where(low | (first == second), first, np.where(high, second, -1))


def _ends_of_others(found: Provenance, sample: Integers) -> Integers:
    """The samples on whose edges there is a crossing that is not near them."""
    on_edge = (found.ends[:, 1] >= 0)[:, None]
    return np.unique(found.ends[on_edge & (found.ends != sample[:, None])])


def _representatives(label: Integers) -> Integers:
    """(V,) the first vertex of its label for each labelled vertex; the others for themselves."""
    target = np.arange(len(label))
    labelled = np.flatnonzero(label >= 0)
    _, first, number = np.unique(label[labelled], return_index=True, return_inverse=True)
    target[labelled] = labelled[first][number]
    return target


def _moved(mesh: Mesh, sample: Integers, labelled: Booleans, nearness: float) -> Floats:
    """(V, 3) where the vertices stand: labelled ones at their sample, other near ones off it."""
    found = mesh.traced()
    near = sample >= 0
    at = np.array(np.unravel_index(np.where(near, sample, 0), found.field.shape), np.float64).T
    away = np.where(found.ends[:, 0] == sample, found.ends[:, 1], found.ends[:, 0])
    other = np.array(np.unravel_index(np.where(near, away, 0), found.field.shape), np.float64).T
    index = at + np.where(labelled, 0.0, nearness)[:, None] * (other - at)
    places = mesh.vertices.copy()
    places[near] = found.field.position(index[near]).astype(places.dtype)
    return _followed(mesh, places)


def _followed(mesh: Mesh, places: Floats) -> Floats:
    """The points inside cells that have neighbours on edges only, moved by the mean of these."""
    inside = mesh.traced().ends[:, 1] < 0
    if not inside.any():
        return places
    rows = mesh.simplices[inside[mesh.simplices].any(axis=1)]
    edges = rows[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)
    start, stop = edges[inside[edges[:, 0]]].T
    free = inside.copy()
    free[start[inside[stop]]] = False
    step = np.zeros_like(places)
    np.add.at(step, start, (places - mesh.vertices)[stop])
    count = np.bincount(start, minlength=len(places))[:, None]
    return np.where(free[:, None], places + step / np.maximum(count, 1), places)


def _wrong(mesh: Mesh, target: Integers, label: Integers) -> Integers:
    """Vertices of the quotient that have a part in something wrong; only labelled ones count."""
    touched = mesh.simplices[(label[mesh.simplices] >= 0).any(axis=1)]
    rows = target[touched]
    rows = rows[three_corners(rows)]
    wrong = (
        rows[degenerate(Mesh(mesh.vertices, rows))],
        _repeated(rows),
        _together(mesh, rows),
        _wrong_edges(mesh, target, label, touched),
        _wrong_vertices(target, label, touched, rows),
    )
    return np.concatenate([vertices.ravel() for vertices in wrong])


def _repeated(rows: Integers) -> Integers:
    """The triangles that stand on the three vertices of another."""
    _, number, counts = np.unique(
        np.sort(rows, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    return np.asarray(rows[counts[number.reshape(-1)] > 1])


def _together(mesh: Mesh, rows: Integers) -> Integers:
    """The triangles with a corner where another vertex stands: two points inside cells."""
    used = np.unique(rows)
    _, number, counts = np.unique(
        mesh.vertices[used], axis=0, return_inverse=True, return_counts=True
    )
    met = used[counts[number.reshape(-1)] > 1]
    return np.asarray(rows[np.isin(rows, met).any(axis=1)])


def _wrong_edges(mesh: Mesh, target: Integers, label: Integers, touched: Integers) -> Integers:
    """(.., 2) the edges of the quotient, at a labelled vertex, that are wrong.

    An edge stands for those that map to it, less the triangles that do: 1 for a strip.
    """
    images = np.sort(target[np.unique(sides(touched), axis=0)], axis=1)
    images = images[images[:, 0] != images[:, 1]]
    edges, strip = np.unique(images, axis=0, return_counts=True)

    # Count the triangles that became the edge, and those that are on it.
    rows = np.sort(target[touched], axis=1)
    same = (rows[:, :-1] == rows[:, 1:]).sum(axis=1)
    size = len(target)
    keys = edges[:, 0] * size + edges[:, 1]
    lost = rows[same == 1][:, [0, 2]]
    np.subtract.at(strip, np.searchsorted(keys, lost[:, 0] * size + lost[:, 1]), 1)
    own = rows[same == 0][:, [0, 1, 1, 2, 0, 2]].reshape(-1, 2)
    here, counts = np.unique(own[:, 0] * size + own[:, 1], return_counts=True)
    on_it = np.zeros(len(edges), np.int64)
    on_it[np.searchsorted(keys, here)] = counts

    # Find the edges between two samples that have the middle of another.
    between = np.flatnonzero((label[edges] >= 0).all(axis=1))
    places = np.array(np.unravel_index(label[edges[between]], mesh.traced().field.shape))
    _, number, shared = np.unique(
        places.sum(axis=2).T, axis=0, return_inverse=True, return_counts=True
    )
    crossed = np.zeros(len(edges), np.bool_)
    crossed[between] = shared[number.reshape(-1)] > 1

    at_label = (label[edges] >= 0).any(axis=1)
    return np.asarray(edges[at_label & (crossed | (strip != 1) | (on_it < 1) | (on_it > 2))])


def _wrong_vertices(
    target: Integers, label: Integers, touched: Integers, rows: Integers
) -> Integers:
    """The labelled vertices that stand for no disc, or have not one fan."""
    # V - E + F of each group: a triangle, edge or vertex is in it when all its corners are.
    euler = np.bincount(target[label >= 0], minlength=len(target))
    for simplices, sign in ((np.unique(sides(touched), axis=0), -1), (touched, 1)):
        images = target[simplices]
        within = (images == images[:, :1]).all(axis=1)
        euler += sign * np.bincount(images[within, 0], minlength=len(target))
    labelled = np.unique(target[label >= 0])
    number = fans(rows, len(target))
    return np.asarray(labelled[(euler[labelled] != 1) | (number[labelled] != 1)])


def _separation(
    mesh: Mesh, sample: Integers, label: Integers, target: Integers, nearness: float
) -> Separation:
    """The quotient, its provenance, and what was done."""
    found, labelled = mesh.traced(), label >= 0
    moved = (sample >= 0) & ~labelled & (found.ends[:, 0] != found.ends[:, 1])
    t = np.where(moved, np.where(found.ends[:, 0] == sample, nearness, 1 - nearness), found.t)
    ends = np.where(labelled[:, None], sample[:, None], found.ends)
    origin = replace(found, ends=ends, t=np.where(labelled, 0.0, t))
    rows = target[mesh.simplices].astype(mesh.simplices.dtype)
    apart = only(Mesh(mesh.vertices, rows, origin), three_corners(rows))
    count = len(np.unique(label[labelled]))
    return Separation(apart, count, int(moved.sum()), int(degenerate(apart).sum()))
