"""Every case the grader knows, by id: one module a family, each with a function ``cases(seed)``."""

from collections.abc import Callable
from functools import cache
from types import ModuleType

from isograde.cases import (
    accuracy,
    analytic,
    blocks,
    bodies,
    cells,
    contours,
    cost,
    curves,
    given,
    magnitudes,
    mosaics,
    nielson_hamann,
    noise,
    pairs,
    passing,
    shapes,
    simplices,
    structured,
    tied,
    ties,
    trilinear_cells,
    types,
    volumes,
)
from isograde.model import Case

PLAN = 4
"""The version of the plan: which cases there are, their numbers, and which run by default.

Reports say it, and verdicts of unlike plans are not to be compared. 1 chose its cases by hand; 2
chooses them by coverage (`reports/coverage.md`), and asks about types, shapes, magnitudes, calls;
3 adds what the last of the faults that were broken on purpose got past (numbers beyond 2 ** 24 and
equal modulo 2 ** 16, the declared side of ties, crossings at them, digits of doubles), and samples
that are infinite or no numbers; 4 adds what faults of strangers got past: a field of each type in
every layout, crops and mapped files, whole isovalues amid whole numbers, spacings of which one is 1
or two are equal, of nanometres and of a millionth along one axis, lengths about 256, more than
400,000 vertices, faces that are nearly undecided, arrays of unlike size, long axes in four
dimensions, -0.0, and the same question asked again among hundreds of others.
"""

FAMILIES: dict[str, ModuleType] = {
    "cells": cells,
    "pairs": pairs,
    "ties": ties,
    "noise": noise,
    "trilinear": trilinear_cells,
    "passing": passing,
    "mosaics": mosaics,
    "tied": tied,
    "types": types,
    "magnitudes": magnitudes,
    "structured": structured,
    "shapes": shapes,
    "bodies": bodies,
    "contours": contours,
    "curves": curves,
    "simplices": simplices,
    "analytic": analytic,
    "accuracy": accuracy,
    "nielson-hamann": nielson_hamann,
    "cost": cost,
    "real": volumes,
}


FULL = frozenset({"passing", "directed", "quality"})
"""Tags of cases that run in full runs alone, every one of them."""


class Catalogue(dict[str, Case]):
    """Cases by id; a block of a case, or one spelt out, is found by its name, though not listed."""

    def __missing__(self, name: str) -> Case:
        """The case of this name. Raises `KeyError` where there is none."""
        if (spelt := given.parse(name)) is not None:
            return spelt
        named = blocks.parse(name)
        if named is None or named[0] not in self:
            raise KeyError(name)
        return blocks.block(self[named[0]], named[1])


@cache
def all_cases(seed: int = 0) -> Catalogue:
    """Every case by id, in the order of the families."""
    found = Catalogue()
    for family in FAMILIES.values():
        listed: Callable[[int], list[Case]] = family.cases
        found.update({case.id: case for case in listed(seed)})
    return found
