"""The original VESTA, as the article has it: Schlei's figures."""

from typing import get_args

import numpy as np
import pytest
import trimesh
from isoref.cube import FACE_CORNERS, is_ambiguous
from isoref.diconex import Mode, diconex
from isoref.field import Floats
from isoref.mesh import Mesh
from isoref.vesta import (
    DIRECTIONS,
    JUNCTURES,
    RANK,
    Path,
    Voxel,
    extract,
    neighbour,
    successor,
    vesta,
    voxels,
)

MODES = get_args(Mode)


def solid(mesh: Mesh) -> trimesh.Trimesh:
    """The mesh as trimesh holds it, nothing merged."""
    return trimesh.Trimesh(mesh.vertices, mesh.simplices, process=False)


def test_paths_run_clockwise_round_the_range_vector() -> None:
    """Fig. 2b: junctures are counterclockwise round r, and a path leads to the one before."""
    for r in range(6):
        for k in range(4):
            here, following = DIRECTIONS[JUNCTURES[r, k]], DIRECTIONS[JUNCTURES[r, (k + 1) % 4]]
            assert np.array_equal(np.cross(here, following), DIRECTIONS[r])
            assert RANK[r, JUNCTURES[r, k]] == k


def test_a_single_voxel_becomes_an_octahedron_with_outward_normals() -> None:
    """Fig. 4: six faces, 24 paths, eight 3-cycles, 12 edges run both ways."""
    surface = extract(np.ones((1, 1, 1)), 1, border="closed")
    assert surface.lengths == {3: 8}
    body = solid(surface.mesh())
    assert body.is_watertight
    assert len(body.edges_unique) == 12
    assert body.volume == pytest.approx(1 / 6)


def test_two_voxels_on_an_edge_are_kept_apart_or_joined() -> None:
    """Fig. 6e, 6f: two octahedra, or one surface with two 6-cycles."""
    two = np.zeros((2, 2, 1))
    two[0, 0] = two[1, 1] = 1
    parts = {m: extract(two, 0.6, mode=m, border="closed") for m in MODES}
    assert {m: s.lengths for m, s in parts.items()} == {
        "disconnect": {3: 16},
        "connect": {3: 12, 6: 2},
        "mixed": {3: 16},
    }
    assert [solid(s.mesh()).body_count for s in parts.values()] == [2, 1, 2]


def test_voxels_that_share_a_corner_only_stay_apart() -> None:
    """Fig. 10a, 10b: no path of one ever meets a path of the other."""
    two = np.zeros((2, 2, 2))
    two[0, 0, 0] = two[1, 1, 1] = 1
    for mode in MODES:
        assert extract(two, 0.1, mode=mode, border="closed").lengths == {3: 16}


def test_an_8_cycle_needs_two_decisions_that_differ() -> None:
    """Figs. 10c, 11a, 12a, 13c: two pairs of voxels, each on an edge, one joined and one not."""
    grey = np.zeros((2, 2, 2))
    grey[0, 0, 0] = grey[1, 1, 0] = 0.9
    grey[0, 0, 1] = grey[1, 1, 1] = 1.2
    cell = {m: extract(grey, 0.5, mode=m).lengths for m in MODES}
    assert cell == {"disconnect": {4: 2}, "connect": {4: 2}, "mixed": {8: 1}}


def test_displacement_stays_within_the_range_vector() -> None:
    """Fig. 2d: a support point moves from the active voxel's centre towards its neighbour's."""
    grey = np.random.default_rng(1).normal(size=(5, 6, 7))
    moved, still = (extract(grey, 0.2, displaced=d) for d in (True, False))
    assert np.array_equal(still.points, 0.5 * still.centres)
    shift = np.abs(moved.points - still.points)
    assert (shift.max(axis=1) <= 0.5).all()
    assert ((shift > 0).sum(axis=1) <= 1).all()


def test_every_path_has_a_successor_and_is_one() -> None:
    """Section II.C: following the paths is a permutation of them."""
    values = np.random.default_rng(4).normal(size=(4, 3, 4))
    grey: dict[Voxel, float] = {v: float(values[v]) for v in voxels(values.shape)}
    active = {v for v in grey if grey[v] >= 0}
    paths: list[Path] = [
        (v, r, k)
        for v in sorted(active)
        for r in range(6)
        for k in range(4)
        if neighbour(v, r) not in active
    ]
    assert len(paths) > 200
    for mode in MODES:
        assert sorted(successor(path, active, grey, mode) for path in paths) == paths


def test_no_surface_where_nothing_is_active() -> None:
    """An empty mesh of the right shapes."""
    mesh = vesta(np.zeros((3, 2, 3)), 1, border="closed")
    assert mesh.vertices.shape == mesh.simplices.shape == (0, 3)


def pairs(points: Floats) -> set[tuple[tuple[float, ...], ...]]:
    """Undirected edges of a closed polygon by their ends, rounded."""
    rounded = [tuple(row) for row in (points.round(9) + 0.0).tolist()]
    return {tuple(sorted(edge)) for edge in zip(rounded, rounded[1:] + rounded[:1], strict=True)}


@pytest.mark.parametrize("mode", MODES)
def test_every_principal_plane_cuts_the_surface_in_contours_of_diconex(mode: Mode) -> None:
    """II.C, and III.C of Figs. 31 and 32c: all contours together are all edges of the cycles."""
    values = np.random.default_rng(4).integers(0, 9, (5, 4, 6)).astype(float)
    surface = extract(values, 4.5, mode=mode, border="closed")
    of_cycles = [pairs(surface.points[row]) for rows in surface.cycles.values() for row in rows]
    edges = set().union(*of_cycles)
    contours = set()
    for axis in range(3):
        for k, plane in enumerate(np.moveaxis(values, axis, 0)):
            for polygon in diconex(plane, 4.5, mode=mode, border="closed").polygons():
                contours |= pairs(np.insert(polygon[:-1], axis, k, axis=1))
    assert len(edges) > 200
    assert contours == edges


def test_a_face_of_a_cell_holds_none_two_or_four_voxel_face_vectors() -> None:
    """II.F: one for each of its four edges that the surface crosses, over all 256 cells."""
    seen = set()
    for signs in range(256):
        for face in FACE_CORNERS:
            high = [signs >> c & 1 for c in face]
            crossed = sum(high[k] != high[(k + 1) % 4] for k in range(4))
            seen.add(crossed)
            assert (crossed == 4) == is_ambiguous(signs, FACE_CORNERS.index(face))
    assert seen == {0, 2, 4}
