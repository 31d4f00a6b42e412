"""What a run has judged so far, kept so that it can go on where it was stopped or killed.

A draft stands beside the report, as ``unfinished-report.jsonl``: the header, the claims, and a case
and a result line for each case as soon as it is judged. Whoever gives the same command again goes
on from there: the same implementation (its file unchanged), declaration, plan, limits and versions;
anything else, and the run begins anew. The last line may be cut off where the process was killed.

While a process writes to it the draft is locked, so that a second one that grades into the same
folder is told so and spoils nothing. The system takes the lock away from a process that ends.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from isograde.report import lines
from isograde.report.lines import JSON, ReportError

# Entries of a header that may differ between two runs of which one goes on with the other.
FREE = frozenset({"date", "jobs", "arguments", "machine", "expected"})
# Files larger than this are known by their size and time, not by their bytes.
LARGEST_READ = 1 << 26


class Busy(RuntimeError):  # noqa: N818 - a state of the folder, not an error of the program
    """Another process is grading into the same folder under the same name."""


class NotResumed(RuntimeError):  # noqa: N818 - nothing is there, or it is of another run
    """There is no unfinished run to go on with; the message says why."""


def unfinished(path: Path) -> Path:
    """Where the lines of the report `path` stand until it has all of them: never compressed."""
    name = path.name.removesuffix(".gz")
    return path.with_name(f"unfinished-{name}")


@dataclass
class Draft:
    """An open draft, locked.

    done : what earlier runs judged: the case and the result line of each case, by its id
    reason : why an earlier draft was not gone on with, or nothing
    """

    path: Path
    file: IO[bytes]
    done: dict[str, tuple[JSON, JSON]]
    reason: str = ""

    @classmethod
    @contextlib.contextmanager
    def of(cls, report: Path, first: Sequence[JSON], resume: bool | None) -> Iterator[Draft]:
        """The draft of a report that begins with these lines, the header first.

        resume : True insists on an earlier draft, None takes one of the same run, False none

        Raises
        ------
        Busy
            where another process has it.
        NotResumed
            where `resume` insists, and there is no draft of this run.
        """
        path = unfinished(report)
        path.parent.mkdir(parents=True, exist_ok=True)
        file = _locked(path)
        try:
            done, length, reason = _earlier(path, first[0]) if resume is not False else ({}, 0, "")
            if resume and not done:
                raise NotResumed(f"{path}: {reason}")
            # Whole lines stay as they are: a process that is killed just now loses none.
            os.ftruncate(file.fileno(), length)
            draft = cls(path, file, done, reason)
            if not done:
                draft.add(*first)
            yield draft
        finally:
            file.close()

    def add(self, *records: Mapping[str, Any]) -> None:
        """The lines are in the file, whatever becomes of this process."""
        text = "".join(lines.line_of(record) for record in records)
        self.file.write(text.encode("utf-8", "backslashreplace"))
        self.file.flush()

    def remove(self) -> None:
        """The draft is gone: the report has all of it."""
        self.path.unlink(missing_ok=True)


def _locked(path: Path) -> IO[bytes]:
    """The file, open at its end and locked for this process; raises `Busy`."""
    while True:
        file = path.open("ab")
        try:
            _lock(file)
        except OSError:
            file.close()
            told = f"another process is grading into {path.parent} under this name"
            raise Busy(f"{told}; wait for it, or name another folder with --out") from None
        # Whoever had the lock before may have removed the file meanwhile.
        try:
            if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                return file
        except FileNotFoundError:
            pass
        file.close()


def _lock(file: IO[bytes]) -> None:
    """The file is locked; raises `OSError` where another process has it."""
    try:
        import fcntl
    except ImportError:  # Windows, where the adapters say what is missing.
        return
    fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def _earlier(path: Path, header: JSON) -> tuple[dict[str, tuple[JSON, JSON]], int, str]:
    """What an earlier run of the same header judged, in how many bytes, or why nothing is taken."""
    records, length = [], 0
    with contextlib.suppress(ReportError, UnicodeDecodeError):  # It may end with half a line.
        for line in path.read_bytes().splitlines(keepends=True):
            if line.endswith(b"\n"):
                records.append(lines.checked(line.decode(), str(path)))
                length += len(line)
    if not records or records[0]["record"] != "header":
        return {}, 0, "there is no unfinished run"
    if differ := _difference(records[0], header):
        return {}, 0, f"the unfinished run there is another: {differ}"
    cases = {one["id"]: one for one in records if one["record"] == "case"}
    results = {one["case"]: one for one in records if one["record"] == "result"}
    done = {name: (cases[name], one) for name, one in results.items() if name in cases}
    return done, length if done else 0, "" if done else "nothing was judged yet"


# What the fingerprint is of.
FILES = "the implementation's files, or those of the cases,"


def _difference(old: JSON, new: JSON) -> str:
    """What differs between two headers, or nothing."""
    for name in dict.fromkeys([*old, *new]):
        if name not in FREE and old.get(name) != new.get(name):
            words = {
                "fingerprint": FILES,
                "tasks": "the plan",
            }
            return f"{words.get(name, name)} changed"
    return ""


def fingerprint(spec: str, own: Sequence[Path] = ()) -> str:
    """A number for the files that an implementation's name leads to; it changes when they do.

    So it does with files of cases of the user's `own`: what was judged on other samples is not
    taken over.

    >>> fingerprint("skimage:lewiner")
    ''
    """
    digest = hashlib.sha256()
    found = [path for path in (*_files(spec), *own) if path.is_file()]
    for path in found:
        stat = path.stat()
        if stat.st_size <= LARGEST_READ:
            digest.update(path.read_bytes())
        else:
            digest.update(f"{stat.st_size} {stat.st_mtime_ns}".encode())
    return digest.hexdigest()[:16] if found else ""


def _files(spec: str) -> Iterator[Path]:
    """The files that a name leads to, as far as they are known without running anything."""
    kind, _, rest = spec.partition(":")
    if kind == "python":
        place = rest.rpartition(":")[0]
        if place.endswith(".py"):
            yield Path(place)
            return
        with contextlib.suppress(ImportError, ValueError, AttributeError):
            top = find_spec(place.partition(".")[0])
            if top is not None and top.origin is not None:
                inner = Path(top.origin).parent.joinpath(*place.split(".")[1:])
                yield from (Path(top.origin), inner.with_suffix(".py"))
    elif kind == "exec":
        with contextlib.suppress(ValueError):
            yield from (Path(word) for word in shlex.split(rest))
    elif kind == "dir":
        yield from sorted(Path(rest).rglob("*"))
