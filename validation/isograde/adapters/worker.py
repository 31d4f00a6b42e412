"""The process in which a Python implementation runs: ``python -m isograde.adapters.worker``.

Its arguments are three descriptors: a log, and what is shared with the grader for large fields and
for large meshes.

It puts the protocol's pipe aside and turns descriptor 1 to a log, so that whatever the
implementation or a library under it prints cannot mix with the protocol. It answers a first frame
with the declaration, and each further frame with a mesh or with how the call failed. What it cannot
catch (exit, crash, hang, memory) the grader sees from outside.

Messages
--------
load    ``{"load": spec, "path": [..]}``: answered by ``{"declaration": {..}}`` or
        ``{"error": .., "unknown": ..}``, unknown where nothing has this name; `path` is Python's
run     ``{"id": i, "isovalues": [..], "spacing": [..], "strides": [..], "writeable": bool,
        "calls": how, "seconds": s}`` (`isograde.model.Calls`) and the samples; where they are
        samples of a known function, that one too, pickled: "function"; where the axes have
        directions in the world, "directions". Answered by the same ``id``
        with ``{"status": .., "detail": .., "changed": .., "seconds": .., "processor": ..,
        "peak": ..}`` and, where the status is "ok", vertices, simplices and, where they came,
        normals
"""

from __future__ import annotations

import base64
import faulthandler
import gc
import mmap
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import combinations, cycle, islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.adapters.exchange import FULL
from isograde.adapters.forms import AnswerError, arrays_from, normals_in
from isograde.adapters.frames import Arrays, Header, pack, unpack
from isograde.adapters.loading import Call, load
from isograde.adapters.shared import Shared
from isograde.adapters.texts import SENT, clean
from isograde.declaration import declaration_json
from isograde.model import AdapterError, Kind, Status, UnknownName

# A worker whose grader is gone ends itself this long after the time limit.
GRACE_SECONDS = 10.0
RESET_PEAK = b"5"
WORDS = (1, 2, 4, 8)
PAGE = mmap.PAGESIZE


def main(log: int, asked: int, answered: int) -> None:
    """Serve frames until the grader closes the pipe."""
    fields, meshes = Shared(asked), Shared(answered)
    source, sink = _set_pipes_aside(log)
    faulthandler.enable()
    read, memory = _reader(source), Memory()
    try:
        wanted, _ = unpack(read)
        extract = _serve_load(wanted, sink)
        while extract is not None:
            header, arrays = unpack(read, shared=fields, mapped=True)
            signal.setitimer(signal.ITIMER_REAL, header["seconds"] + GRACE_SECONDS)
            answer = _call(extract, header, arrays[0], memory)
            try:
                frame = pack(*answer, meshes)
            except OSError as error:  # There is no room, or it was closed.
                word = "full" if error.errno in FULL else "detail"
                bad: Header = {"status": Status.GARBAGE, "seconds": 0.0, "peak": 0}
                frame = pack({"id": header["id"], **bad, word: str(error)})
            _send(sink, frame)
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
        _send(sink, pack({"error": clean(error, SENT), "unknown": unknown}))
        return None
    _send(sink, pack({"declaration": declaration_json(declaration)}))
    return extract


def _call(
    extract: Call, header: Header, samples: NDArray[Any], memory: Memory
) -> tuple[Header, Arrays]:
    """The answer to one request: how it went, what it cost, and the mesh if there is one."""
    given = laid_out(samples, header["strides"])
    if not header["writeable"]:
        given.flags.writeable = False
    kind = Kind(len(header["spacing"]), len(header["isovalues"]))
    places = tuple(header["isovalues"]), tuple(header["spacing"])
    if "function" in header:
        extract = partial(extract, function=pickle.loads(base64.b64decode(header["function"])))
    if "directions" in header:
        extract = partial(extract, directions=np.array(header["directions"]))
    asked = Asked(extract, given, places, kind, memory, header["seconds"])
    status, detail, arrays = _outcome(asked, header["calls"])
    cost = {"seconds": asked.seconds, "processor": asked.processor, "peak": asked.bytes}
    report: Header = {"status": status, "detail": detail, **cost}
    return {**report, "id": header["id"], "changed": differ(samples, given)}, arrays


def _outcome(asked: Asked, calls: str) -> tuple[Status, str, Arrays]:
    """What the implementation did. An exit is let through: it ends the process, as it would."""
    try:
        arrays = WAYS[calls](asked)
        return Status.OK, asked.told, arrays
    except AnswerError as error:
        return error.status, clean(error, SENT), []
    except MemoryError as error:
        return Status.MEMORY, f"MemoryError: {error}", []
    except NotImplementedError as error:
        return Status.DECLINED, clean(error, SENT), []
    except Exception as error:  # noqa: BLE001 - whatever it raises is its answer
        return Status.RAISED, _told(error), []


def _told(error: Exception) -> str:
    """The error in one line, with the innermost place it came from."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return (
        f"{type(error).__name__}: {clean(error, SENT)} ({Path(last.filename).name}:{last.lineno})"
    )


def laid_out(samples: NDArray[Any], strides: Sequence[int]) -> NDArray[Any]:
    """A copy of the samples, with these strides in memory."""
    lowest = sum((n - 1) * s for n, s in zip(samples.shape, strides, strict=True) if s < 0)
    highest = sum((n - 1) * s for n, s in zip(samples.shape, strides, strict=True) if s > 0)
    memory = np.empty(highest - lowest + samples.itemsize, np.uint8)
    given: NDArray[Any] = np.ndarray(samples.shape, samples.dtype, memory, -lowest, strides)
    given[...] = samples
    return given


def differ(samples: NDArray[Any], given: NDArray[Any]) -> bool:
    """Whether the samples are no longer those that were given."""
    if given.shape != samples.shape:
        return True
    # Numbers of the same bits are the same, and nearly always they are.
    if samples.itemsize in WORDS and given.dtype == samples.dtype:
        word = f"u{samples.itemsize}"
        if np.array_equal(samples.view(word), given.view(word)):
            return False
    return not np.array_equal(samples, given, equal_nan=samples.dtype.kind == "f")


# --- ways to put a request -----------------------------------------------------------------------

THREADS, ROUNDS = 4, 6
WARM, MANY = 12, 40
TIMES = 3
# Stop asking again after so many seconds; and do not say what many calls leave where few were made.
SLOW, FEW = 2.0, 8
# An answer is kept while so many other fields are asked, and then so many that are larger.
OTHERS, LARGER = 6, 2
# No further call is made once so much of the time limit is over.
SHARE = 0.3
# Calls after which a store of 128 answers has forgotten one; values of a stamp of one byte, and a
# number that has no divisor in common with the number of samples; how near an isovalue is close by.
FORGOTTEN, PERIOD, PRIME = 130, 256, 7919
CLOSE = 1e-9


@dataclass
class Asked:
    """An implementation and a request, and what the last call cost.

    limit : seconds that all calls of the request may take
    told : what was not done of the way it was to be put, or nothing
    seconds : that it took; of the processor, for a timed request
    processor : seconds of the processors, of all threads
    bytes : by which the resident memory grew meanwhile; of many calls, what they left behind
    """

    extract: Call
    given: NDArray[Any]
    places: tuple[tuple[float, ...], tuple[float, ...]]
    kind: Kind
    memory: Memory
    limit: float
    told: str = ""
    seconds: float = 0.0
    processor: float = 0.0
    bytes: int = 0

    def answer(self, samples: NDArray[Any]) -> object:
        """What the implementation returns for these samples; its cost is known."""
        before = self.memory.reset()
        start, used = time.perf_counter(), time.process_time()
        try:
            return self.extract(samples, *self.places)
        finally:
            self.processor = time.process_time() - used
            self.seconds = time.perf_counter() - start
            self.bytes = max(0, self.memory.peak() - before)

    def arrays(self, answer: object) -> Arrays:
        """The arrays in an answer; raises `AnswerError`."""
        normals = normals_in(answer, self.kind)
        found = list(arrays_from(answer, self.kind))
        return found if normals is None else [*found, np.ascontiguousarray(normals)]

    @property
    def another(self) -> NDArray[Any]:
        """The samples in the other order along every axis of the lattice: another field."""
        first = self.given.ndim - self.kind.n
        return np.ascontiguousarray(np.flip(self.given, tuple(range(first, self.given.ndim))))

    def others(self) -> Iterator[NDArray[Any]]:
        """The samples in other orders, which have answers as large; then larger fields."""
        axes = range(-self.kind.n, 0)
        turns = [some for size in range(self.kind.n, 0, -1) for some in combinations(axes, size)]
        for number, turn in enumerate(islice(cycle(turns), OTHERS + LARGER)):
            field = np.ascontiguousarray(np.flip(self.given, turn))
            yield field if number < OTHERS else np.concatenate([field, field], axis=axes[0])


def _once(asked: Asked) -> Arrays:
    """The answer."""
    return asked.arrays(asked.answer(asked.given))


def _kept(asked: Asked) -> Arrays:
    """The answer as it is after other fields were asked, at least one and as many as time allows.

    Who gives out buffers by turns writes over the first only when they have all been used.
    """
    end = time.monotonic() + SHARE * asked.limit
    answer = asked.answer(asked.given)
    for number, field in enumerate(asked.others()):
        if number and time.monotonic() > end:
            break
        asked.answer(field)
    return asked.arrays(answer)


def _again(asked: Asked) -> Arrays:
    """The first answer that differs from that for a fresh copy of the samples, else the last.

    All that comes after it is asked about one array, which is written over in between (`_course`).
    Once three tenths of the time limit are over, the rest is not asked, and `Asked.told` says so;
    but the question itself is asked at least once more, unless a single call takes that long.
    """
    given, (isovalues, spacing) = asked.given, asked.places
    if not given.flags.writeable:
        raise NotImplementedError("its samples cannot be written over")
    end, real = time.monotonic() + SHARE * asked.limit, given.copy(order="K")
    found = first = [np.array(array) for array in asked.arrays(asked.answer(real))]
    calls, repeated = 0, False
    try:
        for number, (samples, levels) in enumerate(_course(real, isovalues, asked.kind.n), 1):
            question = samples is real and levels == isovalues
            if time.monotonic() > end and (repeated or not question or not calls):
                asked.told = f"it is too slow: {calls} of {number} questions were asked"
                continue
            given[...] = samples
            answer, calls = asked.extract(given, levels, spacing), calls + 1
            if question:
                found, repeated = asked.arrays(answer), True
                if len(found) != len(first) or not all(map(np.array_equal, found, first)):
                    break
    finally:
        given[...] = real
    return found


Question = tuple[NDArray[Any], tuple[float, ...]]


def _course(real: NDArray[Any], isovalues: tuple[float, ...], n: int) -> Iterator[Question]:
    """Questions that end with the real one, in the midst of which it is asked as well.

    Most fields have a single sample on the other side of the isovalue, so that they cost little,
    each at another place. After enough of them that an answer is no longer kept, the real samples
    are asked at an isovalue that differs in the last digits, and then at their own. Then come their
    two halves, and the real question again 256 calls after the one and 255 after the other, while
    hardly anything else was asked where they are: a table of edges that is cleared by a stamp of a
    byte, with zero among the stamps or without, has the vertices of one of the halves.
    """
    axes, length = tuple(range(-n, 0)), real.shape[-n]
    low, high = real.min(axis=axes, keepdims=True), real.max(axis=axes, keepdims=True)
    sizes = np.ravel(high.astype(np.float64) - low)
    close = tuple(
        max(level + CLOSE * float(size), float(np.nextafter(level, np.inf)))
        for level, size in zip(isovalues, sizes, strict=True)
    )
    first = np.arange(length).reshape(-1, *[1] * (n - 1)) < length // 2

    yield from ((_spike(low, high, real, one), isovalues) for one in range(FORGOTTEN))
    yield real, close
    yield real, isovalues
    yield np.where(first, low, real), isovalues
    yield np.where(first, real, low), isovalues
    yield from ((_spike(low, high, real, one), isovalues) for one in range(PERIOD - 2))
    yield real, isovalues


def _spike(low: NDArray[Any], high: NDArray[Any], real: NDArray[Any], number: int) -> NDArray[Any]:
    """The least samples of `real`, but at a place that the number tells the largest."""
    count = real.size // low.size
    field = np.repeat(low.reshape(-1, 1), count, axis=1)
    field[:, PRIME * number % count] = high.reshape(-1)
    return field.reshape(real.shape)


def _from_threads(asked: Asked) -> Arrays:
    """The answer when nobody else asks, or another that came while another field was asked."""
    first = [np.array(array) for array in _once(asked)]
    fields = [(asked.given, asked.another)[number % 2].copy() for number in range(THREADS)]
    ready = threading.Barrier(THREADS)

    def ask(number: int) -> list[Arrays]:
        ready.wait()
        end, found = time.monotonic() + SLOW, list[Arrays]()
        while len(found) < ROUNDS and time.monotonic() < end:
            found.append(asked.arrays(asked.extract(fields[number], *asked.places)))
        return [] if number % 2 else found

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(THREADS) as pool:
            answers = [one for found in pool.map(ask, range(THREADS)) for one in found]
    finally:
        sys.setswitchinterval(interval)
    others = (one for one in answers if not all(map(np.array_equal, one, first)))
    return next(others, first)


def _many(asked: Asked) -> Arrays:
    """The answer; and the memory that calls take and do not give back."""
    end = time.monotonic() + SLOW
    for _ in range(WARM):
        answer = _once(asked)
        if time.monotonic() > end:
            raise NotImplementedError("it is too slow to be asked many times")
    before, end, made = asked.memory.reset(), time.monotonic() + 2 * SLOW, 0
    while made < FEW or (made < MANY and time.monotonic() < end):
        answer, made = _once(asked), made + 1
    asked.bytes = max(0, asked.memory.reset() - before) * MANY // made
    return answer


def _timed(asked: Asked) -> Arrays:
    """The answer; and the processor's seconds, the least of three calls unless they are slow.

    The memory is the most that a call took but the first, which also loads what it needs. Before,
    what was left with the allocator is given back, or a call that takes its memory from there would
    seem to need none.
    """
    took, held = list[float](), 0
    while len(took) < TIMES and sum(took) < SLOW:
        if len(took) == 1:
            _give_back()
        start = time.process_time()
        answer = asked.answer(asked.given)
        took.append(time.process_time() - start)
        held = max(held, asked.bytes) if len(took) > 2 else asked.bytes
    asked.seconds, asked.bytes = min(took), held
    return asked.arrays(answer)


def _trimmed(asked: Asked) -> Arrays:
    """The answer; what it costs in memory is counted from what the process cannot do without."""
    _give_back()
    return _once(asked)


def _give_back() -> None:
    """The system has back what the process does not use, where its library can do that."""
    gc.collect()
    # Here, since no other way of asking needs it, and every worker would wait for the import.
    import ctypes

    system = ctypes.CDLL(None)
    if hasattr(system, "malloc_trim"):
        system.malloc_trim(0)


WAYS: dict[str, Callable[[Asked], Arrays]] = {
    "once": _once,
    "kept": _kept,
    "again": _again,
    "threads": _from_threads,
    "many": _many,
    "timed": _timed,
    "trimmed": _trimmed,
}


class Memory:
    """The resident memory of this process; its files are opened once, for thousands of calls."""

    def __init__(self) -> None:
        try:
            self._reset = os.open("/proc/self/clear_refs", os.O_WRONLY)
            self._status = os.open("/proc/self/status", os.O_RDONLY)
            self._now = os.open("/proc/self/statm", os.O_RDONLY)
        except OSError:
            self._reset = self._status = self._now = -1

    def reset(self) -> int:
        """Resident bytes now; where the system can, the peak is counted from here."""
        if self._now < 0:
            return self.peak()
        os.pwrite(self._reset, RESET_PEAK, 0)
        return PAGE * int(os.pread(self._now, 1 << 10, 0).split()[1])

    def peak(self) -> int:
        """The largest number of resident bytes, since `reset` where the system can."""
        if self._status < 0:
            import resource  # What is no Linux has no /proc, and some systems not even this.

            unit = 1 if sys.platform == "darwin" else 1024
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
        status = os.pread(self._status, 1 << 14, 0)
        return 1024 * int(status.partition(b"VmHWM:")[2].split(maxsplit=1)[0])


if __name__ == "__main__":
    main(*map(int, sys.argv[1:4]))
