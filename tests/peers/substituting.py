"""A plug-in of pytest: the calls of the page "coming from" stand in the place of the libraries'.

It is loaded, by its name, into the process that runs a library's own suite. Each outcome is written
as a line of JSON into the file that ``ISOGRADE_PEERS_SAY`` names, with how often ours was called.
"""

from __future__ import annotations

import json
import os
import sys
import types
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.loading import module_at

PAGE = Path(__file__).parents[2] / "docs" / "coming_from"
called = 0


def counted(call: Callable[..., Any]) -> Callable[..., Any]:
    """The same call, which is counted."""

    def ours(*arguments: Any, **options: Any) -> Any:
        global called
        called += 1
        return call(*arguments, **options)

    return ours


def pytest_configure(config: pytest.Config) -> None:
    """Before a test is imported: theirs are ours."""
    import contourpy
    import skimage.measure

    scikit_image, contours, lines = (
        module_at(PAGE / f"{name}.py", f"coming_from_{name}")
        for name in ("scikit_image", "scikit_image_contours", "contourpy")
    )
    skimage.measure.marching_cubes = counted(scikit_image.marching_cubes)
    skimage.measure.find_contours = counted(contours.find_contours)
    contourpy.contour_generator = counted(lines.contour_generator)
    sys.modules["generic"] = generic()


def generic() -> types.ModuleType:
    """What trimesh's suite imports of a module that its source distribution leaves out."""
    import logging

    import numpy as np
    import trimesh

    def get_mesh(name: str, **options: Any) -> Any:
        pytest.skip(f"the source distribution does not bring {name}")

    module = types.ModuleType("generic")
    names = {"np": np, "trimesh": trimesh, "unittest": unittest, "tol": trimesh.tol}
    names |= {"log": logging.getLogger("generic"), "get_mesh": get_mesh, "has_binvox": False}
    vars(module).update(names)
    return module


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Any:
    """Say what became of a test."""
    global called
    outcome = yield
    report = outcome.get_result()
    if report.when == "call" or report.outcome != "passed":
        why = str(call.excinfo.value) if call.excinfo else ""
        said = {"test": item.name, "outcome": report.outcome, "why": why, "called": called}
        with Path(os.environ["ISOGRADE_PEERS_SAY"]).open("a", encoding="utf-8") as file:
            file.write(json.dumps(said) + "\n")
        called = 0
