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
from isograde.adapters.exchange import TemporaryFull
from isograde.adapters.frames import Arrays, FrameError, Header, pack, unpack
from isograde.adapters.process import ProcessAdapter, samples
from isograde.adapters.protocol import declared
from isograde.declaration import Declaration
from isograde.model import AdapterError, Outcome, Request, Status, UnknownName

# Strides that span more than so many times the samples are not reproduced in the worker. Every
# second sample along three axes spans eight times.
LARGEST_SPAN = 16


class PythonAdapter(ProcessAdapter):
    """A Python function behind a pipe; `spec` is what `isograde.adapters.loading.load` reads."""

    calls = True

    def _spawn(self) -> Child:
        """A worker."""
        return Child([sys.executable, "-u", "-m", "isograde.adapters.worker"], guarded=True)

    def _greet(self, child: Child) -> Declaration:
        """What the function declares, once it is loaded."""
        answers = str(self.exchange.path / "answer")
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
        if request.function is not None and self.declaration.given == "function":
            pickled = cloudpickle.dumps(request.function)
            header["function"] = base64.b64encode(pickled).decode("ascii")
        child.write(pack(header, [values], self.exchange.path / "request"))
        folder, limit = self.exchange.path, self.limits.megabytes * MEGABYTE
        try:
            said, arrays = unpack(child.read, limit, folder=folder)
        except FrameError as error:
            raise Ended(Status.GARBAGE, f"the worker's pipe was written to: {error}") from error
        except MemoryError as error:
            raise Ended(Status.MEMORY, f"an absurd mesh: {error}") from error
        finally:
            self.exchange.empty()
        self.tidy()
        if "full" in said:
            raise TemporaryFull.of(folder.parent)
        if said.get("id") != self.number:
            raise Ended(Status.GARBAGE, f"it answered request {said.get('id')!r:.40} a second time")
        return _outcome(said, arrays)


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
