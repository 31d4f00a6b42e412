"""The discipline of contours: right answers pass, and each claim has a fault that it catches."""

import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isograde.adapters import contour_methods as methods
from isograde.adapters import open_adapter
from isograde.disciplines import contours as discipline
from isograde.disciplines.contours import CLAIMS, Extract, cases
from isograde.model import (
    Declaration,
    Finding,
    Limits,
    Verdict,
)
from isograde.oracles import planar
from isograde.oracles.planar import Points
from isoref.diconex import Contours
from isoref.fast import diconex as reference
from isoref.field import Field
from matplotlib.path import Path

from tests.isograde.judging import Here, grade

Lines = list[Points]
# What cannot be read is judged by nothing else.
EVERYTHING = {claim.id.removeprefix("contours.") for claim in CLAIMS}


# Cases on which each fault below shows.
FEW = {"disc", "two-discs", "bytes", "constant", "saddle-mean-in-out", "saddle-mean-out-in"}


def graded(
    function: Extract, without: frozenset[str] = frozenset(), few: bool = False
) -> dict[tuple[str, str], Any]:
    """Every finding on this function, by case and claim."""
    asked = [c for c in cases() if not few or c.id.removeprefix("contours/") in FEW]
    declaration = Declaration("here", discipline="contours", without=without)
    return {
        (a, b): finding
        for a, b, finding in grade(
            Here(discipline.through_adapter(function), "contours"), declaration, asked
        )
    }


def faults(function: Extract, few: bool = False) -> set[str]:
    """The claims that fail somewhere."""
    found: dict[tuple[str, str], Finding] = graded(function, few=few)
    return {
        claim.removeprefix("contours.") for (_, claim), f in found.items() if f.verdict != "pass"
    }


@pytest.mark.parametrize("mode", ["disconnect", "connect", "mixed"])
def test_the_reference_passes_all_but_the_bilinear_claim(mode: str) -> None:
    """Every mode is consistent; none asks for the saddle."""
    assert faults(methods._reference(mode)) == {"bilinear"}


@pytest.mark.parametrize("name", ["skimage_find_contours", "contourpy_serial"])
def test_the_libraries_pass_all_but_the_bilinear_claim(name: str) -> None:
    """Right answers of other hands pass."""
    assert faults(getattr(methods, name)) == {"bilinear"}


def test_a_contour_without_points_is_refused() -> None:
    """It would go through the adapter as nothing at all."""
    with pytest.raises(TypeError, match=r"contour 1 has shape \(0, 2\)"):
        discipline.through_adapter(lambda *_: [np.eye(2), np.empty((0, 2))])(np.eye(2), 0.5, (1, 1))


def test_a_bilinear_decider_passes_everything() -> None:
    """Marching squares with the asymptotic decider: no claim fails right answers of level 3."""
    assert faults(by_saddle) == set()


def deciding(joins: Callable[[Any], bool]) -> Extract:
    """DICONEX with another decision at each point of ambiguity, from its four relative values."""

    def extract(values: Any, isovalue: float, spacing: tuple[float, ...]) -> Lines:
        field = Field.of(values, spacing)
        grey = values.astype(float) - isovalue
        active = np.pad(grey >= 0, 1)
        vectors = reference.initial_contour_vectors(active)
        joined = np.zeros(np.add(values.shape, 1), np.bool_)
        for i, j in np.ndindex(*np.subtract(values.shape, 1)):
            joined[i + 1, j + 1] = joins(grey[i : i + 2, j : j + 2])
        follow = reference.successors(vectors, active, joined)
        plain = reference.diconex(field, isovalue, border="closed")
        outer = reference._reaches_outside(vectors, field.shape)
        return reference._without(Contours(plain.points, follow), outer).polygons()

    return extract


by_saddle = deciding(lambda square: bool(planar.joins(square, 0.0)["saddle"]))


def changed(change: Callable[[Lines], Lines]) -> Extract:
    """The right answer with its contours changed."""
    return lambda values, isovalue, spacing: change(list(by_saddle(values, isovalue, spacing)))


def crossed_saddles(values: Any, isovalue: float, spacing: tuple[float, ...]) -> Lines:
    """The contours of a single square joined edge to opposite edge."""
    lines: Lines = list(by_saddle(values, isovalue, spacing))
    if values.shape == (2, 2) and len(lines) == 2:
        (a, b), (c, d) = lines
        return [np.array([a, c]), np.array([b, d])]
    return lines


def middles(values: Any, isovalue: float, spacing: tuple[float, ...]) -> Lines:
    """Every point in the middle of its edge."""
    return reference.diconex(Field.of(values, spacing), isovalue, displaced=False).polygons()


def swapped_points(lines: Lines) -> Lines:
    """Two points of each long contour exchanged."""
    for line in lines:
        if len(line) > 8:
            line[[3, 5]] = line[[5, 3]]
    return lines


def in_parts(lines: Lines) -> Lines:
    """Long contours in two parts that share a point."""
    return [part for line in lines for part in ((line[:4], line[3:]) if len(line) > 8 else (line,))]


def outwards(values: Any, isovalue: float, spacing: tuple[float, ...]) -> Lines:
    """Every point nearer to the outer end of its edge than it should be."""
    grey = values.astype(float) - isovalue
    lines: Lines = list(by_saddle(np.where(grey >= 0, 2 * grey, grey), 0.0, spacing))
    return lines


# For each claim an implementation that it catches, and the claims that fail in consequence.
BROKEN: dict[str, tuple[Extract, set[str]]] = {
    "well-formed": (changed(lambda lines: [*lines, np.array([[0.5, 1.0]])]), EVERYTHING),
    "nothing": (changed(lambda lines: lines or [np.array([[0.0, 0.5], [0.5, 0.0]])]), set()),
    "whole": (
        changed(lambda lines: [line[:-1] if len(line) > 2 else line for line in lines]),
        {"separates", "oriented", "legal", "transposed", "count", "area"},
    ),
    "no-point-twice": (
        changed(lambda lines: [np.repeat(line, 2, axis=0) for line in lines]),
        {"legal", "transposed"},
    ),
    "no-crossing": (changed(swapped_points), {"legal", "transposed", "separates", "oriented"}),
    "separates": (
        changed(lambda lines: lines[1:]),
        {"oriented", "legal", "count", "area", "transposed"},
    ),
    "oriented": (changed(lambda lines: [line[::-1] for line in lines]), {"area"}),
    "legal": (crossed_saddles, {"no-crossing", "oriented"}),
    "one-rule": (deciding(lambda square: bool(square[0, 0] > square[1, 1])), {"bilinear"}),
    "transposed": (
        deciding(lambda square: bool(square[0, 1] > square[1, 0])),
        {"one-rule", "bilinear"},
    ),
    "bilinear": (methods._reference("disconnect"), set()),
    "on-edges": (middles, {"bilinear"}),
    "count": (changed(in_parts), {"whole", "no-point-twice"}),
    "area": (outwards, {"on-edges", "one-rule", "bilinear"}),
}


def test_every_claim_has_a_broken_implementation() -> None:
    """The table is complete."""
    assert {f"contours.{name}" for name in BROKEN} == {claim.id for claim in CLAIMS}


@pytest.mark.parametrize("claim", BROKEN)
def test_a_broken_one_is_caught_by_its_claim_and_what_follows(claim: str) -> None:
    """By no other claim, so that the claim is needed."""
    function, follows = BROKEN[claim]
    found = faults(function, few=True)
    assert claim in found
    assert found <= {claim, *follows}


def test_what_is_not_promised_is_unsupported() -> None:
    """A declaration without orientation is judged neither by it nor by the signed area."""
    found = graded(BROKEN["oriented"][0], frozenset({"oriented"}), few=True)
    asking = {"contours.oriented", "contours.area"}
    for (_, claim), finding in found.items():
        assert finding.verdict is (Verdict.UNSUPPORTED if claim in asking else Verdict.PASS)


def test_an_error_is_told_as_an_error() -> None:
    """A call that raises is an error, with its text."""

    def raises(*_: Any) -> Any:
        raise RuntimeError("no contours today")

    found = graded(raises, few=True)
    assert {f.verdict for f in found.values()} == {Verdict.ERROR}
    assert all("no contours today" in f.detail for f in found.values())


@pytest.mark.parametrize("name", ["contours:skimage", "contours:diconex-mixed"])
def test_ready_made_implementations_start_behind_a_adapter(name: str) -> None:
    """The adapters answer from a process of their own."""
    adapter = open_adapter(discipline.READY_MADE[name])
    try:
        declaration = adapter.open(Limits())
        asked = [case for case in cases() if case.id == "contours/disc"]
        found = [finding.verdict for *_, finding in grade(adapter, declaration, asked)]
    finally:
        adapter.close()
    assert declaration.discipline == "contours"
    assert set(found) == {Verdict.PASS}


MINE = """
declaration = {"name": "mine", "discipline": "contours"}

def extract_contours(values, isovalue, spacing):
    from skimage.measure import find_contours
    return [c * spacing for c in find_contours(values, isovalue, positive_orientation="high")]
"""


def test_a_third_party_s_function_is_graded_as_it_stands(tmp_path: pathlib.Path) -> None:
    """The signature of the discipline, a declaration, and nothing else."""
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    adapter = open_adapter(f"python:{tmp_path / 'mine.py'}:extract_contours")
    try:
        declaration = adapter.open(Limits())
        asked = [case for case in cases() if case.id in ("contours/disc", "contours/constant")]
        found = [finding.verdict for *_, finding in grade(adapter, declaration, asked)]
    finally:
        adapter.close()
    assert declaration.name == "mine"
    assert set(found) == {Verdict.PASS}


# --- the truths, a second way --------------------------------------------------------------------


@given(arrays(np.int64, (5, 6), elements=st.integers(0, 3)))
def test_crossings_agree_with_points_in_polygons(image: Any) -> None:
    """Matplotlib's polygons: a step is crossed where one end is inside more polygons."""
    lines = reference.diconex(image, 1.5, mode="connect", border="closed").polygons()
    depth = np.zeros(image.shape, int)
    for line in lines:
        turn = np.sign(planar.enclosed_area([line]))
        places = np.argwhere(np.ones(image.shape))
        depth += (turn * Path(line).contains_points(places)).reshape(image.shape).astype(int)
    parts = planar.segments(lines)
    # Frame the lattice, so that no contour ends on its border.
    framed = np.pad(depth, 1)
    for axis in (0, 1):
        crossed = planar.crossings(parts + 1, framed.shape, axis)
        assert np.array_equal(crossed, -np.diff(framed, axis=axis))


def test_legal_squares_are_those_of_marching_squares() -> None:
    """scikit-image, both ways to connect: sixteen squares, two answers for two of them."""
    from skimage.measure import find_contours

    for signs in range(16):
        sides = np.array([[signs & 1, signs >> 1 & 1], [signs >> 2 & 1, signs >> 3 & 1]])
        found = []
        for connected in ("low", "high"):
            lines = find_contours(sides.astype(float), 0.5, fully_connected=connected)
            pairs = planar.squares(planar.segments(lines)).get((0, 0), [])
            found.append(set(pairs))
        answers = planar.legal(sides.astype(bool)).get((0, 0), [set()])
        assert answers == (found if found[0] != found[1] else found[:1])


@given(arrays(np.float64, 4, elements=st.floats(0.1, 1)), st.booleans())
def test_the_saddle_rule_is_the_value_at_the_saddle(size: Any, first: bool) -> None:
    """Nielson & Hamann, section 2: the bilinear interpolant where its gradient vanishes."""
    a, d, b, c = size * np.array([1, 1, -1, -1]) * (1 if first else -1)
    s = (a - b) / (a + d - b - c)
    t = (a - c) / (a + d - b - c)
    value = a * (1 - s) * (1 - t) + c * s * (1 - t) + b * (1 - s) * t + d * s * t
    assume(abs(value) > 1e-9)
    assert planar.joins(np.array([[a, b], [c, d]]), 0.0)["saddle"] == (value > 0)


def test_a_point_is_on_an_edge_where_one_coordinate_is_whole() -> None:
    """Neither on a sample nor inside a square."""
    assert planar.edge_of(np.array([2.0, 1.5])) == (2, 1, 1)
    assert planar.edge_of(np.array([2.5, 1.0])) == (2, 1, 0)
    assert planar.edge_of(np.array([2.0, 1.0])) is None
    assert planar.edge_of(np.array([2.5, 1.5])) is None


def test_segments_cross_away_from_their_ends_only() -> None:
    """An end on the other segment, a shared end and a gap are no crossings."""
    across = np.array([[0.0, 0], [2, 2]])
    others = np.array([[[0.0, 2], [2, 0]], [[1, 1], [2, 0]], [[2, 2], [3, 0]], [[3, 3], [4, 1]]])
    assert planar.crossing_pairs(np.stack([across, *others])).tolist() == [[0, 1]]
    assert planar.crossing_pairs(np.stack([others[1], across])).tolist() == []
