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
    """The convention is value >= isovalue, compared exactly and not in the samples' precision."""
    for kind in (np.float16, np.float32, np.float64):
        middle = kind(0.3)
        samples = np.array(
            [np.nextafter(middle, kind(-1)), middle, np.nextafter(middle, kind(1))], kind
        )
        exact = [float(s) >= 0.3 for s in samples]
        assert (samples >= least_inside(samples.dtype, 0.3)).tolist() == exact
    mask = inside_samples(Field.of(np.arange(5, dtype=np.uint8)), 2.5)
    assert mask.tolist() == [False, False, False, True, True]
