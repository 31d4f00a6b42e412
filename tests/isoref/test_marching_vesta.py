"""Marching VESTA: Table I, the examples of Figs. 16 and 17, and the original beside it."""

from collections import Counter
from itertools import product
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from isograde.oracles.complexes import Complex
from isograde.proof import prove
from isoref import cycles as general
from isoref.cube import CORNERS, ambiguous_faces, corner_at
from isoref.diconex import Mode
from isoref.fast.sweep import sweep
from isoref.field import Field, Integers
from isoref.marching_vesta import (
    CENTRES,
    DIAGONALS,
    JUNCTURES,
    ORDER,
    PATHS,
    RULES,
    cell_paths,
    cycles,
    paper_number,
    rule,
)
from isoref.mesh import Mesh
from isoref.sweep import sweep as sweep_plain
from isoref.vesta import SIX_SURFACES, Resolution, extract

MODES = get_args(Mode)

# Table I as printed: centre, then the plus path's two junctures; the minus path is its reverse.
TABLE_1 = {
    0: (13, 12), 1: (12, 14), 2: (15, 12), 3: (12, 16), 4: (14, 13), 5: (13, 15),
    6: (16, 14), 7: (15, 16), 8: (17, 13), 9: (14, 17), 10: (17, 15), 11: (16, 17),
}  # fmt: skip

# Fig. 15b: the paper's voxel numbers go round the bottom, then round the top.
PAPER_CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
PAPER_CORNERS += [(i, j, 1) for i, j, _ in PAPER_CORNERS]


def signs_of(*voxels: int) -> int:
    """Signs with these voxels, numbered as in the paper, active."""
    return sum(1 << corner_at(*PAPER_CORNERS[v]) for v in voxels)


def test_the_paths_are_table_1() -> None:
    """Table I, all 24 paths, derived here from the right-hand rule."""
    printed = {}
    for plus, minus in PATHS:
        assert minus == plus[::-1]
        begin, centre, end = plus
        printed[paper_number(CENTRES[centre])] = (
            paper_number(JUNCTURES[begin]),
            paper_number(JUNCTURES[end]),
        )
    assert printed == TABLE_1


def test_one_active_voxel_gives_the_sequence_of_figure_16() -> None:
    """Section II.F: 17 - 9 - 14 - 6 - 16 - 11 - 17 for voxel 7, so the 3-cycle 9 - 6 - 11."""
    signs = signs_of(7)
    (cycle,) = cycles(signs, 0)
    numbers = [paper_number(CENTRES[e]) for e in cycle]
    at = numbers.index(9)
    assert numbers[at:] + numbers[:at] == [9, 6, 11]
    begins = {paper_number(CENTRES[e]): p[0] for e, p in cell_paths(signs).items()}
    assert [paper_number(JUNCTURES[begins[n]]) for n in (9, 6, 11)] == [17, 14, 16]


def test_three_active_voxels_give_the_cycles_of_figure_17() -> None:
    """Section II.F: a 3- and a 4-cycle disconnect, one 7-cycle connects; one ambiguous face."""
    shapes = []
    for three in range(256):
        if three.bit_count() == 3 and len(ambiguous_faces(three)) == 1:
            apart = sorted(len(c) for c in cycles(three, 0b111111))
            shapes.append((apart, [len(c) for c in cycles(three, 0)]))
    assert shapes == [([3, 4], [7])] * 24


def rotated_to_start(polygon: tuple[int, ...]) -> tuple[int, ...]:
    """The polygon begun at its first centre in the order of VESTA."""
    start = polygon.index(min(polygon, key=ORDER.index))
    return polygon[start:] + polygon[:start]


def test_tables_and_faces_trace_the_same_cycles() -> None:
    """The paths of Table I and the segments of `isoref.cycles`, for all signs and decisions."""
    for signs in range(256):
        for choice in product((0, 1), repeat=len(ambiguous_faces(signs))):
            bits = sum(b << f for f, b in zip(ambiguous_faces(signs), choice, strict=True))
            expected = {rotated_to_start(p) for p in general.cycles(signs, bits)}
            assert set(cycles(signs, bits)) == expected


@pytest.mark.parametrize("separated", [0b111111, 0])
def test_the_256_cells_in_a_global_mode(separated: int) -> None:
    """Both global modes give 144, 66, 72, 52 and 24 cycles of 3 to 7 over the 256 cells."""
    total = Counter(len(c) for signs in range(256) for c in cycles(signs, separated))
    assert total == {3: 144, 4: 66, 5: 72, 6: 52, 7: 24}


@pytest.mark.parametrize("mode", MODES)
def test_each_cell_has_the_cycles_of_the_original(mode: Mode) -> None:
    """A cell is a volume of eight voxels: the global algorithm finds the cycles of the table."""
    generator = np.random.default_rng(0)
    for signs in range(256):
        size = generator.uniform(0.1, 1, 8)
        g = np.where([signs >> c & 1 for c in range(8)], size, -size)
        grey = np.empty((2, 2, 2))
        for c, corner in enumerate(CORNERS):
            grey[corner] = g[c]
        surface = extract(grey, 0, mode=mode)
        whole = {
            tuple(map(tuple, surface.centres[row].tolist()))
            for rows in surface.cycles.values()
            for row in rows
        }
        found = rule(mode, "L").decisions(g[:, None])[0] if mode == "mixed" else 0
        bits = {"disconnect": 63, "connect": 0, "mixed": int(found)}[mode]
        table = {tuple(map(tuple, CENTRES[list(c)].tolist())) for c in cycles(signs, bits)}
        assert whole == table


def volumes() -> st.SearchStrategy[Integers]:
    """Small volumes of small whole numbers: many ties, many points of ambiguity."""
    shapes = array_shapes(min_dims=3, max_dims=3, min_side=2, max_side=4)
    drawn: st.SearchStrategy[Integers] = arrays(np.int64, shapes, elements=st.integers(0, 4))
    return drawn


def placed(mesh: Mesh) -> list[list[list[float]]]:
    """The triangles by the positions of their corners, each begun at its least, sorted."""
    corners = np.round(mesh.vertices, 9)[mesh.simplices].tolist()
    return sorted(t[(s := t.index(min(t))) :] + t[:s] for t in corners)


@given(volumes(), st.sampled_from(SIX_SURFACES))
def test_original_and_marching_give_the_same_mesh(
    grey: Integers, six: tuple[Mode, Resolution]
) -> None:
    """Section II.F: the same cycles, and with shared points the same triangles."""
    mode, resolution = six
    marching = sweep(rule(mode, resolution), Field.of(grey), 1.7)
    original = extract(grey, 1.7, mode=mode).mesh(resolution)
    assert len(marching.vertices) == len(original.vertices)
    assert placed(marching) == placed(original)


@given(volumes(), st.sampled_from(MODES))
def test_shared_support_points_are_equal_to_the_last_bit(grey: Integers, mode: Mode) -> None:
    """Both interpolate along the lattice edge, from its lower end."""
    marching = sweep(rule(mode, "L"), Field.of(grey, spacing=(0.3, 1.1, 7)), 1.7).vertices
    original = extract(Field.of(grey, spacing=(0.3, 1.1, 7)), 1.7, mode=mode)
    count = len(original.points)
    assert sorted(marching[:count].tolist()) == sorted(original.points.tolist())


@pytest.mark.parametrize(("mode", "resolution"), SIX_SURFACES)
def test_plain_and_vectorised_sweeps_agree(mode: Mode, resolution: Resolution) -> None:
    """The rules run in both sweeps."""
    field = Field.of(np.random.default_rng(1).normal(size=(5, 6, 4)))
    one, other = (run(rule(mode, resolution), field, 0.2) for run in (sweep, sweep_plain))
    assert placed(one) == placed(other)


def test_there_are_six_rules() -> None:
    """Section II.E: six different types of surfaces."""
    assert len({r.name for r in RULES}) == 6


@pytest.mark.parametrize(("mode", "resolution"), SIX_SURFACES)
def test_a_tube_links_voxels_that_share_a_point(mode: Mode, resolution: Resolution) -> None:
    """Fig. 10: two octahedra without the tube, one closed surface of a sphere with it."""
    values = np.zeros((4, 4, 4))
    values[1, 1, 1] = values[2, 2, 2] = 1
    apart = sweep(rule(mode, resolution), Field.of(values), 0.5)
    linked = sweep(rule(mode, resolution, tube=True), Field.of(values), 0.5)
    two, one = (Complex.of(m.vertices, m.simplices) for m in (apart, linked))
    assert (two.components, two.euler) == (2, 4)
    assert (one.components, one.euler) == (1, 2)
    assert len(one.open_facets) == len(one.misdirected_facets) == len(one.crowded_facets) == 0
    assert len(linked.simplices) == len(apart.simplices) - 2 + 6
    assert one.enclosed > two.enclosed > 0


def test_a_tube_keeps_surfaces_closed_and_oriented() -> None:
    """By enumeration of all tiles that can meet; and the complement of two voxels has no tube."""
    assert prove(rule("mixed", "L", tube=True)).holds
    plain, tubed = rule("disconnect", "L"), rule("disconnect", "L", tube=True)
    changed = [s for s in range(256) if plain.tile(s, 0) != tubed.tile(s, 0)]
    assert changed == sorted(DIAGONALS)
    assert all(s.bit_count() == 2 for s in changed)
