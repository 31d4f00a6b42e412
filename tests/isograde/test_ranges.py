"""How far an answer stays is measured: everywhere, down to an epsilon, up to lost digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.declaration import Declaration
from isograde.model import Finding, Verdict
from isoref.field import Field
from isoref.methods import METHODS

from tests.isograde import mistaken
from tests.isograde.judging import Here, grade

CASE = "noise/white-5x6x7"


def measured(function: Any, claim: str, case: str = CASE) -> Finding:
    """What this claim says of a function in this process."""
    here = Here(function, Declaration("here"))
    [(_, _, found)] = grade(here, [all_cases()[case]], claim)
    return found


def labels(values: Any, isovalue: float, spacing: Any) -> Any:
    """The surface of what is inside, which compares no values."""
    mesh = METHODS["label-cubes"](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def test_the_reference_stays_the_same_from_end_to_end() -> None:
    """From 1e-300 to 1e300, and on a million times the range."""
    scale = measured(mistaken.correct, "range.scale")
    assert (scale.verdict, dict(scale.numbers)) == (
        Verdict.PASS,
        {"least": "1e-300", "greatest": "1e+300"},
    )
    shift = measured(mistaken.correct, "range.shift")
    assert (shift.verdict, dict(shift.numbers)) == (Verdict.PASS, {"offset": "1e6"})


def test_an_absolute_epsilon_ends_the_range_of_small_values() -> None:
    """Of "range.scale": a thousandth of a thousandth is lost between 2^-10 and 2^-20."""
    found = measured(mistaken.with_epsilon, "range.scale")
    assert found.verdict is Verdict.FAIL
    assert found.numbers == {
        "least": "2^-10",
        "greatest": "1e+300",
        "variant": "magnitude/2^-20",
    }


def test_single_precision_ends_the_ranges_where_its_numbers_end() -> None:
    """Digits are lost beyond 2^10, and 2^-126 and 2^128 are not passed: degrees, no faults."""
    shift = measured(mistaken.in_single_precision, "range.shift")
    assert shift.verdict is Verdict.PASS
    assert shift.numbers == {"offset": "2^10"}
    scale = measured(mistaken.in_single_precision, "range.scale")
    assert scale.verdict is Verdict.PASS
    assert scale.numbers == {"least": "2^-60", "greatest": "2^+60"}


def test_half_precision_loses_the_answer_on_an_offset() -> None:
    """Of "range.shift": eleven bits do not hold a thousandth of an offset."""

    def in_half(values: Any, isovalue: float, spacing: Any) -> Any:
        with np.errstate(over="ignore"):
            half = np.asarray(values, np.float64).astype(np.float16)
        return mistaken.correct(np.nan_to_num(half), isovalue, spacing)

    found = measured(in_half, "range.shift")
    assert found.verdict is Verdict.FAIL
    assert found.numbers == {"offset": "0", "variant": "offset/2^10"}


def test_digits_of_doubles_are_kept_or_not() -> None:
    """Of "range.digits": single precision has none left a million times the range away."""
    assert measured(mistaken.correct, "range.digits").verdict is Verdict.PASS
    single = measured(mistaken.in_single_precision, "range.digits")
    assert single.verdict is Verdict.FAIL
    assert "2^20" in single.detail


def test_samples_of_1e300_beside_ordinary_ones_are_borne_or_not() -> None:
    """Of "range.extremes": a square of one, or single precision, is infinite."""

    def squares(values: Any, isovalue: float, spacing: Any) -> Any:
        away = np.asarray(values, np.float64) - isovalue
        with np.errstate(over="ignore"):
            return mistaken.correct(np.nan_to_num(np.sign(away) * away**2), 0.0, spacing)

    def overflowing(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mistaken.correct(values, isovalue, spacing)
        return (vertices if np.abs(values).max() < 1e200 else vertices * np.nan), faces

    def torn(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mistaken.correct(values, isovalue, spacing)
        return vertices, faces if np.abs(values).max() < 1e200 else faces[1:]

    assert measured(mistaken.correct, "range.extremes").verdict is Verdict.PASS
    # Crossings move, and neither tear nor come to stand on another side.
    assert measured(squares, "range.extremes").verdict is Verdict.PASS
    assert measured(overflowing, "range.extremes").verdict is Verdict.FAIL
    assert measured(torn, "range.extremes").verdict is Verdict.FAIL


def test_a_surface_of_labels_is_asked_at_every_sample() -> None:
    """Of "range.extremes": its vertices are halfway, however large the samples are."""
    here = Here(labels, Declaration("here", interpolant="labels"))
    [(_, _, found)] = grade(here, [all_cases()[CASE]], "range.extremes")
    assert found.verdict is Verdict.PASS


def test_a_crossing_that_rounds_to_a_sample_is_on_neither_side_of_it() -> None:
    """Of "range.extremes": between 1e300 and 1 no coordinate is left for a crossing beside 1."""
    assert (
        measured(mistaken.correct, "range.extremes", "noise/white-10x8x9").verdict is Verdict.PASS
    )

    def turned(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mistaken.correct(values, isovalue, spacing)
        return vertices, faces if np.abs(values).max() < 1e200 else faces[:, ::-1]

    found = measured(turned, "range.extremes", "noise/white-10x8x9")
    assert found.verdict is Verdict.FAIL
    assert "the samples ask for" in found.detail


@pytest.mark.parametrize("name", ["range.scale", "range.shift", "range.digits", "range.extremes"])
def test_nobody_need_promise_a_range(name: str) -> None:
    """A matter of degree, beside the ladder."""
    from isograde.claims import CLAIMS

    assert CLAIMS[name].level is None
    assert not CLAIMS[name].held(Declaration("anybody", level=2))


def test_the_report_says_in_a_sentence_how_far_the_answer_stays() -> None:
    """The least of all cases, either way."""
    from isograde.report import words

    from tests.isograde.reporting import graded

    here = Here(mistaken.with_epsilon, Declaration("here"))
    asked = [all_cases()[name] for name in (CASE, "types/signed")]
    report = graded(here, "python:tests.isograde.mistaken:with_epsilon", asked)
    assert words.ranges(report) == (
        "The answer stays the same for values from 2^-10 to 1e300 times as large and on offsets "
        "of up to 1e6 times their range."
    )


def test_an_error_on_samples_of_1e300_is_an_error() -> None:
    """And no fault of a mesh: the finding has the words that came with it."""

    def refusing(values: Any, isovalue: float, spacing: Any) -> Any:
        if np.abs(values).max() > 1e200:
            raise OverflowError("too large for me")
        return mistaken.correct(values, isovalue, spacing)

    found = measured(refusing, "range.extremes")
    assert (found.verdict, found.detail) == (Verdict.ERROR, "too large for me")
