"""Cases judged by the workers of a dask cluster, and the process in which a worker judges them.

The plan is cut into portions, as for processes of this machine, and each portion is a task of dask:
what a lost worker was to do is done by another. A worker runs tasks in threads, and judging wants
the main thread of a process, whose clock gives up claims that take too long. So each of its threads
has a *judge*, a process ``python -m isograde.cluster``, to which it sends portions, and which opens
the adapter once::

    here            dask's worker       judge                    implementation
    portion   --->  thread        --->  one case after the other  --->  its own process
    Judged    <---                <---                            <---

A judge does what a process of this machine does, so verdicts are the same. What is named by a file
(``python:mine.py:extract``, ``--cases``) has to be under the same path on every machine.

Messages between a worker and its judge are a length of 8 bytes and a pickle: first the
implementation and the options, then lists of tasks; answered by `None` or an error, then by lists.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
import uuid
from collections.abc import Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

from isograde.runner import Judged, Options, Task, Worker, portions

LENGTH = struct.Struct("<Q")
# Wait for a scheduler so many seconds; and ask again so often where a judge ended.
PATIENCE, RETRIES = 10, 2


class ClusterError(RuntimeError):
    """No cluster answers, or it was lost; the message says what to do."""


def connected(address: str) -> Any:
    """A client of the scheduler at this address; raises `ClusterError`."""
    try:
        import distributed
    except ImportError as error:
        told = f'distributed is needed: pip install "isograde[distributed]" ({error})'
        raise ClusterError(told) from error
    try:
        return distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(f"no dask scheduler answers at {address}: {error}") from error


def run(spec: str, tasks: Sequence[Task], options: Options) -> Generator[Judged]:
    """Every task judged by the cluster at `options.dask`, in the order of the plan.

    Raises
    ------
    ClusterError
        where no scheduler answers, where it is lost, and where workers die again and again on the
        same cases.
    """
    assert options.dask is not None
    # One name for all of this run, by which the workers know their judges.
    name = uuid.uuid4().hex
    with connected(options.dask) as client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            told = f"the dask scheduler at {options.dask} has no workers: start some"
            raise ClusterError(told) from error
        threads = sum(client.nthreads().values())
        parts = portions(tasks, replace(options, jobs=max(1, threads)))
        # Those of the beginning come first: they are waited for first.
        futures = [
            client.submit(
                judged_there,
                name,
                spec,
                options,
                os.getcwd(),
                part,
                key=f"isograde-{name}-{number}",
                priority=-number,
                pure=False,
                retries=RETRIES,
            )
            for number, part in enumerate(parts)
        ]
        try:
            for number in range(len(futures)):
                yield from _result(client, futures[number], options.dask)
                futures[number].release()
        finally:
            # After Ctrl-C nobody waits for the one that is cancelled, and it need not complain.
            client.loop.asyncio_loop.set_exception_handler(lambda *_: None)
            client.cancel(futures)
            with contextlib.suppress(Exception):  # Workers that are gone have no judges.
                client.run(release, name)


def _result(client: Any, future: Any, address: str) -> list[Judged]:
    """What a worker answered; raises `ClusterError` where none can."""
    import asyncio

    import distributed

    kept = "what was judged is kept, and the same command goes on"
    try:
        found: list[Judged] = client.gather(future)
    except (distributed.scheduler.KilledWorker, EOFError) as error:
        raise ClusterError(f"workers died again and again: {error}; {kept}") from error
    except (asyncio.CancelledError, OSError, distributed.comm.core.CommClosedError) as error:
        raise ClusterError(f"the dask scheduler at {address} was lost; {kept}") from error
    return found


# --- In a worker of dask -------------------------------------------------------------------------

# Judges that wait for a portion, by the run that they are of; None where the run is over.
_IDLE: dict[str, list[Judge] | None] = {}
_LOCK = threading.Lock()


def judged_there(
    name: str, spec: str, options: Options, folder: str, tasks: Sequence[Task]
) -> list[Judged]:
    """The tasks judged by a judge of this worker, one that waits or a new one."""
    with _LOCK:
        idle = _IDLE.setdefault(name, [])
        judge = idle.pop() if idle else None
    judge = judge or Judge(spec, options, folder)
    try:
        found = judge.judged(tasks)
    except BaseException:
        judge.close()
        raise
    with _LOCK:
        idle = _IDLE[name]
        if idle is not None:
            idle.append(judge)
            return found
    judge.close()
    return found


def release(name: str) -> None:
    """The judges of a run that is over are gone."""
    with _LOCK:
        idle = _IDLE.get(name) or []
        _IDLE[name] = None
    for judge in idle:
        judge.close()


class Judge:
    """A process that judges portions, in its main thread; it ends when its input does."""

    def __init__(self, spec: str, options: Options, folder: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "isograde.cluster"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            cwd=folder if Path(folder).is_dir() else None,
        )
        try:
            self._asked((spec, options, sys.path))
        except BaseException:
            self.close()
            raise

    def judged(self, tasks: Sequence[Task]) -> list[Judged]:
        """The tasks judged."""
        found: list[Judged] = self._asked(tasks)
        return found

    def _asked(self, message: Any) -> Any:
        """The answer to a message; raises what the judge raised."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        _write(self.process.stdin, message)
        answer = _read(self.process.stdout)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def close(self) -> None:
        """The process has ended, and with it the implementation."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(5.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()


def _write(stream: IO[bytes], message: Any) -> None:
    """The message is sent."""
    body = pickle.dumps(message)
    stream.write(LENGTH.pack(len(body)) + body)
    stream.flush()


def _read(stream: IO[bytes]) -> Any:
    """The next message; raises EOFError where there is none."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError("the other end is gone")
    return pickle.loads(stream.read(LENGTH.unpack(head)[0]))


# --- In a judge ----------------------------------------------------------------------------------


def main() -> None:
    """Judge portions until the input ends."""
    # What is printed must not mix with the answers.
    source, sink = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        spec, options, path = _read(source)
        sys.path += [entry for entry in path if entry not in sys.path]
        try:
            worker = Worker.open(spec, options)
        except Exception as error:  # noqa: BLE001 - raised again where it was asked for
            _write(sink, _told(error))
            return
        try:
            _write(sink, None)
            while True:
                _write(sink, _answer(worker, _read(source)))
        finally:
            worker.adapter.close()
    except (EOFError, BrokenPipeError):
        return


def _answer(worker: Worker, tasks: Sequence[Task]) -> list[Judged] | Exception:
    """The tasks judged, or what kept the grader from judging them, such as a full folder."""
    try:
        return [worker.judge(task) for task in tasks]
    except Exception as error:  # noqa: BLE001 - raised again where it was asked for
        return _told(error)


def _told(error: Exception) -> Exception:
    """The error, or one that says the same where it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001 - whatever keeps it from being sent
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


if __name__ == "__main__":
    main()
