"""Functions in two to five dimensions: known manifolds, noise, ties, and zeros apart.

Facts of a known case: "manifold", the `Manifold`; "euler" and "components".
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field

from isograde.model import Case, Kind
from isograde.oracles.known_manifolds import MANIFOLDS, Manifold

# Samples along each axis of a known case, by n.
COARSE = {2: 25, 3: 17, 4: 12, 5: 8}
# Samples along each axis of a case of noise, by n.
ROUGH = {2: (9, 8), 3: (6, 5, 6), 4: (4, 4, 3, 4), 5: (3, 2, 3, 2, 2)}
# Samples along the axis that is long, and along the others.
LONG, WIDE = 258, 2
# Kinds that no other family poses in every way.
POSED = ((4, 1), (4, 2), (5, 3))


def cases(seed: int = 0) -> list[Case]:
    """Every case, deterministic for a seed."""
    listed = [_known_case(known) for known in MANIFOLDS.values()]
    for n, m in ((2, 1), (3, 1), (3, 2), (4, 1), (4, 2), (5, 1), (5, 3)):
        for samples, tags in (("noise", "noise"), ("integers", "ties")):
            posed = f"{tags} posed" if (n, m) in POSED else tags
            listed.append(_case(samples, n, m, seed, posed))
    listed += [_case(f"uneven-{last}", 3, 2, seed, "noise") for last in range(2)]
    listed += [_long_case(axis, seed) for axis in range(4)]
    return [
        *listed,
        _case("positive", 2, 1, seed, "empty"),
        _case("positive", 3, 1, seed, "empty"),
        Case("simplices/apart", _apart, (0.0, 0.0), 5**3, _tags("empty"), {}, Kind(3, 2)),
    ]


def _tags(tags: str) -> frozenset[str]:
    """The tags of a case of this family; `tags` are separated by spaces."""
    return frozenset({"simplices", *tags.split()})


def _case(samples: str, n: int, m: int, seed: int, tags: str) -> Case:
    """The case of m arrays of such random samples."""
    build = partial(_noise, n, m, samples, seed)
    size = int(np.prod(ROUGH[n]))
    name = f"simplices/{samples}-{n}-{m}"
    return Case(name, build, (0.0,) * m, size, _tags(tags), {}, Kind(n, m))


def _long_case(axis: int, seed: int) -> Case:
    """The case of noise at both ends of one axis of four, past 256 samples."""
    size = LONG * WIDE**3
    build = partial(_long, axis, seed)
    return Case(f"simplices/long-{axis}", build, (0.0,), size, _tags("noise"), {}, Kind(4, 1))


def _known_case(known: Manifold) -> Case:
    """The case that samples a known manifold."""
    N, n, m = COARSE[known.n], known.n, known.m
    facts = {"manifold": known, "euler": known.euler, "components": known.pieces}
    tags = _tags("flat" if known.flat else "curved")
    name, build = f"simplices/{known.name}", partial(_sampled, known, N)
    return Case(name, build, (0.0,) * m, N**n, tags, facts, Kind(n, m))


def _sampled(known: Manifold, N: int) -> Field:
    """A known manifold's functions on N samples a side."""
    values, spacing = known.sample(N)
    values = values[0] if known.m == 1 else values
    return Field.of(values, spacing, [-known.half] * known.n, dimension=known.n)


def _noise(n: int, m: int, kind: str, seed: int) -> Field:
    """Random samples: generic, positive, whole from -1 to 1, or one array far below the others."""
    rng = np.random.default_rng([seed, n, m])
    shape = (m, *ROUGH[n])
    values = rng.integers(-1, 2, shape) * 1.0 if kind == "integers" else rng.normal(size=shape)
    values = np.exp(values) if kind == "positive" else values
    if kind.startswith("uneven-"):
        values[int(kind[-1])] *= 2.0**-40
    return Field.of(values[0] if m == 1 else values, dimension=n)


def _long(axis: int, seed: int) -> Field:
    """Low samples, with noise in the first and the last layers of this axis."""
    values = np.full((LONG, WIDE, WIDE, WIDE), -1.0)
    ends = np.r_[:3, LONG - 3 : LONG]
    values[ends] = np.random.default_rng([seed, axis]).normal(size=(6, WIDE, WIDE, WIDE))
    return Field.of(np.ascontiguousarray(np.moveaxis(values, 0, axis)))


def _apart() -> Field:
    """Two components with zeros, but none in common."""
    x = np.indices((5, 5, 5))[0].astype(float)
    return Field.of(np.stack([x - 0.5, x - 3.5]), dimension=3)
