"""VESTA, vectorised: the article's numbers, the laws of its cycles, other codes beside it."""

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise, permutations, product
from pathlib import Path
from typing import get_args

import isoref.fast.vesta
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from isoref import vesta as article
from isoref.diconex import Border, Mode
from isoref.fast.diconex import diconex
from isoref.fast.vesta import (
    Faces,
    Surface,
    cycles_of,
    extract,
    fan_start,
    successors,
    vesta,
)
from isoref.field import Booleans, Field, FieldError, Floats, Integers
from isoref.mesh import Mesh
from isoref.vesta import SIX_SURFACES, Cycles, Resolution
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkMarchingCubes

MODES = get_args(Mode)
RESOLUTIONS = get_args(Resolution)


def volumes(max_side: int = 4) -> st.SearchStrategy[Integers]:
    """Small volumes of small whole numbers: many ties, many points of ambiguity."""
    shapes = array_shapes(min_dims=3, max_dims=3, max_side=max_side)
    drawn: st.SearchStrategy[Integers] = arrays(np.int64, shapes, elements=st.integers(0, 3))
    return drawn


def noise(seed: int, *shape: int) -> Floats:
    """Values without ties and with every ambiguity there is."""
    return np.random.default_rng(seed).normal(size=shape)


# --- The census of cycles ----------------------------------------------------------------------


def legal_cells() -> Iterator[tuple[Booleans, Cycles, Integers]]:
    """Every cell with every choice on its ambiguous faces: corners, cycles, doubled centres.

    The cell is a volume of 2 x 2 x 2 voxels; the cycles round its middle are those with an open
    border.
    """
    for bits in range(256):
        active = np.pad(np.array([bits >> c & 1 for c in range(8)], np.bool_).reshape(2, 2, 2), 1)
        faces = Faces.of(active)
        for choice in product((False, True), repeat=len(ambiguous(active))):
            joined = dict(zip(ambiguous(active), choice, strict=True))
            cycles = cycles_of(successors(faces, active, decider(joined, faces)))
            inner = {n: rows // 4 for n, rows in cycles.items()}
            kept = {n: rows[~faces.outer[rows].any(axis=1)] for n, rows in inner.items()}
            yield active, {n: rows for n, rows in kept.items() if len(rows)}, faces.centres


def ambiguous(active: Booleans) -> list[tuple[float, ...]]:
    """The doubled junctures of the cell where two active voxels meet along an edge alone."""
    places = []
    for axis, side in product(range(3), range(2)):
        face = np.take(active[1:3, 1:3, 1:3], side, axis=axis)
        if face[0, 0] == face[1, 1] != face[0, 1] == face[1, 0]:
            places.append(tuple(float(x) for x in np.insert([1, 1], axis, 2 * side)))
    return places


def decider(joined: dict[tuple[float, ...], bool], faces: Faces):  # type: ignore[no-untyped-def]
    """Decides each point of ambiguity as told, and those outside the cell to disconnect."""

    def decide(v: Integers, q: Integers, w: Integers, p: Integers) -> Booleans:
        juncture = faces.indices(v) + faces.indices(q)
        return np.array([joined.get(tuple(map(float, j)), False) for j in juncture], np.bool_)

    return decide


def test_only_the_lengths_3_to_9_and_12_occur() -> None:
    """Section II.E: N-cycles of length 10 or 11 do not exist, nor longer ones."""
    lengths = Counter(
        n for _, cycles, _ in legal_cells() for n, rows in cycles.items() for _ in rows
    )
    assert sorted(lengths) == [3, 4, 5, 6, 7, 8, 9, 12]


def test_the_types_of_cycle() -> None:
    """Figs. 7 and 12 show nine types of global modes and five of mixed mode, 14 in all.

    Every choice of decisions taken together gives 16: three kinds of 12-cycle instead of one.
    (Two of them need decisions that the averages of four voxels never take together, see
    `papers/schlei_2010`.)
    """
    types: dict[int, set[tuple[tuple[int, ...], ...]]] = {}
    for _, cycles, centres in legal_cells():
        for n, rows in cycles.items():
            types.setdefault(n, set()).update(canonical(centres[row]) for row in rows)
    assert {n: len(kinds) for n, kinds in types.items()} == {
        3: 1, 4: 2, 5: 1, 6: 4, 7: 1, 8: 3, 9: 1, 12: 3,
    }  # fmt: skip


def canonical(cycle: Integers) -> tuple[tuple[int, ...], ...]:
    """The same for all cycles that a rotation of the cube or reversal carries over.

    Centres are doubled places in a cell with corners 0 and 2, so 1 is its middle.
    """
    images = []
    for axes, signs in product(permutations(range(3)), product((1, -1), repeat=3)):
        turn = np.eye(3, dtype=int)[list(axes)] * signs
        if np.linalg.det(turn) > 0:
            turned = [tuple(p) for p in ((cycle - 1) @ turn).tolist()]
            for way in (turned, turned[::-1]):
                images += [tuple(way[s:] + way[:s]) for s in range(len(way))]
    return min(images)


@pytest.mark.parametrize("mode", ["disconnect", "connect"])
def test_the_256_cells_in_a_global_mode(mode: Mode) -> None:
    """Fig. 7: only lengths 3 to 7. The counts are our own, the same in both modes by symmetry."""
    total: Counter[int] = Counter()
    for bits in range(256):
        cell = np.array([bits >> c & 1 for c in range(8)]).reshape(2, 2, 2)
        total.update(extract(cell, 1, mode=mode).lengths)
    assert total == {3: 144, 4: 66, 5: 72, 6: 52, 7: 24}


def test_every_cycle_up_to_seven_has_a_fan_and_no_longer_one_always_has() -> None:
    """Section II.D and Table III: why 8-, 9- and 12-cycles take their average point."""
    without: Counter[int] = Counter()
    for _, cycles, centres in legal_cells():
        for n, rows in cycles.items():
            for row in rows:
                try:
                    start = int(fan_start(centres[row][None])[0])
                except ValueError:
                    without[n] += 1
                    with pytest.raises(ValueError, match="no fan"):
                        article.fan_start(centres[row])
                else:
                    assert article.fan_start(centres[row]) == start
    assert set(without) == {8, 9, 12}
    assert without[9] == 96
    assert without[12] == 32


@pytest.mark.parametrize("resolution", RESOLUTIONS)
def test_no_triangles_of_a_cell_degenerate_or_cross(resolution: Resolution) -> None:
    """Section III.B: unmoved surfaces are not degenerate and never intersect themselves.

    Cells overlap in their common face at most, where no triangle has more than an edge, so that a
    cell at a time is enough. One pair of cycles touches: two 6-cycles that pass the middle of the
    cell, each cut along a diagonal of the cell, which they cannot avoid in L. They need two
    opposite faces that connect and four others that do not, and averages of four never decide so:
    the sum of two opposite faces' averages is the same for all three pairs.
    """
    touching, seen = set(), set()
    for active, cycles, centres in legal_cells():
        signature = (active.tobytes(), *(rows.tobytes() for rows in cycles.values()))
        if signature not in seen:
            seen.add(signature)
            mesh = Surface(centres.astype(float), centres, cycles).mesh(resolution)
            corners = mesh.vertices[mesh.simplices]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            assert (np.abs(normals).max(axis=1, initial=1) > 0.01).all()
            if not apart(mesh.simplices, corners):
                touching.add(tuple(n for n, rows in cycles.items() for _ in rows))
    assert touching == ({(6, 6)} if resolution == "L" else set())


def apart(triangles: Integers, corners: Floats) -> bool:
    """Whether triangles meet nowhere, or from two sides where they share a vertex.

    Two convex sets are apart when some axis keeps their shadows apart. For triangles the normals,
    the products of edges, and the normals of edges within each plane are enough.
    """
    one, other = np.triu_indices(len(triangles), 1)
    shared = (triangles[one][:, :, None] == triangles[other][:, None]).any(axis=(1, 2))
    a, b = corners[one], corners[other]
    e, f = np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b
    n, m = np.cross(e[:, 0], e[:, 1])[:, None], np.cross(f[:, 0], f[:, 1])[:, None]
    products = np.cross(e[:, :, None], f[:, None]).reshape(len(a), 9, 3)
    axes = np.concatenate([n, m, products, np.cross(e, n), np.cross(f, m)], axis=1)
    s, t = np.einsum("pxc,pvc->pxv", axes, a), np.einsum("pxc,pvc->pxv", axes, b)
    gap = np.maximum(s.min(axis=2) - t.max(axis=2), t.min(axis=2) - s.max(axis=2))
    wide = np.maximum(np.ptp(s, axis=2), np.ptp(t, axis=2)) > 1e-9
    free = np.where(shared, ((gap > -1e-9) & wide).any(axis=1), (gap > 1e-9).any(axis=1))
    return bool(free.all())


# --- Laws --------------------------------------------------------------------------------------


@given(volumes(), st.sampled_from(MODES), st.sampled_from(get_args(Border)), st.booleans())
def test_the_twin_has_the_numbers_of_the_article(
    grey: Integers, mode: Mode, border: Border, displaced: bool
) -> None:
    """Points, cycles and triangles, in the same order, to the last bit."""
    field = Field.of(grey, spacing=(1, 0.3, 2), origin=(5, -1, 0.1))
    fast, plain = (
        make(field, 2, mode=mode, border=border, displaced=displaced)
        for make in (extract, article.extract)
    )
    assert_same_surface(fast, plain)


@pytest.mark.parametrize("mode", MODES)
def test_the_twin_has_the_numbers_of_the_article_on_noise(mode: Mode) -> None:
    """Without ties, every length of cycle there is in this mode."""
    field = Field.of(noise(11, 8, 9, 7), spacing=(1, 0.3, 2))
    fast, plain = (make(field, 0.1, mode=mode) for make in (extract, article.extract))
    assert len(fast.lengths) >= 5
    assert_same_surface(fast, plain)


def assert_same_surface(fast: article.Surface, plain: article.Surface) -> None:
    """The same arrays, and the same triangles and normals cut from them."""
    assert np.array_equal(fast.points, plain.points)
    assert np.array_equal(fast.centres, plain.centres)
    assert list(fast.cycles) == list(plain.cycles)
    for length in fast.cycles:
        assert np.array_equal(fast.cycles[length], plain.cycles[length])
        assert np.allclose(fast.normals[length], plain.normals[length], rtol=1e-12, atol=1e-12)
    for resolution in RESOLUTIONS:
        assert_same(fast.mesh(resolution), plain.mesh(resolution))


@given(volumes(), st.sampled_from(MODES))
def test_the_successor_of_a_path_is_a_permutation(grey: Integers, mode: Mode) -> None:
    """Section II.C: each path lies on one closed cycle, within one 2 x 2 x 2 neighbourhood."""
    surface = extract(grey, 2, mode=mode, border="closed")
    visits = np.concatenate([np.empty(0, int), *(r.ravel() for r in surface.cycles.values())])
    assert (np.bincount(visits, minlength=len(surface.points)) == 4).all()
    for rows in surface.cycles.values():
        centres = surface.centres[rows]
        assert (np.ptp(centres, axis=1) <= 2).all()


@given(volumes(), st.sampled_from(SIX_SURFACES), st.booleans())
def test_all_six_surfaces_are_closed_oriented_and_manifold(
    grey: Integers, six: tuple[Mode, Resolution], displaced: bool
) -> None:
    """Section IV: holes can never occur; each edge runs once each way, each star is one disc."""
    mode, resolution = six
    mesh = vesta(grey, 2, mode=mode, resolution=resolution, border="closed", displaced=displaced)
    check_closed_oriented_manifold(mesh)


def check_closed_oriented_manifold(mesh: Mesh) -> None:
    """Every edge is run once in each direction, and the link of every vertex is one circle."""
    edges = Counter(
        (a, b) for x, y, z in mesh.simplices.tolist() for a, b in ((x, y), (y, z), (z, x))
    )
    assert set(edges.values()) <= {1}
    assert all((b, a) in edges for a, b in edges)
    links: dict[int, dict[int, int]] = {}
    for x, y, z in mesh.simplices.tolist():
        for a, b, c in ((x, y, z), (y, z, x), (z, x, y)):
            links.setdefault(a, {})[b] = c
    for link in links.values():
        start = here = next(iter(link))
        walked = 0
        while walked == 0 or here != start:
            here, walked = link[here], walked + 1
        assert walked == len(link)


@given(volumes(3), st.sampled_from(SIX_SURFACES))
def test_the_surface_winds_round_active_voxels_only(
    grey: Integers, six: tuple[Mode, Resolution]
) -> None:
    """The enclosed solid holds every active centre and no inactive one (solid angles)."""
    mode, resolution = six
    mesh = vesta(grey, 2, mode=mode, resolution=resolution, border="closed", displaced=False)
    corners = mesh.vertices[mesh.simplices]
    for index, value in np.ndenumerate(grey):
        assert winding(corners - index) == pytest.approx(float(value >= 2), abs=1e-9)


def winding(corners: Floats) -> float:
    """Times closed triangles (n, 3, 3) wind round the origin: van Oosterom & Strackee."""
    a, b, c = np.moveaxis(corners, 1, 0)
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    dots = x * y * z + (a * b).sum(1) * z + (b * c).sum(1) * x + (c * a).sum(1) * y
    angles = 2 * np.arctan2((a * np.cross(b, c)).sum(1), dots)
    return float(angles.sum()) / (4 * np.pi)


@given(volumes(), st.sampled_from(MODES), st.integers(0, 2))
def test_slices_through_voxel_centres_are_diconex_contours(
    grey: Integers, mode: Mode, axis: int
) -> None:
    """Section II.C: VESTA reproduces the 2-D contours in each principal plane, both ways."""
    mesh = extract(grey, 1.5, mode=mode, border="closed")
    runs: Counter[tuple[tuple[float, ...], tuple[float, ...]]] = Counter()
    for rows in mesh.cycles.values():
        for row in rows:
            ends = [tuple(p) for p in mesh.points[[*row, row[0]]].tolist()]
            runs.update(pairwise(ends))
    for k in range(grey.shape[axis]):
        plane = Field.of(np.take(grey, k, axis=axis))
        flat = diconex(plane, 1.5, mode=mode, border="closed").mesh
        expected: Counter[tuple[tuple[float, ...], tuple[float, ...]]] = Counter()
        for a, b in np.insert(flat.vertices, axis, k, axis=1)[flat.simplices].tolist():
            expected.update([(tuple(a), tuple(b)), (tuple(b), tuple(a))])
        got = {ab: n for ab, n in runs.items() if ab[0][axis] == k == ab[1][axis]}
        assert got == expected


@given(volumes(), st.sampled_from(MODES))
def test_an_open_border_drops_the_cycles_that_leave_the_samples(grey: Integers, mode: Mode) -> None:
    """The open surface is the part of the closed one on the hull of the samples."""
    closed = extract(grey, 2, mode=mode, border="closed")
    top = 2 * (np.array(grey.shape) - 1)
    inside = np.logical_and(closed.centres >= 0, closed.centres <= top).all(axis=1)
    expected = sorted(
        closed.points[row].tolist()
        for rows in closed.cycles.values()
        for row in rows
        if np.all(inside[row])  # type: ignore[index]
    )
    cut = extract(grey, 2, mode=mode)
    got = sorted(cut.points[row].tolist() for rows in cut.cycles.values() for row in rows)
    assert got == expected


@given(st.permutations(range(12)))
def test_cycles_of_a_permutation_are_found(order: list[int]) -> None:
    """Each member is on one cycle, and following the rows is following the permutation."""
    successor = np.array(order)
    rows = [row for group in cycles_of(successor).values() for row in group.tolist()]
    assert sorted(x for row in rows for x in row) == list(range(12))
    for row in rows:
        assert row[0] == min(row)
        assert [successor[x] for x in row] == [*row[1:], row[0]]


def test_counts_obey_the_identities_of_the_tables() -> None:
    """Tables II to IV: triangles and points follow from the cycles by length."""
    for mode in MODES:
        surface = extract(noise(2, 12, 13, 14), 0.3, mode=mode, border="closed")
        lengths = surface.lengths
        low, high = surface.mesh("L"), surface.mesh("H")
        averaged = sum(n for N, n in lengths.items() if N > 7)
        assert len(low.vertices) == len(surface.points) + averaged
        assert len(low.simplices) == sum(n * (N if N > 7 else N - 2) for N, n in lengths.items())
        assert len(high.vertices) == len(surface.points) + sum(
            n for N, n in lengths.items() if N > 3
        )
        assert len(high.simplices) == sum(n * (N if N > 3 else 1) for N, n in lengths.items())


def test_normals_of_cycles_sum_those_of_their_triangles() -> None:
    """Eq. 1: the same for both resolutions, since both fill the same cycle."""
    surface = extract(noise(3, 5, 5, 5), 0.1, border="closed")
    total = np.concatenate(list(surface.normals.values())).sum(axis=0)
    assert np.allclose(total, 0)
    for resolution in RESOLUTIONS:
        mesh = Surface(surface.points, surface.centres, {5: surface.cycles[5][:1]}).mesh(resolution)
        a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
        sigma = 0.5 * np.cross(b - a, c - a)
        assert np.allclose(sigma.sum(axis=0), surface.normals[5][0])


# --- Beside others -----------------------------------------------------------------------------


def test_disconnect_has_as_many_triangles_as_vtk() -> None:
    """Section I: the extended marching cubes is VESTA's global disconnect mode in L."""
    grey = noise(4, 20, 21, 22)
    image = vtkImageData()
    image.SetDimensions(grey.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(grey.ravel(order="F")))
    contour = vtkMarchingCubes()
    contour.SetInputData(image)
    contour.SetValue(0, 0.25)
    contour.ComputeNormalsOff()
    contour.ComputeGradientsOff()
    contour.Update()
    mesh = vesta(grey, 0.25, mode="disconnect")
    assert contour.GetOutput().GetNumberOfPolys() == len(mesh.simplices)
    assert contour.GetOutput().GetNumberOfPoints() == len(mesh.vertices)


# --- Input -------------------------------------------------------------------------------------


def test_positions_follow_spacing_and_origin() -> None:
    """A vertex is origin + index * spacing."""
    grey = noise(5, 4, 5, 6)
    plain = extract(grey, 0.0).points
    placed = extract(Field.of(grey, spacing=(2, 0.5, 3), origin=(1, -1, 0)), 0.0).points
    assert np.allclose(placed, plain * [2, 0.5, 3] + [1, -1, 0])


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.float32])
def test_the_type_of_the_samples_does_not_matter(kind: type) -> None:
    """Whole numbers give the same surface in every type that holds them."""
    grey = np.random.default_rng(6).integers(0, 120, (6, 7, 8))
    assert_same(vesta(grey.astype(kind), 60.5), vesta(grey.astype(float), 60.5))


def assert_same(one: Mesh, other: Mesh) -> None:
    """Both meshes are equal to the last bit."""
    assert np.array_equal(one.vertices, other.vertices)
    assert np.array_equal(one.simplices, other.simplices)


def test_no_surface_outside_the_range() -> None:
    """An isovalue nobody reaches gives an empty mesh, in every variant."""
    for (mode, resolution), border in product(SIX_SURFACES, get_args(Border)):
        mesh = vesta(np.zeros((3, 3, 3)), 1, mode=mode, resolution=resolution, border=border)
        assert mesh.vertices.shape == (0, 3)
        assert mesh.simplices.shape == (0, 3)


def test_bad_input_is_named() -> None:
    """An error says what was wrong."""
    with pytest.raises(FieldError, match="sample \\(0, 1, 0\\) is inf"):
        vesta([[[0.0], [np.inf]]], 0.5)
    with pytest.raises(FieldError, match="rank 2"):
        vesta(np.zeros((2, 2)), 0.5)
    with pytest.raises(ValueError, match="border 'ajar' is not one of open, closed"):
        vesta(np.zeros((2, 2, 2)), 0.5, border="ajar")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="resolution 'M' is not one of L, H"):
        vesta(np.zeros((2, 2, 2)), 0.5, resolution="M")  # type: ignore[arg-type]


@pytest.mark.slow
def test_table_2_on_the_bunny(data: Path) -> None:
    """Table II, original VESTA: cycles, points and triangles, in the mode with most code."""
    grey = np.load(data / "bunny_ct.npz")["values"]
    assert np.count_nonzero(grey >= 1807) == 3_100_197
    surface = extract(grey, 1807, mode="mixed", border="closed")
    assert surface.lengths == {3: 254_662, 4: 550_229, 5: 178_512, 6: 38_063}
    assert len(surface.points) == 1_021_460
    assert len(surface.mesh("L").simplices) == 2_042_908
    high = surface.mesh("H")
    assert (len(high.vertices), len(high.simplices)) == (1_788_264, 3_576_516)


@pytest.mark.parametrize("voxels", [1, 200, 500])
def test_blocks_of_voxels_make_no_difference(voxels: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Paths are followed block by block: wherever blocks are cut, the same cycles."""
    values = np.random.default_rng(8).normal(size=(9, 7, 11))
    for border in get_args(Border):
        monkeypatch.undo()
        whole = extract(values, 0.1, border=border)
        monkeypatch.setattr(isoref.fast.vesta, "BLOCK_VOXELS", voxels)
        parts = extract(values, 0.1, border=border)
        assert np.array_equal(parts.points, whole.points)
        assert parts.lengths == whole.lengths
        assert all(np.array_equal(parts.cycles[n], whole.cycles[n]) for n in whole.cycles)
