"""A class's submissions: who handed in what, each judged by itself, and a table of it.

A folder holds one folder a person, with files ``exercise_4.py``; or files with the name before it,
``ada_exercise_4.py``, as learning platforms hand them out. Every file is read before any is judged,
and judged from a copy in a folder of its own.

Each is judged by a process of its own (`isograde.exercises.row`), which runs the submission in
another. A submission that hangs, crashes, fills memory, kills the process that judges it, or speaks
in its place, costs its own row. It runs as you all the same: your files, your network and your
other processes are within its reach. Judge a class that you do not trust in a container.

Glossary
--------
submission  one person's file for one exercise
row         what is said of it: mended, still wrong (and what), or no answer (and why)
changed     how many lines of it are not lines of the file that was given
"""

from __future__ import annotations

import csv
import io
import json
import re
import secrets
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from isograde.adapters.child import Child, Ended
from isograde.adapters.texts import clean
from isograde.exercises import EXERCISES
from isograde.model import Limits

NAMED = re.compile(r"(?:(?P<name>.*[^ _.-])[ _.-]+)?exercise_(?P<number>\d{1,3})\.py")
LARGEST = 1 << 20
# What the process that judges may take beyond the time of the submission: to start, and to judge.
GRACE = 120.0
MEGABYTES = 4096
LONGEST = 600
Result = Literal["mended", "still wrong", "no answer", "not handed in"]


class NoSubmissionsError(ValueError):
    """There is nothing to judge; says where was looked, and for what."""


@dataclass(frozen=True)
class Submission:
    """A person's file for an exercise; no text where it was not handed in or cannot be read.

    fault : why it cannot be read
    """

    name: str
    number: int
    text: bytes | None
    fault: str = ""


@dataclass(frozen=True)
class Row:
    """What is said of a submission; `told` is what is still wrong, or why there is no answer."""

    name: str
    number: int
    result: Result
    told: tuple[str, ...] = ()
    changed: int = 0


def collected(folder: Path, numbers: Sequence[int] = ()) -> list[Submission]:
    """The submissions of a folder, by name and exercise; those asked for that nobody sent too.

    numbers : the exercises to judge; those that somebody handed in, where none is named

    Raises `NoSubmissionsError`.
    """
    found: dict[tuple[str, int], Submission] = {}
    for path in sorted([*folder.glob("*.py"), *folder.glob("*/*.py")]):
        matched = NAMED.fullmatch(path.name)
        if matched is None or int(matched["number"]) not in EXERCISES:
            continue
        # In a person's folder the file has its own name; beside others it has the person's too.
        own = path.parent != folder
        if own is (matched["name"] is not None):
            continue
        name = path.parent.name if own else matched["name"]
        key = shown(name) or "?", int(matched["number"])
        twice = Submission(*key, None, "it was handed in twice, in a folder and beside it")
        found[key] = twice if key in found else _read(*key, path)
    wanted = list(numbers) or sorted({number for _, number in found})
    kept = [one for key, one in found.items() if key[1] in wanted]
    if not kept:
        which = " or ".join(map(str, numbers)) or "N"
        raise NoSubmissionsError(
            f"{folder} holds no submission: no NAME/exercise_{which}.py and no "
            f"NAME_exercise_{which}.py"
        )
    people = sorted({name for name, _ in found})
    every = ((name, number) for name in people for number in wanted)
    return [found.get(key, Submission(*key, None)) for key in every]


def _read(name: str, number: int, path: Path) -> Submission:
    """The submission in a file that is one: a link could lead to what is not the person's."""
    if path.is_symlink() or not path.is_file():
        return Submission(name, number, None, "it is a link, or no file")
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST + 1)
    except OSError as error:
        return Submission(name, number, None, f"it cannot be read: {error.strerror}")
    if len(text) > LARGEST:
        return Submission(name, number, None, f"it has more than {LARGEST:,} bytes")
    return Submission(name, number, text)


def rows(submissions: Sequence[Submission], seconds: float, jobs: int = 1) -> Iterator[Row]:
    """What is said of each, in order; so many judged at a time.

    seconds : what all calls of one submission may take together
    """
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda one: row(one, seconds), submissions)


def row(submission: Submission, seconds: float) -> Row:
    """What is said of one submission, by a process that does nothing else."""
    name, number, text = submission.name, submission.number, submission.text
    if text is None:
        result: Result = "no answer" if submission.fault else "not handed in"
        return Row(name, number, result, (submission.fault,) if submission.fault else ())
    with TemporaryDirectory(prefix="isograde-", ignore_cleanup_errors=True) as folder:
        path = Path(folder) / EXERCISES[number].file
        path.write_bytes(text)
        result, told = _asked(number, path, seconds)
    return Row(name, number, result, tuple(map(shown, told)), _changed(number, text))


def _asked(number: int, path: Path, seconds: float) -> tuple[Result, Sequence[str]]:
    """What the judging process says of the file, or how it ended."""
    command = [sys.executable, "-m", "isograde.exercises.row", str(number), str(path), str(seconds)]
    child = Child(command, directory=path.parent)
    # What the submission runs in could write to the judging process's pipe, but not know this.
    secret = secrets.token_hex()
    try:
        child.allow(Limits(seconds + GRACE, MEGABYTES))
        child.write([f"{secret}\n".encode()])
        said = json.loads(child.read_line())
        if said["secret"] != secret:
            raise ValueError("somebody else wrote this")
        return said["result"], [one.replace(f"{path.parent}/", "") for one in said["told"]]
    except Ended as ended:
        return "no answer", [f"it took the process that judges it along: {ended}"]
    except (ValueError, KeyError, TypeError):
        return "no answer", ["the process that judges it was made to say something else"]
    finally:
        child.kill()


def shown(text: str) -> str:
    r"""A text from a submission, on one line of bounded length.

    >>> shown("a\nb" + 400 * "c")[:9], len(shown(900 * "c"))
    ('a bcccccc', 600)
    """
    line = " ".join(clean(text.encode("utf-8", "replace").decode("utf-8")).split())
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."


def _changed(number: int, text: bytes) -> int:
    """How many lines of a file are not lines of the one that was given."""
    given = set(EXERCISES[number].text.split("\n"))
    lines = text.decode("utf-8", "replace").replace("\r\n", "\n").split("\n")
    return sum(line not in given for line in lines)


# --- tables -------------------------------------------------------------------------------------

HEAD = ("name", "exercise", "result", "changed lines", "what")


def as_csv(table: Sequence[Row]) -> str:
    r"""The table for a spreadsheet: a cell that could be a formula is text there.

    >>> print(as_csv([Row("=1+1", 4, "mended", changed=1)]).splitlines()[1])
    '=1+1,4,mended,1,
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEAD)
    for one in table:
        cells = (one.name, str(one.number), one.result, str(one.changed), " / ".join(one.told))
        writer.writerow([f"'{cell}" if cell[:1] in "=+-@\t\r" and cell else cell for cell in cells])
    return out.getvalue()


def as_markdown(table: Sequence[Row]) -> str:
    r"""The table in Markdown, names and errors as they are and never as markup.

    >>> print(as_markdown([Row("a|<b>", 4, "mended")]).splitlines()[2])
    | a\|\<b\> | 4 | mended | 0 |  |
    """
    lines = [f"| {' | '.join(HEAD)} |", "| --- | ---: | --- | ---: | --- |"]
    for one in table:
        told = plain(" / ".join(one.told))
        lines.append(
            f"| {plain(one.name)} | {one.number} | {one.result} | {one.changed} | {told} |"
        )
    return "\n".join(lines) + "\n"


def plain(text: str) -> str:
    r"""The text with every character that Markdown or HTML could take for markup escaped.

    >>> plain("[x](y)")
    '\\[x\\]\\(y\\)'
    """
    return re.sub(r"([\\`*_{}\[\]()<>#|!&~$])", r"\\\1", text)
