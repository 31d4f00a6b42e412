"""Conventions are measured, and each measurement can come out either way."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from isograde.adapters import measure
from isograde.adapters.conventions import to_house
from isograde.adapters.measure import Measured
from isograde.model import Conventions, Outcome, Request, Status
from isoref.field import Field, FieldError
from isoref.methods import METHODS
from numpy.typing import NDArray

Change = Callable[[Outcome, Field], Outcome]
HOUSE = Measured("inside", "to_low", "array", "world", "raises", "mesh")


def reference(field: Field, isovalue: float) -> Outcome:
    """The reference, which has the house's conventions."""
    try:
        checked = Field.of(field.values, field.spacing)
        mesh = METHODS["asymptotic-decider"](checked, isovalue)
    except FieldError as error:
        return Outcome(Status.RAISED, detail=str(error))
    return Outcome(Status.OK, mesh.vertices, mesh.simplices)


def arrays(outcome: Outcome) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices and faces of an outcome that has them."""
    assert outcome.vertices is not None
    assert outcome.faces is not None
    return outcome.vertices, outcome.faces


def turned(outcome: Outcome, field: Field) -> Outcome:
    return replace(outcome, faces=arrays(outcome)[1][:, ::-1])


def reversed_axes(outcome: Outcome, field: Field) -> Outcome:
    """Coordinates in the other order, and faces that still face the same way in that order."""
    vertices, faces = arrays(outcome)
    return replace(outcome, vertices=vertices[:, ::-1], faces=faces[:, ::-1])


def unscaled(outcome: Outcome, field: Field) -> Outcome:
    return replace(outcome, vertices=arrays(outcome)[0] / field.spacing)


def raising_where_empty(outcome: Outcome, field: Field) -> Outcome:
    return outcome if len(arrays(outcome)[0]) else Outcome(Status.RAISED, detail="empty")


CHANGES: list[tuple[str, str, Change]] = [
    ("normals", "to_high", turned),
    ("units", "index", unscaled),
    ("axes", "reversed", reversed_axes),
    ("empty", "raises", raising_where_empty),
]


def changed(change: Change) -> measure.Ask:
    """The reference with every answer changed."""

    def ask(field: Field, isovalue: float) -> Outcome:
        outcome = reference(field, isovalue)
        return change(outcome, field) if outcome.status is Status.OK else outcome

    return ask


def mirrored(field: Field, isovalue: float) -> Outcome:
    """A tie counts outside: the surface of the negated field, facing the same way."""
    outcome = reference(replace(field, values=-field.values), -isovalue)
    return turned(outcome, field) if outcome.status is Status.OK else outcome


def filled(field: Field, isovalue: float) -> Outcome:
    """A sample that is not a number counts as zero."""
    return reference(replace(field, values=np.nan_to_num(field.values)), isovalue)


def test_the_reference_has_the_conventions_of_the_house() -> None:
    """`isograde.model.Conventions`, whose defaults are the design's."""
    assert measure.measure(reference) == HOUSE
    assert HOUSE.differences(Conventions()) == []


@pytest.mark.parametrize(("name", "value", "change"), CHANGES)
def test_each_convention_is_seen_alone(name: str, value: str, change: Change) -> None:
    measured = measure.measure(changed(change))
    assert measured == replace(HOUSE, **{name: value})  # type: ignore[arg-type]
    assert measured.differences(Conventions()) == [(name, getattr(Conventions(), name), value)]


def test_the_side_of_a_tie_is_seen() -> None:
    assert measure.measure(mirrored) == replace(HOUSE, tie="outside")


def test_an_answer_in_spite_of_nan_is_seen() -> None:
    assert measure.measure(filled) == replace(HOUSE, nan="answers")


def test_all_conventions_are_seen_at_once_and_undone() -> None:
    """What is measured of a converted answer is the house's, whatever it was converted from."""

    def ask(field: Field, isovalue: float) -> Outcome:
        outcome = mirrored(field, isovalue)
        for _, _, change in CHANGES:
            if outcome.status is Status.OK:
                outcome = change(outcome, field)
        return outcome

    foreign = Conventions("outside", "to_high", "reversed", "index", "raises", "raises")

    def converted(field: Field, isovalue: float) -> Outcome:
        request = Request("test", "plain", field, isovalue)
        return to_house(ask(field, isovalue), request, foreign)

    assert measure.measure(ask).differences(foreign) == []
    assert measure.measure(converted) == replace(HOUSE, tie="outside")


def test_nothing_is_told_of_a_surface_that_lies_nowhere_near() -> None:
    lost = measure.measure(changed(lambda o, f: replace(o, vertices=arrays(o)[0] + 50)))
    assert (lost.axes, lost.units) == (None, None)
    assert measure.measure(lambda f, i: Outcome(Status.RAISED)).normals is None
