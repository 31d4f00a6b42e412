"""Who does not take a plain field is asked for fields that are cubes, or of other types."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from isoref.field import Field


def other_fields(
    field: Field, isovalues: tuple[float, ...]
) -> Iterator[tuple[dict[str, Any], Field, tuple[float, ...]]]:
    """Limits, with fields that keep them, for who does not take the plain one."""
    n = field.dimension
    spacing = (1.0,) * n
    side = 8
    middle = (side - 1) / 2 + 0.1
    away = np.indices((side,) * n, dtype=float) - middle
    high = 8 - np.einsum("i...,i...->...", away, away)
    cube = high if field.components == 1 else np.stack([high, *away[n - field.components + 1 :]])
    level = (4.0, *isovalues[1:])
    bytes_ = np.clip(128 + 10 * cube, 0, 255).astype(np.uint8)
    byte_level = tuple(128 + 10 * one + 0.5 for one in level)
    for limits, values, asked in (
        ({"cubes": True}, cube, level),
        ({"types": ("float32",)}, field.values.astype(np.float32), isovalues),
        ({"types": ("float32",), "cubes": True}, cube.astype(np.float32), level),
        ({"types": ("uint8",), "cubes": True}, bytes_, byte_level),
    ):
        yield limits, Field.of(values, spacing, dimension=n), asked
    plain = np.clip(128 + 10 * field.values, 0, 255).astype(np.uint8)
    asked = tuple(128 + 10 * one + 0.5 for one in isovalues)
    yield {"types": ("uint8",)}, Field.of(plain, field.spacing, dimension=n), asked


def told_limits(limits: dict[str, Any]) -> str:
    """Limits in words."""
    parts = ["a cube"] if limits.get("cubes") else []
    parts += [f"of type {', '.join(limits['types'])}"] if "types" in limits else []
    return f"{' '.join(parts)}: declare " + json.dumps({"limits": limits})
