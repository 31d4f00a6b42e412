"""Fields in the plane: known shapes, every square, every saddle, noise, ties and constants.

Facts: "closed" and "open", how many curves there are; "area", what the closed ones enclose, in
squares, to within "tolerance".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.shapes import CHEAP, ENDS, LONG, gentle
from isograde.model import CONTOURS, Case


def cases(seed: int = 0) -> list[Case]:
    """Every case, deterministic for a seed."""
    listed = [
        _case("disc", _disc, 0.0, PLANE, "known posed", _round(2.5, 0.3, closed=1)),
        _case("annulus", _annulus, 0.0, PLANE, "known", _annular()),
        _case("two-discs", _two_discs, 0.0, PLANE, "known", _round(1.5, 0.3, closed=2)),
        _case("border", _border, 0.0, PLANE, "known", {"closed": 0, "open": 2}),
        _case("waves", partial(_waves, seed), 0.1, PLANE, "posed"),
        _case("noise", partial(_noise, seed), 0.05, (16, 19), "posed noise"),
        _case("narrow", partial(_narrow, seed), 0.0, (2, 24), "posed noise"),
        _case("bytes", partial(_bytes, seed), 99.5, (14, 12), "posed noise"),
        _case("integers", _integers, 9.0, (9, 9), "ties posed"),
        _case("nanometres", partial(_small, seed), 0.05, (16, 19), "noise"),
        _case("constant", _constant, 0.5, (5, 6), "empty"),
        _case("at-the-constant", _constant, 1.0, (5, 6), "empty"),
        _case("out-of-range", _integers, 1000.0, (9, 9), "empty"),
    ]
    for signs in range(16):
        listed.append(_case(f"square-{signs:04b}", partial(_square, signs), 0.0, (2, 2), "cells"))
    for mean in (False, True):
        for saddle in (False, True):
            name = f"saddle-{'mean-in' if mean else 'mean-out'}-{'in' if saddle else 'out'}"
            build = partial(_saddle, mean, saddle)
            listed.append(_case(name, build, 0.0, (2, 2), "cells posed"))
    for axis in range(2):
        build = partial(_long, seed, axis)
        listed.append(_case(f"long-{axis}", build, 0.0, (LONG, 4), "large", only=CHEAP))
    one, every = {"closed": 1, "open": 0}, {"closed": 400, "open": 0}
    also = (*CHEAP, "curves.count")
    listed.append(_case("winding", _winding, 0.0, (WIDE, WIDE), "large known", one, also))
    listed.append(_case("specks", partial(_specks, seed), 0.0, (41, 41), "noise known", every))
    return listed


def _case(
    name: str,
    build: Callable[[], Field],
    isovalue: float,
    shape: tuple[int, int],
    tags: str,
    facts: Mapping[str, Any] | None = None,
    only: tuple[str, ...] = (),
) -> Case:
    """The case of this name; `tags` are separated by spaces."""
    labels = frozenset({"contours", *tags.split()})
    size, key = int(np.prod(shape)), f"contours/{name}"
    return Case(key, build, (isovalue,), size, labels, facts or {}, CONTOURS, only)


PLANE = (25, 29)
# A comb of so many teeth has an outline of more than 65,536 points.
WIDE = 271


def _plane() -> tuple[Floats, Floats, tuple[float, float]]:
    """Coordinates over -3.6 to 3.6 and -4.2 to 4.2 in squares of 0.3."""
    n1, n2 = PLANE
    x, y = np.meshgrid(
        0.3 * (np.arange(n1) - (n1 - 1) / 2), 0.3 * (np.arange(n2) - (n2 - 1) / 2), indexing="ij"
    )
    return x, y, (0.3, 0.3)


def _round(radius: float, h: float, *, closed: int) -> dict[str, Any]:
    """What is known of discs of this radius sampled by their distance, in squares of side h.

    A chord of length up to sqrt(2) h lies h^2 / 4 r inside the circle at most, and interpolation
    errs by h^2 / 8 r: both times the length of the circle bounds the area's error.
    """
    length = 2 * np.pi * radius
    error = length * (h**2 / (4 * radius) + h**2 / (8 * radius)) * closed
    total = closed * np.pi * radius**2 / h**2
    return {"closed": closed, "open": 0, "area": total, "tolerance": error / h**2}


def _annular() -> dict[str, Any]:
    """What is known of the annulus."""
    outer, inner = _round(3.2, 0.3, closed=1), _round(1.4, 0.3, closed=1)
    return {
        "closed": 2,
        "open": 0,
        "area": outer["area"] - inner["area"],
        "tolerance": outer["tolerance"] + inner["tolerance"],
    }


def _disc() -> Field:
    """The distance to a circle."""
    x, y, h = _plane()
    return Field.of(2.5 - np.hypot(x - 0.031, y + 0.017), h)


def _annulus() -> Field:
    """The distance to two circles, the inside between them."""
    x, y, h = _plane()
    return Field.of(0.9 - np.abs(np.hypot(x - 0.031, y + 0.017) - 2.3), h)


def _two_discs() -> Field:
    """The distance to the nearer of two circles."""
    x, y, h = _plane()
    nearer = np.minimum(np.hypot(x - 0.7, y - 2.11), np.hypot(x + 0.6, y + 1.97))
    return Field.of(1.5 - nearer, h)


def _border() -> Field:
    """A band that leaves the lattice on two sides, in oblong squares."""
    x, y, _ = _plane()
    return Field.of(1.03 - np.abs(x + 0.2 * np.sin(y)), (0.5, 2.0))


def _waves(seed: int) -> Field:
    """Twelve plane waves of one length."""
    chance = np.random.default_rng(seed)
    x, y, h = _plane()
    angles, phases = chance.uniform(0, 2 * np.pi, (2, 12))
    sums = [np.cos(3 * (x * np.cos(a) + y * np.sin(a)) + p) for a, p in zip(angles, phases)]  # noqa: B905
    return Field.of(np.sum(sums, axis=0), h)


def _noise(seed: int) -> Field:
    """Independent normal numbers: every square, and every saddle."""
    return Field.of(np.random.default_rng(seed + 1).normal(size=(16, 19)), (1.0, 0.25))


def _small(seed: int) -> Field:
    """The same noise in squares of some nanometres."""
    return Field.of(_noise(seed).values, (4e-9, 3e-9))


def _narrow(seed: int) -> Field:
    """Noise two samples wide: squares with borders on both sides."""
    return Field.of(np.random.default_rng(seed + 2).normal(size=(2, 24)))


def _long(seed: int, axis: int) -> Field:
    """Low samples, with noise in the first and last layers of an axis beyond 65,536 samples."""
    values = np.full((LONG, 4), -1.0)
    values[:ENDS] = gentle("contours/long", seed, (ENDS, 4))
    values[-ENDS:] = gentle("contours/long/end", seed, (ENDS, 4))
    return Field.of(np.ascontiguousarray(np.moveaxis(values, 0, axis)))


def _winding() -> Field:
    """A comb: every second line of samples is inside, and all are joined at one end."""
    values = -np.ones((WIDE, WIDE))
    values[1:-1:2, 1:-1] = 1
    values[1:-1, 1] = 1
    return Field.of(values)


def _specks(seed: int) -> Field:
    """A high sample at every second place in either direction, none at the border."""
    values = -np.abs(gentle("contours/specks", seed, (41, 41)))
    values[1::2, 1::2] *= -1
    return Field.of(values)


def _bytes(seed: int) -> Field:
    """Noise in bytes, with an isovalue between them."""
    return Field.of(np.random.default_rng(seed + 3).integers(0, 200, (14, 12)).astype(np.uint8))


def _integers() -> Field:
    """A disc in small integers: samples on the isovalue."""
    x, y = np.indices((9, 9)) - 4
    return Field.of(18 - x**2 - y**2)


def _constant() -> Field:
    """One value everywhere."""
    return Field.of(np.ones((5, 6)))


def _square(signs: int) -> Field:
    """One square with these corners inside: bit c for the corner (c & 1, c >> 1)."""
    size = np.random.default_rng(signs).uniform(0.1, 1, 4)
    corners = np.where([signs >> c & 1 for c in range(4)], size, -size)
    return Field.of(corners.reshape(2, 2).T)


def _saddle(mean: bool, saddle: bool) -> Field:
    """An ambiguous square whose mean and whose saddle are inside or outside as told."""
    # Opposite corners a, d inside, b, c outside: a + d > b + c joins by mean, ad > bc by saddle.
    a, d, b, c = {
        (True, True): (0.9, 0.7, 0.4, 0.3),
        (False, False): (0.4, 0.3, 0.9, 0.7),
        (True, False): (1.3, 0.1, 0.6, 0.5),
        (False, True): (0.6, 0.5, 1.3, 0.1),
    }[mean, saddle]
    return Field.of([[a, -b], [-c, d]])
