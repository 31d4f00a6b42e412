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
`isoref.fast.dyadic` is the vectorised twin: the same boxes in the same order, the same mesh.

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
[1] C. Min, 2003: section 6, Figure 3.
[2] J. Strain, "Tree methods for moving interfaces", J. Comput. Phys. 151, 1999.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, Protocol

import numpy as np

from isoref.field import Field, FieldError, Floats, Integers
from isoref.kuhn import corner_offsets, strides
from isoref.mesh import Mesh
from isoref.simplicial import (
    Complex,
    Isovalue,
    Sampler,
    check_input,
    checked_values,
    levels,
    section_of_cells,
    takes_both_signs,
    to_mesh,
    zeroed,
)

Function = Callable[[Floats], Floats]
Slopes = Callable[[Integers, Integers], Floats]
Test = Literal["corners", "centre"]


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
        # Place the lattice.
        steps = np.broadcast_to(np.asarray(spacing, np.float64), (len(shape),))
        lattice = Field(np.empty(0), tuple(steps.tolist()), tuple(origin or [0.0] * len(shape)))

        # Ask the function where a sample is asked for.
        def at(numbers: Integers) -> Floats:
            index = np.array(np.unravel_index(numbers, tuple(shape)), np.float64).T
            values = np.asarray(function(lattice.position(index)), np.float64)
            if values.ndim != 2 or len(values) != len(numbers):
                raise FieldError(
                    f"the function gave an array of shape {values.shape} "
                    f"for {len(numbers)} points; ({len(numbers)}, m) is needed"
                )
            return values

        # Count the components.
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

    def __post_init__(self) -> None:
        """Raise FieldError for a constant that bounds nothing."""
        check_slopes(np.array(self.L))

    def spread(self, extent: Integers, low: Integers, high: Integers) -> Floats:
        """L times the longest edge."""
        return np.asarray(self.L * extent.max(axis=1, keepdims=True), np.float64)


@dataclass(frozen=True, eq=False)
class SlopeBound:
    """A slope per sample step for each component along each axis.

    slopes : (m, n), or a function of boxes, low and high corners (B, n), that gives (B, m, n)
    """

    slopes: Floats | Slopes

    def __post_init__(self) -> None:
        """Raise FieldError for slopes that bound nothing; those of boxes are asked box by box."""
        if not callable(self.slopes):
            check_slopes(np.asarray(self.slopes))

    def spread(self, extent: Integers, low: Integers, high: Integers) -> Floats:
        """The sum over the axes of slope times edge: a way from sample to sample, axis by axis."""
        slopes = self.slopes
        if callable(slopes):
            slopes = slopes(low, high)
            check_slopes(np.asarray(slopes))
        spread: Floats = np.matmul(slopes, extent[..., None].astype(np.float64))[..., 0]
        return spread


def check_slopes(slopes: Floats) -> None:
    """Raise FieldError unless every slope is a number of at least 0; infinity rules nothing out."""
    wrong = np.asarray(slopes)[~(np.asarray(slopes) >= 0)]
    if wrong.size:
        raise FieldError(
            f"a slope or Lipschitz constant of {wrong.flat[0]} bounds nothing: give the largest "
            "change in one sample step, 0 or more, or infinity where none is known"
        )


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
    largest = [
        absolute_steps(field, axis).reshape(field.components, -1).max(axis=1) for axis in axes
    ]
    return SlopeBound(np.stack(largest, axis=1))


def absolute_steps(field: Field, axis: int) -> Floats:
    """The absolute change of each sample to the next one along `axis`, (m, N1, .., Nn)."""
    values = field.values.reshape(field.components, *field.shape).astype(np.float64, copy=False)
    steps = np.diff(values, axis=1 + axis)
    return np.abs(steps, out=steps)


def local_slopes(field: Field) -> SlopeBound:
    """The largest change of each component in one step along each axis, box by box."""
    values = field.values.reshape(field.components, *field.shape).astype(np.float64)

    def slopes(low: Integers, high: Integers) -> Floats:
        found = np.empty((len(low), field.components, field.dimension))
        for b in range(len(low)):
            box = tuple(slice(i, j + 1) for i, j in zip(low[b], high[b], strict=True))
            for axis in range(field.dimension):
                steps = np.abs(np.diff(values[:, *box], axis=1 + axis))
                found[b, :, axis] = steps.reshape(field.components, -1).max(axis=1)
        return found

    return SlopeBound(slopes)


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
    return np.asarray(np.minimum(low + side, np.array(shape) - 1), np.int64)


def corner_numbers(low: Integers, high: Integers, shape: tuple[int, ...]) -> Integers:
    """The numbers of the 2^n corner samples of boxes, (B, 2^n)."""
    step = strides(shape)
    offsets = ((high - low) * step) @ corner_offsets(len(shape)).T
    return np.asarray((low @ step)[:, None] + offsets)


def dyadic_tree(
    samples: Samples,
    bound: Bound,
    isovalue: Isovalue = 0.0,
    test: Test = "centre",
) -> Tree:
    """The tree of boxes that may meet the isosurface (section 6).

    Parameters
    ----------
    samples : a lattice with m components
    bound : what is known of them
    isovalue : one number for all components, or one a component
    test : where a box is tested; see the module's text

    Raises
    ------
    FieldError
        for bad samples, or where two samples contradict the bound.
    """
    check_input(samples.shape, samples.components)
    level = levels(isovalue, samples.components)
    n, cells = len(samples.shape), np.array(samples.shape) - 1

    # Start with one box that holds the whole lattice.
    side = 1 << int(cells.max() - 1).bit_length()
    waiting = [np.zeros(n, np.int64)]
    sides: list[int] = []
    boxes: list[Integers] = []
    tested = 0
    while True:
        # Drop the boxes that the surface cannot meet.
        kept = [low for low in waiting if may_meet(samples, bound, level, low, side, test)]
        tested += len(waiting)
        sides.append(side)
        boxes.append(np.array(kept, np.int64).reshape(-1, n))
        if side == 1:
            return Tree(sides, boxes, tested)

        # Halve the others along every axis, and leave out what lies beyond the lattice.
        side //= 2
        parts = [low + side * offset for low in kept for offset in corner_offsets(n)]
        waiting = [low for low in parts if (low < cells).all()]


def may_meet(
    samples: Samples, bound: Bound, level: Floats, low: Integers, side: int, test: Test
) -> bool:
    """Whether the box of this side with low corner (n,) may meet the isosurface."""
    high = clipped(low, side, samples.shape)
    corners = corner_numbers(low[None], high[None], samples.shape)[0]
    spread = bound.spread((high - low)[None], low[None], high[None])[0]

    def phi(numbers: Integers) -> Floats:
        return checked_values(samples.at(numbers) - level)

    # The paper's test: is a corner farther from 0 than phi can change across the box?
    if test == "corners":
        values = phi(corners)
        check_bound(np.ptp(values, axis=0), spread, low, high)
        return bool((np.abs(values).max(axis=0) <= spread).all())

    # The tighter test: is the middle farther from 0 than phi can change from there to a corner?
    centre, step = (low + high) // 2, strides(samples.shape)
    reach = bound.spread((high - centre)[None], low[None], high[None])[0]
    middle, corner = phi(np.array([centre @ step, high @ step]))
    check_bound(np.abs(corner - middle), reach, centre, high)
    if not (np.abs(middle) <= reach).all():
        return False
    if side > 1:
        return True

    # A cell stays only where every component takes both signs on its corners.
    values = phi(corners)
    crossed = takes_both_signs(values)
    if crossed:
        check_bound(np.ptp(values, axis=0), spread, low, high)
    return crossed


def check_bound(change: Floats, spread: Floats, low: Integers, high: Integers) -> None:
    """Raise FieldError unless the samples of a box change by no more than the bound says.

    `change` and `spread` have one number a component, (m,); `spread` may have one for all.
    """
    wrong = np.flatnonzero(change > spread * (1 + 1e-9))
    if len(wrong):
        c = int(wrong[0])
        allowed = np.broadcast_to(spread, change.shape)[c]
        raise FieldError(
            f"the bound is too small: component {c} changes by {change[c]:.6g} between "
            f"samples of the box from {low.tolist()} to {high.tolist()}, "
            f"the bound allows {allowed:.6g}"
        )


def extract_dyadic(
    samples: Samples,
    bound: Bound,
    isovalue: Isovalue = 0.0,
    *,
    test: Test = "centre",
    rule: str = "staircase",
    epsilon: float | None = None,
) -> Mesh:
    """The mesh of `isoref.simplicial.extract`, from the leaves of the tree alone.

    Parameters and errors are those of `extract` and of `dyadic_tree`.

    >>> i = np.indices((17, 17))
    >>> field = Field.of(((i - 8.5) ** 2).sum(axis=0))
    >>> extract_dyadic(Samples.of_field(field), local_slopes(field), 20.0)
    Mesh(58 vertices in R^2, 58 simplices of dimension 1)
    """
    tree = dyadic_tree(samples, bound, isovalue, test)
    complex_ = section_of_leaves(samples, tree, isovalue, rule, epsilon)
    return to_mesh(complex_, samples.spacing, samples.origin)


def section_of_leaves(
    samples: Samples,
    tree: Tree,
    isovalue: Isovalue = 0.0,
    rule: str = "staircase",
    epsilon: float | None = None,
) -> Complex:
    """The isosurface in the leaves of a tree, as a complex whose simplices know their parents."""
    level = levels(isovalue, samples.components)

    def sample(numbers: Integers) -> Floats:
        return zeroed(samples.at(numbers) - level, epsilon)

    cells = np.sort(tree.leaves @ strides(samples.shape))
    return section_of_cells(samples.shape, cells, sample, rule, epsilon)
