"""Areas and distances, and the margin below which they are taken for none."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isograde.oracles import apart
from isograde.oracles.apart import MARGIN, together, without_area
from isograde.oracles.self_intersections import self_intersections
from isoref.cube import ambiguous_faces
from isoref.field import Floats, Integers
from isoref.marching_vesta import tile
from isoref.sweep import cell_crossings
from isoref.vesta import Resolution


@given(arrays(np.int64, (3, 3), elements=st.integers(0, 3)))
def test_triangles_without_area_have_corners_on_a_line(corners: Integers) -> None:
    """In whole numbers: the differences of the corners have rank 1 or less."""
    flat = np.linalg.matrix_rank(corners[1:] - corners[0]) < 2
    assert without_area(corners[None].astype(float)).tolist() == [0] * int(flat)


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


@pytest.mark.parametrize("resolution", ["L", "H"])
def test_the_margin_is_far_below_what_sound_triangles_have(
    resolution: Resolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Areas and distances of all unmoved cells stay clear even of twenty times the margin.

    No triangles meet where they should not, but for the pairs of 6-cycles that touch in L
    (`tests/isoref/test_vesta.py`).
    """
    monkeypatch.setattr(apart, "MARGIN", 20 * MARGIN)
    places, faces, sizes = unmoved_cells(resolution)
    assert len(sizes) == 654
    assert not len(without_area(places[faces]))
    assert not len(together(places[np.unique(faces)]))
    owner = np.repeat(np.arange(len(sizes)), sizes)
    touching = np.unique(owner[self_intersections(places, faces)])
    assert [sizes[cell] for cell in touching] == ([8] * 12 if resolution == "L" else [])
