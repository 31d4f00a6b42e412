"""Memory that two processes share, for arrays that are too large for a pipe.

A `Shared` is a file without a name: one in memory where the system has such files, else one in the
temporary folder. It goes with the last process that has it open, however that ends, so nothing is
left behind; and it is written to again and again, since fresh memory costs as much as the copying.

The grader copies out of it and into it and never maps it: an implementation may cut it short at any
moment, and who looks at mapped memory that is gone is killed for it. What was copied, nobody can
change any more, whatever an implementation goes on to do. The worker maps what it is asked.
"""

from __future__ import annotations

import math
import mmap
import os
import tempfile
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Begin each array where memory that is mapped, and any number, may begin.
ALIGNED = mmap.ALLOCATIONGRANULARITY
# Keep no more than so many bytes when a call is over.
KEPT = 1 << 26
PORTION = 1 << 20


class Shared:
    """A file without a name, by its open descriptor, which is closed with this object."""

    def __init__(self, descriptor: int):
        self.descriptor = descriptor
        weakref.finalize(self, os.close, descriptor)

    @classmethod
    def make(cls) -> Shared:
        """An empty one; raises `OSError` where there is no room for a file."""
        if hasattr(os, "memfd_create"):
            # Nobody can seal it: sealing would have to be allowed here.
            return cls(os.memfd_create("isograde"))
        descriptor, path = tempfile.mkstemp()
        os.unlink(path)
        return cls(descriptor)

    def put(self, array: NDArray[Any], at: int) -> int:
        """The contiguous array stands here from byte `at` on; where the next one may stand."""
        rest, place = _bytes(array), at
        while rest:
            count = os.pwrite(self.descriptor, rest, place)
            rest, place = rest[count:], place + count
        return -(-place // ALIGNED) * ALIGNED

    def taken(self, dtype: np.dtype[Any], shape: tuple[int, ...], at: int) -> NDArray[Any]:
        """A copy of the array that stands here from byte `at` on; raises `OSError`."""
        array = np.empty(shape, dtype)
        rest, place = _bytes(array), at
        while rest:
            count = _read(self.descriptor, rest, place)
            if not count:
                raise OSError(f"shared memory ends at byte {place:,}")
            rest, place = rest[count:], place + count
        return array

    def mapped(self, dtype: np.dtype[Any], shape: tuple[int, ...], at: int) -> NDArray[Any]:
        """The array that stands here from byte `at` on, to be read where it is."""
        count = math.prod(shape)
        memory = mmap.mmap(
            self.descriptor, count * dtype.itemsize, access=mmap.ACCESS_READ, offset=at
        )
        return np.frombuffer(memory, dtype, count).reshape(shape)

    def trim(self) -> None:
        """What a large call left is given back."""
        if os.fstat(self.descriptor).st_size > KEPT:
            os.ftruncate(self.descriptor, 0)


def _read(descriptor: int, space: memoryview, at: int) -> int:
    """The number of bytes that were read into the space, 0 at the end of the file."""
    if hasattr(os, "preadv"):
        return os.preadv(descriptor, [space], at)
    some = os.pread(descriptor, min(len(space), PORTION), at)
    space[: len(some)] = some
    return len(some)


def _bytes(array: NDArray[Any]) -> memoryview:
    """The memory of a contiguous array."""
    return array.reshape(-1).view(np.uint8).data
