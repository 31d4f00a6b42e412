"""Who does not take a plain field is asked for fields that are cubes, or of other types.

`Within` poses any field so that it keeps such limits: filled up to a cube beyond its ends, with its
values mapped into the range of a type of whole numbers. The level set stays where it was, but for
the rounding; samples that are equal to the isovalue stay equal to it, and no others become so.

`posed` does so to a case of the plan, for an implementation that says which types it takes, or that
it takes cubes only; else most of the plan would be no evidence of anything. Where the same numbers
exist in a type that it takes, nothing changes, and all that is known of the case stays known.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.declaration import Scope
from isograde.model import Case

Isovalues = tuple[float, ...]
# What is tried in turn, the least restrictive first.
TRIED: tuple[Mapping[str, Any], ...] = (
    {"cubes": True},
    {"types": ("float32",)},
    {"types": ("float32",), "cubes": True},
    {"types": ("uint8",)},
    {"types": ("uint8",), "cubes": True},
    {"types": ("int16",)},
    {"types": ("int16",), "cubes": True},
)
# Values are mapped to so many steps on each side of the isovalue: few enough that four times the
# values, and the values plus their size, are still of the type.
STEPS = {
    **{f"{sign}int8": 28 for sign in ("", "u")},
    **{f"{sign}int{bits}": 7_000 for sign in ("", "u") for bits in (16, 32, 64)},
}
# The isovalue, or the least number above it; 0 for types with a sign.
MIDDLES = {"uint8": 32, "uint16": 1 << 13, "uint32": 1 << 13, "uint64": 1 << 13}
# What is said of cases with these tags is true of the numbers that they are posed with, too.
STILL = frozenset({"cells", "noise", "ties", "posed", "empty"})
# Larger cases are given as they stand, or not at all: they are what they are by their numbers.
LARGEST_POSED = 1000


@dataclass(frozen=True)
class Within:
    """Fields posed within limits on their type and their shape."""

    limits: Mapping[str, Any] = field(default_factory=dict)

    @property
    def type(self) -> str:
        """The one type that is taken, or nothing where every type is."""
        return str(self.limits.get("types", ("",))[0])

    @property
    def whole(self) -> bool:
        """Only whole numbers are taken."""
        return self.type in STEPS

    def pose(self, plain: Field, isovalues: Isovalues) -> tuple[Field, Isovalues]:
        """The field and isovalues within the limits.

        >>> posed, levels = Within({"types": ("uint8",)}).pose(Field.of([[0.0, 1.0]]), (0.5,))
        >>> posed.values.tolist(), levels
        ([[3, 60]], (31.5,))
        """
        single, parts = plain.values.ndim == plain.dimension, _parts(plain)
        if self.limits.get("cubes"):
            parts = np.stack([_cube(part) for part in parts])
        levels = isovalues
        if self.whole:
            mapped = [
                _whole(part, level, self.type) for part, level in zip(parts, isovalues, strict=True)
            ]
            parts = np.stack([one for one, _ in mapped])
            levels = tuple(level for _, level in mapped)
        elif self.type:
            with np.errstate(over="ignore", under="ignore"):
                parts = parts.astype(self.type)
        return Field(parts[0] if single else parts, plain.spacing, plain.origin), levels

    def told(self) -> str:
        """The limits in words, with what to declare."""
        parts = ["a cube"] if self.limits.get("cubes") else []
        parts += [f"of type {self.type}"] if self.type else []
        return f"{' '.join(parts)}: declare " + json.dumps({"limits": dict(self.limits)})


def _cube(part: NDArray[Any]) -> NDArray[Any]:
    """The samples, filled up with their least value to as many along each axis."""
    side = max(part.shape)
    return np.pad(part, [(0, side - n) for n in part.shape], constant_values=part.min())


def _whole(part: NDArray[Any], level: float, name: str) -> tuple[NDArray[Any], float]:
    """The samples as whole numbers of this type, and their isovalue."""
    away = part.astype(np.float64) - level
    steps = STEPS[name]
    middle = MIDDLES.get(name, 0)
    scaled = away * (steps / max(float(np.abs(away).max()), 1e-300))
    if (away == 0).any():
        # Round away from the isovalue, so that no further sample is on it.
        values = middle + np.sign(scaled) * np.ceil(np.abs(scaled))
        return values.astype(name), float(middle)
    values = middle - 0.5 + np.sign(scaled) * (np.floor(np.abs(scaled)) + 0.5)
    return values.astype(name), middle - 0.5


# --- Cases -------------------------------------------------------------------------------------


def posed(case: Case, plain: Field, limits: Scope) -> tuple[Case, Field]:
    """The case and its field as they are given to who states these limits.

    They are the same where the limits allow them, and where nothing can be done about it: of a
    single bit a sample, or where rounding would move a sample to the other side.
    """
    if not limits.refusal(case.kind, plain.shape, plain.values.dtype):
        return case, plain
    types = sorted(limits.types, key=_width, reverse=True)
    cube = not limits.cubes or len(set(plain.shape)) == 1
    same = next((one for one in types if _exact(plain.values, one)), None)
    if cube and same is not None:
        return case, replace(plain, values=plain.values.astype(same))
    # A ten-millionth of the values moves no level set that is known.
    near = cube and bool(types) and _width(types[0]) > (1, 16)
    if not near and (case.samples > LARGEST_POSED or types[:1] == ["bool"]):
        return case, plain
    kept: dict[str, Any] = {"cubes": True} if limits.cubes else {}
    if types and plain.values.dtype.name not in types:
        kept["types"] = (same or types[0],)
    field, isovalues = Within(kept).pose(plain, case.isovalues)
    if _turned(plain, case.isovalues, field, isovalues):
        return case, plain
    new = replace(case, build=lambda: field, isovalues=isovalues, function=None)
    new = replace(new, samples=int(np.prod(field.shape)))
    if near:
        return new, field
    # What is known of the level set was known of other numbers, or ends elsewhere.
    tags = case.tags & STILL - (set() if case.kind.m == 1 else {"empty"})
    return replace(new, tags=tags, facts={}), field


def recast(field: Field, like: Field, limits: Scope) -> Field:
    """The field in the type of another one, where its own is not taken and the numbers exist."""
    taken = limits.types and field.values.dtype.name not in limits.types
    if taken and like.values.dtype.name in limits.types and _exact(field.values, like.values.dtype):
        return replace(field, values=field.values.astype(like.values.dtype))
    return field


def _width(name: str) -> tuple[int, int]:
    """How much a type holds: floats before whole numbers, and then by their bits."""
    dtype = np.dtype(name)
    return int(dtype.kind == "f"), 1 if dtype.kind == "b" else 8 * dtype.itemsize


def _exact(values: NDArray[Any], name: str | np.dtype[Any]) -> bool:
    """Whether the type holds the same numbers."""
    with np.errstate(all="ignore"):
        there = values.astype(name)
        return bool(np.array_equal(there.astype(values.dtype), values, equal_nan=True))


def _turned(plain: Field, levels: Isovalues, field: Field, isovalues: Isovalues) -> bool:
    """Whether some sample of the plain field is on another side, or no longer a tie, or one now."""
    inner = tuple(slice(0, n) for n in plain.shape)
    sides = []
    for some, at in ((plain, levels), (field, isovalues)):
        with np.errstate(invalid="ignore"):
            away = [p[inner] - np.float64(a) for p, a in zip(_parts(some), at, strict=True)]
        sides.append(np.sign(away))
    return not np.array_equal(sides[0], sides[1], equal_nan=True)


def _parts(plain: Field) -> NDArray[Any]:
    """(m, N1, .., Nn) the samples, by component."""
    return plain.values if plain.values.ndim > plain.dimension else plain.values[None]
