"""Triangles that keep apart, held to a linear programme that knows no axes."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isograde.truths import apart
from isograde.truths.apart import MARGIN, are_apart, crossing, together, without_area
from isoref.cube import ambiguous_faces
from isoref.field import Floats, Integers
from isoref.marching_vesta import tile
from isoref.sweep import cell_crossings
from isoref.vesta import Resolution
from scipy.optimize import linprog


def triangles() -> st.SearchStrategy[Integers]:
    """Two triangles with corners on a small lattice: they touch, cross and lie in one plane."""
    drawn: st.SearchStrategy[Integers] = arrays(np.int64, (2, 3, 3), elements=st.integers(0, 3))
    return drawn


def meet(a: Floats, b: Floats) -> bool:
    """Whether some weighted mean of a's corners is one of b's."""
    sums = np.array([[1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]])
    equal = np.vstack([np.hstack([a.T, -b.T]), sums])
    right = [0, 0, 0, 1, 1]
    return bool(linprog(np.zeros(6), A_eq=equal, b_eq=right, method="highs").status == 0)


@given(triangles())
def test_axes_and_a_linear_programme_agree(two: Integers) -> None:
    """Two triangles meet where no axis keeps them apart, and nowhere else."""
    a, b = two.astype(float)
    if len(without_area(two.astype(float))) == 0:
        assert bool(are_apart(a[None], b[None], np.array([False]))[0]) == (not meet(a, b))


@given(triangles())
def test_triangles_with_a_common_corner_agree_with_the_programme_too(two: Integers) -> None:
    """They may meet in that corner alone; drawn a little back from it, they do not meet.

    Where they are drawn back and still meet they cross; where they touch along a common edge or
    one's corner lies on the other, only the axes decide.
    """
    a, b = two.astype(float)
    b = b - b[0] + a[0]
    if len(without_area(np.stack([a, b]))) == 0 and not meet_beyond_the_first(a, b):
        assert bool(are_apart(a[None], b[None], np.array([True]))[0])


def meet_beyond_the_first(a: Floats, b: Floats) -> bool:
    """Whether the triangles meet in more than their first corner: rays from it lie in both."""
    one, other = (a[1:] - a[0]).T, (b[1:] - b[0]).T
    equal = np.vstack([np.hstack([one, -other]), [1, 1, 0, 0]])
    return bool(linprog(np.zeros(4), A_eq=equal, b_eq=[0, 0, 0, 1], method="highs").status == 0)


def test_folded_and_doubled_triangles_are_not_apart() -> None:
    """Two on one side of their common edge, in one plane; one triangle twice; a pierced one."""
    places = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.4, 0.3, -1], [0.4, 0.3, 1]])
    assert len(crossing(places, np.array([[0, 1, 2], [1, 0, 3]]))) == 1
    assert len(crossing(places, np.array([[0, 1, 2], [2, 1, 0]]))) == 1
    assert len(crossing(0.9 * places, np.array([[0, 1, 2], [2, 1, 3]]))) == 0
    assert not are_apart(places[None, :3], places[None, [4, 5, 3]], np.array([False]))[0]


def test_places_that_fall_together_are_named_with_their_neighbours() -> None:
    """Three in one place, and a pair; a lone one is not among them."""
    places = np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0], [2, 0, 0], [5, 0, 0], [5, 0, 1e-3]])
    found = together(places)
    assert found[:, 0].tolist() == [0, 1, 2, 4, 5]
    assert (found[:, 0] != found[:, 1]).all()
    assert len(together(places[:1])) == 0


def unmoved_cells(resolution: Resolution) -> tuple[Floats, Integers, list[int]]:
    """Every cell with every decision, unmoved, as marching VESTA cuts it, each in a place apart.

    Places and faces of all, and how many faces each cell has.
    """
    places: list[Floats] = []
    faces: list[Integers] = []
    for signs in range(1, 255):
        g = np.where([signs >> c & 1 for c in range(8)], 1.0, -1.0)[:, None]
        crossings = cell_crossings(g)
        for choice in product((0, 1), repeat=len(ambiguous_faces(signs))):
            bits = sum(b << f for f, b in zip(ambiguous_faces(signs), choice, strict=True))
            made = tile(signs, bits, "mixed", resolution)
            inner = [put(g, crossings)[0] for put in made.interior]
            faces.append(np.array(made.triangles) + sum(map(len, places)))
            shift = np.array([3 * len(places), 0, 0])
            places.append(np.array([*crossings[:, 0], *inner]) + shift)
    return np.concatenate(places), np.concatenate(faces), [len(f) for f in faces]


@pytest.mark.parametrize("factor", [1, 20])
@pytest.mark.parametrize("resolution", ["L", "H"])
def test_margins_are_far_below_what_sound_triangles_have(
    resolution: Resolution, factor: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Areas, distances and gaps of all unmoved cells stay clear even of twenty times the margin.

    But for the pairs of 6-cycles that touch (`tests/isoref/test_vesta.py`), in L.
    """
    monkeypatch.setattr(apart, "MARGIN", factor * MARGIN)
    places, faces, sizes = unmoved_cells(resolution)
    assert len(sizes) == 654
    assert not len(without_area(places[faces]))
    assert not len(together(places[np.unique(faces)]))
    owner = np.repeat(np.arange(len(sizes)), sizes)
    touching = np.unique(owner[crossing(places, faces)])
    assert [sizes[cell] for cell in touching] == ([8] * 12 if resolution == "L" else [])
