"""Segments joined into curves, beside a count of components and degrees by hand."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from isograde.oracles.chains import curves_of
from isograde.oracles.rows import components_of


def test_open_and_closed_curves_keep_the_way_of_their_segments() -> None:
    """A line given out of order, and a triangle."""
    segments = np.array([[2, 3], [7, 8], [0, 1], [9, 7], [1, 2], [8, 9]])
    found = [curve.tolist() for curve in curves_of(segments)]
    assert found == [[0, 1, 2, 3], [7, 8, 9, 7]]


def test_curves_end_where_three_meet_and_two_points_are_joined_twice() -> None:
    """A letter Y, and a circle of two segments."""
    star = curves_of(np.array([[0, 9], [9, 1], [2, 9]]))
    assert sorted(sorted(curve.tolist()) for curve in star) == [[0, 9], [1, 9], [2, 9]]
    (purse,) = curves_of(np.array([[4, 5], [5, 4]]))
    assert purse.tolist() == [4, 5, 4]


def test_nothing_has_no_curves() -> None:
    """No segment, no curve."""
    assert curves_of(np.empty((0, 2), np.int64)) == []


@given(seed=st.integers(0, 199))
def test_every_segment_is_in_one_curve_and_curves_are_as_many_as_ends_say(seed: int) -> None:
    """Where no more than two segments meet: closed ones are the components without an end."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(20)
    cuts = np.sort(rng.choice(np.arange(1, 20), 4, replace=False))
    rows = []
    for part in np.split(order, cuts):
        rows += [*pairwise(part)]
        if len(part) > 2 and rng.random() < 0.5:
            rows.append((part[-1], part[0]))
    segments = rng.permutation(np.array(rows, np.int64).reshape(-1, 2))
    flipped = rng.random(len(segments)) < 0.5
    segments[flipped] = segments[flipped, ::-1]
    found = curves_of(segments)
    joined = [tuple(sorted(p)) for c in found for p in pairwise(c)]
    assert sorted(joined) == sorted(tuple(sorted(row)) for row in segments.tolist())
    used, name = np.unique(segments, return_inverse=True)
    pieces, _ = components_of(len(used), name.reshape(segments.shape).T)
    ends = int((np.bincount(name.ravel()) == 1).sum())
    closed = sum(curve[0] == curve[-1] for curve in found)
    assert (len(found), len(found) - closed) == (pieces, ends // 2)
