from typing import Any

import numpy as np
import pytest
from isoref.field import Field, FieldError, inside_samples, least_inside


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"values": [[1.0, np.nan]]}, r"sample \(0, 1\) is nan"),
        ({"values": [[1.0, np.inf]]}, r"sample \(0, 1\) is inf"),
        ({"values": np.zeros((2, 0))}, "no samples"),
        ({"values": 3.0}, "rank 0"),
        ({"values": np.zeros((2, 2)), "dimension": 3}, "rank 2"),
        ({"values": [[1.0, 2.0], [3.0]]}, "different lengths"),
        ({"values": ["a"]}, "not real numbers"),
        ({"values": [1j]}, "not real numbers"),
        ({"values": [1.0], "spacing": 0}, "positive"),
        ({"values": [1.0], "origin": [0, 0]}, "origin"),
        ({"values": np.zeros((2, 2)), "spacing": [1, 1, 1]}, "spacing .* does not fit 2 axes"),
        ({"values": np.zeros((2, 2)), "spacing": [1]}, "spacing .* does not fit 2 axes"),
        ({"values": np.zeros((2, 2)), "spacing": "wide"}, "spacing 'wide' is not made of numbers"),
        ({"values": np.zeros((2, 2)), "origin": [[0, 0]]}, "origin .* does not fit 2 axes"),
        ({"values": np.zeros((2, 2)), "origin": [0, np.inf]}, "origin .* finite"),
        ({"values": np.ma.masked_less([1.0, 2.0], 1.5)}, "masked array .* fill it"),
        ({"values": np.ma.array([1.0, 2.0])}, "masked array"),
        ({"values": np.zeros((2, 2)), "origin": [0, np.nan]}, "origin"),
        ({"values": np.zeros((2, 2)), "spacing": [1, np.inf]}, "finite"),
        ({"values": np.zeros((2, 2)), "directions": np.eye(3)}, "2 rows of 2 finite numbers"),
        ({"values": np.zeros((2, 2)), "directions": [[1, 0], [0, np.nan]]}, "2 finite numbers"),
        ({"values": np.zeros((2, 2)), "directions": "up"}, "not made of numbers"),
        ({"values": np.zeros((2, 2)), "directions": [[2, 0], [0, 1]]}, "belongs to spacing"),
        ({"values": np.zeros((2, 2)), "directions": [[1, 0], [-1, 0]]}, "lie in a plane"),
    ],
)
def test_what_is_no_field_is_refused_with_what_and_where(
    arguments: dict[str, Any], message: str
) -> None:
    """Design: NaN, infinities, empty arrays, wrong ranks give a clear error."""
    with pytest.raises(FieldError, match=message):
        Field.of(**arguments)


def test_components_come_first_where_the_dimension_is_named() -> None:
    """A field of m components on an n-dimensional lattice has rank n + 1."""
    field = Field.of(np.zeros((2, 3, 4, 5)), dimension=3)
    assert (field.components, field.shape, field.dimension) == (2, (3, 4, 5), 3)


def test_samples_are_not_copied() -> None:
    """Large volumes are held once."""
    values = np.zeros((3, 3, 3), np.int16)
    assert Field.of(values).values is values


def test_a_scalar_field_has_one_component() -> None:
    """However many samples it has along its first axis."""
    field = Field.of(np.zeros((3, 4)))
    assert (field.components, field.shape, field.dimension) == (1, (3, 4), 2)


def test_a_sample_on_the_isovalue_is_inside_whatever_its_type() -> None:
    """The convention is value >= isovalue, compared exactly and not in the samples' precision.

    Single precision rounds 0.3 up and 0.7 down.
    """
    for kind in (np.float16, np.float32, np.float64):
        for level in (0.1, 0.3, 0.7):
            middle = kind(level)
            samples = np.array(
                [np.nextafter(middle, kind(-1)), middle, np.nextafter(middle, kind(1))], kind
            )
            exact = [float(s) >= level for s in samples]
            assert (samples >= least_inside(samples.dtype, level)).tolist() == exact
    mask = inside_samples(Field.of(np.arange(5, dtype=np.uint8)), 2.5)
    assert mask.tolist() == [False, False, False, True, True]


@pytest.mark.parametrize(
    ("affine", "message"),
    [
        (np.eye(4), "the affine of 2 axes is 3 by 3"),
        (np.diag([1, 1, 2]), "last row"),
        (np.diag([1, 0, 1]), "moves nothing along axis 1"),
        (np.diag([1, np.nan, 1]), "finite numbers"),
        ([[1, 2, 0], [1, 2, 0], [0, 0, 1]], "lie in a plane"),
    ],
)
def test_an_affine_that_is_none_is_refused(affine: Any, message: str) -> None:
    """With what is wrong."""
    with pytest.raises(FieldError, match=message):
        Field.of_affine(np.zeros((2, 2)), affine)


def test_an_affine_comes_back_and_takes_indices_to_positions() -> None:
    """Oblique, mirrored and sheared: `affine`, `position` and `index` say one thing."""
    random = np.random.default_rng(0)
    for _ in range(20):
        affine = np.vstack([random.normal(size=(3, 4)), [0, 0, 0, 1]])
        field = Field.of_affine(np.zeros((2, 3, 4)), affine)
        assert field.affine == pytest.approx(affine)
        assert field.handedness == np.sign(np.linalg.det(affine[:3, :3]))
        index = random.normal(size=(5, 7, 3))
        places = index @ affine[:3, :3].T + affine[:3, 3]
        assert field.position(index) == pytest.approx(places)
        assert field.index(places) == pytest.approx(index)


def test_directions_along_the_axes_of_space_change_nothing() -> None:
    """A field with them is a straight one."""
    field = Field.of(np.zeros((2, 2, 2)), 2, 5, directions=np.eye(3))
    assert field.directions is None
    assert field.straight() is field
    assert field.handedness == 1
