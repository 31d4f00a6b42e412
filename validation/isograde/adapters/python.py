"""The adapter to implementations that are called from Python, in a worker process.

How to write such an implementation: see `isograde.adapters.loading`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.adapters.child import MEGABYTE, Child, Ended
from isograde.adapters.frames import FrameError, pack, unpack
from isograde.adapters.process import ProcessAdapter, empty, own_directory, samples
from isograde.adapters.protocol import declared
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
        self._directory = own_directory(self)

    def _spawn(self) -> Child:
        """A worker."""
        return Child([sys.executable, "-u", "-m", "isograde.adapters.worker"], guarded=True)

    def _greet(self, child: Child) -> Declaration:
        """What the function declares, once it is loaded."""
        answers = str(self._directory / "answer")
        path = [entry for entry in sys.path if entry]
        child.write(pack({"load": self.spec, "path": path, "files": answers}))
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
        child.write(pack(header, [values], self._directory / "request"))
        try:
            said, arrays = unpack(child.read, self.limits.megabytes * MEGABYTE)
        except FrameError as error:
            raise Ended(Status.GARBAGE, f"the worker's pipe was written to: {error}") from error
        except MemoryError as error:
            raise Ended(Status.MEMORY, f"an absurd mesh: {error}") from error
        finally:
            empty(self._directory)
        if said["id"] != self.number:
            raise Ended(Status.GARBAGE, f"it answered request {said['id']} a second time")
        vertices, simplices = arrays or (None, None)
        cost = {"seconds": said["seconds"], "peak_bytes": said["peak"]}
        status, changed = Status(said["status"]), said["changed"]
        return Outcome(status, vertices, simplices, said["detail"], changed, **cost)


def _strides(values: NDArray[Any]) -> Sequence[int]:
    """The strides the worker shall reproduce: those of `values`, unless they span too much."""
    reach = [(n - 1) * abs(s) for n, s in zip(values.shape, values.strides, strict=True)]
    if sum(reach) > LARGEST_SPAN * values.nbytes:
        return np.empty(values.shape, values.dtype).strides
    return values.strides
