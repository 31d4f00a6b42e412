"""Frames carry arrays to the last bit, and are no way in for anything else."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays, floating_dtypes, integer_dtypes
from isograde.adapters.frames import LARGE, LENGTH, FrameError, pack, unpack
from numpy.typing import NDArray


def reader(data: bytes) -> Any:
    """A function that reads exactly so many bytes of the data."""
    stream = io.BytesIO(data)

    def read(count: int) -> bytearray:
        assert count <= len(data), "asks for more than there is"
        return bytearray(stream.read(count))

    return read


def through(header: dict[str, Any], sent: list[NDArray[Any]], **how: Any) -> Any:
    """What arrives of a frame."""
    return unpack(reader(b"".join(pack(header, sent, **how))))


@given(arrays(integer_dtypes() | floating_dtypes(), array_shapes(min_dims=0, min_side=0)))
def test_an_array_arrives_as_it_was(sent: NDArray[Any]) -> None:
    header, (came,) = through({"isovalue": 0.1}, [sent])
    assert header["isovalue"] == 0.1
    assert (came.dtype, came.shape) == (sent.dtype, sent.shape)
    assert came.tobytes() == sent.tobytes()


def test_a_large_array_stands_in_a_file(tmp_path: Path) -> None:
    sent = np.random.default_rng(0).random((LARGE // 8 + 1,))
    frame = pack({}, [sent, sent[:3]], tmp_path / "request")
    assert [path.name for path in tmp_path.iterdir()] == ["request0.npy"]
    assert sum(len(part) for part in frame) < 1000
    _, (large, small) = unpack(reader(b"".join(frame)))
    assert np.array_equal(large, sent)
    assert np.array_equal(small, sent[:3])


@given(st.binary(max_size=200))
def test_any_other_bytes_are_no_frame(text: bytes) -> None:
    with pytest.raises(FrameError):
        unpack(reader(LENGTH.pack(len(text)) + text))


@pytest.mark.parametrize(
    "entry",
    [
        {"dtype": "O", "shape": [1], "bytes": 8},
        {"dtype": "f8", "shape": [2], "bytes": 8},
        {"dtype": "f8", "shape": [-1], "bytes": -8},
        {"dtype": "f8", "shape": [1]},
        {"dtype": "no", "shape": [1], "bytes": 8},
        {"file": "absent.npy", "bytes": 8},
    ],
)
def test_an_entry_that_lies_is_no_frame(entry: dict[str, Any]) -> None:
    text = json.dumps({"arrays": [entry]}).encode()
    with pytest.raises(FrameError):
        unpack(reader(LENGTH.pack(len(text)) + text + bytes(64)))


def test_more_than_the_limit_is_not_even_read() -> None:
    frame = b"".join(pack({}, [np.zeros(100)]))
    with pytest.raises(MemoryError):
        unpack(reader(frame), limit=799)
    assert len(unpack(reader(frame), limit=800)[1][0]) == 100
