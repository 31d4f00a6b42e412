"""Answers in natural form become vertices and simplices, and each fault of a form is named."""

from collections import Counter
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from isograde.adapters.forms import AnswerError, arrays_from, from_polylines, triangles
from isograde.model import CONTOURS, CURVES, SURFACES, Kind
from isoref.mesh import Mesh

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
POINTS = Kind(2, 2)


@given(st.lists(st.lists(st.integers(0, 50), min_size=3, max_size=9, unique=True), max_size=8))
def test_a_fan_has_the_polygon_s_boundary(polygons: list[list[int]]) -> None:
    """Every edge of a polygon is in its triangles once, and every diagonal in both directions."""
    width = max((len(p) for p in polygons), default=3)
    rows = np.array([p + [-1] * (width - len(p)) for p in polygons], int).reshape(-1, width)
    cut = triangles(rows)
    ragged = arrays_from((SQUARE, polygons), SURFACES)[1]
    assert np.array_equal(cut, ragged) or not polygons
    assert len(cut) == sum(len(p) - 2 for p in polygons)
    edges = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in cut for i in range(3))
    edges.subtract(Counter((int(t[(i + 1) % 3]), int(t[i])) for t in cut for i in range(3)))
    expected: Counter[tuple[int, int]] = Counter()
    for p in polygons:
        expected.update((a, b) for a, b in zip(p, [*p[1:], p[0]], strict=True))
        expected.subtract((b, a) for a, b in zip(p, [*p[1:], p[0]], strict=True))
    assert {e: n for e, n in edges.items() if n} == {e: n for e, n in expected.items() if n}


@pytest.mark.parametrize(
    ("answer", "kind", "rows"),
    [
        ((SQUARE, [[0, 1, 2, 3]]), SURFACES, [[0, 1, 2], [0, 2, 3]]),
        ((SQUARE, np.array([[0, 1, 2, -1], [0, 1, 2, 3]])), SURFACES,
         [[0, 1, 2], [0, 1, 2], [0, 2, 3]]),
        ((SQUARE, [[0, 1, 2], [0, 1, 2, 3]]), SURFACES, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]),
        ((SQUARE, np.array([[0, 1, 2], [0, 1, 2, 3]], dtype=object)), SURFACES,
         [[0, 1, 2], [0, 1, 2], [0, 2, 3]]),
        ([SQUARE, [[0, 1, 2]]], SURFACES, [[0, 1, 2]]),
        (SQUARE[[[0, 1, 2], [0, 2, 3]]], SURFACES, [[0, 1, 2], [3, 4, 5]]),
        (SQUARE[[[0, 1, 2]] * 3].tolist(), SURFACES, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]),
        (Mesh.of(SQUARE, [[0, 1, 2]]), SURFACES, [[0, 1, 2]]),
        (trimesh.Trimesh(SQUARE, [[0, 1, 2]], process=False), SURFACES, [[0, 1, 2]]),
        ((SQUARE, [[0, 1, 2, 3]]), Kind(3, 1), [[0, 1, 2], [0, 2, 3]]),
        ((SQUARE[:, :2], [[0, 1]]), CONTOURS, [[0, 1]]),
        ([SQUARE, SQUARE[:2]], CURVES, [[0, 1], [1, 2], [2, 3], [4, 5]]),
        ([SQUARE[:1], SQUARE[2:]], CURVES, [[1, 2]]),
        ([[*SQUARE, SQUARE[0]]], CURVES, [[0, 1], [1, 2], [2, 3], [3, 0]]),
        ((SQUARE, SQUARE, SQUARE), CURVES,
         [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6], [6, 7], [8, 9], [9, 10], [10, 11]]),
        (SQUARE[[[0, 1], [2, 3]]], CURVES, [[0, 1], [2, 3]]),
        (Mesh.of(SQUARE, [[0, 1]]), CURVES, [[0, 1]]),
        (SQUARE[:, :2], POINTS, [[0], [1], [2], [3]]),
        ((SQUARE[:, :2], [[0], [3]]), POINTS, [[0], [3]]),
        ((np.zeros((5, 4)), [[0, 1, 2, 3]]), Kind(4, 1), [[0, 1, 2, 3]]),
        ([], CURVES, []),
        ([], SURFACES, []),
        (([], []), SURFACES, []),
        (([], []), CURVES, []),
        ([[], []], SURFACES, []),
    ],
)  # fmt: skip
def test_every_form_is_read(answer: Any, kind: Kind, rows: list[list[int]]) -> None:
    vertices, simplices = arrays_from(answer, kind)
    assert vertices.shape[1:] == (kind.n,)
    assert simplices.shape == (len(rows), kind.k + 1)
    assert simplices.tolist() == rows


@pytest.mark.parametrize(
    ("answer", "kind", "words"),
    [
        ("done", SURFACES, "returned str, not vertices and simplices"),
        (None, CURVES, "returned NoneType"),
        ({"vertices": []}, SURFACES, "returned dict"),
        ((SQUARE, [[0, 1, 2, 3], [0, 1]]), SURFACES, r"polygon 1 has 2 corners: \[0, 1\]"),
        ((SQUARE, [[0, 1, 2, 3], [0, -1, 2, 3]]), SURFACES, "polygon 1 has a -1 before its last"),
        ((SQUARE, [[0, 1, 2], [0, 1, 2, 3.5]]), SURFACES, "polygon 1 has shape .* of float64"),
        ((SQUARE, [[0, 1, 2], [[0], [1], [2], [3]]]), SURFACES, "polygon 1 has shape"),
        ([SQUARE, SQUARE[:0]], CURVES, "polyline 1 has no points"),
        ([SQUARE, SQUARE[:, :2]], CURVES, r"polyline 1 has shape \(4, 2\), not \(N, 3\)"),
        ([SQUARE, np.array([[0, 1]])], CURVES, "vertices and segments are a tuple"),
        ([SQUARE, "ab"], CURVES, "polyline 1 .* not real numbers"),
        (SQUARE, CURVES, r"neither a pair .* nor a soup \(S, 2, 3\)"),
        (SQUARE.reshape(2, 2, 3), SURFACES, r"an array of shape \(2, 2, 3\)"),
        ((SQUARE, [[0, 1, 2]], [[0, 1]], None), SURFACES, "cannot be made an array"),
    ],
)
def test_a_fault_of_a_form_is_named(answer: Any, kind: Kind, words: str) -> None:
    with pytest.raises(AnswerError, match=words):
        arrays_from(answer, kind)


def test_what_every_mesh_may_have_wrong_passes_for_the_claims() -> None:
    """Shapes, types and the range of indices are judged, not refused."""
    for answer in (
        (SQUARE.ravel(), [[0, 1, 2]]),
        (SQUARE[:, :2], [[0, 1, 2]]),
        (SQUARE, [[0, 1]]),
        (SQUARE, [[0.0, 1.0, 2.0]]),
        (SQUARE, [[-1, 1, 9]]),
        (SQUARE * np.nan, [[0, 1, 2]]),
    ):
        vertices, simplices = arrays_from(answer, SURFACES)
        assert vertices.tobytes() == np.asarray(answer[0]).tobytes()
        assert simplices.tolist() == answer[1]


@given(st.lists(st.tuples(st.integers(2, 6), st.booleans()), max_size=5))
def test_polylines_become_as_many_segments_as_they_have(shapes: list[tuple[int, bool]]) -> None:
    """A closed one has as many vertices as segments, an open one one more."""
    rng = np.random.default_rng(0)
    lines = []
    for count, closed in shapes:
        line = rng.random((count, 3))
        lines.append(np.concatenate([line, line[:1]]) if closed else line)
    vertices, segments = from_polylines(lines, CURVES)
    assert len(segments) == sum(len(line) - 1 for line in lines)
    assert len(vertices) == sum(count for count, _ in shapes)
    assert sorted(set(segments.ravel().tolist())) == list(range(len(vertices)))
    pieces = np.concatenate([np.stack([a[:-1], a[1:]], 1) for a in lines]) if lines else None
    assert pieces is None or np.array_equal(vertices[segments], pieces)


def test_one_long_polygon_among_many_costs_no_more_than_its_corners() -> None:
    """Filled up to one length these rows would hold 10^10 numbers."""
    long = list(range(100_000))
    rows = arrays_from((SQUARE, [long, *[[0, 1, 2]] * 100_000]), SURFACES)[1]
    assert len(rows) == 99_998 + 100_000
    assert rows[99_997].tolist() == [0, 99_998, 99_999]
