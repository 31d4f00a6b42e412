"""Messages with arrays, between the grader and its worker process.

A frame is the length of a header (4 bytes, little-endian), the header (JSON), and the bytes of
the arrays the header lists under ``arrays``, one after the other. An array of more than `LARGE`
bytes stands in a .npy file instead, where both sides know a folder. Nothing is unpickled, so that
whatever an implementation returns reaches the grader as numbers or not at all.
"""

from __future__ import annotations

import json
import math
import os
import stat
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Header = dict[str, Any]
Arrays = list[NDArray[Any]]
LENGTH = struct.Struct("<I")
HEADER_LIMIT = 1 << 20
LARGE = 1 << 20


class FrameError(ValueError):
    """The bytes are no frame."""


def pack(
    header: Header, arrays: Sequence[NDArray[Any]] = (), files: Path | None = None
) -> list[bytes | memoryview]:
    """The frame, as buffers to be written one after the other.

    Large arrays are written to files whose names begin with `files`, where that is given.
    """
    listed: list[Header] = []
    buffers: list[bytes | memoryview] = []
    for number, array in enumerate(arrays):
        if files is not None and array.nbytes > LARGE:
            path = files.with_name(f"{files.name}{number}.npy")
            np.save(path, array, allow_pickle=False)
            listed.append({"file": str(path), "bytes": array.nbytes})
        else:
            solid = np.ascontiguousarray(array)
            listed.append({"dtype": solid.dtype.str, "shape": array.shape, "bytes": solid.nbytes})
            buffers.append(solid.reshape(-1).view(np.uint8).data)
    text = json.dumps({**header, "arrays": listed}).encode()
    return [LENGTH.pack(len(text)) + text, *buffers]


def unpack(
    read: Callable[[int], bytearray],
    limit: float = math.inf,
    mmap_mode: Literal["r"] | None = None,
    folder: Path | None = None,
) -> tuple[Header, Arrays]:
    """The next frame, its bytes taken with `read(count)`, its files loaded or mapped.

    Where a folder is given, only regular files that stand in it are read.

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
        total = sum(_size(entry, folder) for entry in header["arrays"])
        if total > limit:
            raise MemoryError(f"{total:,} bytes of arrays")
        return header, [_array(entry, read, mmap_mode) for entry in header["arrays"]]
    except (
        ValueError, TypeError, KeyError, OSError, AttributeError, RecursionError, SyntaxError,
    ) as error:  # fmt: skip
        raise FrameError(f"a header that cannot be read: {error}") from error


def _size(entry: Header, folder: Path | None) -> int:
    """The bytes of an array, of a file those it really has; raises `FrameError`."""
    if "file" not in entry or folder is None:
        size = entry["bytes"]
        if not isinstance(size, int) or size < 0:
            raise FrameError(f"an array of {size!r:.40} bytes")
        return size
    path = Path(entry["file"])
    found = os.lstat(path)
    if path.parent != folder or not stat.S_ISREG(found.st_mode):
        raise FrameError(f"{path.name!r:.60} is no file of the folder for exchange")
    return found.st_size


def _array(
    entry: Header, read: Callable[[int], bytearray], mmap_mode: Literal["r"] | None
) -> NDArray[Any]:
    """The array that an entry of the header lists."""
    if "file" in entry:
        loaded: NDArray[Any] = np.load(entry["file"], mmap_mode, allow_pickle=False)
        return loaded
    dtype, shape = np.dtype(entry["dtype"]), tuple(entry["shape"])
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != entry["bytes"]:
        raise FrameError(f"{entry['bytes']} bytes for {shape} of {dtype}")
    if not entry["bytes"]:
        return np.empty(shape, dtype)
    return np.frombuffer(read(entry["bytes"]), dtype).reshape(shape)
