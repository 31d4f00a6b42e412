"""Faults of published libraries that the plan finds by itself, on cases that run by default."""

from __future__ import annotations

import pytest
from isograde.cases import all_cases
from isograde.model import Finding, Verdict
from isograde.runner import Options, Task, Worker


def judged(spec: str, case: str, claim: str) -> Finding:
    """What the claim says of the library on the case, which every grade has."""
    assert "full" not in all_cases()[case].tags
    worker = Worker.open(spec, Options())
    try:
        return worker.judge(Task(case, (claim,))).findings[claim]
    finally:
        worker.adapter.close()


def test_pymcubes_misreads_doubles_in_the_other_byte_order() -> None:
    """It reads the bytes as they lie: a sphere of any radius gets hundreds of vertices."""
    pytest.importorskip("mcubes")
    found = judged("pymcubes", "types/signed", "symmetry.layout")
    assert found.verdict is Verdict.FAIL
    assert "swapped" in found.detail


@pytest.mark.parametrize(
    ("case", "claim", "told"),
    [
        ("magnitudes/small", "topology.bilinear", "ambiguous faces"),
        ("noise/white-5x6x7", "range.scale", "2^-30"),
        ("magnitudes/single-0", "topology.ties", "not cancelled"),
    ],
)
def test_lewiner_changes_with_magnitude_and_tears_on_an_offset(
    case: str, claim: str, told: str
) -> None:
    """At 1e-7 a face is decided otherwise; at 10,000 in single precision ties are torn."""
    pytest.importorskip("skimage")
    found = judged("skimage:lewiner", case, claim)
    assert found.verdict is Verdict.FAIL
    assert told in found.detail


def test_flying_edges_overflow_where_integers_are_far_apart() -> None:
    """VTK takes differences in the type of the samples."""
    pytest.importorskip("vtkmodules")
    assert judged("vtk:flying-edges", "types/int32-low", "topology.sides").verdict is Verdict.FAIL
    other = judged("vtk:marching-cubes", "types/int32-low", "topology.sides")
    assert other.verdict is Verdict.PASS
