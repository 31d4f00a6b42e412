"""All 256 sign configurations of a cell, each in an inside and in an outside border.

A cell by itself ends at its faces. Here the cell stands in the middle of a lattice of 4 x 4 x 4
samples whose outer samples are all inside, or all outside, so that a closed surface runs round or
through it, and a hole is a fault.

Glossary
--------
configuration   eight bits: bit c is set where corner c is inside
corner c        stands at offset (c & 1, c >> 1 & 1, c >> 2 & 1)
border          the 56 samples around the cell
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
from isoref.field import Booleans, Field

from isograde.cases.frozen import magnitudes
from isograde.model import Case

ISOVALUE = 0.5


def corners(configuration: int) -> Booleans:
    """The inside corners of a configuration, as an array of 2 x 2 x 2.

    >>> corners(2)[1, 0, 0], corners(4)[0, 1, 0], corners(128)[1, 1, 1]
    (np.True_, np.True_, np.True_)
    """
    bits = configuration >> np.arange(8) & 1 == 1
    return np.asarray(bits, np.bool_).reshape((2, 2, 2), order="F")


def number(inside: Booleans) -> int:
    """The configuration these corners make; undoes `corners`.

    >>> number(corners(105))
    105
    """
    return int(inside.reshape(-1, order="F") @ (1 << np.arange(8)))


@cache
def representatives() -> frozenset[int]:
    """The smallest configuration of each class under rotations; marked and unmarked differ.

    >>> len(representatives())
    23
    """
    return frozenset(min(_rotated(corners(configuration))) for configuration in range(256))


def _rotated(inside: Booleans) -> set[int]:
    """The configurations that rotations turn this one into."""
    reached, frontier = {number(inside)}, [inside]
    while frontier:
        box = frontier.pop()
        for axes in ((0, 1), (1, 2)):
            turned = np.rot90(box, axes=axes)
            if number(turned) not in reached:
                reached.add(number(turned))
                frontier.append(turned)
    return reached


def signed(name: str, seed: int, inside: Booleans) -> Field:
    """The field with these inside samples and random distances from the isovalue."""
    distance = magnitudes(name, seed, inside.shape)
    return Field.of(np.where(inside, ISOVALUE + distance, ISOVALUE - distance))


def embedded(configuration: int, *, border: bool) -> Booleans:
    """The configuration in the middle of 4 x 4 x 4 samples; the rest is inside where `border`."""
    inside = np.full((4, 4, 4), border)
    inside[1:3, 1:3, 1:3] = corners(configuration)
    return inside


def cases(seed: int = 0) -> list[Case]:
    """512 cases: "cells/outside/000" to "cells/inside/255"."""
    return [
        _case(f"cells/{'inside' if border else 'outside'}/{configuration:03d}", seed, border)
        for border in (False, True)
        for configuration in range(256)
    ]


def _case(name: str, seed: int, border: bool) -> Case:
    """The case of this name."""
    configuration = int(name[-3:])
    tags = {"cells", "closed" if not border else "bordered"}
    if configuration in representatives():
        tags.add("posed")
    build = partial(signed, name, seed, embedded(configuration, border=border))
    return Case(name, build, (ISOVALUE,), 64, frozenset(tags))
