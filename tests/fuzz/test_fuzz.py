"""Whatever reads from outside ends with a value or with an error of its own, in words.

Half a minute of what `tests.fuzz.run` does at length, from the same beginning, and all that it
found.
"""

from __future__ import annotations

import itertools
import shutil
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.fuzz import run
from tests.fuzz.changes import made
from tests.fuzz.readers import READERS, Reader, folder

#: So many inputs of each reader at least, and for so many seconds of the processor in all.
INPUTS, SECONDS = 150, 30.0
KEPT = sorted(path for path in run.CORPUS.rglob("*") if path.is_file())


@pytest.fixture
def place() -> Iterator[Path]:
    """A folder for the files of inputs."""
    made_here = folder()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield made_here
    shutil.rmtree(made_here)


pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.mark.parametrize("name", sorted(READERS))
def test_a_reader_bears_inputs_that_nobody_would_write(name: str, place: Path) -> None:
    """Some are read and some are refused: else nothing was tried.

    Inputs are known by their numbers, from 0 on; how many go into the time is the machine's.
    A report has a date, so its inputs are others each day, and few changes of it are read.
    """
    one, end, said = READERS[name], time.process_time() + SECONDS / len(READERS), list[str]()
    for number in itertools.count():
        if number >= INPUTS and time.process_time() > end:
            break
        said.append(run.tried(one, place, *run.input_of(one, number)))
    assert "read" in said or name == "report"
    assert set(said) - {"read"}


@pytest.mark.parametrize("path", KEPT, ids=[f"{one.parent.name}-{one.name}" for one in KEPT])
def test_what_was_found_is_read_or_refused(path: Path, place: Path) -> None:
    """Each of these ended otherwise once."""
    ending = path.name.partition(".")[2]
    assert run.tried(READERS[path.parent.name], place, ending, path.read_bytes())


def test_every_reader_reads_its_seeds(place: Path) -> None:
    """Changes of what is refused anyway would try nothing."""
    assert READERS
    for one in READERS.values():
        for ending, seeds in one.seeds().items():
            said = [run.tried(one, place, ending, seed) for seed in seeds]
            # Lines of a report are none by themselves, and a raw volume needs to be told its shape.
            assert "read" in said or ending == "raw", (one.name, ending, said)


def test_an_input_is_known_by_its_number() -> None:
    """Nothing but the reader, its seeds and the number decide."""
    seeds = [b'{"a": [1, 2, {"b": null}]}', b"OFF 3 1 0"]
    again = [[made(seeds, "one", number) for number in range(40)] for _ in range(2)]
    assert again[0] == again[1]
    assert len(set(again[0])) > 30
    assert made(seeds, "another", 3) != made(seeds, "one", 3)


def test_what_ends_the_process_or_never_ends_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The program is a judge too: an exit, an error that is not the reader's, an endless loop."""
    import os

    monkeypatch.setattr(run, "BUILD", tmp_path)
    monkeypatch.setattr(run, "SECONDS", 0.05)

    def bad(_: Path, __: str, data: bytes) -> int:
        if len(data) % 11 == 3:
            os._exit(7)
        if len(data) % 11 == 5:
            raise KeyError(data)
        if len(data) % 11 == 7:
            while True:
                pass
        return len(data)

    one = Reader("bad", "one that is bad", lambda: {"txt": [b"abcdef 12 [3]"]}, bad, ())
    done, _, said = run.go(one, 0, 40, 20)
    assert done >= 40
    told = [path.read_text() for path in tmp_path.rglob("*.txt.txt")]
    assert any("ended the process" in text for text in told)
    assert any("took more than" in text for text in told)
    assert any("KeyError" in text for text in told)
    assert said["ended"] >= 2
