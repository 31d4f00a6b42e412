"""The gallery: every program of it runs and draws."""

from __future__ import annotations

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

PROGRAMS = sorted((Path(__file__).parents[1] / "docs" / "examples").glob("plot_*.py"))


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_every_program_of_the_gallery_runs_and_shows_a_picture(
    program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It calls `show` once, with one figure whose axes all hold something."""
    shown: list[int] = []
    monkeypatch.setattr(plt, "show", lambda: shown.extend(plt.get_fignums()))
    try:
        runpy.run_path(str(program))
        assert len(shown) == 1
        axes = plt.figure(shown[0]).axes
        assert axes
        assert all(axis.has_data() or axis.collections for axis in axes)
    finally:
        plt.close("all")
