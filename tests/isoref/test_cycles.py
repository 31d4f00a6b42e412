from collections import Counter

import numpy as np
import pytest
from isoref import cube, cycles


def all_choices(signs: int) -> list[int]:
    """Every decision on the ambiguous faces of these signs."""
    faces = cube.ambiguous_faces(signs)
    return [
        sum(1 << f for i, f in enumerate(faces) if choice >> i & 1)
        for choice in range(1 << len(faces))
    ]


def sides(polygon: cycles.Polygon) -> list[tuple[int, int]]:
    """The oriented sides of a polygon."""
    return list(zip(polygon, (*polygon[1:], polygon[0]), strict=True))


def test_each_crossed_edge_is_passed_once_by_the_polygons() -> None:
    """The invariant of the module: one segment starts and one ends at a crossed edge."""
    for signs in range(256):
        for separated in all_choices(signs):
            edges = [e for polygon in cycles.cycles(signs, separated) for e in polygon]
            assert sorted(edges) == list(cube.crossed_edges(signs))


def test_polygons_need_an_interior_point_exactly_where_the_paper_says() -> None:
    """Nielson & Hamann section 3: 10B/D (8 sides), 7C and 13D/H (9), 13E/F (12)."""
    need = Counter(
        (cube.configuration(signs), len(polygon))
        for signs in range(256)
        for separated in all_choices(signs)
        for polygon in cycles.cycles(signs, separated)
        if cycles.triangulate(polygon) is None
    )
    assert set(need) == {(10, 8), (7, 9), (13, 9), (13, 12)}


def test_polygon_lengths_of_the_global_modes_are_those_of_vesta() -> None:
    """Facts (Schlei): 144, 66, 72, 52, 24 cycles of length 3 to 7 in either global mode."""
    for mode in (cycles.ALL_SEPARATED, cycles.ALL_JOINED):
        lengths = Counter(len(p) for signs in range(256) for p in cycles.cycles(signs, mode))
        assert lengths == {3: 144, 4: 66, 5: 72, 6: 52, 7: 24}


def test_polygon_lengths_of_all_choices_are_3_to_9_and_12() -> None:
    """Schlei section II.E: no cycles of length 10 or 11 exist."""
    lengths = {
        len(polygon)
        for signs in range(256)
        for separated in all_choices(signs)
        for polygon in cycles.cycles(signs, separated)
    }
    assert lengths == {3, 4, 5, 6, 7, 8, 9, 12}


def test_exchanging_inside_and_outside_reverses_the_polygons() -> None:
    """Separating the inside corners is joining the outside ones."""
    for signs in range(256):
        for separated in all_choices(signs):
            exchanged = ~separated & sum(1 << f for f in cube.ambiguous_faces(signs))
            there = {side for p in cycles.cycles(signs, separated) for side in sides(p)}
            back = {side for p in cycles.cycles(255 - signs, exchanged) for side in sides(p)}
            assert there == {(b, a) for a, b in back}


def test_normals_point_from_inside_to_outside() -> None:
    """The convention: the triangle that cuts corner 0 off looks away from it."""
    (polygon,) = cycles.cycles(1, 0)
    a, b, c = (np.mean([cube.CORNERS[v] for v in cube.EDGES[e]], axis=0) for e in polygon)
    assert np.cross(b - a, c - a) @ [1, 1, 1] > 0


@pytest.mark.parametrize(("length", "catalan"), [(3, 1), (4, 2), (5, 5), (6, 14), (7, 42)])
def test_triangulations_are_complete_where_no_chord_is_barred(
    length: int, catalan: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A convex n-gon has a Catalan number of triangulations, of n - 2 triangles each."""
    monkeypatch.setattr(cycles, "share_face", lambda e, f: False)
    found = {frozenset(t) for t in cycles.triangulations(tuple(range(length)))}
    assert len(found) == catalan
    assert all(len(t) == length - 2 for t in found)
