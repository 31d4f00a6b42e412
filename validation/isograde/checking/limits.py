"""Who does not take a plain field is asked for fields that are cubes, or of other types.

`Within` poses any field so that it keeps such limits: filled up to a cube beyond its ends, with its
values mapped into the range of a type of whole numbers. The level set stays where it was, but for
the rounding; samples that are equal to the isovalue stay equal to it, and no others become so.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

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
# Values are mapped to so many steps on each side of the isovalue.
STEPS = {"uint8": 120, "int16": 30_000}


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
        ([[7, 248]], (127.5,))
        """
        n, parts = plain.dimension, plain.values
        single = parts.ndim == n
        parts = parts[None] if single else parts
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
    middle = 128 if name == "uint8" else 0
    scaled = away * (steps / max(float(np.abs(away).max()), 1e-300))
    if (away == 0).any():
        # Round away from the isovalue, so that no further sample is on it.
        values = middle + np.sign(scaled) * np.ceil(np.abs(scaled))
        return values.astype(name), float(middle)
    values = middle - 0.5 + np.sign(scaled) * (np.floor(np.abs(scaled)) + 0.5)
    return values.astype(name), middle - 0.5
