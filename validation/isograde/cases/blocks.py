"""Blocks of a case: what is left of it when its outer samples are dropped.

A block is named by its case and its ranges, ``ties/noise-05[0:3,1:4,2:5]``, so that the smallest
failing part of a large case can be graded again by name.
"""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import numpy as np
from isoref.field import Field

from isograde.model import Case

Ranges = tuple[tuple[int, int], ...]
NAME = re.compile(r"(?P<case>[^\[\]]+)\[(?P<ranges>\d+:\d+(,\d+:\d+)*)\]")
# What is known of a whole surface is not known of a part, and a part may run into the border.
WHOLE = frozenset(
    {"closed", "bordered", "analytic", "nielson-hamann", "full"}
    | {"known", "open", "curved", "flat", "volume", "levels", "touching"}
)


def parse(name: str) -> tuple[str, Ranges] | None:
    """The case and the ranges that a block's name holds; None where it is no such name.

    >>> parse("ties/noise-05[0:3,1:4,2:5]")
    ('ties/noise-05', ((0, 3), (1, 4), (2, 5)))
    >>> parse("ties/noise-05") is None
    True
    """
    found = NAME.fullmatch(name)
    if found is None:
        return None
    pairs = [part.split(":") for part in found["ranges"].split(",")]
    return found["case"], tuple((int(start), int(stop)) for start, stop in pairs)


def block(case: Case, ranges: Ranges) -> Case:
    """The part of the case in these half-open ranges; nothing is known of its surface.

    A block of a block is named as a block of the whole.
    """
    if isinstance(case.build, partial) and case.build.func is cut:
        whole, outer = case.build.args
        return block(
            whole,
            tuple(
                (a + start, a + stop) for (a, _), (start, stop) in zip(outer, ranges, strict=True)
            ),
        )
    named = ",".join(f"{start}:{stop}" for start, stop in ranges)
    samples = int(np.prod([stop - start for start, stop in ranges]))
    build = partial(cut, case, ranges)
    return Case(
        f"{case.id}[{named}]",
        build,
        case.isovalues,
        samples,
        case.tags - WHOLE,
        kind=case.kind,
        only=case.only,
    )


def cut(case: Case, ranges: Ranges) -> Field:
    """The samples of the case in these ranges, where they stood."""
    whole = case.build()
    index: Any = (..., *(slice(start, stop) for start, stop in ranges))
    values = np.ascontiguousarray(whole.values[index])
    origin = whole.position([start for start, _ in ranges])
    return Field.of(
        np.ascontiguousarray(values), whole.spacing, origin.tolist(), dimension=len(ranges)
    )
