"""What follows from what on one case: a table of logic, and findings in one place."""

from fnmatch import fnmatchcase
from itertools import product

import numpy as np
import pytest
from isograde.causes import FOLLOWS, ORDER, apart, box, can_follow, roots
from isograde.claims import CLAIMS

EDGE = {"first": [[1.0, 0.7, 0.0], [1.0, 0.0, 0.2]], "facets": 2}


def test_every_glob_of_the_table_names_claims() -> None:
    globs = [glob for globs in FOLLOWS.values() for glob in globs]
    assert len(globs) > 40
    assert set(ORDER) <= set(CLAIMS)
    assert [g for g in globs if not any(fnmatchcase(name, g) for name in CLAIMS)] == []


def test_no_claim_is_a_cause_of_its_own_cause() -> None:
    """The order of the table is that of the causes, whatever the globs name."""
    both = [
        (one, other)
        for one, other in product(CLAIMS, CLAIMS)
        if can_follow(one, other) and can_follow(other, one)
    ]
    assert both == []


def test_what_follows_goes_back_to_its_root() -> None:
    """A hole makes vertices where sheets meet, and these come from nothing else."""
    bad: dict[str, dict[str, object]] = {
        name: {}
        for name in ("topology.ties", "topology.manifold", "topology.closed", "topology.scan")
    }
    assert set(roots(bad).values()) == {"topology.closed"}


def test_a_chain_ends_at_its_root() -> None:
    bad: dict[str, dict[str, object]] = {
        "topology.bilinear": {},
        "topology.trilinear": {},
        "topology.scan": {},
    }
    assert roots(bad)["topology.scan"] == "topology.bilinear"


def test_what_nothing_explains_stands_alone() -> None:
    bad: dict[str, dict[str, object]] = {
        "symmetry.type": {},
        "topology.manifold": {},
        "structure.all_used": {},
    }
    assert roots(bad) == {name: name for name in bad}


def test_faults_in_two_places_are_two() -> None:
    """A crowded edge at one end of a field and a crossing at the other have not one cause."""
    near = {"first": [[1.0, 0.7, 0.0], [1.0, 1.0, 0.3], [1.0, 0.2, 0.0]], "pairs": 1}
    far = {"first": [[5.0, 0.7, 4.0], [5.0, 1.0, 4.3], [5.0, 0.2, 4.0]], "pairs": 1}
    for place, root in ((near, "topology.manifold"), (far, "geometry.embedded")):
        found = roots({"topology.manifold": EDGE, "geometry.embedded": place})
        assert found["geometry.embedded"] == root


def test_of_many_faults_the_first_need_not_be_in_one_place() -> None:
    far = {"first": [5.0, 5.0, 5.0], "pairs": 9}
    assert not apart(EDGE, far)
    assert apart(EDGE, {**far, "pairs": 1})


@pytest.mark.parametrize(
    ("numbers", "low", "high"),
    [
        ({"first": [1.0, 2.0]}, [1, 2], [1, 2]),
        ({"first": [[[0.0, 1.0], [2.0, 0.0]]]}, [0, 0], [2, 1]),
        ({"cell": [3, 4]}, [3, 4], [4, 5]),
    ],
)
def test_the_box_of_what_a_finding_names(
    numbers: dict[str, object], low: list[int], high: list[int]
) -> None:
    found = box(numbers)
    assert found is not None
    assert np.array_equal(found, [low, high])


@pytest.mark.parametrize("numbers", [{}, {"first": "here"}, {"first": 3}, {"first": [[1], [2, 3]]}])
def test_a_finding_that_names_no_place_has_no_box(numbers: dict[str, object]) -> None:
    assert box(numbers) is None
