"""Messages with arrays, between the grader and its worker process.

A frame is the length of a header (4 bytes, little-endian), the header (JSON), and the bytes of
the arrays the header lists under ``arrays``, one after the other. Nothing is unpickled, so that
whatever an implementation returns reaches the grader as numbers or not at all.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Header = dict[str, Any]
Arrays = list[NDArray[Any]]
LENGTH = struct.Struct("<I")
HEADER_LIMIT = 1 << 20


class FrameError(ValueError):
    """The bytes are no frame."""


def pack(header: Header, arrays: Sequence[NDArray[Any]] = ()) -> list[bytes | memoryview]:
    """The frame, as buffers to be written one after the other."""
    solid = [np.ascontiguousarray(a) for a in arrays]
    listed = [{"dtype": a.dtype.str, "shape": a.shape} for a in solid]
    text = json.dumps({**header, "arrays": listed}).encode()
    return [LENGTH.pack(len(text)) + text, *(a.reshape(-1).view(np.uint8).data for a in solid)]


def unpack(
    read: Callable[[int], bytearray], limit: int = np.iinfo(np.int64).max
) -> tuple[Header, Arrays]:
    """The next frame, its bytes taken with `read(count)`.

    Raises
    ------
    FrameError
        for bytes that are no frame.
    MemoryError
        where the arrays would need more than `limit` bytes.
    """
    (length,) = LENGTH.unpack(read(LENGTH.size))
    if length > HEADER_LIMIT:
        raise FrameError(f"a header of {length} bytes")
    try:
        header = json.loads(read(length))
        kinds = [(np.dtype(a["dtype"]), tuple(map(int, a["shape"]))) for a in header["arrays"]]
    except (ValueError, TypeError, KeyError) as error:
        raise FrameError(f"a header that cannot be read: {error}") from error
    sizes = [dtype.itemsize * _product(shape) for dtype, shape in kinds]
    if sum(sizes) > limit:
        raise MemoryError(f"{sum(sizes):,} bytes of arrays")
    parts = [
        np.frombuffer(read(size), dtype).reshape(shape) if size else np.empty(shape, dtype)
        for (dtype, shape), size in zip(kinds, sizes, strict=True)
    ]
    return header, parts


def _product(shape: tuple[int, ...]) -> int:
    """The number of elements of an array of this shape, in exact integers."""
    count = 1
    for length in shape:
        count *= length
    return count
