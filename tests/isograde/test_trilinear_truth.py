"""The truth about cells is checked by refinement, by turning cells, and in exact arithmetic."""

from itertools import permutations

import numpy as np
import pytest
from isograde.oracles import trilinear
from isograde.oracles.trilinear import BODY, CLOSE, CORNER, FACE, NONE, Truths, cells
from isograde.oracles.trilinear_by_refinement import UnresolvedError, refine
from isograde.oracles.trilinear_grid import GridTruth, grid
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def random_cells(n: int, seed: int) -> Floats:
    """Corner values uniform in (-1, 1)."""
    return np.random.default_rng(seed).uniform(-1, 1, (n, 2, 2, 2))


def saddle_cells(n: int, seed: int) -> Floats:
    """Cells a (x - p)(y - q)(z - r) + b (x - p')(y - q')(z - r') with all six roots inside.

    These are the cells that have two body saddles on parallel level sets, so tunnels are common.
    """
    rng = np.random.default_rng(seed)
    roots = rng.uniform(-0.1, 1.1, (2, n, 3, 1))
    factors = np.array([0, 1]) - roots
    weights = rng.uniform(-1, 1, (2, n))
    x, y, z = np.moveaxis(factors, 2, 0)
    return np.asarray(np.einsum("sn,sni,snj,snk->nijk", weights, x, y, z))


def same_parts(names: NDArray[np.int64], others: NDArray[np.int64]) -> bool:
    """Whether two namings of eight corners make the same parts."""
    return bool(((names[:, None] == names) == (others.ravel()[:, None] == others.ravel())).all())


def agrees_with_refinement(values: Floats, truths: Truths) -> int:
    """Number of cells compared; every one of them agrees."""
    compared = 0
    for i, cell in enumerate(values):
        if truths.ties[i] != NONE:
            continue
        try:
            found = refine(cell, limit=400_000)
        except UnresolvedError:
            continue
        compared += 1
        expected = tuple(int(x[i]) for x in (truths.components, truths.euler, truths.curves))
        assert (found.components, found.euler, found.curves) == expected, cell.tolist()
        assert same_parts(truths.body[i], found.corners), cell.tolist()
    return compared


def test_random_cells_agree_with_refinement() -> None:
    """Components, Euler characteristic, curves and who is joined to whom."""
    values = random_cells(600, seed=0)
    assert agrees_with_refinement(values, cells(values)) == len(values)


def test_cells_with_saddles_agree_with_refinement() -> None:
    """The same where one cell in some has a tunnel."""
    values = saddle_cells(1500, seed=1)
    truths = cells(values)
    assert (truths.tunnels > 0).sum() > 50
    assert agrees_with_refinement(values, truths) > 0.99 * len(values)


@pytest.mark.slow
def test_thousands_of_cells_agree_with_refinement() -> None:
    """Ten thousand cells, random ones and ones with saddles."""
    values = np.concatenate([random_cells(5000, seed=2), saddle_cells(5000, seed=3)])
    assert agrees_with_refinement(values, cells(values)) > 9900


def test_small_integers_agree_with_refinement() -> None:
    """Events coincide in such cells, and many are ties; those that are not have one truth."""
    values = np.random.default_rng(4).integers(-3, 4, (1500, 2, 2, 2))
    values[values == 0] = 5
    truths = cells(values)
    assert truths.exact.any()
    assert (truths.ties == FACE).any()
    assert agrees_with_refinement(values.astype(float), truths) > 1000


def test_every_axis_gives_the_same_truth() -> None:
    """The sweep along any axis, in any direction, finds the same parts."""
    values = np.concatenate([random_cells(2000, 5), saddle_cells(4000, 6)])
    small = np.random.default_rng(7).integers(-3, 4, (2000, 2, 2, 2))
    for cases in (values, small):
        plain = cells(cases)
        where = np.arange(8).reshape(2, 2, 2)
        for axes in permutations(range(3)):
            turned = cells(cases.transpose(0, *(a + 1 for a in axes))[:, ::-1])
            home = where.transpose(axes)[::-1].ravel()
            good = plain.ties == NONE
            assert ((plain.ties == NONE) == (turned.ties == NONE)).all()
            assert (plain.euler == turned.euler)[good].all()
            names = plain.body[:, home]
            same = names[:, :, None] == names[:, None]
            assert (same == (turned.body[:, :, None] == turned.body[:, None]))[good].all()


def test_floats_and_integers_read_the_same() -> None:
    """The float filter, the integers behind it, and signs alone where they are enough."""
    values = np.concatenate([random_cells(500, 8), saddle_cells(1000, 9)])
    plain = cells(values)
    for other in (
        cells(values.astype(object)),
        trilinear._cells(values, 0.0, skip_plain=False),
        trilinear._cells(values.astype(object), 0.0, skip_plain=False),
    ):
        for name in ("high", "faces", "rim", "body", "euler", "ties"):
            assert (getattr(plain, name) == getattr(other, name)).all(), name


def test_exchange_of_high_and_low_keeps_the_surface() -> None:
    """F and -F have one level set."""
    values = saddle_cells(2000, 10)
    one, other = cells(values), cells(-values)
    for name in ("body", "rim", "euler"):
        assert (getattr(one, name) == getattr(other, name)).all()


def test_sheets_have_no_genus_and_euler_is_two_sheets_less_curves() -> None:
    """A sheet in a cell is a sphere with holes; Euler's formula ties the three counts."""
    truths = cells(np.concatenate([random_cells(20_000, 11), saddle_cells(20_000, 12)]))
    assert (truths.euler == 2 * truths.components - truths.curves).all()


def test_a_decision_below_rounding_is_made_in_integers() -> None:
    """A face saddle of 1e-30 is beyond float64 but not beyond the truth; Nielson & Hamann, 2."""
    tiny = 2.0**-60
    values = np.full((2, 2, 2), -1.0)
    values[0, 0, 0], values[0, 1, 1] = 1 + 2**-52, 1 - 2**-52
    values[0, 0, 1] = values[0, 1, 0] = -1
    one = cells(values)
    assert bool(one.exact[0])
    assert one.faces[0, 0] == -1  # (1 + e)(1 - e) < 1
    assert cells(values, isovalue=-tiny).faces[0, 0] == 1


def test_ties_are_named() -> None:
    """Corner, face and body saddle on the isovalue."""
    corner = np.full((2, 2, 2), -1)
    corner[0, 0, 0] = 0
    face = np.full((2, 2, 2), -1)
    face[0, 0, 0] = face[0, 1, 1] = 1
    # (2x-1)(2y-1)(2z-1) + .. has its body saddle at the centre, on zero
    x, y, z = np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")
    body = 4 * (x * y + y * z + z * x)
    assert cells(corner).ties[0] == CORNER
    assert cells(face).ties[0] == FACE
    assert cells(body).ties[0] == BODY


def test_whole_grids_agree_with_refinement() -> None:
    """Noise on 4^3 samples, refined as a whole."""
    rng, compared = np.random.default_rng(13), 0
    for _ in range(25):
        values = rng.uniform(-1, 1, (4, 4, 4))
        try:
            found = refine(values)
        except UnresolvedError:
            continue
        compared += 1
        truth = grid(values)
        assert (truth.components, truth.euler, truth.curves) == (
            found.components,
            found.euler,
            found.curves,
        )
    assert compared > 20


def test_a_grid_with_a_tie_says_so() -> None:
    """One sample on the isovalue, seen by eight cells."""
    values = np.random.default_rng(14).uniform(1, 2, (4, 4, 4))
    values[1, 1, 1] = 0
    assert grid(values).ties == 8


def test_no_cells_no_surface() -> None:
    """An isovalue outside the range."""
    assert grid(np.ones((3, 3, 3)), 2.0) == GridTruth(0, 0, 0, 0)
    assert len(cells(np.zeros((0, 2, 2, 2)))) == 0


def test_a_saddle_nearer_than_distances_are_rounded_is_told() -> None:
    """Tenths at 0.05: two faces of a cell are undecided but for what 0.4 - 0.05 is rounded by."""
    cell = np.array([[[0.4, -0.4], [0.4, 0.5]], [[0.0, 0.5], [0.5, -0.4]]])
    assert cells(cell[None], 0.05).ties.tolist() == [CLOSE]
    assert cells(np.rint(20 * cell[None]), 1.0).ties.tolist() == [FACE]  # In whole numbers.
    # Undecided to a last digit, and no distance is rounded: that is decided.
    cell = np.array([[[1, -1], [-1, 1 + 2.0**-52]], [[-2, -2], [-2, -2]]])
    assert cells(cell[None], 0.0).ties.tolist() == [NONE]
