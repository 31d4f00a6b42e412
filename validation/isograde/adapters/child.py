"""A child process that is watched: how long it takes, what memory it holds, what it prints.

The child speaks through its standard input and output. Reading and writing never wait beyond a
deadline, and every `TICK` seconds of waiting the memory of the child and of its children is
looked up. A child that dies, hangs or grows too large ends in `Ended`, which says how.

The child leads a process group of its own, and the whole group is killed with it. Its environment
bears a mark, by which children of it are found that began a session of their own (on Linux). A
child of a child bears the marks of both.
"""

from __future__ import annotations

import contextlib
import os
import re
import select
import signal
import subprocess
import tempfile
import time
import uuid
import weakref
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import psutil

try:
    import fcntl
except ImportError:  # Windows, where `Child` refuses.
    fcntl = None  # type: ignore[assignment]

from isograde.adapters.system import require
from isograde.model import Limits, Status

TICK = 0.02
# Look for grandchildren only every so many ticks: it walks the whole process table.
FAMILY_TICKS = 10
# What a child may print before the log is emptied, and how much of it a report quotes.
LOG_BYTES = 1 << 26
QUOTED_BYTES = 2000
CHUNK = 1 << 20
# Read, and write, what is smaller in one go.
SMALL = 1 << 16
# The variable whose value is different for each child.
MARK = "ISOGRADE_PROCESS"
SEARCHES = 5
MEGABYTE = 1 << 20


class Ended(Exception):  # noqa: N818 - an outcome of the child, not a fault of ours
    """The child can no longer be used; `status` and the message say why."""

    def __init__(self, status: Status, detail: str):
        super().__init__(detail)
        self.status = status


class Child:
    """A running process, with logs of what it printed.

    Attributes
    ----------
    peak_bytes : largest memory seen since `allow`, while waiting
    """

    def __init__(
        self,
        command: Sequence[str] | str,
        *,
        guarded: bool = False,
        shared: Sequence[int] = (),
        directory: Path | None = None,
    ):
        """Start `command`, a string for the shell or a sequence of words.

        Raises
        ------
        AdapterError
            where the system lacks what watching a process takes.

        With `guarded` the child gets one more word: the number of a descriptor to which it turns
        its standard output once it has put the protocol's aside. Then come those of the descriptors
        that are `shared` with it.
        """
        require()
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `kill`
        self.prints = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `kill`
        self._mark = uuid.uuid4().hex
        extra = (*((self.prints.fileno(),) if guarded else ()), *shared)
        for log in (self.errors, self.prints):
            _append_only(log.fileno())
        self.process = subprocess.Popen(
            command if isinstance(command, str) else [*command, *map(str, extra)],
            shell=isinstance(command, str),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            pass_fds=extra,
            cwd=directory,
            start_new_session=True,
            bufsize=0,
            env={**os.environ, MARK: _nested(self._mark)},
        )
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self._outgoing = self.process.stdin.fileno()
        self._incoming = self.process.stdout.fileno()
        os.set_blocking(self._outgoing, False)
        os.set_blocking(self._incoming, False)
        _widen(self._outgoing, self._incoming)
        self._kill = weakref.finalize(self, _kill_group, self.process, self._mark)
        self._buffer, self._space = bytearray(), memoryview(bytearray(SMALL))
        self.allow(Limits())

    def allow(self, limits: Limits) -> None:
        """From now on the child may take this long and this much."""
        self._limits = limits
        self._deadline = time.monotonic() + limits.seconds
        self._ticks = 0
        self.peak_bytes = 0

    def write(self, buffers: Iterable[bytes | memoryview]) -> None:
        """The child has been sent the buffers; raises `Ended` where it does not take them in time.

        A child that stopped listening may have spoken before: reading from it says how it ended.
        """
        buffers = list(buffers)
        if sum(map(len, buffers)) <= SMALL:
            buffers = [b"".join(buffers)]
        for buffer in buffers:
            rest = memoryview(buffer)
            while rest:
                try:
                    rest = rest[os.write(self._outgoing, rest) :]
                except BlockingIOError:
                    self._wait(self._outgoing, select.POLLOUT)
                except BrokenPipeError:
                    return

    def read(self, count: int) -> bytearray:
        """The next `count` bytes of the child; raises `Ended`."""
        while len(self._buffer) < count <= SMALL:
            self._buffer += self._space[: self._fill(self._space)]
        if count <= len(self._buffer):
            taken = self._buffer[:count]
            del self._buffer[:count]
            return taken
        taken = bytearray(count)
        have = min(count, len(self._buffer))
        taken[:have] = self._buffer[:have]
        del self._buffer[:have]
        rest = memoryview(taken)[have:]
        while rest:
            rest = rest[self._fill(rest) :]
        return taken

    def read_line(self, limit: int = 64 * CHUNK) -> bytes:
        """The next line of the child, without its end; raises `Ended`."""
        seen, space = 0, bytearray(CHUNK)
        while (end := self._buffer.find(b"\n", seen)) < 0:
            seen = len(self._buffer)
            if seen > limit:
                raise Ended(Status.GARBAGE, f"a line of more than {limit:,} bytes on stdout")
            count = self._fill(memoryview(space))
            self._buffer += memoryview(space)[:count]
        return bytes(self.read(end + 1)[:-1])

    def unread(self) -> bytes:
        """What the child sent without being asked, as far as it has arrived; now forgotten."""
        with contextlib.suppress(BlockingIOError):
            self._buffer += os.read(self._incoming, CHUNK)
        rest, self._buffer = bytes(self._buffer), bytearray()
        return rest

    def said(self, log: str = "errors") -> str:
        """The end of what the child wrote to stderr ("errors") or stdout ("prints")."""
        file = self.errors if log == "errors" else self.prints
        size = os.fstat(file.fileno()).st_size
        text = os.pread(file.fileno(), QUOTED_BYTES, max(0, size - QUOTED_BYTES))
        return without_folders(text.decode(errors="replace").strip())

    def finish(self, patience: float = 1.0) -> int | None:
        """The exit status of the child, which is asked to end and killed when it does not."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(patience)
        status = self.process.returncode
        self.kill()
        return status

    def kill(self) -> None:
        """The child and its whole group are dead, its pipes and logs closed."""
        self._kill()
        for stream in (self.process.stdin, self.process.stdout, self.errors, self.prints):
            if stream is not None:
                stream.close()

    def _fill(self, space: memoryview) -> int:
        """The number of bytes, at least one, that were read into `space`; raises `Ended`."""
        while True:
            try:
                count = os.readv(self._incoming, [space])
            except BlockingIOError:
                self._wait(self._incoming, select.POLLIN)
                continue
            if not count:
                raise self._death()
            return count

    def _wait(self, descriptor: int, event: int) -> None:
        """The descriptor is ready; raises `Ended` when the child breaks a limit before that."""
        poll = select.poll()
        poll.register(descriptor, event)
        while not poll.poll(1000 * max(0.0, min(TICK, self._deadline - time.monotonic()))):
            if time.monotonic() >= self._deadline:
                late = f"no answer within {self._limits.seconds:g} s"
                raise Ended(Status.TIMEOUT, self._with_last_words(late))
            self._check_memory()
            self._trim_logs()
            self._ticks += 1
            if self.process.poll() is not None and not poll.poll(0):
                raise self._death()

    def _check_memory(self) -> None:
        """Nothing, or `Ended` where the child and its children hold more than they may."""
        try:
            leader = psutil.Process(self.process.pid)
            family = [leader]
            if self._ticks % FAMILY_TICKS == FAMILY_TICKS - 1:
                family += leader.children(recursive=True)
            held = sum(process.memory_info().rss for process in family)
        except psutil.Error:
            return  # It ended while it was looked at; the next read says how.
        self.peak_bytes = max(self.peak_bytes, held)
        if held > self._limits.megabytes * MEGABYTE:
            limit = f"{held // MEGABYTE} MB held, {self._limits.megabytes} MB allowed"
            raise Ended(Status.MEMORY, limit)

    def _trim_logs(self) -> None:
        """Logs that grew beyond all use are emptied."""
        for log in (self.errors, self.prints):
            if os.fstat(log.fileno()).st_size > LOG_BYTES:
                log.truncate(0)

    def _death(self) -> Ended:
        """How the child died, with the end of what it said."""
        try:
            code = self.process.wait(1.0)
        except subprocess.TimeoutExpired:
            return Ended(Status.CRASH, "it closed the pipe to the grader")
        how = f"exited with status {code}" if code >= 0 else f"killed by {_signal_name(-code)}"
        return Ended(Status.CRASH, self._with_last_words(how))

    def _with_last_words(self, how: str) -> str:
        """How it ended, with the end of what it said on stderr."""
        said = self.said()
        return f"{how}; last words: {said}" if said else how


# An absolute path, of two folders at least, with whatever stands before it.
PATH = re.compile(r"(?<![\w.:/\\-])(?:file://|[A-Za-z]:)?[/\\](?:[\w.+@~-]+[/\\])+[\w.+@-]+")
# Where the part of a path begins that says something of the program, and not of the machine.
KEPT_FROM = re.compile(r".*[/\\](?:registry[/\\]src[/\\][^/\\]+|site-packages|node_modules)[/\\]")


def without_folders(text: str) -> str:
    """What a program said, files named, but not the folders of the machine it ran on.

    >>> without_folders('File "/home/me/my files/mine.py", line 3')
    'File "mine.py", line 3'
    >>> without_folders("panicked at /home/me/registry/src/a/nets-1/lib.rs:7, see /tmp/a/b.txt")
    'panicked at nets-1/lib.rs:7, see b.txt'
    """
    text = re.sub(r'File "([^"\n]+)"', lambda found: f'File "{_short(found)}"', text)
    return PATH.sub(_short, text)


def _short(found: re.Match[str]) -> str:
    """The path from its package on, or else the name of the file."""
    path = found[found.lastindex or 0]
    rest, packages = KEPT_FROM.subn("", path)
    return rest if packages else re.split(r"[/\\]", path)[-1]


def _widen(*pipes: int) -> None:
    """The pipes hold as much as an unprivileged process may ask for, where the system can."""
    if hasattr(fcntl, "F_SETPIPE_SZ"):
        for pipe in pipes:
            with contextlib.suppress(OSError):
                fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, CHUNK)


def _append_only(descriptor: int) -> None:
    """Whoever writes to the file writes at its end, even after it was emptied."""
    fcntl.fcntl(descriptor, fcntl.F_SETFL, os.O_APPEND)


def _signal_name(number: int) -> str:
    """The name of a signal, or its number where it has none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _kill_group(process: subprocess.Popen[bytes], mark: str) -> None:
    """The process, its group and whoever left that are dead; the process is collected."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    # A process that was let in meanwhile may start another: look until there is none.
    for _ in range(SEARCHES):
        found = list(_marked(mark))
        if not found:
            return
        for pid in found:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)


def _nested(mark: str) -> str:
    """The marks of a child that is started now: those of this process, where it has any, and one.

    >>> _nested("b").split()[-1]
    'b'
    """
    return f"{os.environ.get(MARK, '')} {mark}".strip()


def _marked(mark: str) -> Iterator[int]:
    """The processes whose environment has the mark: children of a child, in any session."""
    try:
        listed = [int(name) for name in os.listdir("/proc") if name.isdigit()]
    except OSError:
        listed = psutil.pids()
    begin, wanted = f"{MARK}=".encode(), mark.encode()
    for pid in listed:
        try:
            environment = Path(f"/proc/{pid}/environ").read_bytes()
        except OSError:
            continue
        marks = [one for one in environment.split(b"\0") if one.startswith(begin)]
        if any(wanted in one for one in marks) and not _is_dead(pid):
            yield pid


def _is_dead(pid: int) -> bool:
    """Whether a process has ended and is only not collected yet."""
    with contextlib.suppress(psutil.Error):
        return bool(psutil.Process(pid).status() == psutil.STATUS_ZOMBIE)
    return True
