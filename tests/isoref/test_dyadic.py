"""The dyadic tree, as the article walks it: box by box."""

import numpy as np
import pytest
from isoref import Field
from isoref.dyadic import (
    LipschitzBound,
    Samples,
    SlopeBound,
    dyadic_tree,
    extract_dyadic,
    local_slopes,
)
from isoref.field import FieldError, Floats, Integers
from isoref.simplicial import extract


def disc(N: int) -> Field:
    """The square of the distance from a point near the middle of N^2 samples."""
    return Field.of(((np.indices((N, N)) - N / 2.1) ** 2).sum(axis=0))


def test_the_tree_gives_the_mesh_of_the_uniform_grid() -> None:
    """Section 6: samples are left out "without changing" the isosurface."""
    field = disc(17)
    tree = extract_dyadic(Samples.of_field(field), local_slopes(field), 20.0)
    grid = extract(field, 20.0)
    assert len(tree.simplices) > 30
    np.testing.assert_array_equal(tree.vertices, grid.vertices)
    np.testing.assert_array_equal(tree.simplices, grid.simplices)


def test_boxes_halve_down_to_cells_and_stay_in_the_lattice() -> None:
    """Figure 3: sides 16, 8, 4, 2, 1, each box a part of one that was kept."""
    field = disc(14)
    tree = dyadic_tree(Samples.of_field(field), local_slopes(field), 20.0)
    assert tree.sides == [16, 8, 4, 2, 1]
    for side, above, boxes in zip(tree.sides[1:], tree.boxes, tree.boxes[1:], strict=False):
        parents = {tuple(low) for low in above.tolist()}
        assert {tuple((low // (2 * side) * 2 * side).tolist()) for low in boxes} <= parents
    assert (tree.leaves < 13).all()


def test_a_surface_that_is_nowhere_is_found_out_at_the_first_box() -> None:
    """Section 6: if phi exceeds L * 2N at a corner, there is nothing more to do."""
    field = Field.of(np.full((9, 9), 5.0) + np.indices((9, 9))[0] * 0.1)
    tree = dyadic_tree(Samples.of_field(field), LipschitzBound(0.1), test="corners")
    assert (tree.tested, len(tree.boxes[0])) == (1, 0)


@pytest.mark.parametrize("wrong", [float("nan"), -1.0, -float("inf")])
def test_a_constant_that_bounds_nothing_is_refused(wrong: float) -> None:
    """NaN and negative numbers would rule out every box: an empty mesh, and no word."""
    field = Field.of(np.indices((9, 9)).sum(axis=0) - 7.5)
    samples = Samples.of_field(field)
    with pytest.raises(FieldError, match="bounds nothing"):
        LipschitzBound(wrong)
    with pytest.raises(FieldError, match="bounds nothing"):
        SlopeBound(np.array([[1.0, wrong]]))

    def slopes(low: Integers, high: Integers) -> Floats:
        return np.full((len(low), 1, 2), wrong)

    with pytest.raises(FieldError, match="bounds nothing"):
        extract_dyadic(samples, SlopeBound(slopes))


def test_an_infinite_slope_rules_nothing_out() -> None:
    """Min's section 7.2 has a function that no slope bounds."""
    field = Field.of(np.indices((9, 9)).sum(axis=0) - 7.5)
    bound = SlopeBound(np.full((1, 2), np.inf))
    mesh = extract_dyadic(Samples.of_field(field), bound)
    assert len(mesh.simplices) == len(extract(field).simplices) > 0
