"""All that can happen in a cell, derived; that it does happen, shown by cells."""

from collections import Counter

import numpy as np
import pytest
from isograde.oracles.trilinear import cells
from isograde.oracles.trilinear_cases import (
    SYMMETRIES,
    Topology,
    case_name,
    case_names,
    classes,
    configuration,
    every_case,
    every_topology,
    exchanged,
)
from isoref import cube
from numpy.typing import NDArray


def found_in(values: NDArray[np.float64]) -> set[Topology]:
    """The topologies of these cells."""
    truths = cells(values)
    rows = np.column_stack([np.where(truths.high, 1, -1), truths.faces, truths.body])
    unique = np.unique(rows[truths.ties == 0], axis=0).tolist()
    return {Topology(tuple(r[:8]), tuple(r[8:14]), tuple(r[14:])) for r in unique}


def saddle_cells(n: int, seed: int) -> NDArray[np.float64]:
    """Cells with the roots of their three quadratics in or near the cell."""
    rng = np.random.default_rng(seed)
    x, y, z = np.moveaxis(np.array([0, 1]) - rng.uniform(-0.3, 1.3, (2, n, 3, 1)), 2, 0)
    weights = rng.uniform(-1, 1, (2, n))
    return np.asarray(np.einsum("sn,sni,snj,snk->nijk", weights, x, y, z))


@pytest.mark.slow
def test_exactly_the_derived_topologies_occur() -> None:
    """Nothing outside the list is ever met, and all 768 are met."""
    rng = np.random.default_rng(0)
    checkers = np.where(np.indices((2, 2, 2)).sum(0) % 2, 1, -1)
    values = np.concatenate(
        [
            rng.uniform(-1, 1, (120_000, 2, 2, 2)),
            saddle_cells(200_000, 1),
            checkers * rng.uniform(0, 1, (40_000, 2, 2, 2)),
            -checkers * rng.uniform(0, 1, (40_000, 2, 2, 2)),
        ]
    )
    assert found_in(values) == every_topology()


def test_the_list_is_closed_under_symmetries_and_exchange() -> None:
    """A cell can be turned, mirrored and negated."""
    everything = every_topology()
    assert {exchanged(one) for one in everything} == everything
    for symmetry in SYMMETRIES:
        assert {symmetry.of(one) for one in everything} == everything


def test_how_many_cases_there_really_are() -> None:
    """Chernyaev's 33, if mirror images are kept apart and high and low are exchanged."""
    assert len(every_topology()) == 768
    assert len(classes(mirror=False)) == 33
    assert len(classes()) == 31
    assert len(classes(mirror=False, exchange=False)) == 57


def test_a_case_name_is_a_class_and_a_class_has_one_name() -> None:
    """32 names: 31 classes, and 11 with 14 two names for mirror images."""
    assert len(every_case()) == 32
    names = Counter(case_name(one) for one in classes())
    assert set(names.values()) == {1}
    assert len(names) == 31
    assert {case_name(s.of(one)) for one in classes() for s in SYMMETRIES} == set(every_case())


def test_no_sheet_has_more_than_two_curves_and_no_cell_two_tunnels() -> None:
    """Tunnels occur in configurations 4, 6, 7, 10, 12 and 13 and nowhere else (Chernyaev)."""
    with_tunnel = [one for one in every_topology() if one.tunnels]
    assert {configuration(one.signs) for one in with_tunnel} == {4, 6, 7, 10, 12, 13}
    assert all(one.tunnels == 1 for one in with_tunnel)
    assert len(with_tunnel) == 148


def test_opposite_faces_never_decide_against_another_pair_of_opposite_faces() -> None:
    """Nielson & Hamann's 64 face choices of configuration 13: 46 can occur for each of two signs.

    If both faces across one axis join the high corners, the product of the four high values
    exceeds that of the four low ones; if both across another join the low ones, the reverse.
    """
    faces = {one.faces for one in every_topology() if configuration(one.signs) == 13}
    assert len(faces) == 46
    for f in faces:
        axes = {f[0] + f[1], f[2] + f[3], f[4] + f[5]}
        assert not {2, -2} <= axes


def test_configurations_are_those_of_the_reference() -> None:
    """Another numbering of corners, another way to the configurations, the same numbers."""
    for code in range(256):
        corners = [code >> c & 1 for c in range(8)]  # bit a of c is coordinate a
        mine = tuple(1 if corners[(c >> 2 & 1) | (c & 2) | (c & 1) << 2] else -1 for c in range(8))
        assert configuration(mine) == cube.configuration(code)


def test_cells_are_named() -> None:
    """A cell with two high corners: joined through the middle or not."""
    apart = np.full((2, 2, 2), -1.0)
    apart[0, 0, 0] = apart[1, 1, 1] = 1
    joined = apart.copy()
    joined[0, 0, 0] = joined[1, 1, 1] = 30
    assert case_names(cells([apart, joined])).tolist() == ["4.1", "4.2"]
    assert case_names(cells([np.zeros((2, 2, 2))])).tolist() == ["tie"]


def test_half_of_the_symmetries_are_rotations() -> None:
    """Those whose matrix has determinant 1."""
    assert len(SYMMETRIES) == 48
    for symmetry in SYMMETRIES:
        matrix = np.eye(3)[list(symmetry.axes)] * (1 - 2 * np.array(symmetry.flips))[:, None]
        assert symmetry.is_rotation == (np.linalg.det(matrix) > 0)
