"""Dual marching cubes: a manifold whatever the signs, by enumeration and by exact counts."""

from collections import Counter
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from isoref.cube import EDGE_OF, EDGES, FACE_EDGES, ambiguous_faces, configuration, is_exchanged
from isoref.cycles import ALL_JOINED, ALL_SEPARATED, cycles
from isoref.dual import DualRule
from isoref.dual_marching_cubes import RULE, fans, patches, pinched_face
from isoref.fast.dual import quads, surface
from isoref.field import Field, Floats, Integers
from isoref.surface_nets import RULE as NETS
from isoref.surface_nets import never

from tests.isoref import counting

# Nielson's surface: without the repair.
UNREPAIRED = replace(RULE, name="nielson", turns_at=never)


def test_the_signs_that_pinch_are_two_configurations_with_outside_in_the_minority() -> None:
    """Nielson, section 5.3; 36 of 256 signs, each with one ambiguous face."""
    pinching = [signs for signs in range(256) if pinched_face(signs) is not None]
    kinds = Counter((configuration(s), is_exchanged(s), s.bit_count()) for s in pinching)
    assert kinds == {(3, True, 6): 12, (6, True, 5): 24}
    assert {len(ambiguous_faces(signs)) for signs in pinching} == {1}


def test_turning_parts_the_two_segments_of_the_face() -> None:
    """Wenger, section 3.3.5: each polygon of a turned cell has one of them."""
    for signs in range(256):
        f = pinched_face(signs)
        if f is not None:
            face = set(FACE_EDGES[f])
            assert [len(face & set(p.quads)) for p in patches(signs, True, 0)] == [2, 2]


def test_each_crossed_edge_of_a_cell_is_a_corner_of_one_vertex() -> None:
    """Polygons share no crossing, and at the border only inner edges are left."""
    for signs, turned in product(range(256), (False, True)):
        expected = sorted(e for p in cycles(signs, ALL_SEPARATED) for e in p)
        assert sorted(e for patch in patches(signs, turned, 0) for e in patch.quads) == expected
        kept = [e for e in expected if e not in FACE_EDGES[3]]
        assert sorted(e for patch in patches(signs, turned, 8) for e in patch.quads) == kept


def test_a_fan_is_a_run_of_inner_edges_round_the_polygon() -> None:
    """Between the last and the first of a run there is an edge of the border."""
    polygon = (0, 8, 4, 1, 11, 5)
    for kept in product((False, True), repeat=6):
        inner = frozenset(e for e, keep in zip(polygon, kept, strict=True) if keep)
        runs = fans(polygon, inner)
        assert sorted(e for run in runs for e in run.quads) == sorted(inner)
        shared = [e for run in runs for e in run.crossings]
        assert len(set(shared)) == len(shared)
        assert inner <= set(shared) <= set(polygon)
        breaks = sum(not kept[i] and kept[(i + 1) % 6] for i in range(6))
        assert len(runs) == (breaks or bool(inner))


def test_the_fans_of_a_polygon_passed_the_other_way_are_the_same() -> None:
    """So a mirrored field has the mirrored surface: `symmetry.orientation` at the border."""
    polygon = (0, 8, 4, 1, 11, 5, 2)
    for kept in product((False, True), repeat=7):
        inner = frozenset(e for e, keep in zip(polygon, kept, strict=True) if keep)
        there, back = fans(polygon, inner), fans(polygon[::-1], inner)
        assert {frozenset(f.crossings) for f in there} == {frozenset(f.crossings) for f in back}


# --- The proof: every pair of cells ----------------------------------------------------------


def segments(signs: int, turned: bool, f: int) -> list[tuple[frozenset[int], int]]:
    """The two ends of each dual edge's segment on face f, and the polygon that holds it."""
    face, found = set(FACE_EDGES[f]), []
    for number, polygon in enumerate(cycles(signs, ALL_JOINED if turned else ALL_SEPARATED)):
        for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            if {a, b} <= face:
                found.append((frozenset((a, b)), number))
    return found


def choices(signs: int, f: int, other: int) -> list[bool]:
    """Whether a cell turns, where its neighbour beyond face f has the signs `other`.

    Where it is pinched at another face, that face's neighbour is unknown, and both can be.
    """
    own = pinched_face(signs)
    if own is None:
        return [False]
    return [pinched_face(other) == f ^ 1] if own == f else [False, True]


def faults(rule: DualRule) -> Counter[str]:
    """What is wrong on the shared face of two cells, over all pairs of cells."""
    found: Counter[str] = Counter()
    for axis in range(3):
        near, far = 2 * axis + 1, 2 * axis
        across = {e: opposite(e, axis) for e in FACE_EDGES[near]}
        side = [c for c in range(8) if c >> axis & 1]
        for a, b in product(range(256), repeat=2):
            if any((a >> c & 1) != (b >> (c ^ 1 << axis) & 1) for c in side):
                continue
            both = product(choices(a, near, b), choices(b, far, a))
            for turn_a, turn_b in both if rule is RULE else [(False, False)]:
                one, other = segments(a, turn_a, near), segments(b, turn_b, far)
                there = dict(other)
                seen = {frozenset(across[e] for e in ends): number for ends, number in one}
                found["pairs"] += 1
                found["torn"] += set(seen) != set(there)
                joined = [(number, there.get(ends)) for ends, number in seen.items()]
                found["pinched"] += len(set(joined)) < len(joined)
    return found


def opposite(e: int, axis: int) -> int:
    """The edge of the next cell along the axis that is this cell's edge e of their shared face."""
    return EDGE_OF[frozenset(c ^ 1 << axis for c in EDGES[e])]


def test_no_two_cells_tear_or_pinch_the_face_they_share() -> None:
    """All 12,288 pairs, and all ways their other neighbours may turn them.

    This is all there is to prove. An edge of the quadrilaterals joins a polygon of one cell to one
    of the next across a segment of their face; if both cells draw the same segments, every edge
    has the two quadrilaterals at the segment's ends, and if no two segments join the same pair of
    polygons, the edge is no other's. The quadrilaterals round a vertex follow its polygon, which
    is one circle.
    """
    found = faults(RULE)
    assert found["pairs"] > 12_288
    assert found["torn"] == found["pinched"] == 0


def test_the_proof_finds_what_nielson_remarked() -> None:
    """Without the repair nothing is torn, but pairs of pinched cells are."""
    found = faults(UNREPAIRED)
    assert found["pairs"] == 12_288
    assert found["torn"] == 0
    # For each of the six diagonals in three directions: pairs of the cells pinched there.
    pinching = Counter(pinched_face(signs) for signs in range(256))
    at_one = pinching[0] // 2
    assert found["pinched"] == 3 * 2 * at_one**2


# --- Exact counts on meshes ------------------------------------------------------------------


def every_pair(axis: int) -> Floats:
    """All 512 pairs of cells with an ambiguous face between, each in a block of random samples."""
    values = np.random.default_rng(axis).choice([-1.0, 1.0], size=(512, 4, 4, 5))
    bits = (np.arange(4096)[:, None] >> np.arange(12) & 1).reshape(-1, 2, 2, 3)
    face = bits[:, :, :, 1].reshape(-1, 4)
    ambiguous = (face[:, 0] == face[:, 3]) & (face[:, 1] == face[:, 2]) & (face[:, 0] != face[:, 1])
    values[:, 1:3, 1:3, 1:4] = 2.0 * bits[ambiguous] - 1
    blocks = np.moveaxis(values.reshape(8, 8, 8, 4, 4, 5), (3, 4, 5), (1, 3, 5))
    return np.moveaxis(blocks.reshape(32, 32, 40), 2, axis)


def manifold_faults(rows: Integers, vertices: int) -> tuple[int, int, int]:
    """Edges with more than two polygons, edges passed twice one way, vertices of several fans."""
    found = counting.edges(rows)
    twice = int(((found.forth > 1) | (found.back > 1)).sum())
    return len(found.crowded), twice, int((counting.fans(rows, vertices) != 1).sum())


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_meshes_of_every_pair_of_cells_are_manifolds(axis: int) -> None:
    """By exact half-edge counts, as quadrilaterals and as triangles, at the border too."""
    field = Field.of(every_pair(axis))
    vertices, rows = quads(RULE, field, 0.0)
    assert len(rows) > 50_000
    assert manifold_faults(rows, len(vertices)) == (0, 0, 0)
    assert manifold_faults(surface(RULE, field, 0.0).simplices, len(vertices)) == (0, 0, 0)


def test_the_counts_find_the_flaws_of_nets_and_of_nielson() -> None:
    """The same counts on the same field, so that they are known to see something."""
    field = Field.of(every_pair(0)[:20])
    for rule in (NETS, UNREPAIRED):
        vertices, rows = quads(rule, field, 0.0)
        crowded, twice, _ = manifold_faults(rows, len(vertices))
        assert crowded > 50
        assert twice == crowded


@pytest.mark.parametrize("seed", range(4))
def test_noise_and_integers_are_manifolds_and_close_behind_a_low_border(seed: int) -> None:
    """Ties or not: the mesh by index depends on signs alone."""
    rng = np.random.default_rng(seed)
    for values, isovalue in (
        (rng.normal(size=(15, 16, 17)), 0.3),
        (rng.integers(0, 4, size=(15, 16, 17)).astype(np.uint8), 2.0),
    ):
        open_ended = Field.of(values)
        vertices, rows = quads(RULE, open_ended, isovalue)
        assert manifold_faults(rows, len(vertices)) == (0, 0, 0)
        closed = Field.of(np.pad(values.astype(float), 1, constant_values=-9))
        vertices, rows = quads(RULE, closed, isovalue)
        assert len(counting.edges(rows).one_sided) == 0
        assert manifold_faults(rows, len(vertices)) == (0, 0, 0)


def test_two_pinched_cells_of_the_remark_have_two_vertices_each() -> None:
    """Two cells full but for two outside corners on the face between them."""
    values = np.ones((4, 4, 4))
    values[1, 1, 2] = values[2, 2, 2] = 0  # Two voxels that touch along an edge.
    counts = [len(quads(rule, Field.of(values), 0.5)[0]) for rule in (UNREPAIRED, RULE)]
    assert counts == [14, 16]
    assert manifold_faults(quads(RULE, Field.of(values), 0.5)[1], 16) == (0, 0, 0)
