"""An index of bricks gives the mesh of the whole, and looks at no more than it has to."""

from itertools import product
from pathlib import Path
from typing import Any

import isoref.fast.bricks
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isoref.fast.bricks import Index, boxes
from isoref.field import FieldError
from isoref.mesh import Mesh, Precision
from isoref.methods import RULES, extract
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

PLACE: dict[str, Any] = {"spacing": (0.7, 1.1, 3), "origin": (5, 0.1, -2)}
SHEARED = [[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [1.0, 0.0, 0.0]]
TYPES = [
    "bool",
    "uint8",
    "int8",
    ">i2",
    "int64",
    "uint64",
    "float16",
    "float32",
    ">f8",
    "longdouble",
]


@pytest.fixture(autouse=True)
def apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """To begin with a box costs nothing, so that there are as many as there can be."""
    monkeypatch.setattr(isoref.fast.bricks, "CALL", 0)


def assert_same(a: Mesh, b: Mesh) -> None:
    """Both are one mesh, bit by bit, up to the order of vertices and triangles."""
    assert (a.vertices.dtype, a.simplices.dtype) == (b.vertices.dtype, b.simplices.dtype)
    assert a.vertices.shape == b.vertices.shape
    came, right = (one.vertices[one.simplices].reshape(-1, 9).tolist() for one in (a, b))
    assert sorted(came) == sorted(right)
    if len(np.unique(b.vertices, axis=0)) == len(b.vertices):
        a, b = a.canonical(), b.canonical()
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.simplices.tobytes() == b.simplices.tobytes()


def smooth(shape: tuple[int, ...], sigma: float, seed: int = 6) -> NDArray[np.float64]:
    """Noise of so large parts, of standard deviation 1."""
    values = gaussian_filter(np.random.default_rng(seed).normal(size=shape), sigma)
    return np.asarray(values / values.std())


@pytest.mark.parametrize("method", RULES)
def test_every_rule_gives_the_mesh_of_the_whole(method: str) -> None:
    """Whatever the side of the bricks, how rough the field, and how much of it is crossed."""
    several = 0
    for sigma, side, isovalue in product((0, 2), (1, 3, 50), (0.2, 2.0)):
        values = smooth((17, 15, 16), sigma)
        index = Index.of(values, **PLACE, side=side)
        several += len(boxes(index.divided(isovalue), side)) > 1
        assert_same(
            index.extract(isovalue, method), extract(values, isovalue, **PLACE, method=method)
        )
    assert several > 1


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    values=arrays(
        np.int8, st.tuples(*[st.integers(1, 7)] * 3), elements=st.integers(-1, 1), fill=st.just(-1)
    ),
    side=st.integers(1, 4),
    isovalue=st.sampled_from([-1, -0.5, 0, 1, 2]),
)
def test_ties_on_the_border_of_a_brick_divide_both(
    values: NDArray[np.int8], side: int, isovalue: float
) -> None:
    """A sample at the isovalue is inside, in each of the bricks that share it."""
    index = Index.of(values, side=side)
    assert_same(index.extract(isovalue), extract(values, isovalue))


@pytest.mark.parametrize("kind", TYPES)
def test_types_are_compared_exactly(kind: str) -> None:
    """A brick is divided where the whole has samples on both sides, of any type."""
    values = (10 * smooth((9, 10, 8), 1)).astype(kind)
    for isovalue in (0, 0.5, 1, 7.3, 1e300):
        index = Index.of(values, side=2)
        assert_same(index.extract(isovalue), extract(values, isovalue))


def test_large_integers_are_not_rounded() -> None:
    """2^63 - 1 and its neighbour are one double: the bricks see both sides all the same."""
    values = np.full((5, 5, 5), 2**63 - 1)
    values[2, 2, 2] -= 1024
    isovalue = float(2**63 - 1024)
    assert Index.of(values, side=1).divided(isovalue).sum() == 8
    assert_same(Index.of(values, side=1).extract(isovalue), extract(values, isovalue))


def test_boxes_hold_all_divided_bricks_and_share_no_sample() -> None:
    """The two facts on which the mesh stands."""
    rng = np.random.default_rng(7)
    counts = set()
    for share in (0.003, 0.02, 0.3):
        divided = rng.random((12, 9, 14)) < share
        found = boxes(divided, 4)
        counts.add(len(found) > 1)
        held = np.zeros(divided.shape, int)
        for box in found:
            held[box] += 1
        assert held.max() <= 1
        assert (held[divided] == 1).all()
        for one, other in product(found, found):
            if one is not other:
                apart = [
                    a.stop < b.start or b.stop < a.start for a, b in zip(one, other, strict=True)
                ]
                assert any(apart)
    assert counts == {True, False}
    assert boxes(np.zeros((3, 3, 3), bool), 4) == []


def test_a_file_is_read_only_where_the_isovalue_divides_it(tmp_path: Path) -> None:
    """A volume that stays in its file: the index reads it once, an isovalue its boxes."""
    values = np.zeros((40, 20, 20), np.uint8)
    values[3, 3, 3] = values[30, 10, 10] = 200
    file = tmp_path / "volume.raw"
    values.tofile(file)
    kept = np.memmap(file, np.uint8, "r+", shape=values.shape)
    index = Index.of(kept, side=4)
    assert [len(axis) for axis in (index.least, index.least[0], index.least[0, 0])] == [10, 5, 5]
    right = extract(values, 99)
    # What no box holds may be changed: nobody looks.
    kept[12:20] = 255
    assert_same(index.extract(99), right)
    assert len(right.simplices) == 16


def test_place_precision_and_several_isovalues() -> None:
    """As `isoref.extract` has them: directions, single precision, a list of meshes."""
    values = smooth((12, 11, 10), 1)
    index = Index.of(values, **PLACE, directions=SHEARED, side=3)
    levels = [0.1, 1.5, 99.0]
    precisions: tuple[Precision, ...] = ("double", "single")
    for precision in precisions:
        found = index.extract(levels, precision=precision)
        right = [
            extract(values, one, **PLACE, directions=SHEARED, precision=precision) for one in levels
        ]
        for one, other in zip(found, right, strict=True):
            assert_same(one, other)
        assert [len(one.simplices) > 0 for one in found] == [True, True, False]


@pytest.mark.parametrize("shape", [(1, 5, 5), (5, 1, 5), (5, 5, 1), (1, 1, 1), (2, 2, 2)])
def test_a_volume_without_cells_has_no_bricks_and_no_surface(shape: tuple[int, ...]) -> None:
    values = smooth(shape, 0) if np.prod(shape) > 1 else np.zeros(shape)
    index = Index.of(values, side=2)
    assert_same(index.extract(0.1), extract(values, 0.1))
    assert index.least.size == (shape == (2, 2, 2))


def test_the_last_brick_has_the_last_sample() -> None:
    """Sides that divide the cells and sides that do not, along each axis."""
    for side, n in product((1, 2, 3, 4, 5), (5, 6, 7)):
        for axis in range(3):
            values = np.zeros((n, n, n))
            at = [slice(None)] * 3
            at[axis] = slice(n - 1, None)
            values[tuple(at)] = 1.0
            index = Index.of(values, side=side)
            turned = np.moveaxis(index.divided(0.5), axis, 0)
            assert turned[-1].all()
            assert not turned[:-1].any()
            assert len(turned) == -(-(n - 1) // side)


def test_bad_input_is_refused_as_elsewhere() -> None:
    """With where it is: samples that are not finite, types, masks, names, isovalues."""
    values = np.zeros((9, 4, 5))
    values[7, 2, 3] = np.nan
    with pytest.raises(FieldError, match=r"sample \(7, 2, 3\) is nan"):
        Index.of(values, side=3)
    values[7, 2, 3] = -np.inf
    with pytest.raises(FieldError, match=r"sample \(7, 2, 3\) is -inf"):
        Index.of(values, side=2)
    with pytest.raises(FieldError, match="masked"):
        Index.of(np.ma.masked_equal(np.zeros((2, 2, 2)), 1))
    with pytest.raises(FieldError, match="complex"):
        Index.of(np.zeros((2, 2, 2), complex))
    with pytest.raises(FieldError, match="no volume"):
        Index.of(np.zeros((2, 2)))
    with pytest.raises(FieldError, match="no volume"):
        Index.of(np.zeros((2, 0, 2)))
    with pytest.raises(FieldError, match="0 cells a side"):
        Index.of(np.zeros((2, 2, 2)), side=0)
    index = Index.of(np.zeros((2, 2, 2)))
    with pytest.raises(FieldError, match="isovalue nan is not finite"):
        index.extract(float("nan"))
    with pytest.raises(FieldError, match="precision"):
        index.extract(1.0, precision="half")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="no cube rule 'surface-nets'"):
        index.extract(1.0, "surface-nets")
    with pytest.raises(FieldError, match="positive"):
        Index.of(np.zeros((2, 2, 2)), spacing=-1.0)
