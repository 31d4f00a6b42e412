"""Whatever an implementation does costs the call in which it does it, and no other."""

import time
from pathlib import Path

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.claims import CLAIMS
from isograde.declaration import Declaration
from isograde.model import (
    AdapterError,
    Case,
    Limits,
    Outcome,
    Request,
    Status,
    Trial,
    Verdict,
)
from isoref.field import Field

HOSTILE = Path(__file__).with_name("hostile.py")
BAD = 0.5
FIELD = Field.of(np.arange(8.0).reshape(2, 2, 2))
# How each call must end, what is then said of it, and a word the explanation must contain.
VERDICTS = {
    Status.OK: Verdict.PASS,
    Status.CRASH: Verdict.CRASH,
    Status.TIMEOUT: Verdict.TIMEOUT,
    Status.MEMORY: Verdict.TIMEOUT,
    Status.RAISED: Verdict.ERROR,
    Status.DECLINED: Verdict.UNSUPPORTED,
    Status.GARBAGE: Verdict.FAIL,
}
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
    ("returns_three", Status.GARBAGE, "the answer cannot be made an array"),
    ("returns_list_of_three", Status.GARBAGE, "neither a pair"),
    ("returns_junk_rows", Status.GARBAGE, "polygon 1 (list) are not real numbers"),
    ("returns_two_corners", Status.GARBAGE, "polygon 1 has 2 corners: [0, 1]"),
    ("returns_padding_inside", Status.GARBAGE, "polygon 0 has a -1 before its last corner"),
    ("returns_float_rows", Status.GARBAGE, "polygon 0 has shape (4,) of float64"),
    ("returns_object_array", Status.GARBAGE, "not real numbers: object"),
    ("returns_beyond_integers", Status.GARBAGE, "not real numbers: object"),
    ("returns_beyond_in_rows", Status.GARBAGE, "the index 18446744073709551615"),
    ("returns_flat_soup", Status.GARBAGE, "nor a soup (S, 3, 3)"),
    ("returns_false_mesh", Status.GARBAGE, "no vertices today"),
    ("returns_quads", Status.OK, ""),
    ("returns_polygons", Status.OK, ""),
    ("returns_soup", Status.OK, ""),
    ("returns_object", Status.OK, ""),
    ("returns_ragged", Status.GARBAGE, "vertices cannot be made an array"),
    ("returns_objects", Status.GARBAGE, "no array"),
    ("returns_complex", Status.GARBAGE, "complex"),
    ("returns_huge", Status.MEMORY, "allocate"),
    ("returns_large", Status.MEMORY, "absurd"),
]


def outcomes(name: str, limits: Limits) -> list[Outcome]:
    """Before, while and after it misbehaves."""
    adapter = open_adapter(f"python:{HOSTILE}:{name}")
    adapter.open(limits)
    try:
        isovalues = (1.5, BAD, 1.5)
        return [adapter.run(Request("test", "plain", FIELD, (isovalue,))) for isovalue in isovalues]
    finally:
        adapter.close()


def verdict(claim: str, outcome: Outcome) -> Verdict:
    """What the claim says of the outcome."""
    case = Case("test", lambda: FIELD, (BAD,), 8)
    trial = Trial(case, FIELD, Declaration("hostile"), {"plain": outcome})
    return CLAIMS[claim].judge(trial).verdict


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
    assert verdict("structure.answers", bad) is VERDICTS[status]
    assert bad.mesh is None or status is Status.OK


def test_an_answer_that_comes_twice_cannot_pass_for_the_next_ones() -> None:
    """A child of the worker answers again; the next request is not met by that."""
    adapter = open_adapter(f"python:{HOSTILE}:forks")
    adapter.open(Limits(seconds=5.0, megabytes=500))
    try:
        first = adapter.run(Request("test", "plain", FIELD, (BAD,)))
        time.sleep(0.5)
        second, third = (adapter.run(Request("test", "plain", FIELD, (2.5,))) for _ in range(2))
    finally:
        adapter.close()
    assert [o.status for o in (first, second, third)] == [Status.OK, Status.GARBAGE, Status.OK]
    assert second.detail == "it answered request 1 a second time"


def test_memory_held_by_child_processes_counts() -> None:
    bad = outcomes("eats_memory_elsewhere", Limits(seconds=10, megabytes=300))[1]
    assert bad.status is Status.MEMORY, bad.detail


@pytest.mark.parametrize(
    ("name", "claim"),
    [
        ("returns_nan", "structure.finite"),
        ("returns_wrong_shape", "structure.shapes"),
        ("returns_floats", "structure.shapes"),
        ("returns_one_based", "structure.in_range"),
        ("returns_huge_indices", "structure.in_range"),
        ("returns_quads_out_of_range", "structure.in_range"),
        ("returns_float_quads", "structure.shapes"),
    ],
)
def test_a_malformed_mesh_arrives_as_it_is_for_the_claims_to_judge(name: str, claim: str) -> None:
    before, bad, after = outcomes(name, Limits(seconds=5))
    assert bad.status is Status.OK
    assert bad.vertices is not None
    assert bad.mesh is None
    said = [verdict(claim, outcome) for outcome in (before, bad, after)]
    assert said == [Verdict.PASS, Verdict.FAIL, Verdict.PASS]


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
def test_what_cannot_be_loaded_is_said_at_the_adapter(spec: str, words: str) -> None:
    with pytest.raises(AdapterError, match=words):
        open_adapter(spec).open(Limits())


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (
            'raise ImportError("libGL.so.1: cannot open shared object file: No such file")',
            "libGL.so.1 is missing: install it .*apt-get install libgl1",
        ),
        ('raise ImportError("libodd-2.so.7: cannot open shared object file")', "libodd-2.so.7"),
        ("raise ModuleNotFoundError(\"No module named 'mcubes'\")", "pip install PyMCubes"),
        ("import os; os.abort()", "did not start: killed by SIGABRT"),
        ("raise SystemExit(7)", "exited with status 7"),
        (
            "import hostile; hostile.scribble()",
            "its import wrote to the worker's pipe",
        ),
    ],
)
def test_a_library_that_does_not_load_is_named_with_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, words: str
) -> None:
    """A bare server lacks libraries that wheels do not bring, such as OpenGL."""
    (tmp_path / "mcubes.py").write_text(line)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(HOSTILE.parent)
    with pytest.raises(AdapterError, match=words):
        open_adapter("pymcubes").open(Limits())
