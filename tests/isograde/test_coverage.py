"""The default plan covers what its report says, and no less."""

from __future__ import annotations

import json
from functools import cache

import pytest
from isoref.methods import RULES

from tests.isograde import coverage


@cache
def now() -> dict[str, dict[str, int]]:
    """What is counted today."""
    return coverage.counted()


def kept() -> dict[str, dict[str, int]]:
    """What the report has."""
    found: dict[str, dict[str, int]] = json.loads((coverage.ROOT / "coverage.json").read_text())
    return found


@pytest.mark.slow
def test_nothing_that_is_covered_is_lost() -> None:
    """Row by row of the kept report."""
    assert kept()
    for table, rows in kept().items():
        assert rows, table
        for name, number in rows.items():
            assert now()[table][name] >= number, (table, name)


def test_the_kept_report_has_every_tile_of_every_rule() -> None:
    """618 of the asymptotic decider, 766 of the trilinear rule, and all that any other reaches."""
    tiles = kept()["Tiles of the cube rules"]
    assert set(tiles) == set(RULES)
    assert (tiles["asymptotic-decider"], tiles["trilinear-cubes"]) == (618, 766)
    for name, rule in RULES.items():
        assert tiles[name] >= len(coverage.tiles(rule, coverage.topologies())), name
    near = kept()["Near tunnels"]
    assert near["cases with a tunnel"] == 6
    assert near["independent bases of each"] >= 8
