"""The tree gives the mesh of the uniform grid and looks only where the surface can be."""

from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref import Field, FieldError
from isoref import dyadic as article
from isoref.dyadic import (
    LipschitzBound,
    Samples,
    SlopeBound,
    Tree,
    global_slopes,
    lipschitz_constant,
)
from isoref.fast.dyadic import dyadic_tree, extract_dyadic, local_slopes
from isoref.fast.simplicial import active_cells, extract

BOUNDS = ["paper", "slopes", "local"]


def bound_of(name: str, field: Field) -> Any:
    """A bound of this kind that is true of the field."""
    if name == "paper":
        return LipschitzBound(lipschitz_constant(field))
    return global_slopes(field) if name == "slopes" else local_slopes(field)


def smooth(shape: tuple[int, ...], m: int, seed: int) -> Field:
    """A few long waves on a lattice."""
    rng = np.random.default_rng(seed)
    place = np.indices(shape) / max(shape)
    waves = [
        np.sin(np.tensordot(rng.normal(size=len(shape)) * 4, place, 1) + rng.uniform(0, 6))
        for _ in range(m)
    ]
    return Field.of(np.stack(waves), dimension=len(shape))


@pytest.mark.parametrize("test", ["corners", "centre"])
@pytest.mark.parametrize("bound", BOUNDS)
@pytest.mark.parametrize(
    ("shape", "m"), [((17, 17), 1), ((9, 20, 13), 1), ((9, 9, 9), 2), ((5, 6, 7, 9), 2)]
)
def test_the_tree_gives_the_mesh_of_the_uniform_grid(
    shape: tuple[int, ...], m: int, bound: str, test: Literal["corners", "centre"]
) -> None:
    """Section 6: samples are left out "without changing" the isosurface; here to the last bit."""
    for seed in range(2):
        field = smooth(shape, m, seed)
        tree = extract_dyadic(Samples.of_field(field), bound_of(bound, field), 0.1, test=test)
        grid = extract(field, 0.1)
        np.testing.assert_array_equal(tree.vertices, grid.vertices)
        np.testing.assert_array_equal(tree.simplices, grid.simplices)


@pytest.mark.parametrize("test", ["corners", "centre"])
@pytest.mark.parametrize("bound", BOUNDS)
@pytest.mark.parametrize(("shape", "m"), [((17, 11), 1), ((4, 9, 7), 2), ((3, 4, 2, 5), 2)])
def test_the_twin_has_the_tree_of_the_article(
    shape: tuple[int, ...], m: int, bound: str, test: Literal["corners", "centre"]
) -> None:
    """The same boxes in the same order, level by level, and the same mesh."""
    field = smooth(shape, m, 1)
    samples = Samples.of_field(field)
    slow_bound = article.local_slopes(field) if bound == "local" else bound_of(bound, field)
    fast = dyadic_tree(samples, bound_of(bound, field), 0.1, test)
    plain = article.dyadic_tree(samples, slow_bound, 0.1, test)
    assert len(fast.leaves) > 3
    assert (fast.sides, fast.tested) == (plain.sides, plain.tested)
    for one, other in zip(fast.boxes, plain.boxes, strict=True):
        np.testing.assert_array_equal(one, other)
    meshes = (
        extract_dyadic(samples, bound_of(bound, field), 0.1, test=test),
        article.extract_dyadic(samples, slow_bound, 0.1, test=test),
    )
    np.testing.assert_array_equal(meshes[0].vertices, meshes[1].vertices)
    np.testing.assert_array_equal(meshes[0].canonical().simplices, meshes[1].canonical().simplices)


@given(seed=st.integers(0, 10**6), bound=st.sampled_from(BOUNDS))
def test_no_true_bound_loses_a_cell_even_on_noise(seed: int, bound: str) -> None:
    """The proof in the module's text uses samples only, so roughness does not matter."""
    rng = np.random.default_rng(seed)
    field = Field.of(rng.normal(size=(2, *rng.integers(2, 7, 3))) * 2, dimension=3)
    tests: tuple[Literal["corners", "centre"], ...] = ("corners", "centre")
    for test in tests:
        tree = extract_dyadic(
            Samples.of_field(field),
            bound_of(bound, field),
            test=test,
        )
        np.testing.assert_array_equal(tree.simplices, extract(field).simplices)


def test_tighter_bounds_keep_fewer_boxes() -> None:
    """The paper's constant, slopes by component and axis, and slopes of each box."""
    field = smooth((33, 33, 33), 2, 3)
    samples = Samples.of_field(field)
    paper = dyadic_tree(samples, bound_of("paper", field), test="corners").tested
    slopes, local = (dyadic_tree(samples, bound_of(b, field)).tested for b in ("slopes", "local"))
    assert paper > slopes > local


def brute_lipschitz(field: Field) -> float:
    """Max |phi(b) - phi(a)| / |b - a| over all pairs of samples, as section 6 writes it."""
    index = np.indices(field.shape).reshape(field.dimension, -1).T
    values = field.values.reshape(field.components, -1).T
    apart = abs(index[:, None] - index).max(axis=2) + np.eye(len(index))
    change = abs(values[:, None] - values).max(axis=2)
    return float((change / apart).max())


@pytest.mark.parametrize("shape", [(4, 5), (3, 3, 4), (2, 3, 2, 3)])
def test_the_lipschitz_constant_over_neighbours_is_that_over_all_pairs(
    shape: tuple[int, ...],
) -> None:
    """Section 6, definition of L: a way of d diagonal steps joins samples d apart."""
    field = Field.of(np.random.default_rng(1).normal(size=(2, *shape)), dimension=len(shape))
    assert lipschitz_constant(field) == pytest.approx(brute_lipschitz(field), rel=1e-12)


def test_local_slopes_bound_every_change_in_their_box() -> None:
    """Against the samples of each box of the tree, one by one."""
    field = Field.of(np.random.default_rng(2).normal(size=(2, 7, 5)), dimension=2)
    bound = local_slopes(field)
    for side in (1, 2, 4, 8):
        for low in np.ndindex(*(-(-(N - 1) // side) for N in field.shape)):
            a = np.array([low]) * side
            b = np.minimum(a + side, np.array(field.shape) - 1)
            part = field.values[:, a[0, 0] : b[0, 0] + 1, a[0, 1] : b[0, 1] + 1]
            spread = bound.spread(b - a, a, b)[0]
            assert (np.ptp(part.reshape(2, -1), axis=1) <= spread + 1e-12).all()


def circle(x: np.ndarray) -> np.ndarray:
    """The distance to the circle of radius 0.7 in the plane, (P, 1)."""
    distance: np.ndarray = np.linalg.norm(x, axis=1, keepdims=True) - 0.7
    return distance


def tree_of_circle(N: int) -> tuple[Samples, Tree]:
    """The circle on N cells a side of [-1, 1]^2, by the true slope 1."""
    samples = Samples.of_function(circle, (N + 1, N + 1), 2 / N, [-1, -1])
    return samples, dyadic_tree(samples, SlopeBound(np.full((1, 2), 2 / N)))


def test_a_function_is_called_near_the_surface_only() -> None:
    """Section 6: O(N^(n-m)) samples of O(N^n)."""
    asked = []

    def counting(x: np.ndarray) -> np.ndarray:
        asked.append(len(x))
        return circle(x)

    N = 256
    samples = Samples.of_function(counting, (N + 1, N + 1), 2 / N, [-1, -1])
    mesh = extract_dyadic(samples, SlopeBound(np.full((1, 2), 2 / N)))
    assert sum(asked) < 0.4 * (N + 1) ** 2
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 0.7, atol=1e-4)


def test_boxes_of_a_curve_double_with_the_resolution() -> None:
    """N - m = 1: halving the cells doubles the leaves, and each level has about twice the last."""
    leaves = [len(tree_of_circle(N)[1].leaves) for N in (64, 128, 256, 512)]
    exponent = np.polyfit(np.log2([64, 128, 256, 512]), np.log2(leaves), 1)[0]
    assert abs(exponent - 1) < 0.15
    samples, tree = tree_of_circle(64)
    assert tree.sides == [64, 32, 16, 8, 4, 2, 1]
    assert len(tree.leaves) < tree.stored_samples(samples.shape) < 65**2


def clifford(x: np.ndarray) -> np.ndarray:
    """The Clifford torus |z1| = |z2| = 1 in C^2 = R^4, (P, 2)."""
    return np.stack([1 - x[:, 0] ** 2 - x[:, 1] ** 2, 1 - x[:, 2] ** 2 - x[:, 3] ** 2], axis=1)


def tree_of_torus(N: int) -> Tree:
    """The Clifford torus on N cells a side of [-1.3, 1.3]^4, by its steepest slopes there."""
    h = 2.6 / N
    slopes = 2 * 1.3 * h * np.array([[1, 1, 0, 0], [0, 0, 1, 1]])
    return dyadic_tree(
        Samples.of_function(clifford, (N + 1,) * 4, h, [-1.3] * 4), SlopeBound(slopes)
    )


def test_leaves_of_a_surface_in_four_dimensions_grow_as_its_area() -> None:
    """Section 6: N^(n-m), here N^2; over four sizes, and more nearly with each doubling."""
    sizes = [8, 16, 32, 64]
    leaves = np.log2([len(tree_of_torus(N).leaves) for N in sizes])
    assert abs(np.polyfit(np.log2(sizes), leaves, 1)[0] - 2) < 0.15
    off = abs(np.diff(leaves) - 2)
    assert (np.diff(off) < 0).all()
    assert off[-1] < 0.1


@given(seed=st.integers(0, 10**6), bound=st.sampled_from(BOUNDS))
def test_leaves_are_the_cells_where_every_component_takes_both_signs(seed: int, bound: str) -> None:
    """No fewer, and with the test of all corners no more."""
    rng = np.random.default_rng(seed)
    field = Field.of(rng.integers(-2, 3, size=(2, *rng.integers(2, 7, 3))) * 1.0, dimension=3)
    tree = dyadic_tree(Samples.of_field(field), bound_of(bound, field))
    leaves = np.sort(np.ravel_multi_index(tuple(tree.leaves.T), field.shape))
    np.testing.assert_array_equal(leaves, active_cells(field, np.zeros(2)))


def test_a_surface_that_is_nowhere_is_found_out_at_the_first_box() -> None:
    """Section 6: if phi exceeds L * 2N at a corner, there is nothing more to do."""
    field = Field.of(np.full((9, 9), 5.0) + np.indices((9, 9))[0] * 0.1)
    tree = dyadic_tree(Samples.of_field(field), LipschitzBound(0.1), test="corners")
    assert (tree.tested, len(tree.boxes[0])) == (1, 0)
    assert len(extract_dyadic(Samples.of_field(field), LipschitzBound(0.1)).simplices) == 0


def test_a_constant_that_is_too_small_is_detected_where_samples_contradict_it() -> None:
    """Section 6 trusts L; two samples of one box can show that it is wrong."""
    field = Field.of(np.indices((17, 17)).sum(axis=0))
    samples, small = Samples.of_field(field), LipschitzBound(0.2 * lipschitz_constant(field))
    tests: tuple[Literal["corners", "centre"], ...] = ("corners", "centre")
    for test in tests:
        for make in (dyadic_tree, article.dyadic_tree):
            with pytest.raises(FieldError, match="the bound is too small: component 0 changes by"):
                make(samples, small, 16.0, test=test)


def test_a_constant_that_is_too_small_is_detected_on_the_corners_of_leaves() -> None:
    """A step that neither the middle nor the highest corner of any box shows."""
    values = np.where(np.indices((5, 5)).sum(axis=0) > 3, 1.0, -1.0)
    values[2, 1] = 60.0
    field = Field.of(values)
    for make in (dyadic_tree, article.dyadic_tree):
        with pytest.raises(FieldError, match="component 0 changes by 61 between samples of the"):
            make(Samples.of_field(field), LipschitzBound(2.0))


def test_a_constant_that_is_too_small_goes_unnoticed_where_no_sample_shows_it() -> None:
    """The limit of that: a spike between samples that were never asked is lost."""
    values = np.full((17, 17), 8.0)
    values[5, 6] = -1
    samples = Samples.of_field(Field.of(values))
    assert len(extract(Field.of(values)).simplices) > 0
    assert len(extract_dyadic(samples, LipschitzBound(0.1), test="corners").simplices) == 0


def test_bad_input_is_refused_with_a_reason() -> None:
    """A function of the wrong shape, values that are not finite, a thin lattice, no memory."""
    with pytest.raises(FieldError, match=r"shape \(1,\) for 1 points; \(1, m\) is needed"):
        Samples.of_function(lambda x: x[:, 0], (4, 4))
    broken = Samples.of_function(lambda x: np.full((len(x), 1), np.nan), (4, 4))
    with pytest.raises(FieldError, match="not finite"):
        dyadic_tree(broken, LipschitzBound(1.0))
    thin = Samples.of_function(lambda x: x[:, :1], (4, 1))
    with pytest.raises(FieldError, match="1 sample thick along axis 1"):
        dyadic_tree(thin, LipschitzBound(1.0))


def test_memory_that_would_not_suffice_is_refused_beforehand() -> None:
    """A level of the tree, the isosurface in the leaves, and the look-up of slopes."""
    samples, _ = tree_of_circle(16)
    bound = SlopeBound(np.full((1, 2), 2 / 16))
    with pytest.raises(FieldError, match="a level of 4 boxes needs about 192 bytes, but 100 are"):
        extract_dyadic(samples, bound, memory=100)
    with pytest.raises(
        FieldError, match=r"the isosurface in 44 cells needs about .* but 9,999 are"
    ):
        extract_dyadic(samples, bound, memory=9999)
    with pytest.raises(FieldError, match=r"slopes .* samples needs about 2,592 bytes, but 100 are"):
        local_slopes(Field.of(np.zeros((9, 9))), memory=100)
