"""Samples of every number type, over the whole range of the type.

A program that takes the isovalue off in the type of the samples, or that rounds it to that type, is
right on small positive numbers. Here the samples reach the least and the greatest number of their
type, so that differences overflow, and isovalues lie between whole numbers, on one, and below zero.
Two small fields hold the same whole numbers in all types. They are posed in all ways, and so is a
field of each type: programs have ways of their own for some types, and not for all their layouts.

Glossary
--------
middle      an isovalue in the middle of the type's range, half a step beside a whole number
low, high   an isovalue near the least, or the greatest, number of the type
whole       an isovalue that is a whole number, which no sample has
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field

from isograde.cases.frozen import STEP, integers, words
from isograde.model import Case

SHAPE = (4, 5, 6)
WHOLE = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")
REAL = ("float16", "float32", "float64")


def full_range(name: str, seed: int, dtype: str) -> Field:
    """Random bits read as numbers of this type, the least and the greatest among them."""
    bits = words(name, seed, int(np.prod(SHAPE)))
    size = 8 * np.dtype(dtype).itemsize
    values = (bits >> np.uint64(64 - size)).astype(f"uint{size}").view(dtype).reshape(SHAPE)
    span = np.iinfo(dtype)
    values[1, 1, 1:3] = values[2, 3, 4:2:-1] = span.min, span.max
    return Field.of(values)


def isovalues(dtype: str) -> dict[str, float]:
    """The isovalues by name: between whole numbers where a float can say so."""
    span = np.iinfo(dtype)
    low, high = int(span.min), int(span.max)
    eighth = (high - low) // 8
    return {
        "middle": (low + high) / 2,
        "low": low + eighth + 0.5,
        "high": high - eighth - 0.25,
    }


def odd(name: str, seed: int, dtype: str) -> Field:
    """Odd numbers over the whole range of a whole type."""
    whole = full_range(name, seed, dtype)
    return whole.with_values(whole.values | np.ones(1, dtype))


def saddles(name: str, seed: int) -> Field:
    """Samples of 16 bits near either end of their range, far from the isovalue and near it.

    Differences of those far from it have products that 32 bits do not hold.
    """
    high = integers(name, seed, SHAPE, 0, 2).astype(bool)
    drawn = integers(f"{name}#", seed, SHAPE, 0, 500)
    return Field.of(np.where(high, 32_767 - drawn, drawn - 32_768).astype(np.int16))


def real(name: str, seed: int, dtype: str) -> Field:
    """Noise of multiples of 2 ** -10, which every real type holds."""
    drawn = integers(name, seed, SHAPE, -1024, 1023)
    return Field.of((np.where(drawn >= 0, drawn + 1, drawn) * STEP).astype(dtype))


def truths(name: str, seed: int) -> Field:
    """True and false."""
    return Field.of(integers(name, seed, SHAPE, 0, 2).astype(bool))


def small(name: str, seed: int, low: int, high: int) -> Field:
    """Whole numbers as doubles."""
    return Field.of(integers(name, seed, (4, 5, 4), low, high).astype(np.float64))


def cases(seed: int = 0) -> list[Case]:
    """Every whole type at four isovalues, every real one, bools, and three fields in all types."""
    made = []
    for dtype in WHOLE:
        for place, isovalue in isovalues(dtype).items():
            name = f"types/{dtype}-{place}"
            made.append(_case(name, partial(full_range, name, seed, dtype), isovalue))
    for dtype in WHOLE:
        name = f"types/{dtype}-whole"
        level = 2.0 if np.iinfo(dtype).min < 0 else 2.0 ** (np.iinfo(dtype).bits - 1)
        made.append(_case(name, partial(odd, name, seed, dtype), level, "posed"))
    name = "types/int16-saddles"
    made.append(_case(name, partial(saddles, name, seed), -31_000.0))
    for dtype in REAL:
        name = f"types/{dtype}"
        made.append(_case(name, partial(real, name, seed, dtype), 2.0**-12, "posed"))
    made.append(_case("types/bool", partial(truths, "types/bool", seed), 0.5, "posed"))
    for name, low, high, isovalue in (
        ("types/signed", -100, 101, -12.5),
        ("types/unsigned", 0, 201, 99.625),
        ("types/two", 0, 2, 105 / 256),
    ):
        made.append(_case(name, partial(small, name, seed, low, high), isovalue, "posed", "ranges"))
    return made


def _case(name: str, build: partial[Field], isovalue: float, *tags: str) -> Case:
    """The case of this name."""
    samples = 80 if "ranges" in tags else 120
    return Case(name, build, (isovalue,), samples, frozenset({"types", *tags}))
