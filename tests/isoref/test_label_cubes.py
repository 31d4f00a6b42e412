"""The surface of labels knows nothing but inside and outside."""

import numpy as np
import pytest
from isoref.field import Field, FieldError
from isoref.label_cubes import one_label, surface
from isoref.methods import METHODS

from tests.isoref.counting import edges, fans


def test_vertices_are_the_middles_of_the_crossed_lattice_edges() -> None:
    """Twice a vertex is a lattice point with one odd coordinate, once for each crossed edge."""
    values = np.random.default_rng(0).normal(size=(7, 8, 9))
    doubled = 2 * surface(Field.of(values), 0.2).vertices
    assert ((doubled % 2).sum(axis=1) == 1).all()
    inside = values >= 0.2
    crossed = sum(int((np.diff(inside, axis=axis)).sum()) for axis in range(3))
    assert len(np.unique(doubled, axis=0)) == len(doubled) == crossed


def test_only_the_sides_of_the_samples_count() -> None:
    """Any monotonic change of the values gives the same arrays."""
    values = np.random.default_rng(1).normal(size=(6, 6, 6))
    mesh = surface(Field.of(values), 0.0)
    for changed, isovalue in ((np.exp(values), 1.0), (np.sign(values).astype(np.int8), 0.0)):
        other = surface(Field.of(changed), isovalue)
        np.testing.assert_array_equal(mesh.vertices, other.vertices)
        np.testing.assert_array_equal(mesh.simplices, other.simplices)


@pytest.mark.parametrize("seed", range(3))
def test_closed_oriented_and_a_manifold(seed: int) -> None:
    """By exact counts, behind a border of outside samples."""
    values = np.pad(np.random.default_rng(seed).integers(0, 3, size=(12, 12, 12)), 1)
    mesh = surface(Field.of(values), 1.0)
    found = edges(mesh.simplices)
    assert len(mesh.simplices) > 2000
    assert set(zip(found.forth.tolist(), found.back.tolist(), strict=True)) == {(1, 1)}
    assert set(fans(mesh.simplices, len(mesh.vertices)).tolist()) == {1}


def test_it_is_in_the_catalogue_and_refuses_what_is_no_volume() -> None:
    assert METHODS["label-cubes"] is surface
    with pytest.raises(FieldError, match="3-D lattice"):
        surface(Field.of(np.zeros((3, 3))), 0)
    with pytest.raises(FieldError, match="not finite"):
        surface(Field.of(np.zeros((3, 3, 3))), float("inf"))


def test_one_label_of_many_is_inside() -> None:
    """And it is closed from its neighbours by a surface of its own."""
    values = np.zeros((6, 6, 6), np.uint16)
    values[1:3, 1:3, 1:3], values[3:5, 1:3, 1:3] = 3, 7
    field = one_label(Field.of(values, 2.0), 3)
    assert np.array_equal(field.values > 0, values == 3)
    mesh = METHODS["label-cubes"](field, 0.0)
    assert mesh.vertices.min() == 1.0
    assert mesh.vertices[:, 0].max() == 5.0
    with pytest.raises(FieldError, match="no sample has the label 4; there are 0, 3, 7"):
        one_label(Field.of(values), 4)
