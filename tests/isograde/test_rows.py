"""Rows, places and components, beside what NumPy and SciPy say of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isograde.oracles.rows import components_of, distinct, near_pairs
from isoref.field import Array, Floats
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed: int, count: int, columns: int) -> Floats:
    """Places of which many share coordinates, some with a little noise, as vertices do."""
    random = np.random.default_rng(seed)
    places = random.integers(0, 4, (count, columns)) + 0.5 * random.integers(0, 2, (count, columns))
    noise = random.choice([0.0, 0.0, 1e-6, 3e-6], (count, columns))
    return np.asarray(places + noise * random.choice([-1, 1], (count, columns)))


@settings(max_examples=50, deadline=None)
@given(SEEDS, st.integers(0, 60), st.integers(1, 5), st.booleans())
def test_rows_are_told_apart_as_numpy_does(
    seed: int, count: int, columns: int, whole: bool
) -> None:
    """The same rows in the same order, the same first of each, the same names."""
    rows: Array = drawn(seed, count, columns)
    rows = np.rint(rows).astype(np.int64) if whole else rows
    first, name = distinct(rows)
    if not count:
        assert (len(first), len(name)) == (0, 0)
        return
    unique, index, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    assert np.array_equal(rows[first], unique)
    assert np.array_equal(first, index)
    assert np.array_equal(name, inverse.reshape(-1))


@settings(max_examples=50, deadline=None)
@given(
    SEEDS, st.integers(0, 80), st.integers(1, 6), st.booleans(), st.sampled_from([1e-6, 4e-6, 1])
)
def test_near_pairs_are_those_of_a_tree(
    seed: int, count: int, columns: int, along_axes: bool, tolerance: float
) -> None:
    places = drawn(seed, count, columns) + 100.0
    pairs = near_pairs(places, tolerance, along_axes=along_axes)
    found = {tuple(sorted(pair)) for pair in pairs.T.tolist()}
    if not count:
        assert not found
        return
    assert found == KDTree(places).query_pairs(tolerance, p=np.inf if along_axes else 2)


@pytest.mark.parametrize("far", [0.0, 1e9])
def test_places_far_from_zero_lose_no_pair(far: float) -> None:
    """The line on to which they are projected rounds; what is near in space is still looked at."""
    places = far + np.array([[0.0, 0, 0], [0, 0, 2.0**-20], [5, 0, 0]])
    assert near_pairs(places, 1e-6).tolist() == [[0], [1]]


@settings(max_examples=50, deadline=None)
@given(SEEDS, st.integers(0, 80), st.integers(0, 100))
def test_components_are_those_of_a_graph(seed: int, nodes: int, edges: int) -> None:
    """As many, and numbered as SciPy numbers them: in the order of their first nodes."""
    edges = edges if nodes else 0
    pairs = np.random.default_rng(seed).integers(0, max(nodes, 1), (2, edges))
    count, name = components_of(nodes, pairs)
    graph = coo_array((np.ones(edges), (pairs[0], pairs[1])), shape=(nodes, nodes))
    if not nodes:
        assert count == 0
        return
    wanted = connected_components(graph, directed=False)
    assert (count, name.tolist()) == (wanted[0], wanted[1].tolist())


def test_a_long_chain_in_any_order_is_one_component() -> None:
    """A hundred thousand nodes, whose pairs come as they like: a few dozen rounds, not as many."""
    order = np.random.default_rng(0).permutation(100_000)
    count, name = components_of(len(order), np.stack([order[:-1], order[1:]]))
    assert count == 1
    assert not name.any()


@pytest.mark.parametrize(
    ("along_axes", "tolerance", "near"),
    [(False, 5.0, True), (False, 4.99, False), (True, 4.0, True), (True, 3.99, False)],
)
def test_a_pair_at_the_tolerance_is_near(along_axes: bool, tolerance: float, near: bool) -> None:
    """Three and four away: five in all, and four at most along an axis."""
    pairs = near_pairs(np.array([[0.0, 0], [3, 4]]), tolerance, along_axes=along_axes)
    assert pairs.shape[1] == near
