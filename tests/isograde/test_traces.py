"""Traces of a mesh in the cells, and which are legal, beside counts from other sources."""

import mcubes
import numpy as np
import pytest
from isograde.oracles.flat import OUTSIDE, WALL
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import (
    CORNERS,
    FACES,
    NODES,
    _rows,
    alike,
    legal,
    polygons,
    segments_on,
    traces,
)
from isoref.field import Field
from skimage import measure


def test_every_face_has_four_nodes_and_six_pairs() -> None:
    """Twelve nodes, each on two faces."""
    assert len(NODES) == 12
    assert all(len(segments_on(face)) == 6 for face in FACES)


def test_a_legal_trace_meets_every_crossed_edge_once() -> None:
    """Each crossed edge is an end of exactly one segment of each of its faces; no other is."""
    for signs, faces in enumerate(legal()):
        inside = {c for bit, c in enumerate(CORNERS) if signs >> bit & 1}
        for (axis, side), pair in zip(FACES, faces, strict=True):
            for code in pair:
                ends = [
                    p
                    for s, segment in enumerate(segments_on((axis, side)))
                    if code >> s & 1
                    for p in segment
                ]
                crossed = [
                    p
                    for p in NODES
                    if p[axis] == side
                    and len({tuple(e if x == 1 else x for x in p) for e in (0, 2)} & inside) == 1
                ]
                assert sorted(ends) == sorted(crossed)


def test_complementary_cells_swap_separated_and_joined() -> None:
    """Exchanging inside and outside exchanges the two legal traces of an ambiguous face."""
    table = legal()
    assert np.array_equal(table[::-1, :, ::-1], table)


def test_resolutions_have_the_cycle_lengths_of_vesta() -> None:
    """Separated everywhere, the 256 cells have 144, 66, 72, 52, 24 cycles of 3 to 7 nodes.

    Schlei's Figure 15 and Table I: either global mode gives these numbers of cycles.
    """
    table = legal()
    total, nodes = 0, 0
    for signs in range(256):
        for mode in (0, 1):
            code = sum(int(table[signs, f, mode]) << 6 * f for f in range(6))
            total += polygons(code)
            nodes += code.bit_count()
    assert total == 2 * (144 + 66 + 72 + 52 + 24)
    assert nodes == 2 * (3 * 144 + 4 * 66 + 5 * 72 + 6 * 52 + 7 * 24)


@pytest.mark.parametrize("seed", range(3))
def test_the_peers_are_legal_and_keep_their_polarity(seed: int) -> None:
    """PyMCubes joins the inside corners, skimage's lorensen separates them, lewiner does both."""
    field = Field.of(np.random.default_rng(seed).normal(size=(6, 7, 8)))
    lattice = Lattice.of(field, (0.0,))
    mixed = measure.marching_cubes(field.values, 0.0)[:2]
    apart = measure.marching_cubes(field.values, 0.0, method="lorensen")[:2]
    together = mcubes.marching_cubes(field.values, 0.0)
    for mesh, choices in ((together, (False, True)), (apart, (True, False)), (mixed, (True, True))):
        places = lattice.index(np.asarray(mesh[0], float))
        found = traces(lattice, places, np.asarray(mesh[1], np.int64))
        judged = ~found.tied
        assert (found.separated | found.joined)[judged].all()
        seen = [bool((x & found.ambiguous)[judged].any()) for x in (found.separated, found.joined)]
        assert tuple(seen) == choices


def test_a_triangle_that_spans_cells_is_found() -> None:
    """No cell contains it."""
    lattice = Lattice.of(Field.of(np.random.default_rng(0).normal(size=(4, 4, 4))), (0.0,))
    places = np.array([[0.5, 0, 0], [2.5, 0, 0], [0, 0.5, 0]])
    assert traces(lattice, places, np.array([[0, 1, 2]])).spanning.tolist() == [0]


def test_a_flat_triangle_belongs_to_either_side() -> None:
    """A cell is legal with a triangle in its face, as one of the two cells there."""
    values = np.array([[[1.0, -1], [-1, 1]], [[-1.0, -1], [-1, -1]], [[-1.0, -1], [-1, -1]]])
    field = Field.of(values)
    lattice = Lattice.of(field, (0.0,))
    places = np.array([[0, 0.5, 0], [0, 0, 0.5], [0, 1, 0.5], [0, 0.5, 1]])
    found = traces(lattice, places, np.array([[0, 1, 2]]))
    assert found.code[0] == 0
    assert found.lying.triangle.tolist() == [0]
    assert found.lying.below.tolist() == [WALL]
    assert found.lying.above.tolist() == [0]


def test_a_flat_triangle_is_seen_from_both_sides_alike() -> None:
    """The same pairs in the same order, on the upper face of one cell and the lower of the next."""
    values = np.random.default_rng(0).normal(size=(2, 2, 3))
    values[..., 1] = [[1, -1], [-1, 1]]
    lattice = Lattice.of(Field.of(values), (0.0,))
    places = np.array([[0, 0.5, 1], [0.5, 0, 1], [1, 0.5, 1], [0.5, 0.5, 0.5], [0.5, 0.5, 1.5]])
    inner = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 4], [1, 2, 4], [2, 0, 4]]
    found = traces(lattice, places, np.array([[0, 1, 2], *inner]))
    lower, upper = (int(code) for code in found.code)
    assert upper.bit_count() == 3
    assert lower == upper << 6
    assert found.lying.bits.tolist() == [upper >> 24]


def test_what_lies_outside_the_volume_is_not_looked_at() -> None:
    """Triangles in the cells beyond each side, where flat indices would wrap, and their middles."""
    values = np.random.default_rng(0).normal(size=(4, 4, 4))
    lattice = Lattice.of(Field.of(values), (0.0,))
    points, faces = measure.marching_cubes(values, 0.0)[:2]
    places, faces = lattice.index(points.astype(float)), faces.astype(np.int64)
    alone = traces(lattice, places, faces)
    corner = np.array([[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5], [0.3, 0.3, 0.3]])
    for shift in (*-np.eye(3), *3 * np.eye(3)):
        more = np.concatenate([places, corner + shift])
        triangles = np.array([[0, 1, 2], [0, 1, 3]]) + len(places)
        found = traces(lattice, more, np.concatenate([faces, triangles]))
        assert np.array_equal(found.code, alone.code)
        assert np.array_equal(found.triangles, alone.triangles)
        assert np.array_equal(found.extra, alone.extra)


def test_the_eight_cells_at_a_tied_sample_are_tied() -> None:
    """Whichever of their corners it is."""
    values = np.random.default_rng(0).normal(size=(5, 5, 5))
    values[1, 2, 3] = 0.0
    lattice = Lattice.of(Field.of(values), (0.0,))
    found = traces(lattice, np.empty((0, 3)), np.empty((0, 3), np.int64))
    beside = (abs(found.place + 0.5 - [1, 2, 3]) < 1).all(axis=1)
    assert beside.sum() == 8
    assert np.array_equal(found.tied, beside)


def test_vertices_inside_a_cell_are_counted_where_a_face_names_them() -> None:
    """Neither those on edges and faces, nor those that nothing names."""
    lattice = Lattice.of(Field.of(np.random.default_rng(0).normal(size=(3, 3, 3))), (0.0,))
    places = np.array([[1.5, 0.25, 1.75], [1.5, 0, 1], [1.5, 0, 1.25], [1.25, 0.5, 1.5]])
    found = traces(lattice, places, np.array([[0, 1, 2]]))
    cells = {tuple(p.tolist()): int(n) for p, n in zip(found.place, found.extra, strict=True) if n}
    assert cells == {(1, 0, 1): 1}


def test_faces_are_alike_where_they_can_be_read_alike_or_neither_can_be_read() -> None:
    """Two corners of a face cut off, and one of them: legal in one answer only."""
    values = np.array([[[1.0, -1], [-1, 1]], [[-1.0, -1], [-1, -1]]])
    lattice = Lattice.of(Field.of(values), (0.0,))
    corner = np.array([[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]])
    places = np.concatenate([corner, [0, 1, 1] + corner * [1, -1, -1]])
    rows = np.array([[0, 1, 2], [3, 4, 5]])
    whole, lost = (traces(lattice, places, rows[:count]) for count in (2, 1))
    assert whole.separated.all()
    assert (~whole.joined).any(axis=0).tolist() == [True] + 5 * [False]
    first = np.zeros(1, np.int64)
    broken = [0, 3, 5]  # The faces that the lost triangle has a side on.
    for one, other, unlike in (
        (whole, whole, []),
        (lost, lost, []),
        (whole, lost, broken),
        (lost, whole, broken),
    ):
        assert np.flatnonzero(~alike(one, other, first, first)[0]).tolist() == unlike


def test_a_cell_is_listed_or_unlisted_or_beyond_the_border() -> None:
    """Which tells where nothing is drawn from where there may be more of the surface."""
    shape = np.array([2, 3, 2])
    places = np.array(
        [[0, 0, 0], [1, 2, 1], [0, 1, 1], [1, 0, 0], [-1, 0, 0], [0, 3, 1], [0, 0, 2]]
    )
    listed = np.array([0, 3, 11])
    found = _rows(listed, places, shape)
    assert found.tolist() == [0, 2, 1, -1, OUTSIDE, OUTSIDE, OUTSIDE]
