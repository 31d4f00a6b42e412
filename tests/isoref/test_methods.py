"""The catalogue: one call for every method, in either precision."""

import numpy as np
import pytest
from isoref import METHODS, FieldError, extract
from isoref.methods import RULES


@pytest.mark.parametrize("method", METHODS)
def test_every_method_gives_its_mesh_in_either_precision(method: str) -> None:
    """Single precision is the same mesh, rounded."""
    values = np.random.default_rng(3).normal(size=(5, 6, 7))
    double, single = (
        extract(values, 0.1, (0.5, 1, 3), (9, 0, 1), method, precision=precision)
        for precision in ("double", "single")
    )
    assert len(double.simplices) > 20
    assert [str(a.dtype) for a in (double.vertices, double.simplices)] == ["float64", "int64"]
    assert [str(a.dtype) for a in (single.vertices, single.simplices)] == ["float32", "int32"]
    assert np.array_equal(single.vertices, double.vertices.astype(np.float32))
    assert np.array_equal(single.simplices, double.simplices)


def test_an_unknown_method_or_precision_is_named() -> None:
    """With what there is."""
    with pytest.raises(ValueError, match="no method 'cubes'; there are asymptotic-decider"):
        extract(np.zeros((2, 2, 2)), 0, method="cubes")
    for method in ("asymptotic-decider", "simplicial"):
        with pytest.raises(FieldError, match="precision 'half'"):
            extract(np.zeros((2, 2, 2)), 0, method=method, precision="half")  # type: ignore[arg-type]


def test_rules_are_in_the_catalogue_under_their_names() -> None:
    """Each of them, carried by the sweep."""
    assert len(RULES) == 9
    assert set(RULES) <= set(METHODS)
