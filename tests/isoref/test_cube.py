from collections import Counter
from itertools import combinations

import pytest
from isoref import cube


def test_the_fifteen_configurations_cover_all_256_signs_once() -> None:
    """Nielson & Hamann section 1: 256 signs, 128 up to exchange, 15 up to rotation as well."""
    orbits = {
        frozenset(
            image
            for move in cube.ROTATIONS
            for image in (cube.moved_signs(s, move), 255 - cube.moved_signs(s, move))
        )
        for s in range(256)
    }
    assert len(orbits) == 15
    assert all(len({cube.configuration(s) for s in orbit}) == 1 for orbit in orbits)
    assert {cube.configuration(s) for s in range(256)} == set(range(15))


def test_a_reflection_merges_configurations_11_and_14_and_no_others() -> None:
    """Fact: "14" is the mirror image of "11"; rotations alone keep them apart."""
    merged = {
        frozenset((cube.configuration(s), cube.configuration(cube.moved_signs(s, mirror))))
        for s in range(256)
        for mirror in cube.REFLECTIONS
    }
    assert {pair for pair in merged if len(pair) == 2} == {frozenset((11, 14))}


@pytest.mark.parametrize(
    ("number", "configurations"),
    [(0, {0, 1, 2, 4, 5, 8, 9, 11, 14}), (1, {3, 6}), (2, {10, 12}), (3, {7}), (6, {13})],
)
def test_configurations_have_the_ambiguous_faces_of_the_paper(
    number: int, configurations: set[int]
) -> None:
    """Nielson & Hamann section 3: which configurations have 0, 1, 2, 3, 6 ambiguous faces."""
    found = {cube.configuration(s) for s in range(256) if len(cube.ambiguous_faces(s)) == number}
    assert found == configurations


def test_there_are_24_rotations_and_they_form_a_group() -> None:
    """The rotations of the cube, closed under composition."""
    rotations = set(cube.ROTATIONS)
    assert len(rotations) == 24
    assert all(tuple(a[b[c]] for c in range(8)) in rotations for a in rotations for b in rotations)
    assert not rotations & set(cube.REFLECTIONS)


def test_edges_join_corners_that_differ_in_one_coordinate() -> None:
    """Twelve edges, all different, each along its own axis."""
    assert len(set(cube.EDGES)) == 12
    for e, (a, b) in enumerate(cube.EDGES):
        assert b - a == 1 << cube.axis_of(e)
        assert a & 1 << cube.axis_of(e) == 0
    adjacent = {frozenset(p) for p in combinations(range(8), 2) if (p[0] ^ p[1]).bit_count() == 1}
    assert adjacent == set(cube.EDGE_OF)


def test_faces_run_counterclockwise_seen_from_outside() -> None:
    """Two faces pass each edge, in opposite directions."""
    passed = Counter((walk[i], walk[(i + 1) % 4]) for walk in cube.FACE_CORNERS for i in range(4))
    assert len(passed) == 24
    assert set(passed.values()) == {1}
    # Face 1 stands at x = 1: its walk turns about the +x axis, from y towards z.
    assert [cube.CORNERS[c][1:] for c in cube.FACE_CORNERS[1]] == [(0, 0), (1, 0), (1, 1), (0, 1)]
