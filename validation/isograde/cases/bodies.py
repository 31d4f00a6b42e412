"""Known bodies, sampled: what every implementation, of whatever family, must get right.

Every body of `isograde.oracles.bodies` in boxes of 2^e and of 2^e + 1 samples along the axes, as
float64 and as uint8. The two smallest bodies of a kind are run by default, each once in either box
and once as either type, and one torus; beyond space, one as floats in a box of 2^e samples, the
other as bytes in one of 2^e + 1; the rest is tagged "full". In up to three dimensions these two
come as float32 and int16 as well, for who takes nothing else.

Who samples a function is given that of the body itself where the samples are float64, and the
interpolant of the samples where they are of another type.

Facts: "body", and "rounding", by how many cells the samples are off, and an answer in single
precision.

Floats are rounded to multiples of 2^-20, so that the numbers are the same everywhere (nothing but
sums, products and square roots made them), and lifted by an isovalue that is not zero. Bytes are
distances up to `BAND` cells on either side, spread over 0 to 255; the isovalue is 127.5, so no
sample ties, and their rounding is half a step. Integers of 16 bits have `FINE` steps a cell.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from isoref.field import Field, FieldError

from isograde.cases.analytic import rounded
from isograde.model import Case, Kind
from isograde.oracles.bodies import KINDS, Body, known_bodies

BAND = 8.0
"""Distances in cells, beyond which bytes are all 0 or all 255."""

STEP = 2 * BAND / 255
ISOVALUES = {"float64": 0.3125, "uint8": 127.5, "float32": 0.3125, "int16": 0.5}
FINE = 256
"""Steps of a 16-bit integer in a cell."""

ROUNDINGS = {"float64": 2.0**-21, "uint8": STEP / 2, "float32": 2.0**-18, "int16": 0.5 / FINE}
SINGLE = 4 * 2.0**-24
"""Share of the box by which an answer in single precision is off: the sample, the difference from
the isovalue, the crossing and its place are each rounded once."""


# A surface of another genus, though its box is large.
BESIDES = ("bodies/3-1/torus-64-uint8",)


def cases(seed: int = 0) -> list[Case]:
    """Every case, in the order of the kinds; they do not depend on the seed."""
    del seed
    return [case for n, m in KINDS for case in of_kind(n, m)]


def of_kind(n: int, m: int) -> Iterator[Case]:
    """The cases of m functions on a lattice of dimension n.

    >>> [case.id for case in of_kind(2, 1)][:2]
    ['bodies/2-1/circle-16-float64', 'bodies/2-1/circle-16-uint8']
    """
    pairs = list(zip(known_bodies(n, m, 0), known_bodies(n, m, 1), strict=True))
    sizes = [int(np.prod(even.shape)) for even, _ in pairs]
    plain = sorted(np.argsort(sizes, kind="stable")[:2].tolist())
    for index, pair in enumerate(pairs):
        for odd, body in enumerate(pair):
            for number, samples in enumerate(ISOVALUES):
                turn = plain.index(index) if index in plain else -1
                full = turn < 0 or (number + odd + turn) % 2 == 1
                # Beyond space a mesh may have a quarter of a million simplices: one case a body.
                if n > 3:
                    full = not number == odd == turn
                if number < 2 or (n <= 3 and not full):
                    yield _case(body, samples, full=full)


def _case(body: Body, samples: str, *, full: bool) -> Case:
    """The case of a body, with samples of this type."""
    kind = Kind(body.n, body.m)
    name = f"bodies/{body.n}-{body.m}/{body.name}-{body.shape[0]}-{samples}"
    tags = {"bodies", "closed", samples}
    if full and name not in BESIDES:
        tags.add("full")
    facts = {"body": body, "rounding": ROUNDINGS[samples] + SINGLE * max(body.shape)}
    count = int(np.prod(body.shape))
    isovalues = (ISOVALUES[samples],) * body.m
    own = body.function(isovalues[0]) if samples == "float64" and body.m == 1 else None
    build = partial(sampled, body, samples)
    return Case(name, build, isovalues, count, frozenset(tags), facts, kind, function=own)


def sampled(body: Body, kind: str) -> Field:
    """The field of a body; a field of one component has no axis for it."""
    values = rounded(body.samples())
    if kind == "uint8":
        steps = np.rint(np.clip(values, -BAND, BAND) / STEP + ISOVALUES[kind])
        values = np.clip(steps, 0, 255).astype(np.uint8)
    elif kind == "int16":
        values = np.rint(values * FINE + ISOVALUES[kind]).astype(np.int16)
    elif kind in ISOVALUES:
        values = (values + ISOVALUES[kind]).astype(kind)
    else:
        raise FieldError(f"no type {kind!r}: {', '.join(ISOVALUES)}")
    return Field.of(values[0] if body.m == 1 else values, dimension=body.n)
