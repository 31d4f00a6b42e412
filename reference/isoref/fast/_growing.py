"""Arrays that grow at their end, for a mesh that is made piece by piece (`isoref.fast.sweep`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from isoref.field import Array, Integers


class Growing:
    """An array that grows at its end, with room to spare, and gives the spare room back.

    Memory that is reserved and never written costs nothing.

    size : rows so far
    gone : rows of these that were handed on, and are here no more
    """

    def __init__(self, width: int, dtype: type[Any], rows: int) -> None:
        shape = (rows, width) if width else (rows,)
        self.array = np.empty(shape, dtype)
        self.size = self.gone = 0

    def more(self, rows: int) -> Array:
        """Room for so many rows, behind those that are there."""
        begun, self.size = self.size - self.gone, self.size + rows
        if self.size - self.gone > len(self.array):
            self._widen(2 * (self.size - self.gone), begun)
        return self.array[begun : self.size - self.gone]

    def since(self, row: int) -> Array:
        """The rows from this number on, to be read or changed."""
        return self.array[row - self.gone : self.size - self.gone]

    def put(self, numbers: Integers, rows: Array) -> None:
        """Write the rows with these numbers."""
        self.array[numbers - self.gone] = rows

    def hand_on(self) -> Array:
        """A copy of the rows that are here, which make room for those to come."""
        rows = self.since(self.gone).copy()
        self.gone = self.size
        return rows

    def foresee(self, done: float) -> None:
        """Make room for the whole, of which this share is done, before it is short and costly.

        For twice what the share done says: surfaces are seldom spread evenly, room that is not
        written costs nothing, and to move what is written takes its memory a second time.
        """
        if self.size > len(self.array) * done:
            self._widen(int(2 * self.size / done), self.size)

    def _widen(self, rows: int, used: int) -> None:
        """Move to a larger array."""
        larger = np.empty((rows, *self.array.shape[1:]), self.array.dtype)
        larger[:used] = self.array[:used]
        self.array = larger

    def finished(self) -> Array:
        """The array, no larger than it has to be; the memory behind it is returned, not copied."""
        self.array.resize((self.size, *self.array.shape[1:]), refcheck=False)
        return self.array
