"""Naive surface nets: one vertex a cell, closed, and not a manifold at ambiguous faces."""

import numpy as np
from isoref.cube import is_ambiguous
from isoref.dual import signs_of
from isoref.fast.dual import quads
from isoref.field import Field, Floats
from isoref.surface_nets import RULE

from tests.isoref.counting import edges, fans, in_cells


def noise(seed: int = 0) -> Floats:
    """Normal random samples."""
    return np.random.default_rng(seed).normal(size=(12, 13, 14))


def test_every_active_cell_has_one_vertex() -> None:
    """Gibson, section 2; but for cells of the border without an inner crossed edge."""
    values = noise()
    vertices, _ = quads(RULE, Field.of(values), 0.2)
    cells = np.floor(vertices).astype(int)
    assert len(np.unique(cells, axis=0)) == len(cells)
    inside = values >= 0.2
    with_vertex = {tuple(cell) for cell in cells.tolist()}
    inner = [c for c in np.ndindex(11, 12, 13) if not in_cells(np.array([c]), values.shape)[0]]
    active = {cell for cell in inner if signs_of(inside, cell) not in (0, 255)}
    assert len(active) > 500
    assert active == {cell for cell in inner if cell in with_vertex}


def test_edges_of_four_quadrilaterals_are_exactly_the_ambiguous_faces() -> None:
    """The flaw, counted: away from the border every edge has two, or four at such a face."""
    values = noise(1)
    vertices, rows = quads(RULE, Field.of(values), 0.0)
    cells = np.floor(vertices).astype(int)
    found = edges(rows)
    inner = ~in_cells(cells, values.shape)[found.ends].any(axis=1)
    uses = (found.forth + found.back)[inner]
    assert set(uses.tolist()) == {2, 4}
    assert (found.forth == found.back)[inner].all()

    # Compare with the faces that the samples make ambiguous.
    inside = values >= 0
    for (a, b), n in zip(found.ends[inner].tolist(), uses.tolist(), strict=True):
        low, high = sorted((tuple(cells[a]), tuple(cells[b])))
        axis = int(np.flatnonzero(np.subtract(high, low))[0])
        assert (n == 4) == is_ambiguous(signs_of(inside, low), 2 * axis + 1)


def test_two_opposite_corners_hang_together_in_one_vertex() -> None:
    """The other half of the flaw: no ambiguous face, and still two pieces in one vertex."""
    values = np.zeros((4, 4, 4))
    values[1, 1, 1] = values[2, 2, 2] = 1
    vertices, rows = quads(RULE, Field.of(values), 0.5)
    found = edges(rows)
    assert len(found.crowded) == 0
    assert len(found.one_sided) == 0
    assert sorted(fans(rows, len(vertices)).tolist()) == [1] * 14 + [2]


def test_a_net_is_closed_and_oriented_where_the_samples_at_the_border_are_low() -> None:
    """Quadrilaterals come in pairs at every edge, of opposite directions."""
    values = np.pad(noise(2), 1, constant_values=-9)
    found = edges(quads(RULE, Field.of(values), 0.0)[1])
    assert len(found.one_sided) == 0
    assert len(found.crowded) > 100
