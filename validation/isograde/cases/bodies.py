"""Known bodies, sampled: what every implementation, of whatever family, must get right.

Every body of `isograde.oracles.bodies` in boxes of 2^e and of 2^e + 1 samples along the axes, as
float64 and as uint8. Facts: "body", and "rounding", by how many cells the samples are off, and an
answer in single precision.

Floats are rounded to multiples of 2^-20, so that the numbers are the same everywhere (nothing but
sums, products and square roots made them), and lifted by an isovalue that is not zero. Bytes are
distances up to `BAND` cells on either side, spread over 0 to 255; the isovalue is 127.5, so no
sample ties, and their rounding is half a step.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from isoref.field import Field, FieldError

from isograde.cases.analytic import rounded
from isograde.model import Case
from isograde.oracles.bodies import KINDS, Body, known_bodies

BAND = 8.0
"""Distances in cells, beyond which bytes are all 0 or all 255."""

STEP = 2 * BAND / 255
ISOVALUES = {"float64": 0.3125, "uint8": 127.5}
ROUNDINGS = {"float64": 2.0**-21, "uint8": STEP / 2}
SINGLE = 4 * 2.0**-24
"""Share of the box by which an answer in single precision is off: the sample, the difference from
the isovalue, the crossing and its place are each rounded once."""


def cases(seed: int = 0) -> list[Case]:
    """Every case, in the order of the kinds; they do not depend on the seed."""
    del seed
    return [case for n, m in KINDS for case in of_kind(n, m)]


def of_kind(n: int, m: int) -> Iterator[Case]:
    """The cases of m functions on a lattice of dimension n.

    >>> [case.id for case in of_kind(2, 1)][:3]
    ['bodies/2-1/circle-16-float64', 'bodies/2-1/circle-16-uint8', 'bodies/2-1/circle-17-float64']
    """
    for pair in zip(known_bodies(n, m, 0), known_bodies(n, m, 1), strict=True):
        for body in pair:
            for kind in ISOVALUES:
                yield _case(body, kind)


def _case(body: Body, kind: str) -> Case:
    """The case of a body, with samples of this type."""
    tags = frozenset({"bodies", "closed", kind, f"{body.n}-{body.m}"})
    name = f"bodies/{body.n}-{body.m}/{body.name}-{body.shape[0]}-{kind}"
    facts = {"body": body, "rounding": ROUNDINGS[kind] + SINGLE * max(body.shape)}
    samples = int(np.prod(body.shape))
    return Case(name, partial(sampled, body, kind), ISOVALUES[kind], samples, tags, facts)


def sampled(body: Body, kind: str) -> Field:
    """The field of a body; a field of one component has no axis for it."""
    values = rounded(body.samples())
    if kind == "uint8":
        steps = np.rint(np.clip(values, -BAND, BAND) / STEP + ISOVALUES[kind])
        values = np.clip(steps, 0, 255).astype(np.uint8)
    elif kind == "float64":
        values = values + ISOVALUES[kind]
    else:
        raise FieldError(f"no type {kind!r}: {', '.join(ISOVALUES)}")
    return Field.of(values[0] if body.m == 1 else values, dimension=body.n)
