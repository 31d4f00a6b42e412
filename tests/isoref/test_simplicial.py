"""Isosurfaces in any dimension, as the article cuts them: one section after the other."""

import numpy as np
import pytest
from isoref import Field, FieldError
from isoref.simplicial import extract, kuhn_complex, section, section_of_field


def test_a_section_has_one_dimension_and_one_value_fewer() -> None:
    """Section 4: C_J, then (n-1)-simplices, then (n-2)-simplices."""
    values = np.random.default_rng(1).normal(size=(2, 3, 3, 3))
    flat = values.reshape(2, -1)
    cells = np.flatnonzero((np.indices((3, 3, 3)) < 2).all(axis=0))
    sizes = []
    complex_ = kuhn_complex((3, 3, 3), cells, lambda numbers: flat[:, numbers].T)
    for _ in range(2):
        sizes.append((complex_.simplices.shape[1] - 1, complex_.values.shape[1]))
        complex_ = section(complex_)
    sizes.append((complex_.simplices.shape[1] - 1, complex_.values.shape[1]))
    assert sizes == [(3, 2), (2, 1), (1, 0)]
    assert len(complex_.simplices) > 10
    assert complex_.names.shape[1] == 4


def test_names_climb_and_say_which_samples_a_vertex_comes_from() -> None:
    """Vertices of a section are numbered by (lower end, higher end) of their edge."""
    field = Field.of(np.random.default_rng(2).normal(size=(4, 4)))
    found = section_of_field(field)
    assert sorted(map(tuple, found.names.tolist())) == list(map(tuple, found.names.tolist()))
    ends = np.stack(np.unravel_index(found.names, (4, 4)), axis=-1)
    low, high = ends.min(axis=1), ends.max(axis=1)
    assert len(found.points) > 5
    assert ((low <= found.points) & (found.points <= high)).all()


def test_values_that_cannot_be_interpolated_are_refused() -> None:
    """With a hint what to do."""
    with pytest.raises(FieldError, match="rescale the field"):
        extract(Field.of(np.array([[1e308, -1e308], [0, 0]])))
    with pytest.raises(FieldError, match="3 components on a lattice of dimension 2"):
        extract(Field.of(np.zeros((3, 4, 4)), dimension=2))
