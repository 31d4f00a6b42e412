"""Messages with arrays, between the grader and its worker process.

A frame is the length of a header (4 bytes, little-endian), the header (JSON), and the bytes of
the arrays the header lists under ``arrays``, one after the other. An array of more than `LARGE`
bytes stands in shared memory instead, where both sides have some, and the header says where.
Nothing is unpickled, so that whatever an implementation returns reaches the grader as numbers or
not at all.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.adapters.shared import Shared

Header = dict[str, Any]
Arrays = list[NDArray[Any]]
LENGTH = struct.Struct("<I")
HEADER_LIMIT = 1 << 20
LARGE = 1 << 16


class FrameError(ValueError):
    """The bytes are no frame."""


def pack(
    header: Header, arrays: Sequence[NDArray[Any]] = (), shared: Shared | None = None
) -> list[bytes | memoryview]:
    """The frame, as buffers to be written one after the other.

    Large arrays are put into the shared memory, where that is given; raises `OSError` for want of
    room.
    """
    listed: list[Header] = []
    buffers: list[bytes | memoryview] = []
    at = 0
    for array in arrays:
        solid = np.ascontiguousarray(array)
        entry = {"dtype": solid.dtype.str, "shape": array.shape, "bytes": solid.nbytes}
        if shared is not None and solid.nbytes > LARGE:
            entry["at"] = at
            at = shared.put(solid, at)
        else:
            buffers.append(solid.reshape(-1).view(np.uint8).data)
        listed.append(entry)
    text = json.dumps({**header, "arrays": listed}).encode()
    return [LENGTH.pack(len(text)) + text, *buffers]


def unpack(
    read: Callable[[int], bytearray],
    limit: float = math.inf,
    shared: Shared | None = None,
    *,
    mapped: bool = False,
) -> tuple[Header, Arrays]:
    """The next frame, its bytes taken with `read(count)`, its large arrays from shared memory.

    mapped : they are to be read where they are, and are those of the next frame after it

    Raises
    ------
    FrameError
        for bytes that are no frame.
    MemoryError
        where the arrays have more than `limit` bytes.
    """
    (length,) = LENGTH.unpack(read(LENGTH.size))
    if length > HEADER_LIMIT:
        raise FrameError(f"a header of {length} bytes")
    try:
        header = json.loads(read(length))
        total = sum(map(_size, header["arrays"]))
        if total > limit:
            raise MemoryError(f"{total:,} bytes of arrays")
        return header, [_array(entry, read, shared, mapped) for entry in header["arrays"]]
    except (
        ValueError, TypeError, KeyError, OSError, OverflowError, AttributeError, RecursionError,
        SyntaxError,
    ) as error:  # fmt: skip
        raise FrameError(f"a header that cannot be read: {error}") from error


def _size(entry: Header) -> int:
    """The bytes of an array; raises `FrameError`."""
    size = entry["bytes"]
    if not isinstance(size, int) or size < 0:
        raise FrameError(f"an array of {size!r:.40} bytes")
    return size


def _array(
    entry: Header, read: Callable[[int], bytearray], shared: Shared | None, mapped: bool
) -> NDArray[Any]:
    """The array that an entry of the header lists."""
    dtype, shape = np.dtype(entry["dtype"]), tuple(entry["shape"])
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != entry["bytes"]:
        raise FrameError(f"{entry['bytes']} bytes for {shape} of {dtype}")
    if dtype.hasobject:
        raise FrameError(f"no numbers, but {dtype}")
    if not entry["bytes"]:
        return np.empty(shape, dtype)
    if "at" not in entry:
        return np.frombuffer(read(entry["bytes"]), dtype).reshape(shape)
    if shared is None:
        raise FrameError("shared memory, where there is none")
    return (shared.mapped if mapped else shared.taken)(dtype, shape, entry["at"])
