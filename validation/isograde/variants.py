"""Variants: the same case posed in another way, whose answer is known from the plain one.

A variant takes a field and an isovalue and gives another pair, or nothing where the values do not
allow it: half integers are no bytes, and a shift that loses digits would be another case. Where it
moves the samples it also says how to bring index coordinates back, so that answers can be laid
over the plain one.

Variants that pose bad input (`nan`, `rank-2`, ..) build a `Field` that `Field.of` would refuse: it
is the implementation's answer to it that is judged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import permutations, product

import numpy as np
from isoref.field import Array, Field, Floats

Posed = tuple[Field, float] | None
LETTERS = "xyz"


@dataclass(frozen=True)
class Variant:
    """One way to pose a case.

    name : as claims and reports name it
    meaning : what is changed, for a reader
    pose : the changed field and isovalue, or None where the values do not allow it
    back : index coordinates of the plain field, given those of the changed one and the plain field
    reflects : it exchanges left and right, so that faces must be turned over on the way back
    """

    name: str
    meaning: str
    pose: Callable[[Field, float], Posed]
    back: Callable[[Floats, Field], Floats] = lambda places, _: places
    reflects: bool = False


def pose(name: str, field: Field, isovalue: float) -> Posed:
    """The field and isovalue of the variant of this name, or None where there is none.

    >>> pose("scale", Field.of([[[1, 2]]]), 1.5)[1]
    6.0
    """
    return (field, isovalue) if name == "plain" else VARIANTS[name].pose(field, isovalue)


def _repeat(field: Field, isovalue: float) -> Posed:
    """The same once more."""
    return field, isovalue


def _scale(field: Field, isovalue: float) -> Posed:
    """Four times the values: a power of two, so that nothing rounds."""
    values = 4 * _floats(field.values)
    return (replace(field, values=values), 4 * isovalue) if np.isfinite(values).all() else None


def _shift(field: Field, isovalue: float) -> Posed:
    """All values moved up by about their size, if no difference that counts is lost."""
    values = _floats(field.values)
    size = float(np.abs(values.astype(np.float64) - isovalue).max())
    step = 2.0 ** np.ceil(np.log2(size)) if size > 0 else 1.0
    moved, level = values + values.dtype.type(step), isovalue + step
    same_side = np.sign(moved - level) == np.sign(values.astype(np.float64) - isovalue)
    return (replace(field, values=moved), float(level)) if same_side.all() else None


def _level(field: Field, isovalue: float) -> Posed:
    """Every sample about 1 from the isovalue, now 0, and each crossing in the middle of its edge.

    What is left of the values is a quarter of a thousandth at most, in proportion. On an ambiguous
    face two ones and two minus ones cancel, so the average of its samples keeps its side.
    """
    with np.errstate(over="ignore"):
        away = field.values.astype(np.float64) - isovalue
    largest = float(np.abs(away).max())
    if not np.isfinite(largest):
        return None
    values = np.where(away >= 0, 1.0, -1.0) + 2.0**-12 * away / max(largest, 1e-300)
    return replace(field, values=values), 0.0


def _floats(values: Array) -> Array:
    """Floating samples as they are, any others in double precision."""
    return values if values.dtype.kind == "f" else values.astype(np.float64)


def _translate(field: Field, isovalue: float) -> Posed:
    """The field inside a larger one, one sample further along each axis; the rim repeats it."""
    return replace(field, values=np.pad(field.values, (1, 2), mode="edge")), isovalue


def _space(field: Field, isovalue: float) -> Posed:
    """Three different spacings."""
    spacing = tuple(s * f for s, f in zip(field.spacing, (0.5, 3.0, 1.25), strict=True))
    return replace(field, spacing=spacing), isovalue


def _fortran(field: Field, isovalue: float) -> Posed:
    """The first axis fastest in memory."""
    return replace(field, values=np.asfortranarray(field.values)), isovalue


def _strided(field: Field, isovalue: float) -> Posed:
    """Every second element of a larger array, along its first and last axes."""
    wide = np.repeat(np.repeat(field.values, 2, axis=0), 2, axis=2)
    return replace(field, values=wide[::2, :, ::2]), isovalue


def _backwards(field: Field, isovalue: float) -> Posed:
    """A view that runs backwards through memory."""
    return replace(field, values=np.ascontiguousarray(field.values[:, ::-1])[:, ::-1]), isovalue


def _as_type(kind: str) -> Callable[[Field, float], Posed]:
    """The same numbers in another type, where it holds them all and the isovalue is unharmed."""

    def pose(field: Field, isovalue: float) -> Posed:
        kept = field.values.dtype
        if kept == np.dtype(kind) or not _holds(kind, field.values):
            return None
        return replace(field, values=field.values.astype(kind)), isovalue

    return pose


def _holds(kind: str, values: Array) -> bool:
    """Whether every value is a number of this type."""
    if np.dtype(kind).kind in "iu":
        span = np.iinfo(kind)
        if values.min() < span.min or values.max() > span.max:
            return False
    with np.errstate(over="ignore"):
        return bool((values.astype(kind) == values).all())


def _nan(field: Field, isovalue: float) -> Posed:
    """One sample is not a number."""
    values = _floats(field.values).copy()
    values[tuple(n // 2 for n in values.shape)] = np.nan
    return replace(field, values=values), isovalue


def _beyond(direction: int) -> Callable[[Field, float], Posed]:
    """An isovalue above every sample, or below."""

    def pose(field: Field, isovalue: float) -> Posed:
        low, high = float(field.values.min()), float(field.values.max())
        margin = max(high - low, 1.0)
        return field, high + margin if direction > 0 else low - margin

    return pose


def _flat(field: Field, isovalue: float) -> Posed:
    """The first plane of the field with values on both sides, instead of the field."""
    for plane in field.values:
        if (plane < isovalue).any() and (plane > isovalue).any():
            return Field(plane, field.spacing[1:], field.origin[1:]), isovalue
    return None


def _nothing(field: Field, isovalue: float) -> Posed:
    """No samples at all."""
    return replace(field, values=field.values[:0]), isovalue


def _no_isovalue(field: Field, isovalue: float) -> Posed:
    """An isovalue that is not a number."""
    return field, float("nan")


def _symmetry(order: tuple[int, ...], mirrored: tuple[bool, ...]) -> Variant:
    """Axes in another order, those marked run backwards.

    Axis a of the variant is axis ``order[a]`` of the plain field, mirrored where ``mirrored[a]``.
    """
    name = "".join(
        LETTERS[axis].upper() if flip else LETTERS[axis]
        for axis, flip in zip(order, mirrored, strict=True)
    )
    steps = tuple(slice(None, None, -1 if flip else 1) for flip in mirrored)

    def pose(field: Field, isovalue: float) -> Posed:
        values = np.ascontiguousarray(field.values.transpose(order)[steps])
        spacing = tuple(field.spacing[axis] for axis in order)
        origin = tuple(field.origin[axis] for axis in order)
        return Field(values, spacing, origin), isovalue

    def back(places: Floats, field: Field) -> Floats:
        last = np.subtract([field.shape[axis] for axis in order], 1.0)
        there = np.where(mirrored, last - places, places)
        plain: Floats = there[:, np.argsort(order)]
        return plain

    turns = sum(order[i] > order[j] for i in range(3) for j in range(i + 1, 3)) + sum(mirrored)
    return Variant(
        f"symmetry/{name}",
        f"axes {name}: in this order, capitals backwards",
        pose,
        back,
        turns % 2 == 1,
    )


SYMMETRIES: tuple[Variant, ...] = tuple(
    _symmetry(order, mirrored)
    for order in permutations(range(3))
    for mirrored in product((False, True), repeat=3)
    if (order, any(mirrored)) != ((0, 1, 2), False)
)

VARIANTS: Mapping[str, Variant] = {
    variant.name: variant
    for variant in (
        Variant("repeat", "asked a second time", _repeat),
        Variant("scale", "values and isovalue times four", _scale),
        Variant("shift", "values and isovalue plus a power of two near their size", _shift),
        Variant("level", "samples about 1 or -1, isovalue 0: crossings in the middle", _level),
        Variant(
            "translate",
            "inside a larger grid, one sample further along each axis",
            _translate,
            lambda places, _: places - 1.0,
        ),
        Variant("spacing", "spacing times (1/2, 3, 5/4)", _space),
        Variant("fortran", "first axis fastest in memory", _fortran),
        Variant("strided", "every second element of a larger array", _strided),
        Variant("backwards", "a view that runs backwards through memory", _backwards),
        Variant("float32", "samples in single precision", _as_type("float32")),
        Variant("float64", "samples in double precision", _as_type("float64")),
        Variant("int16", "samples as 16-bit integers", _as_type("int16")),
        Variant("uint8", "samples as bytes", _as_type("uint8")),
        Variant("nan", "the middle sample is not a number", _nan),
        Variant("above", "an isovalue above every sample", _beyond(1)),
        Variant("below", "an isovalue below every sample", _beyond(-1)),
        Variant("rank-2", "a plane of samples", _flat),
        Variant("no-samples", "an array without samples", _nothing),
        Variant("isovalue-nan", "an isovalue that is not a number", _no_isovalue),
        *SYMMETRIES,
    )
}
