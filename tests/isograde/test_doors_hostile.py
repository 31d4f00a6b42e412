"""Whatever an implementation does costs the call in which it does it, and no other."""

from pathlib import Path

import numpy as np
import pytest
from isograde.doors import open_door
from isograde.model import DoorError, Limits, Outcome, Request, Status
from isoref.field import Field

HOSTILE = Path(__file__).with_name("hostile.py")
BAD = 0.5
FIELD = Field.of(np.arange(8.0).reshape(2, 2, 2))
# What each does, how the call must end, and a word its explanation must contain.
ENDINGS = [
    ("sound", Status.OK, ""),
    ("exits", Status.CRASH, "status 3"),
    ("exits_at_once", Status.CRASH, "status 4"),
    ("segfaults", Status.CRASH, "SIGSEGV"),
    ("aborts", Status.CRASH, "SIGABRT"),
    ("hangs", Status.TIMEOUT, "0.5 s"),
    ("hangs_in_c", Status.TIMEOUT, "0.5 s"),
    ("floods", Status.TIMEOUT, "0.5 s"),
    ("eats_memory", Status.MEMORY, "allowed"),
    ("asks_too_much", Status.MEMORY, "MemoryError"),
    ("raises", Status.RAISED, "no such field"),
    ("declines", Status.DECLINED, "cubes only"),
    ("prints", Status.OK, ""),
    ("closes", Status.CRASH, "closed the pipe"),
    ("breaks_protocol", Status.GARBAGE, "written to"),
    ("returns_none", Status.GARBAGE, "NoneType"),
    ("returns_string", Status.GARBAGE, "str"),
    ("returns_strings", Status.GARBAGE, "not real numbers"),
    ("returns_three", Status.GARBAGE, "of 3"),
    ("returns_ragged", Status.GARBAGE, "array"),
    ("returns_objects", Status.GARBAGE, "no array"),
    ("returns_complex", Status.GARBAGE, "complex"),
    ("returns_huge", Status.MEMORY, "allocate"),
    ("returns_large", Status.MEMORY, "absurd"),
]


def outcomes(name: str, limits: Limits) -> list[Outcome]:
    """Before, while and after it misbehaves."""
    door = open_door(f"python:{HOSTILE}:{name}")
    door.open(limits)
    try:
        isovalues = (1.5, BAD, 1.5)
        return [door.run(Request("test", "plain", FIELD, isovalue)) for isovalue in isovalues]
    finally:
        door.close()


@pytest.mark.parametrize(("name", "status", "word"), ENDINGS)
def test_each_ending_is_told_for_what_it_is_and_the_run_goes_on(
    name: str, status: Status, word: str
) -> None:
    limits = Limits(seconds=0.5 if status is Status.TIMEOUT else 20.0, megabytes=180)
    before, bad, after = outcomes(name, limits)
    assert before.status is Status.OK, before.detail
    assert bad.status is status, bad.detail
    assert word in bad.detail
    assert after.status is Status.OK, after.detail
    assert bad.mesh is None or status is Status.OK


def test_memory_held_by_child_processes_counts() -> None:
    bad = outcomes("eats_memory_elsewhere", Limits(seconds=10, megabytes=300))[1]
    assert bad.status is Status.MEMORY, bad.detail


@pytest.mark.parametrize(
    "name", ["returns_nan", "returns_wrong_shape", "returns_floats", "returns_one_based"]
)
def test_a_malformed_mesh_arrives_as_it_is_for_the_claims_to_judge(name: str) -> None:
    bad = outcomes(name, Limits(seconds=5))[1]
    assert bad.status is Status.OK
    assert bad.vertices is not None
    assert bad.mesh is None


def test_writing_into_the_input_is_noticed() -> None:
    before, bad, after = outcomes("overwrites", Limits(seconds=5))
    assert [o.input_changed for o in (before, bad, after)] == [False, True, False]


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("python:no.such.module:f", "No module named 'no'"),
        ("python:no_such_file.py:f", "no such file"),
        (f"python:{HOSTILE}:absent", "it has"),
        ("python:numpy", "write python:package.module:function"),
    ],
)
def test_what_cannot_be_loaded_is_said_at_the_door(spec: str, words: str) -> None:
    with pytest.raises(DoorError, match=words):
        open_door(spec).open(Limits())
