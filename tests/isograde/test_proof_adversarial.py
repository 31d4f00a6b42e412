"""The numbers that tempt decisions: they are what they say, and right rules withstand them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from isograde.proof import prove
from isograde.proof.adversarial import KINDS, faces, pairs
from isograde.proof.premises import signs_of
from isoref.asymptotic_decider import RULE as ASYMPTOTIC
from isoref.field import Floats

from tests.isograde.wrong_rules import by_faces


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("axis", range(3))
def test_pairs_share_a_face_and_mostly_an_ambiguous_one(kind: str, axis: int) -> None:
    """The four values are the same in both cells, and the others are not."""
    low, high = pairs(kind, axis, np.random.default_rng(0), 2000)
    above = [c for c in range(8) if c >> axis & 1]
    below = [c ^ 1 << axis for c in above]
    assert (low[above] == high[below]).all()
    assert (low[below] != high[above]).any(axis=0).mean() > 0.9
    assert np.isfinite([low, high]).all()
    a, b, c, d = low[above] >= 0
    assert ((a == d) & (b == c) & (a != b)).mean() > 0.3
    assert len(set(signs_of(low).tolist())) > 30


def test_saddles_and_means_are_within_units_in_the_last_place() -> None:
    """On both sides of zero, and on it."""
    rng = np.random.default_rng(1)
    a, b, c, d = faces("saddles", rng, 4000)
    left, right = np.abs(a * c), np.abs(b * d)
    near = np.abs(left - right) <= 8 * np.spacing(np.maximum(left, right))
    assert near.mean() > 0.8
    assert {-1.0, 0.0, 1.0} <= set(np.sign(left - right)[near].tolist())
    a, b, c, d = faces("means", rng, 4000)
    total = a + b + c + d
    assert (np.abs(total) <= 32 * np.spacing(np.abs([a, b, c, d]).max(axis=0))).mean() > 0.8
    assert {-1.0, 0.0, 1.0} <= set(np.sign(total).tolist())


def test_the_order_of_a_walk_matters_on_means() -> None:
    """The sum of the four values changes its sign with the order in which they are added."""
    a, b, c, d = faces("means", np.random.default_rng(2), 4000)
    one_way, other_way = ((a + b) + c) + d, ((a + d) + c) + b
    assert ((one_way < 0) != (other_way < 0)).sum() > 40


def plain_products(a: Floats, b: Floats, c: Floats, d: Floats) -> Any:
    """Two rounded products are compared: not exact, and the same from both sides."""
    with np.errstate(all="ignore"):
        return np.where(a >= 0, a * c < b * d, b * d < a * c)


def sorted_mean(a: Floats, b: Floats, c: Floats, d: Floats) -> Any:
    """The mean of four values added in the order of their sizes."""
    with np.errstate(all="ignore"):
        return np.sort([a, b, c, d], axis=0).sum(axis=0) < 0


def largest(a: Floats, b: Floats, c: Floats, d: Floats) -> Any:
    """The side of the value that is farthest from the isovalue."""
    return np.max([a, b, c, d], axis=0) < -np.min([a, b, c, d], axis=0)


@pytest.mark.parametrize("test", [plain_products, sorted_mean, largest])
def test_a_rule_is_not_refused_for_deciding_otherwise(test: Any) -> None:
    """Any function of the face's four values will do, rounded or not."""
    proof = prove(by_faces(test), trials=6000)
    assert proof.holds, proof.text()


def test_decisions_need_not_be_alike_on_all_axes() -> None:
    """One axis joins, one separates, one asks the saddle: a face has one axis."""

    def decisions(g: Floats) -> Any:
        ambiguous = by_faces(lambda a, b, c, d: np.ones(a.shape, bool)).decisions(g)
        return (ambiguous & 0b001100) | (ASYMPTOTIC.decisions(g) & 0b110000)

    proof = prove(replace(ASYMPTOTIC, decisions=decisions), trials=3000)
    assert proof.holds, proof.text()
