"""The judge of cells sees each fault it names, in meshes made to have just that fault."""

from collections.abc import Callable

import numpy as np
import pytest
from isograde.cases import trilinear_cells
from isograde.cases.trilinear_cells import TUNNELS, far
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import cells
from isograde.oracles.trilinear_grid import active_cells
from isoref import asymptotic_decider, lorensen_cline, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, Floats, Integers
from isoref.rule import Rule, Tile
from skimage.measure import marching_cubes


def judged(rule: Rule, values: Array) -> list[Fault]:
    """The fault of each active cell."""
    mesh = sweep(rule, Field.of(values), 0.0)
    index, corners = active_cells(values, 0.0)
    return judge(mesh.vertices, mesh.simplices, index, cells(corners), values.shape)


@pytest.fixture(scope="module")
def posed() -> list[Floats]:
    """The cells of a run that is not full."""
    listed = trilinear_cells.cases(0)
    return [
        np.asarray(case.build().values)
        for case in listed
        if "full" not in case.tags and "pair" not in case.tags
    ]


def test_the_reference_is_right_in_every_posed_cell(posed: list[Floats]) -> None:
    """Each topology, far and near; and in noise."""
    for values in posed[::3]:
        assert set(judged(trilinear_cubes.RULE, values)) <= {Fault.NONE}
    noise = np.random.default_rng(0).uniform(-1, 1, (12, 12, 12))
    assert set(judged(trilinear_cubes.RULE, noise)) == {Fault.NONE}


@pytest.mark.parametrize("name", TUNNELS)
def test_the_asymptotic_decider_misses_tunnels_and_nothing_else(name: str) -> None:
    """It has every face right (level 3) and no interior (Nielson & Hamann 1991)."""
    inside, outside = far(name, 0)
    assert judged(asymptotic_decider.RULE, inside) == [Fault.MISSING]
    assert judged(asymptotic_decider.RULE, outside) == [Fault.NONE]


def always_tunnel(signs: int, decisions: int) -> Tile:
    """A tile with a tunnel wherever faces allow one."""
    faces = decisions & trilinear_cubes.FACE_BITS
    for bit in (trilinear_cubes.INSIDE_TUNNEL, trilinear_cubes.OUTSIDE_TUNNEL):
        if trilinear_cubes.tunnel(signs, faces | bit) is not None:
            return trilinear_cubes.tile(signs, faces | bit)
    return trilinear_cubes.tile(signs, faces)


def has_false_tunnel(name: str) -> bool:
    """Whether drawing the tunnel in the cell without it is named as such."""
    rule = Rule("always", always_tunnel, trilinear_cubes.decisions, trilinear_cubes.asks, 8)
    real = trilinear_cubes.roots
    _, outside = far(name, 0)
    with np.errstate(all="ignore"):
        # The waist of a tunnel that is not there has no roots: put its points in the middle.
        trilinear_cubes.roots = lambda g, axis: (np.full(g.shape[1], 0.4), np.full(g.shape[1], 0.6))
        try:
            return judged(rule, outside) == [Fault.FALSE]
        finally:
            trilinear_cubes.roots = real


@pytest.mark.parametrize("name", TUNNELS)
def test_a_tunnel_that_is_not_there_is_named(name: str) -> None:
    """The opposite fault."""
    assert has_false_tunnel(name)


def test_fixed_polarity_has_wrong_faces() -> None:
    """A convention, not a fault at level 2; but not the trilinear interpolant."""
    values = np.random.default_rng(1).uniform(-1, 1, (10, 10, 10))
    found = judged(lorensen_cline.RULE, values)
    assert found.count(Fault.FACE) > 100
    assert set(found) <= {Fault.NONE, Fault.FACE, Fault.MISSING}


def changed(change: Callable[[Integers], Integers], values: Array) -> Fault:
    """The fault of one cell whose triangles were changed."""
    mesh = sweep(trilinear_cubes.RULE, Field.of(values), 0.0)
    index, corners = active_cells(values, 0.0)
    triangles = change(mesh.simplices)
    return judge(mesh.vertices, triangles, index, cells(corners), values.shape)[0]


def test_holes_handles_and_crowded_edges_are_named() -> None:
    """Take a triangle away; add one twice; glue on a closed bubble."""
    values, _ = far("4.2", 0)
    assert changed(lambda t: t[1:], values) is Fault.OPEN
    assert changed(lambda t: np.concatenate([t, t[:1], t[:1, ::-1]]), values) in {
        Fault.EULER,
        Fault.CROWDED,
    }


def test_a_bubble_in_the_cell_changes_the_euler_characteristic() -> None:
    """A closed surface inside a cell: the trilinear interpolant never has one."""
    values, _ = far("4.2", 0)
    mesh = sweep(trilinear_cubes.RULE, Field.of(values), 0.0)
    points = 0.5 + 0.01 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    bubble = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]) + len(mesh.vertices)
    vertices = np.concatenate([mesh.vertices, points])
    triangles = np.concatenate([mesh.simplices, bubble])
    index, corners = active_cells(values, 0.0)
    assert judge(vertices, triangles, index, cells(corners), (2, 2, 2)) == [Fault.EULER]


def test_flat_triangles_on_two_faces_count_for_the_cell() -> None:
    """Case 10.1.2 as scikit-image draws it: right for the cell, alone and amid others."""
    cell = np.array([-2.0, 1, 5, -5, -3, 5, 1, -2]).reshape(2, 2, 2)
    around = np.pad(cell, 1, constant_values=10.0)
    index, corners = active_cells(around, 0.0)
    vertices, faces = marching_cubes(around, 0.0)[:2]
    flat = vertices[faces].astype(float)
    assert (np.ptp(flat, axis=1) == 0).any()
    found = judge(vertices.astype(float), faces.astype(int), index, cells(corners), around.shape)
    at = index.tolist().index([1, 1, 1])
    assert found[at] is Fault.NONE


def test_single_precision_is_enough() -> None:
    """Vertices rounded to float32 are still found on their edges."""
    values = np.random.default_rng(2).uniform(-1, 1, (8, 8, 8))
    mesh = sweep(trilinear_cubes.RULE, Field.of(values), 0.0)
    index, corners = active_cells(values, 0.0)
    rounded = mesh.vertices.astype(np.float32).astype(float)
    found = judge(rounded, mesh.simplices, index, cells(corners), values.shape)
    assert set(found) == {Fault.NONE}


def test_a_sheet_that_is_missing_leaves_its_edges_open() -> None:
    """Case 4.1 without one of its two sheets: the other is whole."""
    _, values = far("4.2", 0)
    mesh = sweep(trilinear_cubes.RULE, Field.of(values), 0.0)
    assert len(mesh.simplices) == 2
    assert changed(lambda t: t[1:], values) is Fault.OPEN
    assert changed(lambda t: t[:1], values) is Fault.OPEN
