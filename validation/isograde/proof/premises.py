"""What the argument takes for granted of a rule, tried on the rule itself.

Of the form of the rule, before anything is enumerated; of its tiles, all of them; and of its
decisions, which are arithmetic and can only be tried (`isograde.proof.adversarial`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from numbers import Integral
from typing import Any

import numpy as np
from isoref.field import Booleans, Floats, Integers
from isoref.rule import Rule, Tile

from isograde.proof import adversarial
from isograde.proof.tiles import Case, cases, is_ambiguous, rule_face

MOST_BITS = 12
SINGLES = 30
"""How many columns of each trial are decided once more, each by itself."""


class BrokenError(Exception):
    """A premise fails in a way that leaves nothing to go on with."""


# ------------------------------------------------------------------------------------------------
# The form of a rule
# ------------------------------------------------------------------------------------------------


def faults_of_form(rule: Any) -> Iterator[str]:
    """What is not as a rule has it, in words."""
    for part in ("tile", "decisions", "asks"):
        if not callable(getattr(rule, part, None)):
            yield f"it has no function `{part}`"
    bits = getattr(rule, "bits", None)
    if not isinstance(bits, int) or isinstance(bits, bool) or not 0 <= bits <= MOST_BITS:
        yield f"`bits` is {bits!r}, not a whole number from 0 to {MOST_BITS}"
        return
    if not callable(getattr(rule, "asks", None)):
        return
    for signs in range(256):
        answers = [_called(rule.asks, signs) for _ in range(2)]
        if not all(isinstance(answer, bool | np.bool_) for answer in answers):
            yield f"`asks` answers {answers[0]!r} for signs {signs:08b}, not true or false"
            return
        if answers[0] != answers[1]:
            yield f"`asks` answers differently when asked again for signs {signs:08b}"
            return


def _called(function: Any, *arguments: Any) -> Any:
    """What the function returns, or its exception."""
    try:
        return function(*arguments)
    except Exception as error:  # noqa: BLE001 - anybody's code; the error becomes the finding
        return error


# ------------------------------------------------------------------------------------------------
# The tiles
# ------------------------------------------------------------------------------------------------


def tiles_of(rule: Rule) -> tuple[dict[Case, Tile], list[str]]:
    """The tile of every case, and in words which of them are no tiles."""
    found: dict[Case, Tile] = {}
    faults: list[str] = []
    for case in cases(rule):
        tile = _called(rule.tile, case.signs, case.decision)
        wrong = list(_faults_of_tile(tile))
        faults += [f"cell {case}: {fault}" for fault in wrong]
        if not wrong:
            found[case] = tile
    # Ask again, in the opposite order.
    for case in reversed(found):
        again = _called(rule.tile, case.signs, case.decision)
        if list(_faults_of_tile(again)) or _numbers(again) != _numbers(found[case]):
            faults.append(f"cell {case}: asked again, the rule gives another tile")
    return found, faults


def _faults_of_tile(tile: Any) -> Iterator[str]:
    """What makes this no tile, in words."""
    if isinstance(tile, Exception):
        yield f"`tile` raises {type(tile).__name__}: {tile}"
        return
    try:
        triangles, interior = list(tile.triangles), len(tile.interior)
        nodes = [node for triangle in triangles for node in triangle]
        sizes = {len(triangle) for triangle in triangles}
    except (AttributeError, TypeError) as error:
        yield f"`tile` returns no tile: {error}"
        return
    if sizes - {3}:
        yield f"a triangle has {min(sizes - {3})} nodes"
    for node in nodes:
        if not isinstance(node, Integral) or isinstance(node, bool):
            yield f"a triangle names the node {node!r}, which is no whole number"
            return
    for node in sorted({int(node) for node in nodes}):
        if not 0 <= node < 12 + interior:
            yield (
                f"a triangle names node {node}; there are 0 to 11 and {interior} interior points"
            )
    for node in sorted(set(range(12, 12 + interior)) - set(nodes)):
        yield f"no triangle names the interior node {node}: a vertex by itself"


def _numbers(tile: Tile) -> tuple[tuple[tuple[int, ...], ...], int]:
    """The tile's triangles as numbers, and how many interior points it has."""
    return tuple(tuple(map(int, triangle)) for triangle in tile.triangles), len(tile.interior)


# ------------------------------------------------------------------------------------------------
# The decisions
# ------------------------------------------------------------------------------------------------


def faults_of_decisions(rule: Rule, trials: int) -> Iterator[tuple[str, str]]:
    """What is wrong with the rule's decisions, as (which premise, in words); each premise once.

    The premises: "range" (integers that were enumerated), "cell" (of the cell's own values alone),
    "face" (bits of a face the same from both sides).
    """
    asks = np.array([bool(rule.asks(signs)) for signs in range(256)])
    seen: set[str] = set()
    cells: list[Floats] = []
    bits: list[Integers] = []
    for number, (axis, kind) in enumerate(product(range(3), adversarial.KINDS)):
        rng = np.random.default_rng([1991, number])
        low, high = adversarial.pairs(kind, axis, rng, trials_each(trials))
        asked = [g[:, asks[signs_of(g)]] for g in (low, high)]
        try:
            found = list(_faults_between(rule, asks, axis, low, high))
            bits += [decided(rule, g) for g in asked]
        except BrokenError as error:
            yield "range", str(error)
            return
        cells += asked
        for premise, fault in found:
            if premise not in seen:
                yield premise, f"{fault} ({kind})"
                seen.add(premise)
    # All once more in one call, as large as those of a sweep.
    try:
        differ = decided(rule, np.concatenate(cells, axis=1)) != np.concatenate(bits)
    except BrokenError as error:
        yield "range", str(error)
        return
    if differ.any() and "cell" not in seen:
        yield "cell", f"{differ.sum()} cells are decided differently in one call with all others"


def trials_each(trials: int) -> int:
    """How many pairs of cells of each axis and kind make so many in all, at least.

    >>> trials_each(31)
    2
    """
    return -(-trials // (3 * len(adversarial.KINDS)))


def _faults_between(
    rule: Rule, asks: Booleans, axis: int, low: Floats, high: Floats
) -> Iterator[tuple[str, str]]:
    """What is wrong with the decisions of pairs of cells that share a face across `axis`."""
    both = []
    for g in (low, high):
        asked = asks[signs_of(g)]
        bits = np.zeros(g.shape[1], np.int64)
        bits[asked] = decided(rule, g[:, asked])
        yield from _faults_of_range(rule, g[:, asked], bits[asked])
        yield from _faults_of_cells(rule, g[:, asked], bits[asked])
        both.append((asked, bits))
    (asked_low, mine), (asked_high, theirs) = both
    lower, upper = 2 * axis + 1, 2 * axis
    if upper >= rule.bits or lower >= rule.bits:
        return
    differ = asked_low & asked_high & ((mine >> lower & 1) != (theirs >> upper & 1))
    for n in np.flatnonzero(differ)[:1]:
        values = _shown(low[[c for c in range(8) if c >> axis & 1], n])
        words = f"two cells decide their common face across axis {axis} differently: it has the "
        words += f"values {values}, the cells {_shown(low[:, n])} and {_shown(high[:, n])}"
        yield "face", words


def signs_of(g: Floats) -> Integers:
    """The signs of n cells, from g (8, n)."""
    return np.asarray(((g >= 0) * (1 << np.arange(8))[:, None]).sum(axis=0))


def decided(rule: Rule, g: Floats) -> Integers:
    """What the rule decides for cells g (8, n), as (n,) integers.

    Raises `BrokenError` where it raises, changes its argument, or returns something else.
    """
    if g.shape[1] == 0:
        return np.zeros(0, np.int64)
    given = g.copy(order="K")
    with np.errstate(all="ignore"):
        bits = _called(rule.decisions, given)
    if isinstance(bits, Exception):
        raise BrokenError(f"`decisions` raises {type(bits).__name__}: {bits}")
    if not np.array_equal(given, g):
        raise BrokenError("`decisions` changes the values it is given")
    bits = np.asarray(bits)
    if bits.shape != g.shape[1:] or bits.dtype.kind not in "iu":
        raise BrokenError(
            f"`decisions` returns {bits.dtype} of shape {bits.shape} for {g.shape[1]} cells, not "
            "one whole number for each"
        )
    return bits.astype(np.int64)


def _faults_of_range(rule: Rule, g: Floats, bits: Integers) -> Iterator[tuple[str, str]]:
    """Decisions that were not enumerated, in words."""
    for n in np.flatnonzero((bits < 0) | (bits >> rule.bits != 0))[:1]:
        words = f"is decided {int(bits[n])}, which is not of {rule.bits} bits"
        yield "range", f"cell {_shown(g[:, n])} {words}"
    for f in range(min(rule.bits, 6)):
        free = np.array([is_ambiguous(Case(s), rule_face(f)) for s in range(256)])
        for n in np.flatnonzero((bits >> f & 1 == 1) & ~free[signs_of(g)])[:1]:
            yield "range", f"cell {_shown(g[:, n])} decides its face {f}, which is not ambiguous"


def _faults_of_cells(rule: Rule, g: Floats, bits: Integers) -> Iterator[tuple[str, str]]:
    """Cells whose decision changes with the company they are decided in, in words."""
    backwards = decided(rule, g[:, ::-1])[::-1]
    otherwise_laid = decided(rule, np.asfortranarray(g))
    alone = np.array([decided(rule, g[:, [n]])[0] for n in range(min(SINGLES, g.shape[1]))])
    differ = (bits != backwards) | (bits != otherwise_laid)
    differ[: len(alone)] |= bits[: len(alone)] != alone
    for n in np.flatnonzero(differ)[:1]:
        words = (
            f"is decided {int(bits[n])} among others, and differently by itself, in another order"
        )
        yield "cell", f"cell {_shown(g[:, n])} {words} or in another layout"


def _shown(values: Sequence[float] | Floats) -> str:
    """Values so that they can be typed in again."""
    return "[" + ", ".join(repr(float(x)) for x in values) + "]"
