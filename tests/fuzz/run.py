"""Inputs that nobody would write, for all readers: ``make fuzz READER=.. COUNT=..``.

    python -m tests.fuzz.run [--count N] [--minutes M] [READER ...]    goes on where it was stopped
    python -m tests.fuzz.run --again NUMBER READER                     tries one input once more
    python -m tests.fuzz.run --report                                  writes reports/fuzz.md

An input is known by its number (`tests.fuzz.changes`). Inputs are tried in forks of this process, a
few thousand in each, so that what ends a process or fills the memory costs one input. A finding is
kept in ``build/fuzz``, the first of each kind; once it is mended it belongs into
``tests/fuzz/corpus/READER``, whose files the suite reads again.

Hypothesis draws some hundred inputs a second, and changes of bytes are not what it is for; these
are drawn by a generator with a seed instead, thousands a second. (atheris was the other candidate:
it is led by coverage, and its inputs are known by no number.)
"""

from __future__ import annotations

import argparse
import hashlib
import json
import mmap
import os
import re
import resource
import shutil
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tests.fuzz.changes import made
from tests.fuzz.readers import READERS, Reader, folder

HERE = Path(__file__).resolve().parents[2]
CORPUS = Path(__file__).parent / "corpus"
BUILD = HERE / "build" / "fuzz"
COUNTS, REPORT = HERE / "reports" / "fuzz.json", HERE / "reports" / "fuzz.md"
BATCH = 2000
# What one input may take of the processor, in seconds, and a process of memory, in bytes.
SECONDS, MEMORY = 10.0, 3 << 30
LONGEST = 3000
UNFIT = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]")


class UnsoundError(Exception):
    """An error of the reader's own, with a text that is unfit for a line."""


def tried(one: Reader, place: Path, ending: str, data: bytes) -> str:
    """What the reader made of it: "read", or the name of its own error; raises anything else."""
    try:
        one.read(place, ending, data)
    except one.refuses as error:
        told = str(error)
        fit = told.strip() and not UNFIT.search(told) and len(told) <= LONGEST
        if not fit and not isinstance(error, EOFError | MemoryError):
            raise UnsoundError(f"{type(error).__name__}: {told[:200]!r}") from error
        return type(error).__name__
    return "read"


def input_of(one: Reader, number: int) -> tuple[str, bytes]:
    """The ending and the bytes of an input."""
    seeds = one.seeds()
    endings = sorted(seeds)
    ending = endings[number % len(endings)]
    return ending, made(seeds[ending], f"{one.name}/{ending}", number)


def go(one: Reader, first: int, count: int, seconds: float) -> tuple[int, float, dict[str, int]]:
    """Inputs from `first` on are tried: how many, the seconds, what became of how many."""
    one.seeds()
    done, start, said = 0, time.monotonic(), dict[str, int]()
    used = 0.0
    while done < count and time.monotonic() - start < seconds:
        begin, size = first + done, min(BATCH, count - done)
        tried_ones, took, counts = batch(one, begin, size)
        done, used = done + tried_ones, used + took
        for name, number in counts.items():
            said[name] = said.get(name, 0) + number
    return done, used, said


def batch(one: Reader, first: int, size: int) -> tuple[int, float, dict[str, int]]:
    """So many inputs in a fork, or those up to one that ended it, which is kept."""
    shared = mmap.mmap(-1, 16)
    read, write = os.pipe()
    child = os.fork()
    if not child:
        os.close(read)
        _child(one, first, size, shared, write)
    os.close(write)
    with os.fdopen(read, encoding="utf-8") as pipe:
        lines = [json.loads(line) for line in pipe]
    _, status, usage = os.wait4(child, 0)
    number = int.from_bytes(shared[:8], "little")
    counts: dict[str, int] = {}
    for line in lines:
        if "counts" in line:
            counts = line["counts"]
        else:
            keep(one, line["number"], line["told"])
    done = number - first + 1
    if os.WIFSIGNALED(status) or os.WEXITSTATUS(status):
        ended = os.WTERMSIG(status) if os.WIFSIGNALED(status) else -os.WEXITSTATUS(status)
        late = ended == signal.SIGPROF
        what = f"took more than {SECONDS:g} s" if late else f"ended the process ({ended})"
        keep(one, number, what)
        counts = {"ended": 1, "of a batch that ended": done - 1}
    return done, usage.ru_utime + usage.ru_stime, counts


def _child(one: Reader, first: int, size: int, shared: mmap.mmap, write: int) -> None:
    """The fork: tells its findings, and at the end what became of how many."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nothing, number)
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    place, counts, kinds = folder(), dict[str, int](), set[str]()
    with os.fdopen(write, "w", encoding="utf-8") as pipe:
        for number in range(first, first + size):
            shared[:8] = number.to_bytes(8, "little")
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            try:
                said = tried(one, place, *input_of(one, number))
            except BaseException as error:  # noqa: BLE001 - this is what is looked for
                said, told = "found", told_of(error)
                if kind_of(told) not in kinds:
                    kinds.add(kind_of(told))
                    pipe.write(json.dumps({"number": number, "told": told}) + "\n")
                    pipe.flush()
            counts[said] = counts.get(said, 0) + 1
        signal.setitimer(signal.ITIMER_PROF, 0)
        pipe.write(json.dumps({"counts": counts}) + "\n")
    shutil.rmtree(place, ignore_errors=True)
    os._exit(0)


def told_of(error: BaseException) -> str:
    """The error and where it came from, the innermost place of ours first."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "/isograde/" in f.filename or "/isoref/" in f.filename]
    where = ours[-1] if ours else frames[-1]
    place = f"{Path(where.filename).name}:{where.name}"
    return f"{type(error).__name__} in {place}: {str(error)[:300]}"


def kind_of(told: str) -> str:
    """What findings of one kind have in common: the error and its place."""
    return told.partition(":")[0] + told.partition(":")[2].partition(":")[0]


def keep(one: Reader, number: int, told: str) -> None:
    """The input and what was told of it stand in `BUILD`, if no other of its kind does."""
    ending, data = input_of(one, number)
    name = hashlib.sha256(kind_of(told).encode()).hexdigest()[:10]
    path = BUILD / one.name / f"{name}.{ending}"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        text = f"{one.name} {number}: {told}\n"
        path.with_name(f"{path.name}.txt").write_text(text, encoding="utf-8", errors="replace")
        print(f"  found: {text}", end="", flush=True)


def counts() -> dict[str, Any]:
    """How many inputs each reader was given, and what became of them."""
    if not COUNTS.exists():
        return {}
    said: dict[str, Any] = json.loads(COUNTS.read_text(encoding="utf-8"))
    return said


def count(names: Sequence[str], wanted: int, minutes: float) -> None:
    """Each reader is given inputs until there were so many in all, or the time is over."""
    end = time.monotonic() + 60 * minutes
    for name in names:
        READERS[name].seeds()
    for name in names:
        while time.monotonic() < end:
            every = counts()
            row = every.setdefault(name, {"inputs": 0, "seconds": 0.0, "said": {}})
            left = wanted - row["inputs"]
            if left <= 0:
                break
            done, seconds, said = go(READERS[name], row["inputs"], min(left, 20_000), 60)
            row["inputs"] += done
            row["seconds"] = round(row["seconds"] + seconds, 1)
            for key, number in said.items():
                row["said"][key] = row["said"].get(key, 0) + number
            COUNTS.parent.mkdir(parents=True, exist_ok=True)
            COUNTS.write_text(json.dumps(every, indent=1, sort_keys=True) + "\n", encoding="utf-8")
            print(f"{name}: {row['inputs']:,} inputs, {row['seconds']:,.0f} s", flush=True)


def report() -> None:
    """`REPORT` says how many inputs each reader was given, and what became of them."""
    every = counts()
    text = [
        "# Inputs that nobody would write",
        "",
        "Whatever reads from outside was given good inputs with a few changes (`make fuzz`); an "
        "input is known by its number. A reader must end with a value or one of its own errors, in "
        f"words that fit a line, within {SECONDS:g} s of the processor and {MEMORY >> 30} GB. What "
        "it did otherwise was mended, and stands in `tests/fuzz/corpus`, which the suite reads "
        "again.",
        "",
        "| reader | what it is | inputs | read | refused | other ends | seconds of the processor |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, one in READERS.items():
        row = every.get(name, {"inputs": 0, "seconds": 0.0, "said": {}})
        said = dict(row["said"])
        read = said.pop("read", 0)
        other = said.pop("found", 0) + said.pop("ended", 0)
        unknown = said.pop("of a batch that ended", 0)
        refused = sum(said.values())
        note = f" ({unknown:,} not told apart)" if unknown else ""
        text.append(
            f"| {name} | {one.says} | {row['inputs']:,} | {read:,}{note} | {refused:,} | {other:,} "
            f"| {row['seconds']:,.0f} |"
        )
    kept = sorted(path for path in CORPUS.rglob("*") if path.is_file())
    text += ["", f"{len(kept)} inputs are kept as tests.", ""]
    text.append(
        "Other ends were those of the time; the inputs are read again by the suite, as it is now."
    )
    REPORT.write_text("\n".join(text) + "\n", encoding="utf-8")
    print(REPORT.relative_to(HERE))


def main(arguments: list[str] | None = None) -> int:
    """0, or 2 for a reader that is none."""
    parser = argparse.ArgumentParser(description="Inputs that nobody would write.")
    parser.add_argument("readers", nargs="*", metavar="READER", help="all of them if none")
    parser.add_argument("--count", type=int, default=1_000_000, help="inputs a reader, in all")
    parser.add_argument("--minutes", type=float, default=24 * 60.0, help="stop after so long")
    parser.add_argument("--again", type=int, metavar="NUMBER", help="try one input once more")
    parser.add_argument("--report", action="store_true", help="write the report and stop")
    asked = parser.parse_args(arguments)
    if unknown := sorted(set(asked.readers) - set(READERS)):
        print(f"no reader {', '.join(unknown)}; there are {', '.join(READERS)}")
        return 2
    names = asked.readers or list(READERS)
    if asked.again is not None:
        for name in names:
            ending, data = input_of(READERS[name], asked.again)
            print(name, ending, data[:2000])
            print(tried(READERS[name], folder(), ending, data))
        return 0
    if not asked.report:
        count(names, asked.count, asked.minutes)
    report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
