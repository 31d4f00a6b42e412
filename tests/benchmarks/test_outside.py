"""Contestants in processes of their own: what they are asked, and what becomes of the absent."""

import json
import sys
from pathlib import Path

import numpy as np
import outside
import pytest
from outside import AbsentError, Outside

ADAPTER = """
import numpy as np

def surface(values, isovalue, spacing, more=0):
    print("a library says something")
    np.ones(1 << 22).sum()
    return np.zeros((4, 3), "f4"), np.zeros((int((values >= isovalue).sum()) + more, 3), "i4")
"""


def built(folder: Path, function: str = "surface") -> None:
    """A library that is built in this folder, named a, as the league builds one."""
    place = folder / "a"
    (place / "env" / "bin").mkdir(parents=True)
    python = place / "env" / "bin" / "python"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n', encoding="utf-8")
    python.chmod(0o755)
    told = {"function": function, "options": {"more": 2}}
    (place / "a.json").write_text(json.dumps(told), encoding="utf-8")
    (place / "adapter.py").write_text(ADAPTER, encoding="utf-8")
    (place / "ready").touch()


def test_a_library_of_another_environment_is_timed_and_its_memory_seen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Call by call, by its adapter and with its options; what it prints is not an answer."""
    monkeypatch.setattr(outside, "BUILT", tmp_path)
    monkeypatch.setattr(outside, "LEAGUE", tmp_path)
    built(tmp_path)
    values = np.arange(27.0).reshape(3, 3, 3)
    with outside.library("a", values, 20.0) as library:
        assert library.made == "float32, int32"
        for _ in range(2):
            seconds, processor, triangles = library.call()
            assert triangles == 9
            assert 0 < processor <= 2 * seconds + 0.1
        if sys.platform == "linux":
            assert library.memory() >= 8 << 22
    assert library.ended == 0


def test_who_is_not_there_is_a_row_with_a_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not built, or not able to answer: the benchmark goes on without it."""
    monkeypatch.setattr(outside, "BUILT", tmp_path)
    monkeypatch.setattr(outside, "LEAGUE", tmp_path)
    values = np.zeros((2, 2, 2))
    with pytest.raises(AbsentError, match=r"outside\.py a`"):
        outside.library("a", values, 0.5)
    with pytest.raises(AbsentError, match=r"outside\.py gudhi`"):
        outside.gudhi(3, 8, 1.0, 2.6)
    built(tmp_path, function="nowhere")
    with pytest.raises(AbsentError, match="ended with status 1"):
        outside.library("a", values, 0.5)
    with pytest.raises(AbsentError, match="ended with status 3"):
        Outside(sys.executable, "-c", "import sys; sys.exit(3)")


def test_no_headers_no_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It says what to install, and building others goes on."""
    monkeypatch.setattr(outside, "BUILT", tmp_path)
    monkeypatch.setenv("ISOGRADE_GUDHI", str(tmp_path))
    with pytest.raises(AbsentError, match="apt-get install libgudhi-dev"):
        outside.build_gudhi()
    assert outside.build(["gudhi"]) == 0
    assert not (tmp_path / "gudhi").exists()
