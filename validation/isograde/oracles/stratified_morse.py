"""The Euler characteristic of a closed level set, from the critical points above it.

Etiene and others verified isosurfaces by two ways to the topology of the interpolant: by digital
topology (`isograde.oracles.trilinear_by_refinement`) and by stratified Morse theory, as here.
Nothing is drawn and no cell is classified: lower the isovalue from above everything, and count what
each critical point of the piecewise trilinear interpolant adds to the set above, M::

    a sample        (1 - u_x) (1 - u_y) (1 - u_z)     u_a: its greater neighbours on axis a, 0 .. 2
    a face's saddle          -(1 - u)                 u: the sides on which F rises from it, 0 .. 2
    a cell's saddle       -sign(det H)                H: the Hessian, whose trace is 0

A lattice edge has none, as F is linear there. The first line is 1 - chi of the upper link on the
octahedron of neighbours; the second the same product with a saddle's -1 for two of its factors; the
third is -1 for one rising direction and 1 for two. Where the surface does not reach the border, it
is the boundary of M, and has twice M's Euler characteristic.

In general position only: no two neighbours are equal, and no critical point is on the isovalue.

References
----------
[1] T. Etiene, L. G. Nonato, C. Scheidegger, J. Tierny, T. J. Peters, V. Pascucci, R. M. Kirby,
    C. T. Silva, "Topology verification for isosurface extraction", IEEE TVCG 18(6), 2012.
[2] M. Goresky, R. MacPherson, "Stratified Morse theory", 1988: the product of tangential and normal
    data.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Floats
from numpy.typing import ArrayLike


def euler(values: ArrayLike, isovalue: float = 0.0) -> int:
    """The Euler characteristic of the level set of a volume whose border is below the isovalue.

    Raises
    ------
    ValueError
        for a volume that is not three-dimensional, or a border sample that is not below.

    >>> values = np.full((3, 3, 3), -1.0)
    >>> values[1, 1, 1] = 1
    >>> euler(values)
    2
    """
    samples = np.asarray(values, np.float64)
    if samples.ndim != 3 or min(samples.shape) < 3:
        raise ValueError(f"a volume of {samples.shape} samples has no inside")
    border = np.ones(samples.shape, bool)
    border[1:-1, 1:-1, 1:-1] = False
    if (samples[border] >= isovalue).any():
        raise ValueError("the surface reaches the border: pad the volume with samples below")
    above = _of_samples(samples, isovalue) + _of_cells(samples, isovalue)
    return 2 * (above + sum(_of_faces(samples, isovalue, axis) for axis in range(3)))


def _of_samples(samples: Floats, isovalue: float) -> int:
    """What samples above the isovalue add."""
    inner = samples[1:-1, 1:-1, 1:-1]
    product = np.ones(inner.shape, np.int64)
    for axis in range(3):
        rises = np.zeros(inner.shape, np.int64)
        for step in (-1, 1):
            rises += np.roll(samples, step, axis)[1:-1, 1:-1, 1:-1] > inner
        product *= 1 - rises
    return int(product[inner >= isovalue].sum())


def _of_faces(samples: Floats, isovalue: float, axis: int) -> int:
    """What saddles of faces across an axis add, those above the isovalue."""
    planes = np.moveaxis(samples, axis, 0)
    a, b, c, d = _corners(planes)
    with np.errstate(all="ignore"):
        # On its face F = a + (b - a) s + (c - a) t + twist s t, level in s and t at the saddle.
        twist = a - b - c + d
        s, t = (a - c) / twist, (a - b) / twist
        height = (a * d - b * c) / twist
        there = (0 < s) & (s < 1) & (0 < t) & (t < 1) & (height >= isovalue)
    layer, row, column = np.nonzero(there[1:-1])
    rises = np.zeros(len(layer), np.int64)
    at = (row, column)
    s, t, height = (x[1:-1][layer, row, column] for x in (s, t, height))
    for step in (0, 2):
        w = [x[layer + step, *at] for x in (a, b, c, d)]
        beside = (1 - s) * (1 - t) * w[0] + s * (1 - t) * w[1] + (1 - s) * t * w[2] + s * t * w[3]
        rises += beside > height
    return int((rises - 1).sum())


def _corners(planes: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """The samples of each square in each plane: here, one row on, one column on, both."""
    first, last = slice(None, -1), slice(1, None)
    return (
        planes[:, first, first],
        planes[:, last, first],
        planes[:, first, last],
        planes[:, last, last],
    )


def _of_cells(samples: Floats, isovalue: float) -> int:
    """What saddles inside cells add, those above the isovalue."""
    cells = np.lib.stride_tricks.sliding_window_view(samples, (2, 2, 2)).reshape(-1, 8)
    low, high = cells.min(axis=1), cells.max(axis=1)
    cells = cells[(low < high) & (high >= isovalue)]
    one, z, y, yz, x, xz, xy, h = _powers(cells)
    total = 0
    with np.errstate(all="ignore"):
        # With the origin at (-yz, -xz, -xy) / h, F = h XYZ + A X + B Y + C Z + ..: its gradient
        # vanishes where h YZ = -A, h XZ = -B and h XY = -C.
        slopes = x - xy * xz / h, y - xy * yz / h, z - xz * yz / h
        size = np.sqrt(-slopes[0] * slopes[1] * slopes[2] / h)
        for way in (1.0, -1.0):
            place = [
                -cross / h + way * size / slope
                for cross, slope in zip((yz, xz, xy), slopes, strict=True)
            ]
            inside = np.ones(len(cells), bool)
            for coordinate in place:
                inside &= (0 < coordinate) & (coordinate < 1)
            u, v, w = place
            height = one + x * u + y * v + z * w + xy * u * v + xz * u * w + yz * v * w
            height = height + h * u * v * w
            bends = (xy + h * w) * (xz + h * v) * (yz + h * u)
            found = inside & (height >= isovalue)
            total -= int(np.sign(bends[found]).sum())
    return total


def _powers(cells: Floats) -> Floats:
    """(8, n) the coefficients of 1, z, y, yz, x, xz, xy, xyz of cells (n, 8) in C order."""
    found = cells.reshape(-1, 2, 2, 2).copy()
    found[:, 1] -= found[:, 0]
    found[:, :, 1] -= found[:, :, 0]
    found[:, :, :, 1] -= found[:, :, :, 0]
    return found.reshape(-1, 8).T
