"""Doors to Python functions."""

import numpy as np
import pytest
from isograde.doors import open_door, ready_made_names
from isograde.model import Limits, Outcome, Request, Status
from isoref.field import Field
from isoref.methods import METHODS

QUICK = Limits(seconds=20.0, megabytes=1024)


def ask(spec: str, field: Field, isovalue: float) -> Outcome:
    """The outcome of one call through a door of its own."""
    door = open_door(spec)
    door.open(QUICK)
    try:
        return door.run(Request("test", "plain", field, isovalue))
    finally:
        door.close()


def ball(spacing: tuple[float, ...] = (1, 2, 3), origin: tuple[float, ...] = (9, 8, 7)) -> Field:
    """High in the middle of 5 x 6 x 7 samples."""
    i, j, k = np.indices((5, 6, 7))
    return Field.of(4 - (i - 2.1) ** 2 - (j - 2.4) ** 2 - (k - 3.2) ** 2, spacing, origin)


def volume(outcome: Outcome) -> float:
    """Signed volume; positive where right-hand normals point outwards."""
    assert outcome.mesh is not None, outcome.detail
    a, b, c = outcome.mesh.vertices[outcome.mesh.simplices].swapaxes(0, 1)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("spec", ["skimage:lewiner", "skimage:lorensen", "isoref:lorensen-cline"])
def test_every_door_answers_in_the_conventions_of_the_house(spec: str) -> None:
    """World units, origin included, right-hand normals to lower values."""
    outcome = ask(spec, ball(), 1.0)
    assert outcome.status is Status.OK, outcome.detail
    assert outcome.vertices is not None
    assert (outcome.vertices.min(0) > (9, 8, 7)).all()
    assert (outcome.vertices.max(0) < (13, 18, 25)).all()
    assert 6 * 14 < volume(outcome) < 6 * 4 / 3 * np.pi * 3**1.5


def test_a_declared_error_for_an_empty_surface_becomes_an_empty_mesh() -> None:
    """scikit-image raises where the isovalue is out of range; the house has an empty mesh."""
    outcome = ask("skimage:lewiner", ball(), 99.0)
    assert outcome.status is Status.OK
    assert outcome.mesh is not None
    assert len(outcome.mesh.simplices) == 0


def test_every_method_of_the_reference_has_a_door() -> None:
    assert {f"isoref:{name}" for name in METHODS} <= set(ready_made_names())


def test_a_call_reports_its_cost() -> None:
    outcome = ask("skimage:lewiner", Field.of(np.random.default_rng(0).random((40, 40, 40))), 0.5)
    assert outcome.seconds > 0
    assert outcome.peak_bytes > 1 << 20
