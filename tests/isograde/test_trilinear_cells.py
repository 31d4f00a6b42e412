"""The targeted cells are what their ids say, near what they are near to, and frozen."""

from collections import Counter

import numpy as np
import pytest
from isograde.cases import trilinear_cells
from isograde.cases.frozen import digest
from isograde.cases.trilinear_cells import STEPS, TUNNELS, UNIT, near, topology_of
from isograde.model import Case
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_cases import case_names, every_topology
from isograde.oracles.trilinear_grid import grid


@pytest.fixture(scope="module")
def listed() -> list[Case]:
    """All cases of the family."""
    return trilinear_cells.cases(0)


def test_vectors_are_frozen(listed: list[Case]) -> None:
    """Same seed, same numbers, same ids."""
    assert digest(listed[::7]) == (
        "6ac4f01c3b41eccaa930d89025ba1792ef82df712a5a96a2ee67ede4623f6c02"
    )


def test_each_cell_is_of_the_case_its_id_names(listed: list[Case]) -> None:
    """4,224 cells of one voxel."""
    singles = [case for case in listed if "pair" not in case.tags]
    values = np.array([case.build().values for case in singles])
    named = [case.id.split("/")[2 if "each" in case.tags else 1] for case in singles]
    assert case_names(cells(values)).tolist() == named
    assert (values.astype(np.float32) == values).all()


def test_every_topology_has_its_cell(listed: list[Case]) -> None:
    """All 768 that can happen do happen: the derived upper bound is reached."""
    fields = [np.asarray(case.build().values) for case in listed if "each" in case.tags]
    assert {topology_of(values) for values in fields} == every_topology()
    assert len(fields) == 768


def test_every_tunnel_stands_in_all_positions_with_and_without_it(listed: list[Case]) -> None:
    """48 symmetries and two signs, clear of the decision and near it from both sides."""
    count = Counter(tuple(case.id.split("/")[1:3]) for case in listed if "far" in case.tags)
    count += Counter(tuple(case.id.split("/")[1:3]) for case in listed if "near" in case.tags)
    assert count == {
        (name, kind): 96 for pair in TUNNELS.items() for name in pair for kind in ("far", "near")
    }


@pytest.mark.parametrize("name", TUNNELS)
def test_near_cells_differ_little_and_in_the_tunnel_alone(name: str) -> None:
    """Same signs, same faces, one with the tunnel and one without."""
    for bits in STEPS.values():
        inside, outside = near(name, 0, bits)
        one, other = topology_of(inside), topology_of(outside)
        assert (one.signs, one.faces) == (other.signs, other.faces)
        assert (one.tunnels, other.tunnels) == (1, 0)
        assert np.abs(inside - outside).max() <= 2 * 2.0**-bits + 2 * UNIT


def test_pairs_are_no_ties_and_have_two_tunnels(listed: list[Case]) -> None:
    """A cell and its mirror image share a face, and each has its tunnel."""
    pairs = [case for case in listed if "pair" in case.tags]
    assert len(pairs) == 72
    for case in pairs:
        values = np.asarray(case.build().values)
        assert grid(values).ties == NONE
        windows = np.lib.stride_tricks.sliding_window_view(values, (2, 2, 2)).reshape(-1, 2, 2, 2)
        assert case_names(cells(windows)).tolist() == [case.id.split("/")[2]] * 2


def test_a_run_that_is_not_full_poses_every_case(listed: list[Case]) -> None:
    """Fewer positions, but each name, near and far."""
    quick = [case for case in listed if "full" not in case.tags]
    assert len(quick) < 550
    named = {case.id.split("/")[2] for case in quick if "each" in case.tags}
    assert len(named) == 32


def test_another_seed_gives_other_cells() -> None:
    """The names stay, the numbers change."""
    one, other = trilinear_cells.cases(0), trilinear_cells.cases(1)
    assert [case.id for case in one] == [case.id for case in other]
    assert not np.array_equal(one[5].build().values, other[5].build().values)
