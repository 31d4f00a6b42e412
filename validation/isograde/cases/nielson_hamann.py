"""The two analytic examples of Nielson and Hamann.

Example 2 is a field on 69 x 65 x 65 voxels, example 3 one on 49 x 49 x 49; both sample the unit
cube with one more sample than voxels along each side. The formulas are those of section 4, with
the factor printed as "75" read as .75. The printed isovalues are rounded: Table 1 comes out
exactly at 0.5679 and 0.4633 (printed .557 and .463).

References
----------
[1] G. M. Nielson, B. Hamann. The Asymptotic Decider: Resolving the Ambiguity in Marching Cubes.
    Visualization '91, section 4 and Table 1.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Field, Floats

from isograde.model import Case

EXAMPLE_2, ISOVALUE_2 = (69, 65, 65), 0.5679
EXAMPLE_3, ISOVALUE_3 = (49, 49, 49), 0.4633


def _unit_cube(voxels: tuple[int, int, int]) -> tuple[tuple[Floats, ...], tuple[float, ...]]:
    """Coordinates x, y, z of the samples that divide the unit cube, and the spacing."""
    axes = [np.arange(n + 1) / n for n in voxels]
    return tuple(np.meshgrid(*axes, indexing="ij", sparse=True)), tuple(1 / n for n in voxels)


def example_2(voxels: tuple[int, int, int] = EXAMPLE_2) -> Field:
    """The second example [1, section 4]: two columns and two blobs."""
    (x, y, z), spacing = _unit_cube(voxels)
    column = (x - 0.25) ** 2 + (y - 0.25) ** 2
    F = 0.5 * np.exp(-10 * column)
    F = F + 0.75 * np.exp(-16 * (column + (z - 0.25) ** 2))
    F = F + 0.5 * np.exp(-10 * ((x - 0.75) ** 2 + (y - 0.125) ** 2 + (z - 0.5) ** 2))
    F = F - 0.25 * np.exp(-20 * ((x - 0.75) ** 2 + (y - 0.75) ** 2))
    return Field.of(F, spacing)


def example_3(voxels: tuple[int, int, int] = EXAMPLE_3) -> Field:
    """The third example [1, section 4]: four blobs at alternate corners of a cube."""
    (x, y, z), spacing = _unit_cube(voxels)
    blobs = ((0.7, 0.3, 0.3, 0.3), (0.9, 0.7, 0.7, 0.3), (0.7, 0.3, 0.7, 0.7), (0.7, 0.7, 0.3, 0.7))
    F = sum(w * np.exp(-16 * ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)) for w, a, b, c in blobs)
    return Field.of(F, spacing)


def cases(seed: int = 0) -> list[Case]:
    """The two examples; they do not depend on the seed."""
    del seed
    tags = frozenset({"nielson-hamann"})
    return [
        Case("nielson-hamann/example-2", example_2, (ISOVALUE_2,), 70 * 66 * 66, tags | {"full"}),
        Case("nielson-hamann/example-3", example_3, (ISOVALUE_3,), 50**3, tags),
    ]
