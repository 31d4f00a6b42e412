"""Functions in two to five dimensions: known manifolds, noise, ties, and zeros apart."""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field

from isograde.model import Case
from isograde.oracles.known_manifolds import MANIFOLDS, Manifold

# Samples along each axis of a known case, by n; "finer" has cells of half the size.
COARSE = {2: 25, 3: 17, 4: 12, 5: 8}
# Samples along each axis of a case of noise, by n.
ROUGH = {2: (9, 8), 3: (6, 5, 6), 4: (4, 4, 3, 4), 5: (3, 2, 3, 2, 2)}


def cases(seed: int = 0) -> list[Case]:
    """Every case of the discipline, deterministic for a seed."""
    listed = [_known_case(known) for known in MANIFOLDS.values()]
    for n, m in ((2, 1), (3, 1), (3, 2), (4, 1), (4, 2), (5, 1), (5, 3)):
        for kind, tags in (("noise", {"generic"}), ("integers", {"ties"})):
            build = partial(_noise, n, m, kind, seed)
            tagged = frozenset({"simplices", *tags})
            size = int(np.prod(ROUGH[n]))
            listed.append(Case(f"simplices/{kind}-{n}-{m}", build, 0.0, size, tagged))
    empty = frozenset({"simplices", "empty"})
    for n in (2, 3):
        build = partial(_noise, n, 1, "positive", seed)
        listed.append(Case(f"simplices/positive-{n}-1", build, 0.0, int(np.prod(ROUGH[n])), empty))
    return [*listed, Case("simplices/apart", _apart, 0.0, 5**3, empty)]


def _known_case(known: Manifold) -> Case:
    """The case that samples a known manifold."""
    tags = {"simplices", "generic", "known", "flat" if known.flat else "curved"}
    tags |= {"volume"} if known.volume is not None else set()
    size = COARSE[known.n]
    facts = {"euler": known.euler, "components": known.pieces}
    return Case(
        f"simplices/{known.name}",
        lambda: _sampled(known, size),
        0.0,
        size**known.n,
        frozenset(tags),
        facts,
    )


def _sampled(known: Manifold, N: int) -> Field:
    """A known manifold's functions on N samples a side."""
    values, spacing = known.sample(N)
    return Field.of(values, spacing, [-known.half] * known.n, dimension=known.n)


def _noise(n: int, m: int, kind: str, seed: int) -> Field:
    """Random samples: generic ones, positive ones, or whole numbers from -1 to 1."""
    rng = np.random.default_rng([seed, n, m])
    shape = (m, *ROUGH[n])
    values = rng.integers(-1, 2, shape) * 1.0 if kind == "integers" else rng.normal(size=shape)
    return Field.of(np.exp(values) if kind == "positive" else values, dimension=n)


def _apart() -> Field:
    """Two components with zeros, but none in common."""
    x = np.indices((5, 5, 5))[0].astype(float)
    return Field.of(np.stack([x - 0.5, x - 3.5]), dimension=3)


def pose(variant: str, case: Case, field: Field) -> Field:
    """The field of a variant of a case: ``plain`` or ``finer``."""
    if variant == "finer":
        known = MANIFOLDS[case.id.removeprefix("simplices/")]
        return _sampled(known, 2 * COARSE[known.n] - 1)
    return field
