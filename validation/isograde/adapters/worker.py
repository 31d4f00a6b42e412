"""The process in which a Python implementation runs: ``python -m isograde.adapters.worker``.

It puts the protocol's pipe aside and turns descriptor 1 to a log, so that whatever the
implementation or a library under it prints cannot mix with the protocol. It answers a first frame
with the declaration, and each further frame with a mesh or with how the call failed. What it cannot
catch (exit, crash, hang, memory) the grader sees from outside.

Messages
--------
load    ``{"load": spec, "path": [..], "files": prefix}``: answered by ``{"declaration": {..}}``
        or ``{"error": .., "unknown": ..}``, unknown where nothing has this name; `path` is
        Python's, `files` begins the names of files for arrays
run     ``{"id": i, "isovalues": [..], "spacing": [..], "strides": [..], "seconds": s}`` and the
        samples: answered by the same ``id`` with ``{"status": .., "detail": .., "changed": ..,
        "seconds": .., "peak": ..}`` and, where the status is "ok", vertices and simplices
"""

from __future__ import annotations

import faulthandler
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.adapters.forms import AnswerError, arrays_from
from isograde.adapters.frames import Arrays, Header, pack, unpack
from isograde.adapters.loading import Call, load
from isograde.declaration import declaration_json
from isograde.model import AdapterError, Kind, Status, UnknownName

# A worker whose grader is gone ends itself this long after the time limit.
GRACE_SECONDS = 10.0
RESET_PEAK = b"5"


def main(log: int) -> None:
    """Serve frames until the grader closes the pipe."""
    source, sink = _set_pipes_aside(log)
    faulthandler.enable()
    read, memory = _reader(source), Memory()
    try:
        asked, _ = unpack(read)
        extract, files = _serve_load(asked, sink), Path(asked["files"])
        while extract is not None:
            header, arrays = unpack(read, mmap_mode="r")
            signal.setitimer(signal.ITIMER_REAL, header["seconds"] + GRACE_SECONDS)
            _send(sink, pack(*_call(extract, header, arrays[0], memory), files))
            signal.setitimer(signal.ITIMER_REAL, 0)
    except EOFError:
        return


def _set_pipes_aside(log: int) -> tuple[int, int]:
    """The protocol's two pipes; descriptors 0 and 1 now lead to nothing and to the log."""
    source, sink = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(log, 1)
    os.close(nothing)
    os.close(log)
    return source, sink


def _reader(source: int) -> Callable[[int], bytearray]:
    """A function that reads exactly so many bytes, and raises `EOFError` at the end."""
    stream = os.fdopen(source, "rb")

    def read(count: int) -> bytearray:
        taken = bytearray(count)
        if stream.readinto(taken) != count:
            raise EOFError
        return taken

    return read


def _send(sink: int, buffers: list[bytes | memoryview]) -> None:
    """The frame is written whole, small ones in one go."""
    if sum(len(b) for b in buffers) < 1 << 16:
        buffers = [b"".join(buffers)]
    for buffer in buffers:
        rest = memoryview(buffer)
        while rest:
            rest = rest[os.write(sink, rest) :]


def _serve_load(header: Header, sink: int) -> Call | None:
    """The function that was asked for, its declaration sent; None where it cannot be loaded."""
    sys.path += [entry for entry in header["path"] if entry not in sys.path]
    try:
        extract, declaration = load(header["load"])
    except AdapterError as error:
        unknown = isinstance(error, UnknownName)
        _send(sink, pack({"error": str(error), "unknown": unknown}))
        return None
    _send(sink, pack({"declaration": declaration_json(declaration)}))
    return extract


def _call(
    extract: Call, header: Header, samples: NDArray[Any], memory: Memory
) -> tuple[Header, Arrays]:
    """The answer to one request: how it went, what it cost, and the mesh if there is one."""
    given = _laid_out(samples, header["strides"])
    before = memory.reset()
    start = time.perf_counter()
    status, detail, answer = _outcome(extract, given, header)
    seconds = time.perf_counter() - start
    peak = max(0, memory.peak() - before)
    arrays: Arrays = []
    if status is Status.OK:
        try:
            kind = Kind(len(header["spacing"]), len(header["isovalues"]))
            arrays = list(arrays_from(answer, kind))
        except AnswerError as error:
            status, detail = error.status, str(error)
    report: Header = {"status": status, "detail": detail, "seconds": seconds, "peak": peak}
    return {**report, "id": header["id"], "changed": _differ(samples, given)}, arrays


def _outcome(extract: Call, given: NDArray[Any], header: Header) -> tuple[Status, str, object]:
    """What the implementation did. An exit is let through: it ends the process, as it would."""
    try:
        places = tuple(header["isovalues"]), tuple(header["spacing"])
        return Status.OK, "", extract(given, *places)
    except MemoryError as error:
        return Status.MEMORY, f"MemoryError: {error}", None
    except NotImplementedError as error:
        return Status.DECLINED, str(error), None
    except Exception as error:  # noqa: BLE001 - whatever it raises is its answer
        return Status.RAISED, _told(error), None


def _told(error: Exception) -> str:
    """The error in one line, with the innermost place it came from."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"


def _laid_out(samples: NDArray[Any], strides: list[int]) -> NDArray[Any]:
    """A copy of the samples, with these strides in memory."""
    lowest = sum((n - 1) * s for n, s in zip(samples.shape, strides, strict=True) if s < 0)
    highest = sum((n - 1) * s for n, s in zip(samples.shape, strides, strict=True) if s > 0)
    memory = np.empty(highest - lowest + samples.itemsize, np.uint8)
    given: NDArray[Any] = np.ndarray(samples.shape, samples.dtype, memory, -lowest, strides)
    given[...] = samples
    return given


def _differ(samples: NDArray[Any], given: NDArray[Any]) -> bool:
    """Whether the samples are no longer those that were given."""
    floats = samples.dtype.kind == "f"
    return given.shape != samples.shape or not np.array_equal(samples, given, equal_nan=floats)


class Memory:
    """The resident memory of this process; its files are opened once, for thousands of calls."""

    def __init__(self) -> None:
        try:
            self._reset = os.open("/proc/self/clear_refs", os.O_WRONLY)
            self._status = os.open("/proc/self/status", os.O_RDONLY)
        except OSError:
            self._reset = self._status = -1

    def reset(self) -> int:
        """Resident bytes now; where the system can, the peak is counted from here."""
        if self._reset >= 0:
            os.pwrite(self._reset, RESET_PEAK, 0)
        return self.peak()

    def peak(self) -> int:
        """The largest number of resident bytes, since `reset` where the system can."""
        if self._status < 0:
            unit = 1 if sys.platform == "darwin" else 1024
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
        status = os.pread(self._status, 1 << 14, 0)
        return 1024 * int(status.partition(b"VmHWM:")[2].split(maxsplit=1)[0])


if __name__ == "__main__":
    main(int(sys.argv[1]))
