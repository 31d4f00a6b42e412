"""The door to implementations that are called from Python, in a worker process.

The worker is started once, reused for every call, and started again after it died or was killed.
How to write such an implementation: see `isograde.doors.loading`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from isograde.doors.child import MEGABYTE, Child, Ended
from isograde.doors.conventions import to_house
from isograde.doors.declaring import declaration_from
from isograde.doors.frames import Arrays, FrameError, Header, pack, unpack
from isograde.model import Declaration, DoorError, Limits, Outcome, Request, Status

# Imports may be slow on a busy machine, however short a call may be.
START_LIMITS = Limits(seconds=120.0, megabytes=4096)
# Strides that span more than so many times the samples are not reproduced in the worker.
LARGEST_SPAN = 4


class PythonDoor:
    """A Python function behind a pipe."""

    def __init__(self, spec: str):
        self.spec = spec
        self.declaration = Declaration(spec)
        self._limits = Limits()
        self._child: Child | None = None

    def open(self, limits: Limits) -> Declaration:
        """Start the worker; what the implementation declares. Raises `DoorError`."""
        self._limits = limits
        self._start()
        return self.declaration

    def run(self, request: Request) -> Outcome:
        """The outcome of one call, in the house's conventions."""
        return to_house(self.answer(request), request, self.declaration.conventions)

    def answer(self, request: Request) -> Outcome:
        """The outcome of one call, as it came."""
        try:
            child = self._child or self._start()
        except DoorError as error:
            return Outcome(Status.CRASH, detail=f"it did not start again: {error}")
        try:
            return _outcome(*self._ask(child, request))
        except Ended as ended:
            status, detail = ended.status, str(ended)
        except FrameError as error:
            status, detail = Status.GARBAGE, f"the worker's pipe was written to: {error}"
        except MemoryError as error:
            status, detail = Status.MEMORY, f"an absurd mesh: {error}"
        self.close()
        return Outcome(status, detail=detail)

    def said(self) -> tuple[str, str]:
        """The end of what the implementation printed: to stdout, to stderr."""
        return (self._child.said("prints"), self._child.said()) if self._child else ("", "")

    def close(self) -> None:
        """Stop the worker."""
        if self._child is not None:
            self._child.kill()
            self._child = None

    def _start(self) -> Child:
        """A worker that has loaded the implementation; raises `DoorError`."""
        command = [sys.executable, "-u", "-m", "isograde.doors.worker"]
        child = Child(command, guarded=True)
        child.allow(START_LIMITS)
        try:
            child.write(pack({"load": self.spec, "path": [p for p in sys.path if p]}))
            header, _ = unpack(child.read)
        except Ended as ended:
            child.kill()
            raise DoorError(f"{self.spec} did not start: {ended}") from ended
        if "error" in header:
            child.kill()
            raise DoorError(header["error"])
        self.declaration = declaration_from(header["declaration"], self.spec)
        self._child = child
        return child

    def _ask(self, child: Child, request: Request) -> tuple[Header, Arrays]:
        """The worker's answer to the request."""
        values, limits = request.field.values, self._limits
        header = {
            "isovalue": float(request.isovalue),
            "spacing": request.field.spacing,
            "strides": _strides(values),
            "seconds": limits.seconds,
        }
        child.allow(limits)
        child.write(pack(header, [values]))
        return unpack(child.read, limits.megabytes * MEGABYTE)


def _strides(values: np.ndarray[tuple[int, ...], np.dtype[np.generic]]) -> Sequence[int]:
    """The strides the worker shall reproduce: those of `values`, unless they span too much."""
    reach = [(n - 1) * abs(s) for n, s in zip(values.shape, values.strides, strict=True)]
    if sum(reach) > LARGEST_SPAN * values.nbytes:
        return np.empty(values.shape, values.dtype).strides
    return values.strides


def _outcome(header: Header, arrays: Arrays) -> Outcome:
    """The worker's answer as an outcome."""
    vertices, faces = arrays or (None, None)
    return Outcome(
        Status(header["status"]),
        vertices,
        faces,
        header["detail"],
        header["changed"],
        header["seconds"],
        header["peak"],
    )
