"""The sweep: where vertices stand, which are one, and what is refused."""

import numpy as np
import pytest
from isoref.cube import crossed_edges
from isoref.field import Field, FieldError
from isoref.methods import RULES
from isoref.sweep import (
    cell_crossings,
    crossing_parameter,
    lattice_edge,
    sweep,
)


def test_a_lattice_edge_has_one_name_in_all_cells_around_it() -> None:
    """Weld rule: 12 edges of 27 cells are the 3 * 3 * 4 * 4 edges of a lattice of 4^3 samples."""
    names = [lattice_edge(cell, e) for cell in np.ndindex(3, 3, 3) for e in range(12)]
    assert len(set(names)) == 3 * 3 * 4 * 4
    assert max(names.count(name) for name in set(names)) == 4


def test_there_is_one_vertex_on_each_crossed_lattice_edge() -> None:
    """Counted from the samples alone; the rule of 1987 has no interior points."""
    values = np.random.default_rng(5).normal(size=(4, 5, 3))
    inside = values >= 0.2
    crossed = sum(int((np.diff(inside, axis=a) != 0).sum()) for a in range(3))
    assert len(sweep(RULES["lorensen-cline"], Field.of(values), 0.2).vertices) == crossed > 50


def test_each_triangle_names_the_cell_it_lies_in() -> None:
    """In C order over the cells."""
    values = np.random.default_rng(3).normal(size=(3, 4, 5))
    mesh = sweep(RULES["asymptotic-decider"], Field.of(values), 0.0, provenance=True)
    cells = mesh.traced().cells
    assert len(cells) == len(mesh.simplices) > 30
    assert np.all(np.diff(cells) >= 0)
    low = np.stack(np.unravel_index(cells, (2, 3, 4)), axis=1)[:, None]
    points = mesh.vertices[mesh.simplices]
    assert np.all((low <= points) & (points <= low + 1))


def test_crossings_stand_on_the_crossed_edges_alone() -> None:
    """For every signs, whatever the values."""
    g = np.random.default_rng(1).normal(size=(8, 400))
    found = np.asarray(~np.isnan(cell_crossings(g)).all(axis=2))
    signs = ((g >= 0) * (1 << np.arange(8))[:, None]).sum(axis=0)
    for n, s in enumerate(signs.tolist()):
        assert tuple(np.flatnonzero(found[:, n]).tolist()) == crossed_edges(s)


def test_the_crossing_of_the_smallest_floats_is_between_them() -> None:
    """Nothing is halved that has no half."""
    least = np.array([5e-324])
    assert crossing_parameter(-least, least) == 0.5
    assert crossing_parameter(-1.7e308 * least / least, least) == 1.0
    assert crossing_parameter(np.array([-1.7e308]), np.array([0.85e308])) == pytest.approx(2 / 3)


def test_samples_that_are_one_float_are_crossed_at_the_lower_one() -> None:
    """Whole numbers beyond 2^53, one inside and one not: the crossing is somewhere, not NaN."""
    assert crossing_parameter(np.array([0.0, -1.0]), np.array([0.0, 3.0])).tolist() == [0.0, 0.25]


def test_a_difference_beyond_what_a_float_holds_is_refused() -> None:
    """With a hint what to do."""
    with pytest.raises(FieldError, match="than a float holds"):
        crossing_parameter(np.array([-np.inf]), np.array([1e308]))
