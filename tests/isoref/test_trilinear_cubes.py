"""The extractor against the truth about cells, which shares nothing with it."""

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.trilinear import NONE, Truths, cells
from isograde.oracles.trilinear_distance import distance
from isograde.oracles.trilinear_grid import active_cells, grid
from isograde.proof import prove
from isoref import trilinear_cubes as tc
from isoref.cube import CORNERS, EDGES, ambiguous_faces
from isoref.cycles import cycles, share_face
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.methods import METHODS
from isoref.rule import Rule, Tile
from scipy import ndimage
from scipy.spatial import cKDTree

FLIP = np.array([4 * i + 2 * j + k for i, j, k in CORNERS])
"""The truth's number of each corner."""


def random_cells(n: int, seed: int) -> Floats:
    """Corner values uniform in (-1, 1)."""
    return np.random.default_rng(seed).uniform(-1, 1, (n, 2, 2, 2))


def saddle_cells(n: int, seed: int) -> Floats:
    """Cells with the six roots of their three quadratics in or near the cell."""
    rng = np.random.default_rng(seed)
    x, y, z = np.moveaxis(np.array([0, 1]) - rng.uniform(-0.1, 1.1, (2, n, 3, 1)), 2, 0)
    weights = rng.uniform(-1, 1, (2, n))
    return np.asarray(np.einsum("sn,sni,snj,snk->nijk", weights, x, y, z))


def nearly_degenerate_cells(n: int, seed: int) -> Floats:
    """Cells whose quadratics have two roots in the cell, some 1e-16 .. 1e-7 apart: D is near 0."""
    rng = np.random.default_rng(seed)
    p = rng.uniform(0.05, 0.95, (n, 3, 1))
    r = p + 10.0 ** rng.uniform(-16, -7, (n, 3, 1)) * rng.choice([-1, 1], (n, 3, 1))
    apart = rng.random((n, 3, 1)) < 0.5
    apart[np.arange(n), rng.integers(0, 3, n)] = False
    r = np.where(apart, rng.uniform(0.05, 0.95, (n, 3, 1)), r)
    x, y, z = np.moveaxis(np.array([0, 1]) - np.array([p, r]), 2, 0)
    weights = rng.uniform(0.1, 1, (2, n)) * np.array([[1], [-1]])
    return np.asarray(np.einsum("sn,sni,snj,snk->nijk", weights, x, y, z))


def mixed_values(shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Random signs, and magnitudes from 1e-300 to 1e300."""
    return np.asarray(rng.choice([-1, 1], shape) * 10.0 ** rng.uniform(-300, 300, shape))


def mixed_cells(n: int, seed: int) -> Floats:
    """Cells with two roots on each axis, each plane of values times a power of ten of its own.

    Multiplying the values on one side of an axis changes roots, and no sign of c0, c2 and D.
    """
    rng = np.random.default_rng(seed)
    x, y, z = 10.0 ** rng.uniform(-90, 90, (3, n, 2))
    return np.asarray(saddle_cells(n, seed) * np.einsum("ni,nj,nk->nijk", x, y, z))


def exact_tunnel(g: list[Fraction]) -> int:
    """The tunnel bits of a cell, in fractions, from the two terms of F.

    A and B are found from the roots only where these are rational, so the side is read off F at
    the middle of p and r, and the roots are placed by Sturm's way: by signs at 0, at 1 and at the
    vertex of the parabola.
    """
    negative, middle = 0, []
    for axis in range(3):
        b, c = (1 << a for a in range(3) if a != axis)
        ends = [[g[s << axis | u | v] for u in (0, b) for v in (0, c)] for s in (0, 1)]

        def q(t: Fraction, ends: list[list[Fraction]] = ends) -> Fraction:
            w = [x * (1 - t) + y * t for x, y in zip(*ends, strict=True)]
            return Fraction(w[0] * w[3] - w[1] * w[2])

        at_0, at_1, at_half = q(Fraction(0)), q(Fraction(1)), q(Fraction(1, 2))
        bend = 2 * (at_0 + at_1 - 2 * at_half)  # q = at_0 + slope t + bend t^2
        slope = at_1 - at_0 - bend
        if bend == 0 or not 0 < (vertex := -slope / (2 * bend)) < 1:
            return 0
        if not (at_0 * at_1 > 0 and q(vertex) * at_0 < 0):
            return 0
        negative += at_0 < 0
        middle.append(vertex)
    if negative % 2 == 0:
        return 0
    value = Fraction(0)
    for corner in range(8):
        weight = g[corner]
        for axis, t in enumerate(middle):
            weight *= t if corner >> axis & 1 else 1 - t
        value += weight
    return tc.INSIDE_TUNNEL if value > 0 else tc.OUTSIDE_TUNNEL


def keys_of(values: Array, isovalue: float = 0.0) -> Integers:
    """Signs + 256 * decisions of each cell, as the rule takes them."""
    g = values.reshape(-1, 8)[:, FLIP].T.astype(np.float64) - isovalue
    signs = (g >= 0).T @ (1 << np.arange(8))
    asked = np.array([tc.asks(s) for s in range(256)])[signs]
    return np.asarray(signs + 256 * np.where(asked, tc.decisions(g), 0))


def parts_of(tile: Tile) -> list[set[int]]:
    """The nodes of each component of a tile."""
    parts: list[set[int]] = []
    for triangle in tile.triangles:
        touched = [part for part in parts if part & set(triangle)]
        parts = [part for part in parts if not part & set(triangle)]
        parts.append(set(triangle).union(*touched))
    return parts


def sides_of(tile: Tile) -> Counter[tuple[int, int]]:
    """How often each directed side occurs among the triangles."""
    return Counter(s for a, b, c in tile.triangles for s in ((a, b), (b, c), (c, a)))


@cache
def sheets(key: int) -> tuple[int, ...]:
    """For each edge the component of the tile that crosses it; -1 where none does."""
    parts = parts_of(tc.tile(key & 255, key >> 8))
    return tuple(next((i for i, p in enumerate(parts) if e in p), -1) for e in range(12))


@cache
def euler(key: int) -> int:
    """Vertices less edges plus triangles of a tile."""
    tile = tc.tile(key & 255, key >> 8)
    nodes = {node for triangle in tile.triangles for node in triangle}
    return len(nodes) - len({frozenset(s) for s in sides_of(tile)}) + len(tile.triangles)


@cache
def arcs(key: int) -> frozenset[frozenset[int]]:
    """The pairs of edges that the tile's border joins."""
    sides = sides_of(tc.tile(key & 255, key >> 8))
    return frozenset(frozenset(side) for side in sides if side[::-1] not in sides)


def disagreements(values: Array, truths: Truths, isovalue: float = 0.0) -> int:
    """Number of cells where sheets, Euler characteristic or curves are not the truth's.

    A sheet, or a curve, is named in the truth by the parts on its two sides: edges with the same
    two names must be, and must alone be, on one sheet, and on one closed border of the tile.
    """
    good = truths.ties == NONE
    keys = keys_of(values, isovalue)[good]
    rows = np.column_stack([keys, truths.rim[good], truths.body[good], truths.euler[good]])
    unique, count = np.unique(rows, axis=0, return_counts=True)
    wrong = 0
    for (key, *rest), times in zip(unique.tolist(), count, strict=True):
        rim, body, number = np.array(rest[:8])[FLIP], np.array(rest[8:16])[FLIP], rest[16]
        same = euler(key) == number and _agree(sheets(key), key, body)
        wrong += 0 if same and _agree(_curves(key), key, rim) else times
    return int(wrong)


@cache
def _curves(key: int) -> tuple[int, ...]:
    """For each edge the closed border of the tile that passes it; -1 where none does."""
    label = {e: e for arc in arcs(key) for e in arc}
    for a, b in map(sorted, arcs(key)):
        label = {e: label[a] if x == label[b] else x for e, x in label.items()}
    return tuple(label.get(e, -1) for e in range(12))


def _agree(names: tuple[int, ...], key: int, parts: Integers) -> bool:
    """Whether crossed edges are grouped by `names` as by the parts at their ends."""
    ends = [(parts[a], parts[b]) for a, b in EDGES]
    high = [(key >> a & 1, key >> b & 1) for a, b in EDGES]
    crossed = [e for e in range(12) if high[e][0] != high[e][1]]
    if [e for e in range(12) if names[e] >= 0] != crossed:
        return False
    pairs = [frozenset(map(int, ends[e])) for e in crossed]
    groups = [names[e] for e in crossed]
    return len(set(pairs)) == len(set(groups)) == len(set(zip(pairs, groups, strict=True)))


def every_key() -> list[int]:
    """Signs with every choice of the bits that could be set for them."""
    found = []
    for signs in range(256):
        faces = ambiguous_faces(signs)
        for choice in range(1 << len(faces)):
            bits = sum(1 << f for i, f in enumerate(faces) if choice >> i & 1)
            tunnels = range(4) if tc.asks(signs) else range(1)
            found += [signs | (bits | t << 6) << 8 for t in tunnels]
    assert len(found) > 256
    return found


def test_every_tile_is_bounded_by_its_polygons_and_by_nothing_else() -> None:
    """The proof by enumeration: two cells that share a face draw the same pieces on it.

    Inside the cell each side is used once in either direction, so nothing is open there; no inner
    side lies on a face of the cell, so no edge can get four triangles (Grosso 2016).
    """
    for key in every_key():
        signs, bits = key & 255, key >> 8
        sides = sides_of(tc.tile(signs, bits))
        assert max(sides.values(), default=1) == 1
        border = {side for side in sides if side[::-1] not in sides}
        polygons = cycles(signs, bits & tc.FACE_BITS)
        assert border == {s for p in polygons for s in zip(p, (*p[1:], p[0]), strict=True)}
        inner = [(a, b) for a, b in sides if (a, b) not in border and (b, a) not in border]
        assert not any(a < 12 and b < 12 and share_face(a, b) for a, b in inner)


def test_every_vertex_of_every_tile_is_manifold() -> None:
    """The triangles round an inner node are one closed fan, round a crossing one open fan."""
    for key in every_key():
        tile = tc.tile(key & 255, key >> 8)
        for node in {n for t in tile.triangles for n in t}:
            links = {
                t[(i + 1) % 3]: t[(i + 2) % 3]
                for t in tile.triangles
                for i in range(3)
                if t[i] == node
            }
            starts = set(links) - set(links.values())
            at = next(iter(starts), next(iter(links)))
            assert len(starts) == (node < 12)
            for _ in range(len(links)):
                at = links.pop(at)
            assert not links


def test_random_cells_have_the_true_topology() -> None:
    """100,000 random cells: sheets, who shares one, Euler characteristic, curves."""
    values = random_cells(100_000, seed=0)
    assert disagreements(values, cells(values)) == 0


def test_cells_with_saddles_have_the_true_topology() -> None:
    """30,000 cells in which one in ten or so has a tunnel; both signs."""
    values = saddle_cells(30_000, seed=1)
    truths = cells(values)
    assert (truths.tunnels > 0).sum() > 2000
    assert disagreements(values, truths) == 0
    assert disagreements(-values, cells(-values)) == 0


def test_the_asymptotic_decider_alone_is_caught() -> None:
    """The comparison sees what it should: without bits 6 and 7 exactly the tunnels are missing."""
    values = saddle_cells(3000, seed=2)
    truths = cells(values)
    real = tc.decisions
    try:
        tc.decisions = lambda g: real(g) & tc.FACE_BITS
        assert disagreements(values, truths) == int((truths.tunnels > 0).sum())
    finally:
        tc.decisions = real


def test_scaling_does_not_change_a_decision() -> None:
    """Values near the smallest and the largest floats are decided as plain ones."""
    values = saddle_cells(2000, seed=3)
    for scale in (2.0**-900, 2.0**900):
        assert (keys_of(values * scale) == keys_of(values)).all()


@pytest.mark.parametrize("cells_of", [nearly_degenerate_cells, mixed_cells, saddle_cells])
def test_the_interior_is_decided_exactly(cells_of: Callable[[int, int], Floats]) -> None:
    """Root gaps below 1e-7 and mixed magnitudes: the tunnel bits are those of exact fractions."""
    g = cells_of(2000, 7).reshape(-1, 8)[:, FLIP].T
    bits = tc.decisions(g) & (tc.INSIDE_TUNNEL | tc.OUTSIDE_TUNNEL)
    exact = [exact_tunnel([Fraction(x) for x in column]) for column in g.T.tolist()]
    assert 40 < np.count_nonzero(exact) < 1960
    assert bits.tolist() == exact


def test_nearly_degenerate_cells_have_the_true_topology() -> None:
    """20,000 cells with root gaps below 1e-7: the grader's oracle agrees on each."""
    values = nearly_degenerate_cells(20_000, seed=8)
    truths = cells(values)
    assert (truths.tunnels > 0).sum() > 2000
    assert disagreements(values, truths) == 0


def test_ties_of_the_interior_are_decided_exactly() -> None:
    """Small integers, where c0, D and faces are zero by the hundred: no tunnel where D = 0."""
    g: Floats = np.random.default_rng(9).integers(-2, 3, (8, 4000)).astype(np.float64)
    g[:, 0] = [3, -1, -1, -1, -1, -1, -1, 3]
    bits = tc.decisions(g) & (tc.INSIDE_TUNNEL | tc.OUTSIDE_TUNNEL)
    assert bits.tolist() == [exact_tunnel([Fraction(x) for x in one]) for one in g.T.tolist()]
    D = [c1 * c1 - 4 * c0 * c2 for c0, c1, c2 in (tc.quadratic(g, axis) for axis in range(3))]
    assert (D[0] == D[1]).all()
    assert (D[0] == D[2]).all()
    assert (D[0] == 0).sum() > 100
    assert not bits[D[0] == 0].any()


def test_floats_settle_nearly_all_cells() -> None:
    """The filter leaves to integers at most one cell in a thousand, of reals and of bytes."""
    rng = np.random.default_rng(10)
    reals: Floats = rng.uniform(-1, 1, (8, 50_000))
    octets: Floats = rng.integers(0, 256, (8, 50_000)).astype(np.float64) - 127.5
    for g in (reals, octets):
        there, joins, sure = tc.read(tc.normalised(g), tc.ERROR, tc.ERROR_AT_MIDDLE)
        assert (~sure).mean() < 1e-3
        some = np.flatnonzero(sure)[:5000]
        exact = tc.read(tc.integers(g[:, some]), 0, 0)
        assert exact[2].all()
        assert (exact[0] == there[some]).all()
        assert (exact[1] == joins[some])[there[some]].all()


def test_fields_of_mixed_magnitudes_are_closed() -> None:
    """Twenty fields 8^3 of random signs and sizes from 1e-300 to 1e300, outside all round.

    A face must not be decided by numbers scaled with what else is in the cell.
    """
    rng = np.random.default_rng(11)
    triangles = 0
    for _ in range(20):
        values = np.pad(mixed_values((8, 8, 8), rng), 1, constant_values=-1.0)
        mesh = METHODS["trilinear-cubes"](Field.of(values), 0.0)
        assert np.isfinite(mesh.vertices).all()
        assert (edge_counts(mesh.simplices) == 2).all()
        triangles += len(mesh.simplices)
    assert triangles > 10_000


def test_inner_vertices_of_mixed_cells_are_inside_their_cell() -> None:
    """Where sizes are so far apart that floats lose c0, c1 or D, every vertex has its place."""
    values = mixed_cells(1000, seed=12)
    with_tunnel = keys_of(values) >> 14 != 0
    assert with_tunnel.sum() > 50
    for cell in values[with_tunnel]:
        mesh = METHODS["trilinear-cubes"](Field.of(cell), 0.0)
        assert ((mesh.vertices >= 0) & (mesh.vertices <= 1)).all()


def test_inner_vertices_are_inside_the_cell_and_on_the_level_set() -> None:
    """Issue: interior vertices on the surface; F there is zero but for rounding."""
    values = np.concatenate([saddle_cells(1500, seed=4), random_cells(1500, seed=5)])
    seen = 0
    for cell in values:
        mesh = METHODS["trilinear-cubes"](Field.of(cell), 0.0)
        inner = ((mesh.vertices > 0) & (mesh.vertices < 1)).all(axis=1)
        seen += int(inner.sum())
        assert ((mesh.vertices >= 0) & (mesh.vertices <= 1)).all()
        g = cell.reshape(8)[FLIP][:, None].repeat(len(mesh.vertices), axis=1)
        assert (np.abs(tc.interpolate(g, mesh.vertices)) < 1e-9 * np.abs(cell).max()).all()
    assert seen > 1000


def edge_counts(triangles: Integers) -> Integers:
    """How many triangles each edge has."""
    ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.asarray(np.unique(ends, axis=0, return_counts=True)[1])


def grids_agree(number: int, size: int, seed: int) -> int:
    """How many grids of noise were compared as wholes; each agrees with the glued truth."""
    rng = np.random.default_rng(seed)
    for _ in range(number):
        values = rng.uniform(-1, 1, (size,) * 3)
        truth = grid(values)
        mesh = sweep(tc.RULE, Field.of(values), 0.0)
        counts = edge_counts(mesh.simplices)
        assert counts.max() == 2
        assert len(mesh.vertices) - len(counts) + len(mesh.simplices) == truth.euler
        open_sides = int((counts == 1).sum())
        assert (open_sides == 0) == (truth.curves == 0)
        assert disagreements(active_cells(values, 0.0)[1], cells(active_cells(values, 0.0)[1])) == 0
    return number


def test_grids_of_noise_have_the_true_topology() -> None:
    """Grids of 8^3: glued Euler characteristic, at most two triangles an edge, every cell."""
    assert grids_agree(60, 8, seed=6) == 60


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tooth.npz", "headsq.npz"])
def test_ambiguous_cells_of_real_volumes_have_the_true_topology(name: str, data: Path) -> None:
    """Real data at half-integer isovalues, every active cell."""
    with np.load(data / name) as archive:
        volume = archive[archive.files[0]][::2, ::2, ::2]
    isovalue = float(np.floor((int(volume.min()) + int(volume.max())) / 4)) + 0.5
    corners = active_cells(volume, isovalue)[1]
    asked = np.array([tc.asks(s) for s in range(256)])[keys_of(corners, isovalue) & 255]
    assert asked.sum() > 20
    assert disagreements(corners[asked], cells(corners[asked], isovalue), isovalue) == 0


@pytest.mark.parametrize("largest", [2, 3, 5])
def test_points_on_the_level_set_keep_the_surface_closed_manifold_and_free_of_crossings(
    largest: int,
) -> None:
    """The same pieces and handles as the plain tiles; exact arithmetic finds no crossing."""
    values = np.pad(np.random.default_rng(7).normal(size=(7, 7, 7)), 1, constant_values=-1.0)
    field = Field.of(values)
    plain, fine = sweep(tc.RULE, field, 0.0), sweep(tc.drawn(largest), field, 0.0)
    one, other = (Complex.of(m.vertices, m.simplices) for m in (plain, fine))
    assert (one.components, one.euler) == (other.components, other.euler)
    assert len(other.open_facets) == len(other.crowded_facets) == len(other.misdirected_facets) == 0
    assert len(self_intersections(fine.vertices, fine.simplices)) == 0
    assert len(fine.simplices) > len(plain.simplices)


@pytest.mark.parametrize("largest", [2, 3, 5])
def test_points_on_the_level_set_bring_the_mesh_nearer_to_it(largest: int) -> None:
    """Middles of triangles and sides, on smoothed noise: the more points, the nearer."""
    values = ndimage.gaussian_filter(np.random.default_rng(0).normal(size=(16,) * 3), 1.0)
    means = []
    for rule in (tc.RULE, tc.drawn(largest)):
        mesh = sweep(rule, Field.of(values), 0.0)
        probes = mesh.vertices[mesh.simplices].mean(axis=1)
        means.append(float(np.nanmean(distance(values, 0.0, probes))))
    assert means[1] < (0.97 if largest == 5 else 0.85) * means[0]


@pytest.mark.parametrize(
    "rule",
    [
        tc.drawn(5),
        pytest.param(tc.drawn(3), marks=pytest.mark.slow),
        pytest.param(tc.drawn(2), marks=pytest.mark.slow),
        pytest.param(tc.CONTINUOUS, marks=pytest.mark.slow),
    ],
    ids=lambda rule: rule.name,
)
def test_the_drawn_rules_are_proved(rule: Rule) -> None:
    """By enumeration, as the plain rule is."""
    assert prove(rule).holds


def test_the_axis_goes_through_both_saddles_and_says_on_which_side_a_tunnel_is() -> None:
    """No slope at the saddles, and tips on the level set; k beyond 2 in a cell with a tunnel."""
    g = np.random.default_rng(0).uniform(-1, 1, (8, 20_000))
    axis, steps = tc.Axis.of(g), 1e-5 * np.eye(3)
    scaled = tc.normalised(g)
    real = np.isfinite(axis.k) & (np.abs(axis.step).max(axis=1) < 3)
    assert real.sum() > 1000
    for side in (1, -1):
        saddle = (axis.centre + side * axis.step)[real]
        slopes = [
            tc.interpolate(scaled[:, real], saddle + step)
            - tc.interpolate(scaled[:, real], saddle - step)
            for step in steps
        ]
        assert np.abs(slopes).max() < 1e-8
        between = real & (np.abs(axis.k) < 2) & (np.abs(axis.centre).max(axis=1) < 3)
        for tip in axis.tips(side):
            assert np.abs(tc.interpolate(scaled[:, between], tip[between])).max() < 1e-8
    there, joins_inside = tc.tunnels(g)
    assert there.sum() > 50
    assert (np.abs(axis.k[there]) > 2).all()
    assert ((axis.k[there] < 0) == joins_inside[there]).all()


def hausdorff(one: Mesh, other: Mesh) -> float:
    """The distance of two small meshes, by points on their triangles."""
    weights = np.array([[i, j, 8 - i - j] for i in range(9) for j in range(9 - i)]) / 8
    a, b = (
        np.einsum("pk,fkd->pfd", weights, m.vertices[m.simplices]).reshape(-1, 3)
        for m in (one, other)
    )
    return max(float(np.max(cKDTree(x).query(y)[0])) for x, y in ((a, b), (b, a)))


def test_the_mesh_does_not_jump_where_a_tunnel_ends() -> None:
    """Lopes and Brodlie: a hundredth of the step moves it a tenth as far; the plain rule jumps."""
    g = np.random.default_rng(2).uniform(-1, 1, (8, 6000))
    axis, found = tc.Axis.of(g), 0
    for side in (1, -1):
        saddle = axis.centre + side * axis.step
        inside = ((saddle > 0) & (saddle < 1)).all(axis=1)
        level = np.zeros(g.shape[1])
        level[inside] = tc.interpolate(g[:, inside], saddle[inside])
        ends = inside & tc.tunnels(g - np.where(inside, level + side * 1e-4, 0))[0]
        for n in np.flatnonzero(ends)[:5].tolist():
            field, at = Field.of(g[:, n].reshape(2, 2, 2)), level[n]
            plain, near, nearer = (
                hausdorff(sweep(rule, field, at - step), sweep(rule, field, at + step))
                for rule, step in ((tc.RULE, 1e-5), (tc.CONTINUOUS, 1e-3), (tc.CONTINUOUS, 1e-5))
            )
            assert plain > 0.15
            assert nearer < 0.06
            assert nearer < near / 3
            found += 1
    assert found >= 6


def test_the_continuous_rule_keeps_topology_and_is_free_of_crossings() -> None:
    """As closed, as many pieces and handles as the plain tiles, on noise; plain and fast agree."""
    values = np.pad(np.random.default_rng(8).normal(size=(6, 6, 6)), 1, constant_values=-1.0)
    field = Field.of(values)
    plain, fine = sweep(tc.RULE, field, 0.0), sweep(tc.CONTINUOUS, field, 0.0)
    one, other = (Complex.of(m.vertices, m.simplices) for m in (plain, fine))
    assert (one.components, one.euler) == (other.components, other.euler)
    assert len(other.open_facets) == len(other.crowded_facets) == 0
    assert len(self_intersections(fine.vertices, fine.simplices)) == 0


def test_a_cell_without_two_saddles_is_drawn_all_the_same() -> None:
    """Two opposite corners alone, no axis: the discs have their points all the same."""
    for cell in ([1, -1, -1, -1, -1, -1, -1, 1], [3, -1, -1, 0.5, -1, 0.5, 0.5, 3]):
        field = Field.of(np.array(cell, float).reshape(2, 2, 2))
        for level in (0.0, 0.9, 1e-300):
            assert np.isfinite(sweep(tc.CONTINUOUS, field, level).vertices).all()


def test_a_polygon_of_two_sides_is_refused() -> None:
    """Three sides at least: with 2 every polygon has its point, and with 1 nothing more."""
    with pytest.raises(ValueError, match="three sides at least: give 2 or more, not 1"):
        tc.drawn(1)
