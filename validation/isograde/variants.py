"""Variants: the same case posed in another way, whose answer is known from the plain one.

A variant takes a field and its isovalues and gives others, or nothing where the values do not allow
it: half integers are no bytes, and a shift that loses digits would be another case. Where it moves
the samples it also says how to bring index coordinates back, so that answers can be laid over the
plain one. All are said for any number of axes and components.

Variants that pose bad input (`nan`, `rank`, ..) build a `Field` that `Field.of` would refuse: it is
the implementation's answer to it that is judged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import permutations, product

import numpy as np
from isoref.field import Array, Field, Floats

from isograde.model import Calls, Case, Kind

Isovalues = tuple[float, ...]
Posed = tuple[Field, Isovalues] | None
LETTERS = "xyzwvutsrq"
# Up to so many axes a field is posed under every symmetry of the cube; beyond, under generators.
EVERY_SYMMETRY = 3


@dataclass(frozen=True)
class Variant:
    """One way to pose a case.

    name : as claims and reports name it
    meaning : what is changed, for a reader
    pose : the changed field and isovalues, or None where the values do not allow it
    back : index coordinates of the plain field, given those of the changed one and the plain field
    reflects : it exchanges left and right, so that simplices must be turned over on the way back
    calls : how the implementation is called, as in `isograde.model.Request`
    """

    name: str
    meaning: str
    pose: Callable[[Field, Isovalues], Posed]
    back: Callable[[Floats, Field], Floats] = lambda places, _: places
    reflects: bool = False
    calls: Calls = "once"


def pose(name: str, case: Case, field: Field) -> Posed:
    """The field and isovalues of a variant of a case, or None where the values do not allow it."""
    if name == "plain":
        return field, case.isovalues
    return variant(name, case.kind).pose(field, case.isovalues)


def variant(name: str, kind: Kind) -> Variant:
    """The variant of this name for fields of this kind. Raises `KeyError`."""
    return _variants(kind)[name]


def named(names: Iterable[str], kind: Kind) -> list[str]:
    """The names, those that end in a slash replaced by all variants that begin so.

    >>> len(named(["repeat", "symmetry/"], Kind(2, 1)))
    8
    """
    known = _variants(kind)
    found = []
    for name in names:
        found += [one for one in known if one.startswith(name)] if name.endswith("/") else [name]
    return [name for name in found if name in known]


def is_bad_input(name: str) -> bool:
    """Whether the variant poses what is no field."""
    return name in BAD_INPUT


BAD_INPUT = ("rank", "no-samples", "isovalue-nan", "nan", "infinity")


@cache
def _variants(kind: Kind) -> dict[str, Variant]:
    """Every variant for fields of this kind, by name."""
    found = [*SIMPLE, *_symmetries(kind.n)]
    if kind.m > 1:
        odd = kind.m * (kind.m - 1) // 2 % 2 == 1
        found.append(
            Variant("components", "the components in the other order", _components, reflects=odd)
        )
    return {one.name: one for one in found}


def _values(field: Field, values: Array) -> Field:
    """The field with other samples, unchecked."""
    return replace(field, values=values)


def _parts(field: Field) -> Array:
    """(m, N1, .., Nn) samples, whatever the number of components."""
    rank = field.dimension
    return field.values if field.values.ndim > rank else field.values[None]


def _as_given(field: Field, parts: Array) -> Array:
    """(m, ..) samples in the shape in which the field gives them."""
    return parts if field.values.ndim > field.dimension else parts[0]


def _repeat(field: Field, isovalues: Isovalues) -> Posed:
    """The same once more."""
    return field, isovalues


def _scale(field: Field, isovalues: Isovalues) -> Posed:
    """Four times the values: a power of two, so that nothing rounds."""
    with np.errstate(over="ignore"):
        values = 4 * _floats(field.values)
    if not np.isfinite(values).all():
        return None
    return _values(field, values), tuple(4 * level for level in isovalues)


def _shift(field: Field, isovalues: Isovalues) -> Posed:
    """All values moved up by about their size, if no difference that counts is lost."""
    values = _floats(field.values)
    wide = _parts(replace(field, values=values)).astype(np.float64)
    away = [part - level for part, level in zip(wide, isovalues, strict=True)]
    size = max(float(np.abs(part).max()) for part in away)
    step = 2.0 ** np.ceil(np.log2(size)) if size > 0 else 1.0
    moved = values + values.dtype.type(step)
    levels = tuple(level + step for level in isovalues)
    there = _parts(replace(field, values=moved)).astype(np.float64)
    for part, level, old in zip(there, levels, away, strict=True):
        if (np.sign(part - level) != np.sign(old)).any():
            return None
    return _values(field, moved), tuple(float(level) for level in levels)


def _level(field: Field, isovalues: Isovalues) -> Posed:
    """Every sample about 1 from the isovalue, now 0, and each crossing in the middle of its edge.

    What is left of the values is a quarter of a thousandth at most, in proportion. On an ambiguous
    face two ones and two minus ones cancel, so the average of its samples keeps its side.
    """
    parts = []
    for part, level in zip(_parts(field), isovalues, strict=True):
        with np.errstate(over="ignore"):
            away = part.astype(np.float64) - level
        largest = float(np.abs(away).max())
        if not np.isfinite(largest):
            return None
        parts.append(np.where(away >= 0, 1.0, -1.0) + 2.0**-12 * away / max(largest, 1e-300))
    return _values(field, _as_given(field, np.stack(parts))), (0.0,) * len(isovalues)


def _floats(values: Array) -> Array:
    """Floating samples as they are, any others in double precision."""
    return values if values.dtype.kind == "f" else values.astype(np.float64)


def _translate(cells: int) -> Callable[[Field, Isovalues], Posed]:
    """The field inside a larger one, so many samples further; the rim repeats it."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        rim = [(0, 0)] * (field.values.ndim - field.dimension)
        rim += [(cells, cells + 1)] * field.dimension
        return _values(field, np.pad(field.values, rim, mode="edge")), isovalues

    return pose


def _space(field: Field, isovalues: Isovalues) -> Posed:
    """A different spacing along each axis."""
    factors = [(0.5, 3.0, 1.25, 2.0, 0.75)[axis % 5] for axis in range(field.dimension)]
    spacing = tuple(s * f for s, f in zip(field.spacing, factors, strict=True))
    return replace(field, spacing=spacing), isovalues


def _turned(mirrored: bool) -> Callable[[Field, Isovalues], Posed]:
    """The axes turned in the world by some angle from each to the next; the first one backwards."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        n = field.dimension
        rows = np.eye(n)
        for axis in range(n - 1):
            angle = 0.4 + 0.3 * axis
            turn = np.eye(n)
            turn[axis : axis + 2, axis : axis + 2] = [
                [np.cos(angle), np.sin(angle)],
                [-np.sin(angle), np.cos(angle)],
            ]
            rows = rows @ turn
        if mirrored:
            rows[0] *= -1
        return replace(field, directions=tuple(map(tuple, rows.tolist()))), isovalues

    return pose


def _negative(count: int) -> Callable[[Field, Isovalues], Posed]:
    """A spacing below zero along the first axes, so many of them."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        spacing = tuple(-s if axis < count else s for axis, s in enumerate(field.spacing))
        return replace(field, spacing=spacing), isovalues

    return pose


def _fortran(field: Field, isovalues: Isovalues) -> Posed:
    """The first axis fastest in memory."""
    return _values(field, np.asfortranarray(field.values)), isovalues


def _strided(field: Field, isovalues: Isovalues) -> Posed:
    """Every second element of a larger array, along its first and last axes."""
    first, last = 0, field.values.ndim - 1
    wide = np.repeat(field.values, 2, axis=first)
    wide = np.repeat(wide, 2, axis=last) if last else wide
    steps: list[slice] = [slice(None)] * field.values.ndim
    steps[first] = steps[last] = slice(None, None, 2)
    return _values(field, wide[tuple(steps)]), isovalues


def _cropped(field: Field, isovalues: Isovalues) -> Posed:
    """A crop of a larger array of zeros: samples of a row are adjacent, rows and planes are not."""
    rim = [(0, 0)] * (field.values.ndim - field.dimension) + [(1, 2)] * field.dimension
    wide = np.pad(field.values, rim)
    crop = tuple(slice(low, low + n) for (low, _), n in zip(rim, field.values.shape, strict=True))
    return _values(field, wide[crop]), isovalues


def _backwards(field: Field, isovalues: Isovalues) -> Posed:
    """A view that runs backwards through memory along its last axis but one."""
    axis = max(field.values.ndim - 2, 0)
    steps: list[slice] = [slice(None)] * field.values.ndim
    steps[axis] = slice(None, None, -1)
    turned = np.ascontiguousarray(field.values[tuple(steps)])
    return _values(field, turned[tuple(steps)]), isovalues


def _swapped_bytes(field: Field, isovalues: Isovalues) -> Posed:
    """The bytes of every number in the other order."""
    if field.values.dtype.itemsize < 2:
        return None
    return _values(field, field.values.astype(field.values.dtype.newbyteorder("S"))), isovalues


def _read_only(field: Field, isovalues: Isovalues) -> Posed:
    """Samples that cannot be written."""
    values = field.values.copy(order="K")
    values.flags.writeable = False
    return _values(field, values), isovalues


def _mapped(field: Field, isovalues: Isovalues) -> Posed:
    """As the file of another machine is mapped into memory, which is three layouts at once."""
    values = field.values.copy(order="F")
    if values.dtype.itemsize > 1:
        values = values.astype(values.dtype.newbyteorder("S"), order="F")
    values.flags.writeable = False
    return _values(field, values), isovalues


def _without_stride(field: Field, isovalues: Isovalues) -> Posed:
    """The samples along the first axis on which they do not change, each once in memory."""
    first = field.values.ndim - field.dimension
    for axis in range(first, field.values.ndim):
        one = np.take(field.values, [0], axis)
        if field.values.shape[axis] > 1 and (field.values == one).all():
            return _values(field, np.broadcast_to(one, field.values.shape)), isovalues
    return None


def _magnified(exponent: int) -> Callable[[Field, Isovalues], Posed]:
    """Values and isovalues times a power of two, where doubles hold all of them exactly."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        values = _floats(field.values).astype(np.float64)
        with np.errstate(over="ignore", under="ignore"):
            moved, levels = np.ldexp(values, exponent), np.ldexp(isovalues, exponent)
            exact = np.array_equal(np.ldexp(moved, -exponent), values)
            exact &= np.array_equal(np.ldexp(levels, -exponent), isovalues)
        return (_values(field, moved), tuple(map(float, levels))) if exact else None

    return pose


def _lifted(factor: float) -> Callable[[Field, Isovalues], Posed]:
    """Values and isovalues plus so many times their range, where no double loses a digit."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        values = _floats(field.values).astype(np.float64)
        size = float(values.max() - values.min())
        step = factor * 2.0 ** np.ceil(np.log2(size)) if size > 0 else factor
        moved, levels = values + step, np.add(isovalues, step)
        if not (np.array_equal(moved - step, values) and np.array_equal(levels - step, isovalues)):
            return None
        return _values(field, moved), tuple(map(float, levels))

    return pose


def _larger(field: Field, isovalues: Isovalues) -> Posed:
    """The field and its mirror images: twice as many samples along each axis."""
    rim = [(0, 0)] * (field.values.ndim - field.dimension) + [(0, n) for n in field.shape]
    return _values(field, np.pad(field.values, rim, mode="symmetric")), isovalues


def _infinite(field: Field, isovalues: Isovalues) -> Posed:
    """An isovalue of the first component above every number."""
    return field, (float("inf"), *isovalues[1:])


def _as_type(kind: str) -> Callable[[Field, Isovalues], Posed]:
    """The same numbers in another type, where it holds them all and the isovalue is unharmed."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        if field.values.dtype == np.dtype(kind) or not _holds(kind, field.values):
            return None
        return _values(field, field.values.astype(kind)), isovalues

    return pose


def _holds(kind: str, values: Array) -> bool:
    """Whether every value is a number of this type."""
    if np.dtype(kind).kind in "iu":
        span = np.iinfo(kind)
        if values.min().item() < span.min or values.max().item() > span.max:
            return False
    with np.errstate(over="ignore"):
        return bool((values.astype(kind) == values).all())


def _components(field: Field, isovalues: Isovalues) -> Posed:
    """The components, and with them the isovalues, in the other order."""
    return _values(field, field.values[::-1].copy()), isovalues[::-1]


def _nan(field: Field, isovalues: Isovalues) -> Posed:
    """One sample is not a number."""
    values = _floats(field.values).copy()
    values[tuple(n // 2 for n in values.shape)] = np.nan
    return _values(field, values), isovalues


def _infinity(field: Field, isovalues: Isovalues) -> Posed:
    """One sample is infinite."""
    values = _floats(field.values).copy()
    values[tuple(n // 2 for n in values.shape)] = np.inf
    return _values(field, values), isovalues


def _extremes(field: Field, isovalues: Isovalues) -> Posed:
    """Blocks of 2 x 2 x .. samples some 1e300 from the isovalue, now 0, among others as they are.

    Every third block is one, so that there are edges and faces of extremes alone, on which
    differences are finite in double precision, and products of two are not.
    """
    blocks = np.sum([axis // 2 for axis in np.indices(field.shape)], axis=0) % 3 == 0
    parts = []
    for part, level in zip(_parts(field), isovalues, strict=True):
        away = part.astype(np.float64) - level
        with np.errstate(over="ignore"):
            moved = np.where(blocks, np.ldexp(away, MAGNITUDES["1e+300"]), away)
        if not (np.abs(moved) < 2.0**1022).all():
            return None
        parts.append(moved)
    return _values(field, _as_given(field, np.stack(parts))), (0.0,) * len(isovalues)


def _beyond(direction: int) -> Callable[[Field, Isovalues], Posed]:
    """An isovalue of the first component above every sample, or below."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        samples = _parts(field)[0]
        low, high = float(samples.min()), float(samples.max())
        margin = max(high - low, 1.0)
        return field, (high + margin if direction > 0 else low - margin, *isovalues[1:])

    return pose


def _passed(step: float) -> Callable[[Field, Isovalues], Posed]:
    """An isovalue of the first component a step further."""

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        return field, (isovalues[0] + step, *isovalues[1:])

    return pose


def _flat(field: Field, isovalues: Isovalues) -> Posed:
    """The first layer of the field with values on both sides, instead of the field."""
    parts = _parts(field)
    for place in range(parts.shape[1]):
        layer = parts[:, place]
        if (layer[0] < isovalues[0]).any() and (layer[0] > isovalues[0]).any():
            return Field(_as_given(field, layer), field.spacing[1:], field.origin[1:]), isovalues
    return None


def _nothing(field: Field, isovalues: Isovalues) -> Posed:
    """No samples at all."""
    parts = _parts(field)[:, :0]
    return _values(field, _as_given(field, parts)), isovalues


def _no_isovalue(field: Field, isovalues: Isovalues) -> Posed:
    """An isovalue that is not a number."""
    return field, (float("nan"), *isovalues[1:])


@cache
def _symmetries(n: int) -> tuple[Variant, ...]:
    """The symmetries of the n-dimensional cube but the identity; for many axes, generators."""
    identity = tuple(range(n))
    if n <= EVERY_SYMMETRY:
        every = product(permutations(range(n)), product((False, True), repeat=n))
        chosen = [one for one in every if one != (identity, (False,) * n)]
    else:
        swaps = [_swapped(identity, axis) for axis in range(n - 1)]
        mirrors = [tuple(a == axis for a in range(n)) for axis in range(n)]
        chosen = [(order, (False,) * n) for order in swaps]
        chosen += [(identity, mirrored) for mirrored in mirrors]
    return tuple(_symmetry(order, mirrored) for order, mirrored in chosen)


def _swapped(order: Sequence[int], axis: int) -> tuple[int, ...]:
    """The order with an axis and the next exchanged."""
    turned = list(order)
    turned[axis], turned[axis + 1] = turned[axis + 1], turned[axis]
    return tuple(turned)


def _symmetry(order: tuple[int, ...], mirrored: tuple[bool, ...]) -> Variant:
    """Axes in another order, those marked run backwards.

    Axis a of the variant is axis ``order[a]`` of the plain field, mirrored where ``mirrored[a]``.
    """
    n = len(order)
    name = "".join(
        LETTERS[axis].upper() if flip else LETTERS[axis]
        for axis, flip in zip(order, mirrored, strict=True)
    )
    steps = tuple(slice(None, None, -1 if flip else 1) for flip in mirrored)

    def pose(field: Field, isovalues: Isovalues) -> Posed:
        parts = _parts(field).transpose(0, *(1 + axis for axis in order))[(slice(None), *steps)]
        spacing = tuple(field.spacing[axis] for axis in order)
        origin = tuple(field.origin[axis] for axis in order)
        values = np.ascontiguousarray(_as_given(field, parts))
        return Field(values, spacing, origin), isovalues

    def back(places: Floats, field: Field) -> Floats:
        last = np.subtract([field.shape[axis] for axis in order], 1.0)
        there = np.where(mirrored, last - places, places)
        plain: Floats = there[:, np.argsort(order)]
        return plain

    turns = sum(order[i] > order[j] for i in range(n) for j in range(i + 1, n)) + sum(mirrored)
    return Variant(
        f"symmetry/{name}",
        f"axes {name}: in this order, capitals backwards",
        pose,
        back,
        turns % 2 == 1,
    )


def symmetry_of(name: str) -> tuple[tuple[int, ...], tuple[bool, ...]]:
    """The order of the axes and which are mirrored, of the variant of this name.

    >>> symmetry_of("symmetry/yXz")
    ((1, 0, 2), (False, True, False))
    """
    letters = name.removeprefix("symmetry/")
    return tuple(LETTERS.index(x.lower()) for x in letters), tuple(x.isupper() for x in letters)


TYPES = {
    "float16": "half precision",
    "float32": "single precision",
    "float64": "double precision",
    "int8": "signed bytes",
    "int16": "16-bit integers",
    "int32": "32-bit integers",
    "int64": "64-bit integers",
    "uint8": "bytes",
    "uint16": "unsigned 16-bit integers",
    "uint32": "unsigned 32-bit integers",
    "uint64": "unsigned 64-bit integers",
    "bool": "truth values",
}
# Powers of two, from the nearest to the farthest either way; 1e150 and 1e300 are the nearest ones.
MAGNITUDES = {
    f"{base}{sign}{size}": (1 if sign == "+" else -1) * exponent
    for sign in "-+"
    for base, size, exponent in (
        ("2^", "10", 10),
        ("2^", "20", 20),
        ("2^", "30", 30),
        ("2^", "60", 60),
        ("1e", "150", 498),
        ("1e", "300", 996),
    )
}
OFFSETS = {"2^10": 2.0**10, "2^20": 2.0**20, "1e6": 1e6}
# Steps of the isovalue to either side, "passed/-2^-8" and "passed/+2^-8", ..
STEPS = {f"2^{exponent}": 2.0**exponent for exponent in (-8, -11, -14, -17)}

SIMPLE: tuple[Variant, ...] = (
    Variant("repeat", "asked a second time", _repeat),
    Variant("scale", "values and isovalue times four", _scale),
    Variant("shift", "values and isovalue plus a power of two near their size", _shift),
    Variant("level", "samples about 1 or -1, isovalue 0: crossings in the middle", _level),
    Variant(
        "translate",
        "inside a larger grid, one sample further along each axis",
        _translate(1),
        lambda places, _: places - 1.0,
    ),
    Variant(
        "translate-2",
        "inside a larger grid, two samples further along each axis",
        _translate(2),
        lambda places, _: places - 2.0,
    ),
    Variant("spacing", "another spacing along each axis", _space),
    Variant("directions/turned", "the axes turned in the world", _turned(mirrored=False)),
    Variant(
        "directions/mirrored",
        "the axes turned in the world, the first one backwards",
        _turned(mirrored=True),
        reflects=True,
    ),
    Variant("negative/one", "a negative spacing along the first axis", _negative(1), reflects=True),
    Variant("negative/two", "negative spacings along two axes", _negative(2)),
    Variant("fortran", "first axis fastest in memory", _fortran),
    Variant("strided", "every second element of a larger array", _strided),
    Variant("cropped", "a crop of a larger array", _cropped),
    Variant("backwards", "a view that runs backwards through memory", _backwards),
    Variant("swapped", "the bytes of every number in the other order", _swapped_bytes),
    Variant("read-only", "samples that cannot be written", _read_only),
    Variant(
        "mapped",
        "first axis fastest, bytes in the other order, not to be written: a file that is mapped",
        _mapped,
    ),
    Variant("stride-0", "equal samples along an axis, once in memory", _without_stride),
    *(Variant(kind, f"samples as {meaning}", _as_type(kind)) for kind, meaning in TYPES.items()),
    *(
        Variant(f"magnitude/{word}", f"values and isovalue times {word}", _magnified(exponent))
        for word, exponent in MAGNITUDES.items()
    ),
    *(
        Variant(f"offset/{word}", f"values and isovalue plus {word} times their range", _lifted(x))
        for word, x in OFFSETS.items()
    ),
    *(
        Variant(f"passed/{sign}{word}", f"an isovalue {sign}{word} further", _passed(way * step))
        for word, step in STEPS.items()
        for sign, way in (("-", -1), ("+", 1))
    ),
    Variant("kept", "the answer as it is after other fields were asked", _repeat, calls="kept"),
    Variant(
        "again",
        "shifted, and asked again in one array after hundreds of other questions",
        _shift,
        calls="again",
    ),
    Variant("threads", "asked from four threads at once", _repeat, calls="threads"),
    Variant("many", "asked many times in one process", _repeat, calls="many"),
    Variant("timed", "timed, the best of three", _repeat, calls="timed"),
    Variant("larger", "twice as large along each axis, timed", _larger, calls="timed"),
    Variant("infinite", "an infinite isovalue", _infinite),
    Variant("nan", "the middle sample is not a number", _nan),
    Variant("infinity", "the middle sample is infinite", _infinity),
    Variant("extremes", "every third block of samples 1e300 from the isovalue", _extremes),
    Variant("above", "an isovalue above every sample", _beyond(1)),
    Variant("below", "an isovalue below every sample", _beyond(-1)),
    Variant("rank", "one axis less", _flat),
    Variant("no-samples", "an array without samples", _nothing),
    Variant("isovalue-nan", "an isovalue that is not a number", _no_isovalue),
)
