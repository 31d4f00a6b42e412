"""Index coordinates, sides, ties and ends of the domain, by hand and on random fields."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isograde.declaration import Conventions, Declaration, End, Split
from isograde.oracles.lattice import FAR, Lattice, crossing_share
from isoref.field import Field

OUTSIDE = Declaration("", conventions=Conventions(tie="outside"))


def line(*values: float) -> Lattice:
    """A field that varies along its first axis only."""
    samples = np.repeat(np.array(values)[:, None, None], 2, axis=1)
    return Lattice.of(Field.of(np.repeat(samples, 2, axis=2)), (0.0,))


def test_a_tie_is_on_the_declared_side() -> None:
    """A sample equal to the isovalue is inside, unless declared outside."""
    field = Field.of(np.zeros((2, 2, 2)))
    assert Lattice.of(field, (0.0,)).inside.all()
    assert not Lattice.of(field, (0.0,), OUTSIDE).inside.any()


def test_a_sample_is_tied_where_the_surface_comes_to_stand_on_it() -> None:
    """Equal to the isovalue, or so near that a vertex there is not told from the sample."""
    assert line(1.0, 0.0, -1.0).tied[:, 0, 0].tolist() == [False, True, False]
    assert line(1.0, 1e-9, -1.0).tied[:, 0, 0].tolist() == [False, True, False]
    assert line(1e-9, 1e-9, -1e-9).tied[:, 0, 0].tolist() == [False, False, False]
    assert line(1.0, -1e-9).tied[:, 0, 0].tolist() == [False, True]
    assert not line(1.0, 0.01, -1.0).tied.any()


@given(st.integers(0, 10_000), st.sampled_from([(7,), (4, 5), (3, 4, 3), (3, 2, 2, 3)]))
def test_ties_are_where_the_linear_crossing_is_at_a_sample(
    seed: int, shape: tuple[int, ...]
) -> None:
    """One lattice edge at a time, in plain words, in any dimension."""
    rng = np.random.default_rng(seed)
    values = rng.choice([-1.0, -1e-8, 0.0, 1e-7, 1e-5, 1.0, 3.0], shape)
    lattice = Lattice.of(Field.of(values), (0.0,))
    tied = values == 0
    for axis in range(len(shape)):
        for at in np.ndindex(*(n - (a == axis) for a, n in enumerate(values.shape))):
            to = tuple(i + (a == axis) for a, i in enumerate(at))
            low, high = values[at], values[to]
            if (low >= 0) != (high >= 0):
                share = low / (low - high)
                tied[at] |= share <= lattice.reach
                tied[to] |= share >= 1 - lattice.reach
    assert np.array_equal(lattice.tied, tied)


def test_two_components_that_cross_an_edge_at_one_place_tie_its_ends() -> None:
    """A curve through a lattice edge is on the border between two faces."""
    values = np.zeros((2, 2, 2, 2))
    values[:, 0], values[:, 1] = -1.0, 1.0
    values[1] *= 3.0
    field = Field.of(values, dimension=3)
    assert Lattice.of(field, (0.0, 0.0)).tied.all()
    assert not Lattice.of(field, (0.0, 0.5)).tied.any()


def test_a_split_is_tied_on_its_diagonals_too() -> None:
    """A crossing at the end of a diagonal ties the sample, where there are diagonals."""
    values = np.array([[1.0, 1e-7], [1e-7, -1.0]])
    field = Field.of(values + np.array([[0.0, 1.0], [1.0, 0.0]]))
    assert not Lattice.of(field, (0.0,)).tied.any()
    steep = Field.of(np.array([[1e-9, 1.0], [1.0, -1.0]]))
    kuhn = Declaration("", interpolant="tetrahedra", split=Split())
    assert Lattice.of(steep, (0.0,), kuhn).tied.tolist() == [[True, False], [False, False]]
    assert not Lattice.of(steep, (0.0,)).tied.any()


def test_labels_have_no_ties() -> None:
    """Who sees only inside and outside has nothing to round."""
    field = Field.of(np.zeros((3, 3)))
    assert not Lattice.of(field, (0.0,), Declaration("", interpolant="labels")).tied.any()


def test_index_coordinates_undo_spacing_and_origin() -> None:
    """And what is at the border to within single precision is on it."""
    field = Field.of(np.zeros((4, 5, 6)), (0.5, 2.0, 3.0), (10.0, -20.0, 30.0))
    lattice = Lattice.of(field, (0.0,))
    index = np.array([[0.0, 1.25, 5.0], [1.5, 4.0, 2.0]])
    single = field.position(index).astype(np.float32).astype(float)
    assert lattice.index(single) == pytest.approx(index, abs=lattice.tolerance)
    noisy = lattice.index(field.position(index) + 1e-7)
    assert noisy[0, 0] == 0.0
    assert noisy[1, 1] == 4.0
    assert lattice.index(np.array([[1e300, -1e300, 0.0]])).tolist()[0][:2] == [FAR, -FAR]


PLACES = np.array([[0.0, 0.5, 1], [0, 1, 1.5], [1, 0, 0.5], [2, 1.5, 1], [0.4, 0.3, 0.2]])


@pytest.mark.parametrize(
    ("declared", "expected"),
    [
        (Declaration(""), [True, False, False, False]),
        (Declaration("", domain=(End(0.0, "closed"),)), [False] * 4),
        (Declaration("", domain=(End(0.5, "open"),)), [False] * 4),
        (Declaration("", vertices="cells", domain=(End(0.5, "open"),)), [True] * 4),
        (
            Declaration("", vertices="cells", domain=(End(-0.5, "open"),)),
            [True, False, False, False],
        ),
        (Declaration("", vertices="own", reach=0.6), [True, False, False, True]),
    ],
)
def test_a_facet_is_at_an_open_end_when_one_plane_holds_all_its_vertices(
    declared: Declaration, expected: list[bool]
) -> None:
    """In the plane for vertices on edges, in the border layer of cells for those in cells."""
    lattice = Lattice.of(Field.of(np.zeros((3, 3, 3))), (0.0,), declared)
    rows = np.array([[0, 1], [1, 2], [0, 3], [0, 4]])
    assert lattice.on_border(PLACES, rows).tolist() == expected


def test_the_crossing_share_is_linear() -> None:
    """From low to high, whichever is larger."""
    assert crossing_share(np.array([0.0, 1.0]), np.array([1.0, 0.0]), 0.25).tolist() == [0.25, 0.75]


def test_far_from_the_zero_of_the_coordinates_single_precision_is_still_enough() -> None:
    """The tolerance grows with the distance, in spacings, as the rounding of a vertex does."""
    field = Field.of(np.zeros((4, 4, 4)), 0.1, (1e4, -1e4, 1e4))
    lattice = Lattice.of(field, (0.0,))
    corner = field.position([0, 3, 3])
    single = corner.astype(np.float32).astype(float)
    assert (abs(single - corner) > 1e-5).any()
    assert lattice.index(single[None]).tolist() == [[0, 3, 3]]


def test_a_place_is_at_a_tie_where_its_own_sample_is_tied() -> None:
    """Neither elsewhere on the lattice, nor between ties, nor far outside beside one."""
    lattice = line(1.0, 0.0, -1.0)
    near = 1 + lattice.reach / 2
    places = np.array([[1, 0, 0], [near, 1, 0], [0, 0, 0], [1, 0.5, 0], [1.5, 0, 0.0], [1, 9, 0]])
    assert lattice.at_tie(places).tolist() == [True, True, False, False, False, False]


def test_what_is_beside_a_tie_does_not_hang_on_the_last_digit() -> None:
    """A vertex on a lattice edge belongs to the cells all round it (skimage on sphere-uneven)."""
    values = np.full((4, 3, 3), -1.0)
    values[1, 1, 1] = 0.0
    lattice = Lattice.of(Field.of(values), (0.0,))
    exact = np.array([[2.0, 1.5, 1.0], [3.0, 1.5, 1.0]])
    for shift in (-1e-14, 0.0, 1e-14):
        assert lattice.beside_tie(exact + shift).tolist() == [True, False]


@pytest.mark.parametrize("near", ["first", "last"])
@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-3])
def test_a_crossing_behind_the_last_plane_ties_the_sample_it_is_near(
    near: str, size: float
) -> None:
    """Along a periodic axis, between the last sample and the first: the nearer one or neither."""
    values = np.array([-size, -1.0, -1.0, 1.0] if near == "first" else [-1.0, 1.0, 1.0, size])
    periodic = Declaration("", domain=(End(0.0, "periodic"),))
    lattice = Lattice.of(Field.of(np.repeat(values[:, None], 2, axis=1)), (0.0,), periodic)
    tied = [size < 1e-6 and place == near for place in ("first", "", "", "last")]
    assert lattice.tied.all(axis=1).tolist() == lattice.tied.any(axis=1).tolist() == tied


def test_a_facet_is_at_the_border_up_to_its_slack() -> None:
    """The tolerance itself is within it, and twice as much is not."""
    lattice = Lattice.of(Field.of(np.zeros((3, 3))), (0.0,))
    for far, expected in ((1.0, True), (2.0, False)):
        places = np.array([[far * lattice.tolerance, 0.5]])
        assert lattice.on_border(places, np.array([[0]])).tolist() == [expected]


def test_a_crossing_between_the_last_sample_and_the_first_ties_on_a_line_too() -> None:
    """In one dimension the ends of a periodic axis are single samples."""
    declared = Declaration("one", domain=(End(0.0, "periodic"),))
    lattice = Lattice.of(Field.of([1.0, 1.0, 2.0, -1e-7]), (0.0,), declared)
    assert lattice.tied.tolist() == [False, False, False, True]
    assert lattice.beside_tie(np.array([[1.5], [2.5], [0.5]])).tolist() == [False, True, False]
