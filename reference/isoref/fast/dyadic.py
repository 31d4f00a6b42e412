"""The dyadic tree, vectorised: the boxes and the mesh of `isoref.dyadic`.

All boxes of a level are tested together, a block at a time, and each sample is asked for once a
block. Slopes box by box come from a pyramid of maxima: of cells, of blocks of 2^n cells, and so on.
Levels of boxes that would not fit into the memory there is are refused beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from isoref.dyadic import (
    Bound,
    Samples,
    SlopeBound,
    Test,
    Tree,
    absolute_steps,
    check_bound,
    clipped,
    corner_numbers,
)
from isoref.fast.simplicial import (
    allowed_memory,
    check_memory,
    section_of_cells,
    sign_bits,
    straddles,
    weld,
)
from isoref.field import Booleans, Field, Floats, Integers
from isoref.kuhn import corner_offsets, strides
from isoref.mesh import Mesh
from isoref.simplicial import (
    Complex,
    Isovalue,
    check_input,
    checked_values,
    levels,
    to_mesh,
    zeroed,
)

# Boxes tested at once with all their corners: what fits the cache matters more than the number.
BLOCK = 1 << 15

# Bytes of a box and an axis while a level is made: the corners before and after boxes beyond the
# lattice are left out, and the corners that are kept.
BOX_BYTES = 3 * 8


def local_slopes(field: Field, memory: int | None = None) -> SlopeBound:
    """The slopes of each box by a look-up in a pyramid; see `isoref.dyadic.local_slopes`.

    It takes about n + 2 times the memory of the field as float64, of the bytes in `memory` or of
    what the machine has free; a `FieldError` says beforehand where that is too little.
    """
    m, n = field.components, field.dimension
    needed = (n + 2) * field.values.size * 8
    check_memory(needed, allowed_memory(memory), f"a look-up of slopes over {field.shape} samples")
    cells = np.empty((m, n, *(N - 1 for N in field.shape)))
    for axis in range(n):
        cells[:, axis] = _to_cells(absolute_steps(field, axis), axis)
    pyramid = [cells]
    while max(pyramid[-1].shape[2:]) > 1:
        pyramid.append(_halved(pyramid[-1]))

    def slopes(low: Integers, high: Integers) -> Floats:
        side = int((high - low).max(initial=1))
        level = (side - 1).bit_length()
        block = tuple((low >> level).T)
        return np.moveaxis(pyramid[min(level, len(pyramid) - 1)][:, :, *block], -1, 0)

    return SlopeBound(slopes)


def _to_cells(steps: Floats, axis: int) -> Floats:
    """For each cell the maximum of `steps` over its edges along `axis`."""
    for other in range(1, steps.ndim):
        if other != 1 + axis:
            low = (slice(None),) * other + (slice(None, -1),)
            high = (slice(None),) * other + (slice(1, None),)
            steps = np.maximum(steps[low], steps[high])
    return steps


def _halved(blocks: Floats) -> Floats:
    """Maxima over blocks of two along every axis but the first two."""
    for axis in range(2, blocks.ndim):
        even = np.arange(0, blocks.shape[axis], 2)
        blocks = np.maximum.reduceat(blocks, even, axis=axis)
    return blocks


def dyadic_tree(
    samples: Samples,
    bound: Bound,
    isovalue: Isovalue = 0.0,
    test: Test = "centre",
    memory: int | None = None,
) -> Tree:
    """The tree of boxes that may meet the isosurface; see `isoref.dyadic.dyadic_tree`.

    Besides, `memory` says how many bytes may be used; what the machine has free by default. A level
    of boxes that is too large for it raises a FieldError before it is made.
    """
    check_input(samples.shape, samples.components)
    level = levels(isovalue, samples.components)
    allowed = allowed_memory(memory)
    n, cells = len(samples.shape), np.array(samples.shape) - 1
    probe = _Prober(samples, bound, level, test)
    side = 1 << int(cells.max() - 1).bit_length()
    low = np.zeros((1, n), np.int64)
    sides: list[int] = []
    boxes: list[Integers] = []
    tested = 0
    while True:
        tested += len(low)
        low = low[probe.may_meet(low, side)]
        sides.append(side)
        boxes.append(low)
        if side == 1:
            return Tree(sides, boxes, tested)
        side //= 2
        children = len(low) << n
        check_memory(BOX_BYTES * n * children, allowed, f"a level of {children:,} boxes")
        low = (low[:, None] + side * corner_offsets(n)).reshape(-1, n)
        low = low[(low < cells).all(axis=1)]


def extract_dyadic(
    samples: Samples,
    bound: Bound,
    isovalue: Isovalue = 0.0,
    *,
    test: Test = "centre",
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
) -> Mesh:
    """The mesh from the leaves of the tree alone; see `isoref.dyadic.extract_dyadic`."""
    tree = dyadic_tree(samples, bound, isovalue, test, memory)
    return to_mesh(
        section_of_leaves(samples, tree, isovalue, rule, epsilon, memory),
        samples.spacing,
        samples.origin,
    )


def section_of_leaves(
    samples: Samples,
    tree: Tree,
    isovalue: Isovalue = 0.0,
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
) -> Complex:
    """The isosurface in the leaves of a tree, as a complex whose simplices know their parents."""
    level = levels(isovalue, samples.components)

    def sample(numbers: Integers) -> Floats:
        return zeroed(samples.at(numbers) - level, epsilon)

    cells = tree.leaves @ strides(samples.shape)
    return section_of_cells(samples.shape, cells, sample, rule, epsilon, memory)


@dataclass(frozen=True, eq=False)
class _Prober:
    """Tests boxes with one bound in one way."""

    samples: Samples
    bound: Bound
    level: Floats
    test: str

    def may_meet(self, low: Integers, side: int) -> Booleans:
        """Which boxes, low corners (B, n), cannot be ruled out."""
        in_cells = self._by_signs if side == 1 else self._by_centre
        one = self._by_corners if self.test == "corners" else in_cells
        high = clipped(low, side, self.samples.shape)
        kept = [
            one(low[start : start + BLOCK], high[start : start + BLOCK])
            for start in range(0, len(low), BLOCK)
        ]
        return np.concatenate([np.zeros(0, bool), *kept])

    def _values(self, numbers: Integers) -> Floats:
        """Phi minus the isovalue at samples of any shape (..), each computed once: (.., m)."""
        distinct, places = weld(numbers.ravel())
        values = self._minus_level(distinct)
        return np.asarray(values[places].reshape(*numbers.shape, values.shape[1]))

    def _minus_level(self, numbers: Integers) -> Floats:
        """Phi minus the isovalue at samples (P,), (P, m)."""
        return checked_values(self.samples.at(numbers) - self.level)

    def _by_corners(self, low: Integers, high: Integers) -> Booleans:
        """The paper's test."""
        values = self._values(corner_numbers(low, high, self.samples.shape))
        spread = self.bound.spread(high - low, low, high)
        self._check(np.ptp(values, axis=1), spread, low, high)
        return np.asarray((np.abs(values).max(axis=1) <= spread).all(axis=1))

    def _by_centre(self, low: Integers, high: Integers) -> Booleans:
        """The tighter test; the highest corner is asked too, to check the bound."""
        centre, step = (low + high) // 2, strides(self.samples.shape)
        middle, corner = self._values(centre @ step), self._values(high @ step)
        reach = self.bound.spread(high - centre, low, high)
        self._check(np.abs(corner - middle), reach, centre, high)
        return np.asarray((np.abs(middle) <= reach).all(axis=1))

    def _by_signs(self, low: Integers, high: Integers) -> Booleans:
        """The test of cells: signs at all corners, asked where the lowest one leaves it open."""
        near = np.flatnonzero(self._by_centre(low, high))
        numbers = corner_numbers(low[near], high[near], self.samples.shape)
        distinct, places = weld(numbers.ravel())
        values, places = self._minus_level(distinct), places.reshape(numbers.shape)
        crossed = straddles(sign_bits(values)[places].T, values.shape[1])
        kept = np.zeros(len(low), bool)
        kept[near[crossed]] = True
        spread = self.bound.spread((high - low)[kept], low[kept], high[kept])
        self._check(np.ptp(values[places[crossed]], axis=1), spread, low[kept], high[kept])
        return kept

    def _check(self, change: Floats, spread: Floats, low: Integers, high: Integers) -> None:
        """Raise FieldError unless the samples of each box change as the bound allows."""
        wrong = np.flatnonzero((change > spread * (1 + 1e-9)).any(axis=1))
        if len(wrong):
            box = int(wrong[0])
            check_bound(change[box], spread[box], low[box], high[box])
