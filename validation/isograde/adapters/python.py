"""The adapter to implementations that are called from Python, in a worker process.

How to write such an implementation: see `isograde.adapters.loading`.
"""

from __future__ import annotations

import base64
import math
import sys
from collections.abc import Sequence
from typing import Any

import cloudpickle
import numpy as np
from numpy.typing import NDArray

from isograde.adapters.child import MEGABYTE, Child, Ended
from isograde.adapters.exchange import FULL, TemporaryFull
from isograde.adapters.frames import Arrays, FrameError, Header, pack, unpack
from isograde.adapters.process import ProcessAdapter, samples
from isograde.adapters.protocol import declared
from isograde.adapters.shared import Shared
from isograde.declaration import Declaration
from isograde.model import AdapterError, Outcome, Request, Status, UnknownName

# Strides that span more than so many times the samples are not reproduced in the worker. Every
# second sample along three axes spans eight times.
LARGEST_SPAN = 16


class PythonAdapter(ProcessAdapter):
    """A Python function behind a pipe; `spec` is what `isograde.adapters.loading.load` reads."""

    calls = True

    def __init__(self, spec: str):
        super().__init__(spec)
        self._shared: list[Shared] = []

    def _spawn(self) -> Child:
        """A worker, with memory to share, for fields and for meshes, that none before it has."""
        self._shared = [Shared.make(), Shared.make()]
        command = [sys.executable, "-u", "-m", "isograde.adapters.worker"]
        shared = [one.descriptor for one in self._shared]
        return Child(command, guarded=True, shared=shared)

    def _greet(self, child: Child) -> Declaration:
        """What the function declares, once it is loaded."""
        path = [entry for entry in sys.path if entry]
        child.write(pack({"load": self.spec, "path": path}))
        try:
            header, _ = unpack(child.read)
        except FrameError as error:
            raise AdapterError(
                f"{self.spec}: its import wrote to the worker's pipe: {error}"
            ) from error
        if "error" in header:
            raise (UnknownName if header["unknown"] else AdapterError)(header["error"])
        return declared(header["declaration"], self.spec)

    def _ask(self, child: Child, request: Request) -> Outcome:
        """What the function returned, or how the call ended."""
        values = samples(request.field)
        header = {
            "id": self.number,
            "isovalues": [float(isovalue) for isovalue in request.isovalues],
            "spacing": request.field.spacing,
            "strides": _strides(values),
            "writeable": values.flags.writeable,
            "calls": request.calls,
            "seconds": self.limits.seconds,
        }
        if request.field.directions is not None:
            header["directions"] = request.field.directions
        if request.function is not None and self.declaration.given == "function":
            pickled = cloudpickle.dumps(request.function)
            header["function"] = base64.b64encode(pickled).decode("ascii")
        (asked, answered), limit = self._shared, self.limits.megabytes * MEGABYTE
        child.write(_packed(header, values, asked))
        try:
            said, arrays = unpack(child.read, limit, answered)
        except FrameError as error:
            raise Ended(Status.GARBAGE, f"the worker's pipe was written to: {error}") from error
        except MemoryError as error:
            raise Ended(Status.MEMORY, f"an absurd mesh: {error}") from error
        self.tidy()
        asked.trim()
        answered.trim()
        if "full" in said:
            raise TemporaryFull.of(self.exchange.path.parent)
        if said.get("id") != self.number:
            raise Ended(Status.GARBAGE, f"it answered request {said.get('id')!r:.40} a second time")
        return _outcome(said, arrays)

    def close(self) -> None:
        """Stop the worker; what was shared with it is given back."""
        super().close()
        self._shared = []


def _packed(header: Header, values: NDArray[Any], asked: Shared) -> list[bytes | memoryview]:
    """The frame of a request; raises `Ended` where what is shared can no longer be written."""
    try:
        return pack(header, [values], asked)
    except OSError as error:
        if error.errno in FULL:
            raise
        told = f"the memory that is shared with it cannot be written: {error}"
        raise Ended(Status.GARBAGE, told) from error


def _outcome(said: Header, arrays: Arrays) -> Outcome:
    """The outcome that the worker tells; raises `Ended` where it tells none.

    The implementation runs in the same process as what speaks here, and may have changed it.
    """
    try:
        status, seconds, peak = Status(said["status"]), float(said["seconds"]), int(said["peak"])
        vertices, simplices, normals = [*arrays, None, None, None][:3]
    except (KeyError, ValueError, TypeError, OverflowError) as error:
        raise Ended(Status.GARBAGE, f"the worker's answer is none: {error!r}") from error
    numbers = all(array.dtype.kind in "biuf" for array in arrays)
    if not numbers or (status is Status.OK) != (len(arrays) in (2, 3)):
        raise Ended(Status.GARBAGE, "the worker's answer is none: no two arrays of numbers")
    seconds = max(0.0, seconds) if math.isfinite(seconds) else 0.0
    changed = bool(said.get("changed"))
    told = str(said.get("detail", ""))
    return Outcome(
        status, vertices, simplices, told, changed, seconds, peak, normals, _seconds(said)
    )


def _seconds(said: Header) -> float | None:
    """The processor's seconds that the worker tells, None where they are no such number."""
    told = said.get("processor")
    if isinstance(told, int | float) and math.isfinite(told) and told >= 0:
        return float(told)
    return None


def _strides(values: NDArray[Any]) -> Sequence[int]:
    """The strides the worker shall reproduce: those of `values`, unless they span too much."""
    reach = [(n - 1) * abs(s) for n, s in zip(values.shape, values.strides, strict=True)]
    if sum(reach) > LARGEST_SPAN * values.nbytes:
        return np.empty(values.shape, values.dtype).strides
    return values.strides
