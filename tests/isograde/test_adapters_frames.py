"""Frames carry arrays to the last bit, and are no way in for anything else."""

import gc
import io
import json
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays, floating_dtypes, integer_dtypes
from isograde.adapters.frames import LARGE, LENGTH, FrameError, pack, unpack
from isograde.adapters.shared import KEPT, Shared
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


@pytest.mark.parametrize("mapped", [False, True])
def test_large_arrays_stand_in_shared_memory(mapped: bool) -> None:
    """One after the other; small ones in the frame."""
    sent = np.random.default_rng(0).random((3, LARGE // 8 + 1))
    shared = Shared.make()
    frame = pack({}, [sent[0], sent[0, :3], sent[1:]], shared)
    assert sum(len(part) for part in frame) < 1000
    _, (large, small, pair) = unpack(reader(b"".join(frame)), shared=shared, mapped=mapped)
    assert np.array_equal(large, sent[0])
    assert np.array_equal(small, sent[0, :3])
    assert np.array_equal(pair, sent[1:])
    # The next frame is written over this one: what was taken stays, what was mapped does not.
    pack({}, [-sent[0]], shared)
    assert np.array_equal(large, -sent[0] if mapped else sent[0])


def test_without_files_in_memory_there_is_one_on_the_disk(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """And without `preadv`: as on macOS. Nothing bears a name."""
    monkeypatch.delattr(os, "memfd_create", raising=False)
    monkeypatch.delattr(os, "preadv", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    shared = Shared.make()
    sent = np.random.default_rng(0).random((3 * LARGE,))
    _, (came,) = unpack(reader(b"".join(pack({}, [sent], shared))), shared=shared)
    assert np.array_equal(came, sent)
    assert list(tmp_path.iterdir()) == []


def test_shared_memory_is_trimmed_and_closed() -> None:
    """What a large call left is given back; the descriptor goes with the object."""
    shared = Shared.make()
    descriptor = shared.descriptor
    shared.put(np.zeros(8), 0)
    shared.trim()
    assert os.fstat(descriptor).st_size == 64
    os.ftruncate(descriptor, KEPT + 1)
    shared.trim()
    assert os.fstat(descriptor).st_size == 0
    del shared
    gc.collect()
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(descriptor)


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
        {"dtype": "<f8", "shape": [1], "bytes": 8, "at": 0},
    ],
)
def test_an_entry_that_lies_is_no_frame(entry: dict[str, Any]) -> None:
    text = json.dumps({"arrays": [entry]}).encode()
    with pytest.raises(FrameError):
        unpack(reader(LENGTH.pack(len(text)) + text + bytes(64)))


@pytest.mark.parametrize("mapped", [False, True])
@pytest.mark.parametrize("at", [-8, 8, 1 << 40, 1 << 80, 0.5, "0", None])
def test_a_place_that_is_not_shared_is_no_frame(at: Any, mapped: bool) -> None:
    shared = Shared.make()
    shared.put(np.zeros(1), 0)
    text = json.dumps({"arrays": [{"dtype": "<f8", "shape": [1], "bytes": 8, "at": at}]}).encode()
    with pytest.raises(FrameError):
        unpack(reader(LENGTH.pack(len(text)) + text), shared=shared, mapped=mapped)


def test_no_object_is_taken_from_shared_memory() -> None:
    shared = Shared.make()
    shared.put(np.zeros(8), 0)
    for kind in ("|O", "O,i8"):
        entry = {"dtype": kind, "shape": [1], "bytes": np.dtype(kind).itemsize, "at": 0}
        text = json.dumps({"arrays": [entry]}).encode()
        with pytest.raises(FrameError, match="no numbers"):
            unpack(reader(LENGTH.pack(len(text)) + text), shared=shared)


def test_more_than_the_limit_is_not_even_read() -> None:
    frame = b"".join(pack({}, [np.zeros(100)]))
    with pytest.raises(MemoryError):
        unpack(reader(frame), limit=799)
    assert len(unpack(reader(frame), limit=800)[1][0]) == 100
