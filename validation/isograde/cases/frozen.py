"""Numbers that are the same for ever.

A vector must not change with the version of a library. NumPy promises that the *raw* words of a
bit generator stay as they are, and promises nothing of what `Generator` makes of them. So a name
and a seed give a key, the key gives Philox words, and the words become numbers here.

Glossary
--------
name    of the vector: "cells/outside/137"
seed    of the whole set; 0 for the frozen one
word    64 random bits
step    ``2 ** -10``: every number is a multiple, so that it is exact in float16, in float32 and
        under scaling by powers of two
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np
from isoref.field import Floats, Integers
from numpy.typing import NDArray

from isograde.model import Case

STEP = 2.0**-10


def words(name: str, seed: int, count: int) -> NDArray[np.uint64]:
    """`count` random words that depend on nothing but `name` and `seed`.

    >>> [hex(word) for word in words("cells", 0, 2).tolist()] == [
    ...     hex(word) for word in words("cells", 0, 3).tolist()[:2]]
    True
    """
    key = hashlib.sha256(f"{name}#{seed}".encode()).digest()[:16]
    generator = np.random.Philox(key=int.from_bytes(key, "little"))
    return np.asarray(generator.random_raw(count), np.uint64)


def integers(name: str, seed: int, shape: tuple[int, ...], low: int, high: int) -> Integers:
    """Integers of ``low <= number < high``, in this shape."""
    upper = words(name, seed, int(np.prod(shape))) >> np.uint64(32)
    scaled = (upper * np.uint64(high - low)) >> np.uint64(32)
    return (scaled.astype(np.int64) + low).reshape(shape)


def magnitudes(name: str, seed: int, shape: tuple[int, ...]) -> Floats:
    """Multiples of the step in [1/16, 1), for samples that must stand clear of the isovalue."""
    return np.asarray(integers(name, seed, shape, 64, 1024) * STEP, np.float64)


def uniform(name: str, seed: int, shape: tuple[int, ...]) -> Floats:
    """Numbers in [0, 1) with 52 random bits."""
    bits = words(name, seed, int(np.prod(shape))) >> np.uint64(12)
    return (bits.astype(np.float64) * 2.0**-52).reshape(shape)


def digest(cases: Iterable[Case]) -> str:
    """SHA-256 of the ids, isovalues, spacings and samples of these cases, as hexadecimal."""
    total = hashlib.sha256()
    for case in cases:
        field = case.build()
        levels = case.isovalues[0] if len(case.isovalues) == 1 else case.isovalues
        total.update(f"{case.id} {levels!r} {field.spacing!r} {field.shape!r}".encode())
        total.update(np.ascontiguousarray(field.values).astype("<f8").tobytes())
    return total.hexdigest()
