"""Fields of every shape: thin, long, lopsided, with many vertices and many pieces.

A program that names a vertex by a number made of indices may be right for cubes and wrong where
one axis is longer than another, or where a number outgrows its type. The noise here has the shapes
that tell such keys apart. Large fields are judged by what costs little: structure, edges, sides;
and who is too slow for them has not failed.

Glossary
--------
thin    an axis of one, two or three samples, each axis in turn
mixed   three different lengths in every order
long    an axis beyond 65,536 samples, with noise at both its ends; nothing between
deep    noise in the last samples of a field whose lattice edges have numbers beyond 2 ** 24
ends    lengths about 256, where blocks of 8 to 256 cells leave one cell over, two, or none
column  noise along an axis through more than 4 million samples, in full runs
fine    more than a million doubles that single precision does not tell apart, in full runs
many    more than 65,536 vertices
dense   more than 400,000: of 32-bit hashes of their edges some would be equal, whatever the hash
specks  343 pieces, each round one sample
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.frozen import STEP, integers
from isograde.cases.noise import white
from isograde.model import Case

Shape = tuple[int, int, int]


def _orders(*lengths: Shape) -> tuple[Shape, ...]:
    """Each three lengths in every order."""
    orders = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
    every = [(one[a], one[b], one[c]) for one in lengths for a, b, c in orders]
    return tuple(dict.fromkeys(every))


THIN = _orders((1, 4, 5), (2, 4, 5), (3, 4, 5), (2, 9, 9), (1, 9, 9), (1, 1, 6), (2, 2, 7))
MIXED = _orders((3, 5, 17), (4, 9, 33), (2, 7, 65), (6, 8, 11), (3, 16, 20), (5, 10, 13))
CHEAP = ("structure.*", "topology.closed", "topology.oriented", "topology.sides")
ENDS = 6
# The last layers have the numbers of the first, modulo 2 ** 16 and every smaller power of two.
LONG = 2**16 + ENDS
# Three times the number of the last samples is beyond 2 ** 24, and there are few cells.
DEEP = (2, 1676, 1676)
PATCH = 12
LENGTHS = (256, 257, 258, 259)
MANY = (36, 38, 40)
DENSE = (64, 66, 68)
HUGE = (226, 226, 226)
# More than a million samples, in whose doubles single precision sees one number.
FINE, BASE = (102, 102, 102), 2.0**30
# More than 2 ** 22 samples: a program that works in parts has several.
COLUMN, CORE = (1040, 65, 65), slice(30, 36)


def gentle(name: str, seed: int, shape: tuple[int, ...]) -> Floats:
    """Noise of 3/4 to 5/4 in size: every crossing is in the middle quarter of its edge."""
    size = 1 + integers(name, seed, shape, -255, 256) * STEP
    return np.asarray(np.where(integers(f"{name}/side", seed, shape, 0, 2), size, -size))


def long(name: str, seed: int, axis: int) -> Field:
    """Low samples, 4 x 4 across, with noise in the first and last layers of a long axis."""
    values = np.full((LONG, 4, 4), -1.0, np.float32)
    values[:ENDS] = gentle(name, seed, (ENDS, 4, 4))
    values[-ENDS:] = gentle(f"{name}/end", seed, (ENDS, 4, 4))
    return Field.of(np.ascontiguousarray(np.moveaxis(values, 0, axis)))


def deep(name: str, seed: int) -> Field:
    """Low samples, with a patch of noise in the far corner."""
    values, patch = np.full(DEEP, -1, np.int8), (2, PATCH, PATCH)
    size = integers(name, seed, patch, 64, 128)
    noise = np.where(integers(f"{name}/side", seed, patch, 0, 2), size, -size)
    values[:, -PATCH:, -PATCH:] = noise
    return Field.of(values)


def many(name: str, seed: int, shape: Shape) -> Field:
    """Noise of bytes, high or low at random."""
    return Field.of(integers(name, seed, shape, 0, 2).astype(np.uint8))


def ends(name: str, seed: int, length: int, axis: int) -> Field:
    """Noise along an axis, two samples wide across."""
    values = gentle(name, seed, (length, 2, 2))
    return Field.of(np.ascontiguousarray(np.moveaxis(values, 0, axis)))


def specks(name: str, seed: int) -> Field:
    """A high sample at every second place in every direction, none at the border."""
    values = -np.abs(gentle(name, seed, (15, 15, 15)))
    inner = values[1::2, 1::2, 1::2]
    values[1::2, 1::2, 1::2] = -inner
    return Field.of(values)


def fine(name: str, seed: int) -> Field:
    """Noise on a number so large that single precision does not tell its samples apart."""
    return Field.of(BASE + gentle(name, seed, FINE))


def column(name: str, seed: int, axis: int) -> Field:
    """Low samples, with a column of noise along an axis through all of them."""
    values = np.full(COLUMN, -1, np.int8)
    inner = values[:, CORE, CORE]
    size = integers(name, seed, inner.shape, 64, 128)
    inner[...] = np.where(integers(f"{name}/side", seed, inner.shape, 0, 2), size, -size)
    return Field.of(np.ascontiguousarray(np.moveaxis(values, 0, axis)))


def cases(seed: int = 0) -> list[Case]:
    """Thin and mixed noise, long axes, many vertices, many pieces; the largest in full runs."""
    made = [_noise(f"shapes/{_named(shape)}", seed, shape) for shape in (*THIN, *MIXED)]
    for axis in range(3):
        name = f"shapes/long-{axis}"
        made.append(_large(name, partial(long, name, seed, axis), 0.0, LONG * 16))
        for length in LENGTHS:
            name = f"shapes/ends-{length}-{axis}"
            made.append(_end(name, partial(ends, name, seed, length, axis)))
        name = f"shapes/column-{axis}"
        build = partial(column, name, seed, axis)
        made.append(_large(name, build, 0.0, int(np.prod(COLUMN)), "full"))
    made.append(_deep("shapes/deep", seed))
    for name, shape in (("shapes/many", MANY), ("shapes/dense", DENSE)):
        made.append(_large(name, partial(many, name, seed, shape), 0.5, int(np.prod(shape))))
    name = "shapes/huge"
    build = partial(many, name, seed, HUGE)
    made.append(_large(name, build, 0.5, int(np.prod(HUGE)), "full"))
    name = "shapes/fine"
    made.append(_large(name, partial(fine, name, seed), BASE, int(np.prod(FINE)), "full"))
    name = "shapes/specks"
    tags = frozenset({"shapes", "noise"})
    made.append(Case(name, partial(specks, name, seed), (0.0,), 15**3, tags, {"components": 343}))
    return made


def _named(shape: Shape) -> str:
    """The lengths."""
    return "x".join(map(str, shape))


def _noise(name: str, seed: int, shape: Shape) -> Case:
    """White noise of this shape."""
    build = partial(white, name, seed, shape)
    return Case(name, build, (0.0,), int(np.prod(shape)), frozenset({"shapes"}), only=CHEAP)


def _end(name: str, build: partial[Field]) -> Case:
    """A case that is long and thin, of which only what costs little is judged."""
    return Case(name, build, (0.0,), 4 * 258, frozenset({"shapes", "noise"}), only=CHEAP)


def _deep(name: str, seed: int) -> Case:
    """The case of large numbers, of which only the mesh is judged: its field is costly to walk."""
    only = tuple(claim for claim in CHEAP if claim != "topology.sides")
    tags = frozenset({"shapes", "large"})
    return Case(name, partial(deep, name, seed), (0.0,), int(np.prod(DEEP)), tags, only=only)


def _large(name: str, build: partial[Field], isovalue: float, samples: int, *tags: str) -> Case:
    """A case of which only what costs little is judged."""
    return Case(
        name, build, (isovalue,), samples, frozenset({"shapes", "large", *tags}), only=CHEAP
    )
