"""How an implementation bears what it is given: right ones pass, and each fault is named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims.robustness import _apart_from
from isograde.declaration import Conventions, Declaration, End, Scope
from isograde.model import Verdict
from isograde.oracles.complexes import Complex

from tests.isograde.cheats import CHEATS
from tests.isograde.families import cubes
from tests.isograde.judging import verdicts

ONE = [all_cases()["cells/outside/009"]]


def verdict(function: Any, declared: Declaration, claim: str) -> Verdict:
    """What the claim says of a function on one case."""
    found = verdicts(function, declared, ONE, f"robustness.{claim}")
    (only,) = found[f"robustness.{claim}"]
    return only


@pytest.mark.parametrize(
    ("name", "claim"),
    [("in_any_order", "deterministic"), ("overwrites", "input_unmodified")],
)
def test_a_cheat_is_caught(name: str, claim: str) -> None:
    """Other numbers the second time; a sample written to."""
    assert verdict(CHEATS[name].function, Declaration("cheat"), claim) is Verdict.FAIL
    assert verdict(cubes, Declaration("cubes"), claim) is Verdict.PASS


def test_an_empty_answer_given_twice_is_no_evidence() -> None:
    """Nothing is the same as nothing."""
    found = verdict(CHEATS["always_empty"].function, Declaration("empty"), "deterministic")
    assert found is Verdict.SKIP


def test_what_nan_does_is_declared_and_measured() -> None:
    """Neither an error nor an answer is wrong by itself."""

    def answers(values: Any, isovalue: float, spacing: Any) -> Any:
        return cubes(np.nan_to_num(values, nan=0.0), isovalue, spacing)

    declared = Declaration("answers", conventions=Conventions(nan="answers"))
    assert verdict(cubes, Declaration("raises"), "nan") is Verdict.PASS
    assert verdict(answers, declared, "nan") is Verdict.PASS
    assert verdict(answers, Declaration("raises"), "nan") is Verdict.FAIL
    assert verdict(cubes, declared, "nan") is Verdict.FAIL


def test_an_error_where_there_is_no_surface_says_nothing_of_nan() -> None:
    """Who raises on what is empty, as it declares, does so with such a sample or without."""

    def raises(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = cubes(np.nan_to_num(values, nan=-1.0), isovalue, spacing)
        if not len(faces):
            raise ValueError("no surface")
        return vertices, faces

    both = Conventions(nan="answers", empty="raises")
    empty = [all_cases()["cells/outside/000"]]
    found = verdicts(raises, Declaration("raises", conventions=both), empty, "robustness.nan")
    assert list(found["robustness.nan"]) == [Verdict.SKIP]
    only_nan = Declaration("raises", conventions=Conventions(nan="answers"))
    found = verdicts(raises, only_nan, empty, "robustness.nan")
    assert list(found["robustness.nan"]) == [Verdict.FAIL]


def test_bad_input_is_refused_with_words() -> None:
    """A plane, no samples, no isovalue; an answer or a bare error fails."""

    def mute(values: Any, isovalue: float, spacing: Any) -> Any:
        try:
            return cubes(values, isovalue, spacing)
        except ValueError:
            raise ValueError from None

    assert verdict(cubes, Declaration("cubes"), "bad_input") is Verdict.PASS
    assert verdict(mute, Declaration("mute"), "bad_input") is Verdict.FAIL
    assert verdict(CHEATS["always_empty"].function, Declaration("e"), "bad_input") is Verdict.FAIL


def test_who_takes_planes_too_is_right_to_answer_one() -> None:
    """A field with one axis less is bad input only to those who do not take its kind."""

    def planes(values: Any, isovalue: float, spacing: Any) -> Any:
        if values.ndim == 2 and values.size:
            return np.empty((0, 2)), np.empty((0, 2), np.int64)
        return cubes(values, isovalue, spacing)

    both = Declaration("planes", limits=Scope(kinds=((3, 1), (2, 1))))
    assert verdict(planes, both, "bad_input") is Verdict.PASS
    assert verdict(planes, Declaration("planes"), "bad_input") is Verdict.FAIL


def test_out_of_range_gives_nothing_but_a_capped_box_below() -> None:
    """With everything inside, a surface that is closed at the border is the border."""

    def box(values: Any, isovalue: float, spacing: Any) -> Any:
        wide = np.pad(values, 1, constant_values=values.min() - 1 - abs(isovalue))
        vertices, faces = cubes(wide, isovalue, spacing)
        return vertices - np.asarray(spacing), faces

    capped = Declaration("box", domain=(End(-0.5, "closed"),))
    assert verdict(cubes, Declaration("cubes"), "out_of_range") is Verdict.PASS
    assert verdict(box, capped, "out_of_range") is Verdict.PASS
    assert verdict(box, Declaration("box"), "out_of_range") is Verdict.FAIL


def test_a_sample_that_is_no_number_changes_nothing_elsewhere() -> None:
    """Of "robustness.elsewhere": whatever stands for it; vertices that are no numbers beside it."""
    asked = [all_cases()["noise/white-5x6x7"]]

    def verdict_of(function: Any) -> Verdict:
        found = verdicts(function, Declaration("one"), asked, "robustness.elsewhere")
        (only,) = found["robustness.elsewhere"]
        return only

    def filled(values: Any, isovalue: float, spacing: Any) -> Any:
        return cubes(np.nan_to_num(values, nan=-1.0, posinf=1e9), isovalue, spacing)

    def with_holes(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = filled(values, isovalue, spacing)
        where = np.argwhere(~np.isfinite(values))
        for place in where:
            vertices[(np.abs(vertices / spacing - place) <= 1).all(axis=1)] = np.nan
        return vertices, faces

    def normalised(values: Any, isovalue: float, spacing: Any) -> Any:
        with np.errstate(invalid="ignore"):
            away = (values - isovalue) / np.abs(values - isovalue).max()
        return filled(away, 0.0, spacing)

    def nothing(values: Any, isovalue: float, spacing: Any) -> Any:
        if not np.isfinite(values).all():
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        return cubes(values, isovalue, spacing)

    assert verdict_of(cubes) is Verdict.SKIP, "it refuses both"
    assert verdict_of(filled) is verdict_of(with_holes) is Verdict.PASS
    assert verdict_of(normalised) is verdict_of(nothing) is Verdict.FAIL


def test_simplices_are_apart_from_a_sample_beyond_its_reach() -> None:
    """Along every axis: what is exactly as far as that is still within it."""
    points = np.array([[2.0, 1, 1], [1, 2, 0], [2.5, 1, 1], [1, 2.5, 1], [1, 1, -0.5], [1.5, 1, 1]])
    mesh = Complex(points, np.array([[2, 3, 4], [2, 3, 0], [1, 3, 4], [2, 5, 4]]))
    found = _apart_from(mesh, np.array([1, 1, 1]), 1.0)
    assert found.simplices.tolist() == [[2, 3, 4]]
