r"""Isosurfaces from a dyadic tree, which looks only where the surface can be.

A uniform grid has N^n samples, an isosurface of dimension n - m meets about N^(n-m) cells of it.
If samples cannot change faster than a known bound, one sample far from the isovalue rules out a
whole block of cells. So start with one box, drop it if the bound says so, halve it along every
axis otherwise, and do the same with the 2^n parts, down to single cells::

    +-------+---+---+      sides 4, 2, 1; boxes without a letter were dropped,
    |       |   |   |      those with one are cells that may meet the surface
    |       +---+-+-+
    |       |   |x|x|
    +-------+---+-+-+
    |       |  x|x| |
    ..

Samples may come from an array or from a function that is called only where it is asked.

Two things may be chosen: what is known of the samples, and where they are tested.

`LipschitzBound`  one constant L for all axes and components, as in the paper
`SlopeBound`      a slope for each component along each axis, the same everywhere or of each box

`corners`   (the paper) a box goes if phi at one of its corners is farther from 0 than phi can
            change across the whole box
`centre`    it goes if phi at its middle sample is farther from 0 than phi can change from the
            middle to a corner: half as far, and two samples instead of 2^n (the second, at the
            highest corner, only checks the bound). Cells have no middle sample; those that the
            bound leaves go too unless every component takes both signs on their corners

Both are safe. Let x be a point of the box: phi^(x) is an average of samples phi(w) at samples w
of the box. If phi(v) is farther from 0 than phi can change from v to any w, then all phi(w)
have the sign of phi(v) in that component, and so has their average: x is not on the surface.

A box of side s is kept where a tube of width ~ s round the surface reaches, so a level has about
s^(m-n) boxes: 2^(n-m) times those of the level above. On the first levels the tube is the whole
domain and nothing goes. The counts of boxes tested follow the law from where the tube is slim;
those of leaves do so from the start.

Glossary
--------
side        edge of a box in sample steps, a power of two; boxes end at the border of the lattice
extent      edges of a box in sample steps, one an axis
L           Lipschitz constant: max |phi(b) - phi(a)| / |b - a|, both in the maximum norm
spread      the most a component can differ between samples this far apart
leaf        a box of side 1 that was kept: a cell

Invariants
----------
The leaves contain every cell that the isosurface meets, so the mesh is that of the uniform grid,
to the last bit, if the bound is true. A bound that is too small is detected where the samples of
one test contradict it: all corners of a box, or its middle and its highest corner, and all corners
of a leaf. Where no sample was asked for it cannot be.

References
----------
1. C. Min, 2003: section 6, Figure 3.
2. J. Strain, "Tree methods for moving interfaces", J. Comput. Phys. 151, 1999.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, Protocol

import numpy as np

from isoref.field import Booleans, Field, FieldError, Floats, Integers
from isoref.kuhn import corner_offsets, strides
from isoref.mesh import Mesh
from isoref.simplicial import (
    Complex,
    Isovalue,
    Sampler,
    allowed_memory,
    check_input,
    check_memory,
    checked_values,
    levels,
    section_of_cells,
    sign_bits,
    straddles,
    to_mesh,
    weld,
    zeroed,
)

Function = Callable[[Floats], Floats]
Slopes = Callable[[Integers, Integers], Floats]

# Boxes tested at once with all their corners: what fits the cache matters more than the number.
BLOCK = 1 << 15

# Bytes of a box and an axis while a level is made: the corners before and after boxes beyond the
# lattice are left out, and the corners that are kept.
BOX_BYTES = 3 * 8


@dataclass(frozen=True, eq=False)
class Samples:
    """A lattice and a way to the samples on it, asked by number (C order).

    Attributes
    ----------
    shape, spacing, origin : the lattice, as of a `Field`
    components : m
    at : gives the values (P, m) of the samples with numbers (P,)
    """

    shape: tuple[int, ...]
    spacing: tuple[float, ...]
    origin: tuple[float, ...]
    components: int
    at: Sampler

    @classmethod
    def of_field(cls, field: Field) -> Samples:
        """The samples of a field."""
        flat = field.values.reshape(field.components, -1)
        return cls(
            field.shape,
            field.spacing,
            field.origin,
            field.components,
            lambda numbers: flat[:, numbers].T.astype(np.float64),
        )

    @classmethod
    def of_function(
        cls,
        function: Function,
        shape: Sequence[int],
        spacing: float | Sequence[float] = 1.0,
        origin: Sequence[float] | None = None,
    ) -> Samples:
        """The samples of a function of positions (P, n) with values (P, m), none computed yet.

        Raises
        ------
        FieldError
            for values that are not (P, m), finite or small enough to be interpolated; as soon as
            they turn up.

        >>> Samples.of_function(lambda x: x.sum(axis=1, keepdims=True), (3, 3)).at(np.array([5]))
        array([[3.]])
        """
        steps = np.broadcast_to(np.asarray(spacing, np.float64), (len(shape),))
        lattice = Field(np.empty(0), tuple(steps.tolist()), tuple(origin or [0.0] * len(shape)))

        def at(numbers: Integers) -> Floats:
            index = np.array(np.unravel_index(numbers, tuple(shape)), np.float64).T
            values = np.asarray(function(lattice.position(index)), np.float64)
            if values.ndim != 2 or len(values) != len(numbers):
                raise FieldError(
                    f"the function gave an array of shape {values.shape} "
                    f"for {len(numbers)} points; ({len(numbers)}, m) is needed"
                )
            return values

        m = at(np.zeros(1, np.int64)).shape[1]
        return cls(tuple(shape), lattice.spacing, lattice.origin, m, at)


class Bound(Protocol):
    """What is known of how fast samples change."""

    def spread(self, extent: Integers, low: Integers, high: Integers) -> Floats:
        """The most each component differs between samples `extent` (B, n) apart, (B, m) or (B, 1).

        `low` and `high` (B, n) are corners of boxes that hold both samples.
        """
        ...


@dataclass(frozen=True)
class LipschitzBound:
    """One constant: |phi(b) - phi(a)| <= L |b - a| in the maximum norm, in sample steps."""

    L: float

    def spread(self, extent: Integers, low: Integers, high: Integers) -> Floats:
        """L times the longest edge."""
        return np.asarray(self.L * extent.max(axis=1, keepdims=True), np.float64)


@dataclass(frozen=True, eq=False)
class SlopeBound:
    """A slope per sample step for each component along each axis.

    slopes : (m, n), or a function of boxes, low and high corners (B, n), that gives (B, m, n)
    """

    slopes: Floats | Slopes

    def spread(self, extent: Integers, low: Integers, high: Integers) -> Floats:
        """The sum over the axes of slope times edge: a way from sample to sample, axis by axis."""
        slopes = self.slopes(low, high) if callable(self.slopes) else self.slopes
        spread: Floats = np.matmul(slopes, extent[..., None].astype(np.float64))[..., 0]
        return spread


def lipschitz_constant(field: Field) -> float:
    """The constant L of section 6, in sample steps.

    Samples d steps apart in the maximum norm are joined by d steps to neighbours (diagonal ones
    too), so neighbours decide.

    >>> lipschitz_constant(Field.of([[0.0, 1.0], [1.0, 3.0]]))
    3.0
    """
    values = field.values.reshape(field.components, *field.shape).astype(np.float64)
    best = 0.0
    for move in product((-1, 0, 1), repeat=field.dimension):
        if move > (0,) * field.dimension:
            steps = list(zip(move, field.shape, strict=True))
            here = tuple(slice(max(0, -s), N - max(0, s)) for s, N in steps)
            there = tuple(slice(max(0, s), N - max(0, -s)) for s, N in steps)
            change = values[:, *there] - values[:, *here]
            best = max(best, float(np.abs(change).max(initial=0)))
    return best


def global_slopes(field: Field) -> SlopeBound:
    """The largest change of each component in one step along each axis.

    >>> global_slopes(Field.of([[0.0, 1.0], [1.0, 3.0]])).slopes
    array([[2., 2.]])
    """
    axes = range(field.dimension)
    largest = [_steps(field, axis).reshape(field.components, -1).max(axis=1) for axis in axes]
    return SlopeBound(np.stack(largest, axis=1))


def local_slopes(field: Field, memory: int | None = None) -> SlopeBound:
    """The largest change of each component in one step along each axis, box by box.

    Maxima of cells, of blocks of 2^n cells, and so on: a look-up for every box of the tree. It
    takes about n + 2 times the memory of the field as float64, of the bytes in `memory` or of
    what the machine has free; a `FieldError` says beforehand where that is too little.
    """
    m, n = field.components, field.dimension
    needed = (n + 2) * field.values.size * 8
    check_memory(needed, allowed_memory(memory), f"a look-up of slopes over {field.shape} samples")
    cells = np.empty((m, n, *(N - 1 for N in field.shape)))
    for axis in range(n):
        cells[:, axis] = _to_cells(_steps(field, axis), axis)
    pyramid = [cells]
    while max(pyramid[-1].shape[2:]) > 1:
        pyramid.append(_halved(pyramid[-1]))

    def slopes(low: Integers, high: Integers) -> Floats:
        side = int((high - low).max(initial=1))
        level = (side - 1).bit_length()
        block = tuple((low >> level).T)
        return np.moveaxis(pyramid[min(level, len(pyramid) - 1)][:, :, *block], -1, 0)

    return SlopeBound(slopes)


def _steps(field: Field, axis: int) -> Floats:
    """The absolute change of each sample to the next one along `axis`, (m, N1, .., Nn)."""
    values = field.values.reshape(field.components, *field.shape).astype(np.float64, copy=False)
    steps = np.diff(values, axis=1 + axis)
    return np.abs(steps, out=steps)


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


@dataclass(frozen=True, eq=False)
class Tree:
    """What is left of the boxes, level by level.

    Attributes
    ----------
    sides : side of the boxes of each level, falling to 1
    boxes : for each level the low corners (B, n) of the boxes that were kept
    tested : number of boxes that were tested, on all levels
    """

    sides: list[int]
    boxes: list[Integers]
    tested: int

    @property
    def leaves(self) -> Integers:
        """The low corners of the cells that may meet the surface, (C, n)."""
        return self.boxes[-1]

    def stored_samples(self, shape: tuple[int, ...]) -> int:
        """The number of distinct corners of all boxes: the domain D of section 6."""
        numbers = [
            np.unique(corner_numbers(low, clipped(low, side, shape), shape))
            for side, low in zip(self.sides, self.boxes, strict=True)
        ]
        return len(np.unique(np.concatenate(numbers)))


def clipped(low: Integers, side: int, shape: tuple[int, ...]) -> Integers:
    """The high corners of boxes of this side, none beyond the lattice."""
    return np.asarray(np.minimum(low + side, np.array(shape) - 1))


def corner_numbers(low: Integers, high: Integers, shape: tuple[int, ...]) -> Integers:
    """The numbers of the 2^n corner samples of boxes, (B, 2^n)."""
    step = strides(shape)
    offsets = ((high - low) * step) @ corner_offsets(len(shape)).T
    return np.asarray((low @ step)[:, None] + offsets)


def dyadic_tree(
    samples: Samples,
    bound: Bound,
    isovalue: Isovalue = 0.0,
    test: Literal["corners", "centre"] = "centre",
    memory: int | None = None,
) -> Tree:
    """The tree of boxes that may meet the isosurface (section 6).

    Raises
    ------
    FieldError
        for bad samples, where two samples contradict the bound, or before a level of boxes that
        is too large for the memory.
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
    test: Literal["corners", "centre"] = "centre",
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
) -> Mesh:
    """The mesh of `isoref.simplicial.extract`, from the leaves of the tree alone.

    Parameters are those of `extract` and of `dyadic_tree`.

    >>> i = np.indices((65, 65))
    >>> field = Field.of(((i - 32.5) ** 2).sum(axis=0))
    >>> extract_dyadic(Samples.of_field(field), local_slopes(field), 300.0)
    Mesh(234 vertices in R^2, 234 simplices of dimension 1)
    """
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
        """Nothing, where samples change by no more than the bound says; else a `FieldError`."""
        wrong = np.argwhere(change > spread * (1 + 1e-9))
        if len(wrong):
            box, c = (int(i) for i in wrong[0])
            allowed = np.broadcast_to(spread, change.shape)[box, c]
            raise FieldError(
                f"the bound is too small: component {c} changes by {change[box, c]:.6g} between "
                f"samples of the box from {low[box].tolist()} to {high[box].tolist()}, "
                f"the bound allows {allowed:.6g}"
            )
