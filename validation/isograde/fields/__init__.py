"""Every case the grader knows, by id: one module a family, each with a function ``cases(seed)``."""

from collections.abc import Callable
from functools import cache
from types import ModuleType

from isograde.fields import (
    analytic,
    cells,
    nielson_hamann,
    noise,
    pairs,
    ties,
    trilinear_cells,
    volumes,
)
from isograde.model import Case

FAMILIES: dict[str, ModuleType] = {
    "cells": cells,
    "pairs": pairs,
    "ties": ties,
    "noise": noise,
    "trilinear": trilinear_cells,
    "analytic": analytic,
    "nielson-hamann": nielson_hamann,
    "real": volumes,
}


@cache
def all_cases(seed: int = 0) -> dict[str, Case]:
    """Every case by id, in the order of the families."""
    found: dict[str, Case] = {}
    for family in FAMILIES.values():
        listed: Callable[[int], list[Case]] = family.cases
        found.update({case.id: case for case in listed(seed)})
    return found
