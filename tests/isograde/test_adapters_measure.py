"""Conventions are measured, and each measurement can come out either way."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from isograde.adapters import measure
from isograde.adapters.conventions import to_house
from isograde.adapters.measure import Measured
from isograde.declaration import Conventions
from isograde.model import CONTOURS, CURVES, Kind, Outcome, Request, Status
from isoref.fast import simplicial
from isoref.field import Field, FieldError
from isoref.methods import METHODS
from numpy.typing import NDArray

Change = Callable[[Outcome, Field], Outcome]
HOUSE = Measured("inside", "to_low", "array", "world", "raises", "mesh")


def reference(field: Field, isovalues: tuple[float, ...]) -> Outcome:
    """The reference, which has the house's conventions."""
    try:
        checked = Field.of(field.values, field.spacing, dimension=field.dimension)
        if (field.dimension, field.components) == (3, 1):
            mesh = METHODS["asymptotic-decider"](checked, *isovalues)
        else:
            mesh = simplicial.extract(checked, isovalues)
    except FieldError as error:
        return Outcome(Status.RAISED, detail=str(error))
    return Outcome(Status.OK, mesh.vertices, mesh.simplices)


def arrays(outcome: Outcome) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices and simplices of an outcome that has them."""
    assert outcome.vertices is not None
    assert outcome.simplices is not None
    return outcome.vertices, outcome.simplices


def turned(outcome: Outcome, field: Field) -> Outcome:
    return replace(outcome, simplices=arrays(outcome)[1][:, ::-1])


def reversed_axes(outcome: Outcome, field: Field) -> Outcome:
    """Coordinates in the other order, and faces that still face the same way in that order."""
    vertices, faces = arrays(outcome)
    return replace(outcome, vertices=vertices[:, ::-1], simplices=faces[:, ::-1])


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

    def ask(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        outcome = reference(field, isovalues)
        return change(outcome, field) if outcome.status is Status.OK else outcome

    return ask


def mirrored(field: Field, isovalues: tuple[float, ...]) -> Outcome:
    """A tie counts outside: the surface of the negated field, facing the same way."""
    outcome = reference(replace(field, values=-field.values), tuple(-x for x in isovalues))
    return turned(outcome, field) if outcome.status is Status.OK else outcome


def filled(field: Field, isovalues: tuple[float, ...]) -> Outcome:
    """A sample that is not a number counts as zero."""
    return reference(replace(field, values=np.nan_to_num(field.values)), isovalues)


def test_the_reference_has_the_conventions_of_the_house() -> None:
    """`isograde.declaration.Conventions`, whose defaults are the design's."""
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

    def ask(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        outcome = mirrored(field, isovalues)
        for _, _, change in CHANGES:
            if outcome.status is Status.OK:
                outcome = change(outcome, field)
        return outcome

    foreign = Conventions("outside", "to_high", "reversed", "index", "raises", "raises")

    def converted(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        request = Request("test", "plain", field, isovalues)
        return to_house(ask(field, isovalues), request, foreign)

    assert measure.measure(ask).differences(foreign) == []
    assert measure.measure(converted) == replace(HOUSE, tie="outside")


def test_nothing_is_told_of_a_surface_that_lies_nowhere_near() -> None:
    lost = measure.measure(changed(lambda o, f: replace(o, vertices=arrays(o)[0] + 50)))
    assert (lost.axes, lost.units) == (None, None)
    assert measure.measure(lambda f, i: Outcome(Status.RAISED)).normals is None


@pytest.mark.parametrize("kind", [CONTOURS, CURVES, Kind(4, 2)])
@pytest.mark.parametrize("axes", ["array", "reversed"])
@pytest.mark.parametrize("normals", ["to_low", "to_high"])
def test_conventions_of_every_kind_are_seen_and_undone(kind: Kind, axes: str, normals: str) -> None:
    """Axes, units and orientation of contours, curves and more, beside each other."""
    turns = (normals == "to_high") != (axes == "reversed" and kind.n // 2 % 2 == 1)

    def ask(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        outcome = reference(field, isovalues)
        if outcome.status is not Status.OK:
            return outcome
        vertices, rows = arrays(outcome)
        index = vertices / field.spacing
        width = rows.shape[1]
        rows = rows[:, [*range(width - 2), width - 1, width - 2]] if turns else rows
        return Outcome(Status.OK, index[:, ::-1] if axes == "reversed" else index, rows)

    measured = measure.measure(ask, kind)
    foreign = Conventions(normals=normals, axes=axes, units="index")  # type: ignore[arg-type]
    assert measured.differences(foreign) == []
    assert (measured.axes, measured.normals) == (axes, normals)

    def converted(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        return to_house(ask(field, isovalues), Request("test", "plain", field, isovalues), foreign)

    assert measure.measure(converted, kind).differences(Conventions()) == []


def test_simplices_without_orientation_are_seen() -> None:
    """Every second triangle turned over: declared "none", and never turned by the adapter."""

    def mixed(outcome: Outcome, field: Field) -> Outcome:
        rows = arrays(outcome)[1].copy()
        rows[::2] = rows[::2, ::-1]
        return replace(outcome, simplices=rows)

    measured = measure.measure(changed(mixed))
    assert measured.normals == "none"
    field = measure.ball()
    outcome = mixed(reference(field, (1.0,)), field)
    request = Request("test", "plain", field, (1.0,))
    kept = to_house(outcome, request, Conventions(normals="none", axes="reversed"))
    assert np.array_equal(arrays(kept)[1], arrays(outcome)[1])


def test_an_error_for_nothing_is_an_empty_mesh_where_a_field_has_one_side() -> None:
    """For two fields too: one of them on one side of its isovalue; NaN is no side."""
    raised = Outcome(Status.RAISED, detail="empty")
    declared = Conventions(empty="raises")
    values = np.stack([np.arange(8.0).reshape(2, 2, 2), np.ones((2, 2, 2))])
    field = Field.of(values, dimension=3)

    def house(field: Field, *isovalues: float) -> Outcome:
        return to_house(raised, Request("test", "plain", field, isovalues), declared)

    empty = house(field, 3.5, 0.5)
    assert empty.status is Status.OK
    assert arrays(empty)[1].shape == (0, 2)
    assert house(field, 99.0, 0.5).status is Status.OK
    mixed = values.copy()
    mixed[1, 0] = -1
    assert house(Field.of(mixed, dimension=3), 3.5, 0.5).status is Status.RAISED
    values[1, 0, 0, 0] = np.nan
    assert house(Field(values, field.spacing, field.origin), 3.5, 0.5).status is Status.RAISED
