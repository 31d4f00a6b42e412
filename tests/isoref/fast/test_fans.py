"""Tiles are cut into fans without loss, and drawn from them as they are."""

import numpy as np
import pytest
from isoref.cycles import Triangle
from isoref.fast._fans import BLOCK, LONGEST, corners_of, fans
from isoref.methods import RULES
from isoref.rule import Rule


def drawn(triangles: tuple[Triangle, ...]) -> list[list[int]]:
    """The triangles of the fans, read as the sweep reads them."""
    found = []
    for count, hub, nodes in fans(triangles):
        places = corners_of(2 * (3 * count + hub))[: 3 * count] // BLOCK
        found += np.array(nodes)[places].reshape(-1, 3).tolist()
    return found


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
def test_the_fans_of_a_tile_are_its_triangles(rule: Rule) -> None:
    """Each triangle once, and begun at the same corner, for all signs and many decisions."""
    rng = np.random.default_rng(3)
    tiles = [
        rule.tile(signs, int(decisions))
        for signs in range(256)
        for decisions in ({0, *rng.integers(0, 64, 3)} if rule.bits and rule.asks(signs) else {0})
    ]
    assert sum(len(tile.triangles) for tile in tiles) > 500
    for tile in tiles:
        assert sorted(drawn(tile.triangles)) == sorted(map(list, tile.triangles))


@pytest.mark.parametrize("hub", range(3))
@pytest.mark.parametrize("count", [1, 2, LONGEST, LONGEST + 1, 3 * LONGEST])
def test_a_fan_of_any_length_is_cut(hub: int, count: int) -> None:
    """A tile of whoever writes a rule may have more triangles than any of ours."""
    turned = [np.roll([99, n, n + 1], hub).tolist() for n in range(count)]
    triangles = tuple((a, b, c) for a, b, c in turned)
    cut = fans(triangles)
    assert sorted(drawn(triangles)) == sorted(turned)
    assert len(cut) == -(-count // LONGEST)
    assert max(n for n, _, _ in cut) <= LONGEST


def test_no_triangles_make_no_fans() -> None:
    """An empty tile."""
    assert fans(()) == []
