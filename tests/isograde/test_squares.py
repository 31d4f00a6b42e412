"""Squares of the plane: the legal table by its own laws, and scikit-image's contours."""

from itertools import pairwise

import numpy as np
import pytest
from isograde.oracles.lattice import Lattice
from isograde.oracles.squares import CORNERS, NODES, PAIRS, Squares, legal, squares
from isoref.field import Field, Floats
from skimage.measure import find_contours


def test_a_legal_square_meets_every_crossed_edge_once() -> None:
    """And no other edge; inside and outside exchanged, separated and joined are too."""
    table = legal()
    for signs, pair in enumerate(table):
        inside = {c for bit, c in enumerate(CORNERS) if signs >> bit & 1}
        crossed = [
            k
            for k, (a, b) in enumerate(NODES)
            if len({(a if a != 1 else s, b if b != 1 else s) for s in (0, 2)} & inside) == 1
        ]
        for code in pair.tolist():
            ends = [node for bit, both in enumerate(PAIRS) if code >> bit & 1 for node in both]
            assert sorted(ends) == crossed
    assert np.array_equal(table[::-1, ::-1], table)
    assert (table[:, 0] != table[:, 1]).sum() == 2


def of_contours(values: Floats, connected: str) -> Squares:
    """What scikit-image's contours do."""
    lines = find_contours(values, 0.0, fully_connected=connected)
    places = np.concatenate(lines)
    start = np.cumsum([0, *map(len, lines)])
    parts = [
        np.stack([np.arange(a, b - 1), np.arange(a + 1, b)], axis=1) for a, b in pairwise(start)
    ]
    _, name = np.unique(places, axis=0, return_inverse=True)
    _, first = np.unique(places, axis=0, return_index=True)
    return squares(
        Lattice.of(Field.of(values), (0.0,)), places[first], name.reshape(-1)[np.concatenate(parts)]
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_peer_is_legal_and_keeps_its_polarity(seed: int) -> None:
    """`fully_connected` says which side is joined at ambiguous squares."""
    values = np.random.default_rng(seed).normal(size=(12, 13))
    for connected in ("low", "high"):
        found = of_contours(values, connected)
        assert len(found.place) > 60
        assert (found.separated | found.joined).all()
        assert found.ambiguous.sum() > 5
        assert (found.joined if connected == "high" else found.separated)[found.ambiguous].all()


def test_a_vertex_inside_a_square_is_part_of_its_curve() -> None:
    """Cut in two in the middle, a curve is legal; with a spur it is not."""
    field = Field.of(np.array([[1.0, -1], [-1, -1]]))
    places = np.array([[0.5, 0], [0, 0.5], [0.3, 0.3], [0.6, 0.6]])
    lattice = Lattice.of(field, (0.0,))
    right = squares(lattice, places, np.array([[0, 2], [2, 1]]))
    assert right.separated.tolist() == [True]
    assert right.segments.tolist() == right.wanted.tolist() == [2]
    for wrong in ([[0, 2], [2, 1], [2, 3]], [[0, 2], [3, 1]], [[0, 1], [1, 0]], [[0, 2]]):
        assert squares(lattice, places, np.array(wrong)).separated.tolist() == [False]


def test_a_segment_across_two_squares_is_found() -> None:
    """No square contains it."""
    lattice = Lattice.of(Field.of(np.random.default_rng(0).normal(size=(4, 4))), (0.0,))
    places = np.array([[0.5, 0], [2.5, 0]])
    assert squares(lattice, places, np.array([[0, 1]])).spanning.tolist() == [0]


def test_samples_and_ties_of_a_square_are_those_of_its_corners() -> None:
    """In the order of `Squares.values`; one tied corner is enough, whichever it is."""
    values = np.random.default_rng(4).uniform(1, 3, (6, 5))
    values[::2, ::2] *= -1
    values[3, 2] = 0.0
    found = squares(
        Lattice.of(Field.of(values), (0.0,)), np.empty((0, 2)), np.empty((0, 2), np.int64)
    )
    corners = [values[i : i + 2, j : j + 2].T.reshape(-1) for i, j in found.place.tolist()]
    assert found.values.tolist() == np.array(corners).tolist()
    assert found.tied.tolist() == [not corner.all() for corner in corners]
    assert found.tied.sum() == 4
