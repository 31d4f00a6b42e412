"""The sentence that an author needs, from extractors that are broken in a known way."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.checking import sentences
from isograde.checking.rows import cell, fault_told, judged
from isograde.checking.sentences import looks_like
from isograde.declaration import declaration_from
from isograde.model import Case, Outcome, Status
from isograde.report.diagnosis import cells_round, diagnosis, right_cells, wrong_by_case
from isograde.report.findings import causes
from isograde.report.misplaced import crossings, misplacement
from isograde.report.reading import Report
from isograde.report.words import right, verdict
from isoref.field import Field

from tests.isograde import broken_tables, families
from tests.isograde import miniatures as mini
from tests.isograde.judging import Here
from tests.isograde.reporting import graded
from tests.isograde.test_flat import BOTH, by

Change = Callable[[Any, Any], Any]


@pytest.fixture(autouse=True)
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """No reference is started to draw a legal answer beside."""
    monkeypatch.setattr("isograde.grading.contrast", lambda *_: {})


def cases(*names: str) -> list[Case]:
    """These cases of the catalogue."""
    every = all_cases(0)
    return [every[name] for name in names]


def told(function: Callable[..., Any], claim: str, *names: str, **says: Any) -> str:
    """The diagnosis of one claim on these cases."""
    report = made(function, *names, only=claim, **says)
    return diagnosis(report, report.summaries[claim])


def made(function: Callable[..., Any], *names: str, only: str = "", **says: Any) -> Report:
    """The report of a function in this process."""
    declared = declaration_from({"level": 2, **says}, "it")
    return graded(Here(function, declared), "python:it:it", cases(*names), only)


def test_flat_triangles_are_told_of_the_cells_that_drew_them() -> None:
    """Issue 12: 4 triangles lie flat in the face between cells a and b, two of each."""

    def both(values: Any, isovalue: float, spacing: Any) -> Any:
        mesh = by(BOTH)(Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    said = told(both, "topology.manifold", "noise/white-5x6x7")
    assert "triangles lie flat in the face between the cells [" in said
    assert said.endswith(", two of each, and share an edge")


def test_two_cells_that_disagree_on_a_face_are_told() -> None:
    """Nielson & Hamann 1991, Figure 3."""
    said = told(mini.made(decide=mini.by_cell), "topology.closed", "pairs/0217")
    assert said == (
        "the cells [0, 0, 0] and [1, 0, 0] disagree on the face between them: [0, 0, 0] joins its "
        "inside corners; [1, 0, 0] separates its inside corners"
    )


def missing_one(vertices: Any, faces: Any) -> Any:
    """The triangle strictly inside a cell of the middle is left out."""
    middle = vertices[faces].mean(axis=1)
    away = np.abs(middle - np.array([1.5, 1.5, 1.5])).max(axis=1)
    return vertices, np.delete(faces, away.argmin(), axis=0)


def test_a_missing_triangle_is_told_with_its_cell() -> None:
    said = told(mini.changed(missing_one), "topology.closed", "noise/white-5x6x7")
    # One cell shows it, so a row of a table would look the same, and is named by its number.
    assert said.startswith("a row of the table ")
    assert "in the usual order of corners row " in said


def test_a_triangle_that_is_turned_over_is_told() -> None:
    said = told(mini.changed(mini.with_flipped_face), "topology.oriented", "noise/white-5x6x7")
    assert said.startswith("triangle 0, in the cell [")
    assert said.endswith(" is turned over")


def test_normals_that_point_the_other_way_everywhere_are_told_with_the_word_to_declare() -> None:
    said = told(mini.changed(mini.turned_over), "topology.sides", "noise/white-5x6x7")
    assert said == (
        'all normals point the other way: turn every triangle over, or declare "normals": "to_high"'
    )


def test_normals_that_are_right_elsewhere_are_not_said_to_be_declared_wrongly() -> None:
    """Of misc3d: all of the smallest field point the other way, and most fields are right."""

    def mixed(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mini.plain(values, isovalue, spacing)
        return vertices, faces[:, ::-1] if values.shape == (5, 6, 7) else faces

    said = told(mixed, "topology.sides", "noise/white-5x6x7", "noise/white-8x9x10", "pairs/0217")
    assert said == "in this field all normals point the other way; in 2 others they are right"


def test_a_vertex_beyond_the_samples_is_told_as_that() -> None:
    """Of ITK and VTK: no edge of the lattice is there, so no ends of one."""

    def astray(vertices: Any, faces: Any) -> Any:
        on = int(np.flatnonzero(vertices[:, 0] == 0)[0])
        moved = vertices.copy()
        moved[on, 0] = -1.75
        return moved, faces

    said = told(mini.changed(astray), "geometry.vertices", "noise/white-5x6x7")
    assert said.startswith("a vertex stands at index [-1.75, ")
    assert said.endswith(", beyond the samples, which end at [1, 1, 1]")


def test_a_hole_that_no_edge_of_the_welded_mesh_shows_is_told_as_it_was_judged() -> None:
    """Of ITK on one row of samples: there is nothing inside such a domain."""

    def strips(values: Any, isovalue: float, spacing: Any) -> Any:
        points = [[0.5, 0, 1], [0, 0.5, 1], [0, 0, 0.5], [1, 0, 0.5], [0.5, 0, 0], [1, 0.5, 0]]
        points += [[0.5, 0, 1], [0, 0, 1.5], [0, 0.5, 1]]
        return np.array(points), np.array([[0, 2, 1], [3, 5, 4], [6, 8, 7]])

    said = told(strips, "topology.closed", "shapes/1x1x6", interpolant="labels")
    assert "hole of 0" not in said
    assert "belong to one simplex only" in said


def test_a_soup_that_does_not_say_so_is_told() -> None:
    said = told(mini.changed(mini.soup), "topology.closed", "noise/white-5x6x7")
    assert said == (
        "no two triangles share a vertex: it is closed once equal vertices are one; share them, "
        'or declare "mesh": {"soup": 0}'
    )


def with_a_wrong_entry(values: Any, isovalue: float, spacing: Any) -> Any:
    """Cells with two opposite corners of a face inside and no other lose a triangle."""
    vertices, faces = mini.plain(values, isovalue, (1.0, 1.0, 1.0))
    inside = values >= isovalue
    cell = np.floor(vertices[faces].mean(axis=1)).astype(int)
    seen, keep = set(), []
    for a, b, c in cell.tolist():
        corners = inside[a : a + 2, b : b + 2, c : c + 2].ravel().tolist()
        wrong = corners == [True, True, False, False, False, False, False, False]
        keep.append(not wrong or (a, b, c) in seen)
        seen.add((a, b, c))
    return vertices * spacing, faces[keep]


def test_one_wrong_entry_of_a_table_is_told_by_its_corners() -> None:
    said = told(
        with_a_wrong_entry, "cells.legal", "cells/outside/003", "noise/white-5x6x7",
        "noise/white-8x9x10",
    )  # fmt: skip
    assert said.startswith("1 row of the table leaves a crossed edge without a vertex: ")
    assert "inside corners (0, 0, 0) (0, 0, 1), in the usual order of corners row 17" in said


# What a mistake in placing does to index coordinates, and how it is told.
PLACED: dict[str, tuple[Change, str]] = {
    "scale": (
        lambda v, n: v * n / (n - 1),
        "scaled by n/(n-1), n the number of samples along each axis",
    ),
    "shrink": (lambda v, n: v * (n - 1) / n, "scaled by (n-1)/n"),
    "unit": (lambda v, n: v / (n - 1), "drawn in the unit cube"),
    "ends": (lambda v, n: 2 * v / (n - 1) - 1, "drawn in a cube from -1 to 1"),
    "half": (lambda v, _: v + 0.5, "shifted by half a cell along every axis"),
    "back": (lambda v, _: v - 0.5, "shifted by half a cell against every axis"),
    "padded": (lambda v, _: v + 1, "shifted by a whole cell along"),
    "centred": (lambda v, n: v - (n - 1) / 2, "centred at 0"),
    "axes": (lambda v, _: v[:, ::-1], "given in reversed order of the axes"),
    "two axes": (lambda v, _: v[:, [1, 0, 2]], "axes are exchanged: vertex = index[:, [1, 0, 2]]"),
    "cycle": (lambda v, _: v[:, [2, 0, 1]], "axes are exchanged: vertex = index[:, [1, 2, 0]]"),
    "both": (lambda v, n: (v * n / (n - 1))[:, ::-1], "and in reversed order of the axes"),
}


@pytest.mark.parametrize("name", PLACED)
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.5, 0.7, 1.3)])
def test_a_map_of_all_vertices_is_told(name: str, spacing: tuple[float, ...]) -> None:
    """Issue 12: vertices scaled by n/(n-1)."""
    values = np.random.default_rng(2).standard_normal((4, 5, 6))
    vertices, _ = mini.plain(values, 0.0, (1.0, 1.0, 1.0))
    move, word = PLACED[name]
    moved = np.asarray(move(vertices, np.array(values.shape, float)))
    assert word in misplacement(moved, values, 0.0, np.array(spacing))
    assert misplacement(vertices, values, 0.0, np.array(spacing)) == ""


@pytest.mark.parametrize(
    ("share", "word"),
    [
        (lambda t: 1 - t, "at 1 - t of their edges"),
        (lambda t: np.full(len(t), 0.5), "halfway along their edges"),
        (np.round, "vertices stand on samples"),
        (lambda t: t**2, "at a wrong share of the way"),
    ],
)
def test_a_wrong_interpolation_is_told(share: Any, word: str) -> None:
    values = np.random.default_rng(2).standard_normal((4, 5, 6))
    low, high, right = crossings(values, 0.0)
    vertices = np.asarray(low + share(right)[:, None] * (high - low), float)
    assert word in misplacement(vertices, values, 0.0, np.ones(3))


def closed_at_samples(values: Any, isovalue: float, spacing: Any) -> Any:
    """Marching cubes with a vertex on each sample at the ends of the first axis that is inside."""
    vertices, faces = mini.plain(values, isovalue, spacing)
    ends = np.argwhere(values >= isovalue)
    ends = ends[(ends[:, 0] == 0) | (ends[:, 0] == values.shape[0] - 1)]
    return np.concatenate([vertices, ends * np.asarray(spacing)]), faces[1:]


def test_no_share_is_called_wrong_where_every_crossing_is_right() -> None:
    """PyGEL3D's page said both, of vertices on samples of the border."""
    values = np.random.default_rng(2).standard_normal((4, 5, 6))
    vertices, _ = closed_at_samples(values, 0.0, (1.0, 1.0, 1.0))
    asked = (vertices, values, 0.0, np.ones(3))
    assert "at a wrong share of the way" in misplacement(*asked)
    assert misplacement(*asked, shares=False) == ""
    report = made(closed_at_samples, "noise/white-6x7x5")
    assert "every crossing is where the interpolant has it" in right(report)
    said = " ".join(cause.said for cause in causes(report))
    assert "share" not in said, said


def test_a_vertex_that_is_astray_alone_is_no_map() -> None:
    values = np.random.default_rng(2).standard_normal((4, 5, 6))
    low, high, right = crossings(values, 0.0)
    vertices = np.asarray(low + right[:, None] * (high - low), float)
    vertices[3] += 0.01
    assert misplacement(vertices, values, 0.0, np.ones(3)) == ""


def kuhn_turned(values: Any, isovalue: float, spacing: Any) -> Any:
    """Marching tetrahedra whose first two axes are exchanged, and that do not say what they are."""
    vertices, faces = families.tetrahedra_of_kuhn(values, isovalue, (1.0, 1.0, 1.0))
    return vertices[:, [1, 0, 2]] * np.asarray(spacing), faces


def test_exchanged_axes_are_told_though_the_split_is_not_declared() -> None:
    """A trial of 27 November: the smallest answer is the same with its axes exchanged."""
    report = made(kuhn_turned, "cells/outside/003", "cells/outside/007", only="geometry.")
    held = [one for one in causes(report) if one.held]
    assert "axes are exchanged: vertex = index[:, [1, 0, 2]] * spacing" in held[0].said
    assert '"interpolant": "kuhn", if it is meant to be' in held[0].said
    assert sum(one.mistakes for one in held) == 2
    assert "by 2 causes" in verdict(report)


def test_a_split_that_is_not_declared_is_one_mistake() -> None:
    report = made(families.tetrahedra_of_kuhn, "cells/outside/003", only="geometry.")
    held = [one for one in causes(report) if one.held]
    assert [(one.root.id, one.mistakes) for one in held] == [("geometry.vertices", 1)]
    assert "stand on diagonals of cells" in held[0].said
    assert looks_like("interpolant", "kuhn", "multilinear") in held[0].said


def test_a_fixed_tolerance_is_told_as_check_tells_it() -> None:
    names = "noise/white-5x6x7", "cells/outside/003"
    said = told(broken_tables.with_epsilon, "range.scale", *names)
    assert said.startswith("it gives another surface for the same samples times 2^-")
    assert "is a fixed tolerance added or compared with? So it is in " in said


def test_a_scale_is_one_finding_whatever_it_breaks() -> None:
    """One cause: vertices, crossings, sides, holes at the border, bodies."""

    def scaled(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mini.plain(values, isovalue, spacing)
        n = np.array(values.shape, float)
        return vertices * n / (n - 1), faces

    report = made(scaled, "noise/white-5x6x7", "cells/outside/003")
    held = [one for one in causes(report) if one.held]
    assert len(report.broken) > 3
    assert [one.root.id for one in held] == ["geometry.vertices"]
    assert held[0].said == f"vertices are {sentences.scaled()}"


def test_the_faults_inside_cells_are_counted_by_case() -> None:
    """Issue 12: false tunnel in 16 of 32 cells of case 4.1."""
    names = [name for name in all_cases(0) if name.startswith("trilinear/each/")]
    report = made(mini.made(decide=mini.asymptotic), *names, only="topology.trilinear", level=4)
    judged, wrong = wrong_by_case(report)
    assert {fault for _, fault in wrong} == {"missing tunnel"}
    assert len(judged) == 31
    said = diagnosis(report, report.summaries["topology.trilinear"])
    assert said.startswith(f"missing tunnel in {judged['10.1.2']} of {judged['10.1.2']} cells of")
    assert right_cells(report).startswith("all cells of 25 of the 31 cases (1, 2, 3.1, 3.2, ")


def test_the_cells_round_a_place_are_those_that_hold_it() -> None:
    assert cells_round(np.array([[1.0, 0.5, 0.5]]), (3, 2, 2)) == [[0, 0, 0], [1, 0, 0]]
    assert cells_round(np.array([[0.0, 0.5, 0.5], [1.0, 0.2, 0.5]]), (3, 2, 2)) == [[0, 0, 0]]
    assert cells_round(np.array([[0.5, 0.5], [1.5, 0.5]]), (3, 2)) == []


def test_a_claim_without_more_to_say_is_told_in_the_words_of_its_judge() -> None:
    field = Field.of(np.ones((2, 2, 2)))
    case = Case("a/b", lambda: field, (0.5,), 8)
    declared = declaration_from({}, "it")
    report = graded(Here(lambda *_: 1 / 0, declared), "python:it:it", [case], "structure.answers")
    said = diagnosis(report, report.summaries["structure.answers"])
    assert said == "1 call: error: division by zero"


def in_slabs(values: Any, isovalue: float, spacing: Any) -> Any:
    """Slabs of two layers of cells, each with vertices of its own."""
    found, rows, count = [np.zeros((0, 3))], [np.zeros((0, 3), int)], 0
    for start in range(0, len(values) - 1, 2):
        vertices, faces = mini.plain(values[start : start + 3], isovalue, (1.0, 1.0, 1.0))
        found.append(vertices + np.array([start, 0, 0]))
        rows.append(np.asarray(faces).reshape(-1, 3) + count)
        count += len(vertices)
    return np.concatenate(found) * np.asarray(spacing), np.concatenate(rows)


def test_a_seam_is_told_from_all_cases_with_no_advice_to_declare_a_soup() -> None:
    """A trial of 27 November: the smallest case was of two triangles that share nothing."""
    said = told(in_slabs, "topology.closed", "noise/white-5x6x7")
    assert said.startswith("the surface is open inside, along axis 0 at 2: is there a seam")
    assert "soup" not in said
    assert "no two triangles" not in said


def one_wrong_number(values: Any, isovalue: float, spacing: Any) -> Any:
    """A cell with three inside corners of a face names a wrong corner of one triangle."""
    vertices, faces = mini.plain(values, isovalue, spacing)
    if len(faces) == 3 and values.shape == (2, 2, 2):
        (shared,) = set(faces[0]) & set(faces[1]) & set(faces[2]) or {faces[0][0]}
        other = next(v for v in range(len(vertices)) if v not in faces[1])
        faces = np.array(faces)
        faces[1][next(k for k in range(3) if faces[1][k] != shared)] = other
    return vertices, faces


def test_a_wrong_number_in_a_table_is_told_with_its_row_and_what_mends_it() -> None:
    """A trial of 27 November: one number of row 100 was wrong, and no row was named."""
    inside = frozenset({(1, 0, 1), (1, 1, 0), (1, 1, 1)})
    field = cell(inside)
    vertices, faces = one_wrong_number(field.values, 0.5, (1.0, 1.0, 1.0))
    outcome = Outcome(Status.OK, np.asarray(vertices), np.asarray(faces))
    said = fault_told(judged(inside, outcome, field), alone=True)
    assert said.startswith("1 row of the table ")
    assert "in the usual order of corners row 100, or 155 by the outside" in said
    assert " in place of " in said
    assert "its boundary is then " in said


def test_the_row_is_named_by_the_report_too() -> None:
    inside = frozenset({(1, 0, 1), (1, 1, 0), (1, 1, 1)})
    case = Case("cells/one", lambda: cell(inside), (0.5,), 8)
    declared = declaration_from({"level": 2}, "it")
    report = graded(Here(one_wrong_number, declared), "python:it:it", [case], "topology.closed")
    said = diagnosis(report, report.summaries["topology.closed"])
    assert "row of the table has two triangles that pass an edge in the same direction" in said
    assert " both pass from " in said
