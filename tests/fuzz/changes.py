"""Inputs made of good ones by a few changes, each known by its number.

Input `number` of a reader is a function of its seeds and of this number alone, so that a run goes
on where it was stopped, and what another machine found is found again.

What is changed: bits and bytes; runs of bytes taken out, doubled, or put in from another seed; a
number written as text, by one from the ends of some range; and, where the seed is JSON, one value
of the tree, by another of another type or depth.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
NUMBERS = (
    b"0", b"-1", b"1", b"2", b"3", b"255", b"256", b"65535", b"65536", b"2147483647",
    b"-2147483648", b"4294967296", b"9223372036854775807", b"9223372036854775808",
    b"1e308", b"1e309", b"-1e-320", b"1e999", b"NaN", b"Infinity", b"-Infinity", b"nan",
    b"inf", b"0x10", b"1.5", b"00", b"-0", b"", b"9" * 400, b"1_000", b"+7", b".5", b"\xd9\xa3",
)  # fmt: skip
BYTES = (0, 1, 10, 13, 32, 34, 44, 48, 91, 92, 93, 123, 125, 127, 128, 192, 254, 255)
TEXTS = (
    "", " ", "\x00", "\x1b[31m", "\ud800", "\u202e", "a" * 3000, "<script>", "../../x",
    "/etc/passwd", "x.npy", "NaN", "\n", "\U0001f600", "topology.closed", "<f8", "|O", "V8",
    "plain", "pass",
)  # fmt: skip
PLAIN: tuple[Callable[[], Any], ...] = (
    lambda: None, lambda: True, lambda: False, lambda: 0, lambda: -1, lambda: 1, lambda: 2**31,
    lambda: 2**63, lambda: 2**64, lambda: 10**40, lambda: 0.5, lambda: -0.0, lambda: 1e308,
    lambda: 5e-324, list, dict, lambda: [[]], lambda: [[[]]], lambda: [None],
    lambda: [0, 0, 0], lambda: [[0.0, 0.0, 0.0]], lambda: {"": 0}, lambda: [True, False],
)  # fmt: skip


def made(seeds: Sequence[bytes], name: str, number: int) -> bytes:
    """Input `number` of the reader of this name.

    >>> made([b"[1, 2]"], "any", 7) == made([b"[1, 2]"], "any", 7)
    True
    """
    chance = random.Random(f"{name}/{number}")
    data = chance.choice(seeds)
    if chance.random() < 0.5 and (tree := _tree(data)) is not None:
        for _ in range(chance.choice((1, 1, 2, 3))):
            tree = other(tree, chance)
        plain = chance.random() < 0.5
        with suppress(RecursionError):  # A nest in a nest, deeper than can be written.
            data = json.dumps(tree, ensure_ascii=plain).encode("utf-8", "surrogatepass")
        if chance.random() < 0.8:
            return data
    for _ in range(chance.choice((1, 1, 1, 2, 3, 5))):
        data = chance.choice(CHANGES)(data, seeds, chance)
    return data


def _tree(data: bytes) -> Any:
    """What a text of JSON says; None for any other."""
    if data[:1] not in (b"{", b"["):
        return None
    try:
        return json.loads(data)
    except ValueError:
        return None


def other(tree: Any, chance: random.Random) -> Any:
    """The tree with one value of it changed, taken out or doubled."""
    if isinstance(tree, dict) and tree and chance.random() < 0.9:
        key = chance.choice(list(tree))
        way = chance.random()
        if way < 0.08:
            return {one: value for one, value in tree.items() if one != key}
        if way < 0.14:
            return {**tree, chance.choice((*TEXTS, *tree)): chance.choice(PLAIN)()}
        return {**tree, key: other(tree[key], chance)}
    if isinstance(tree, list) and tree and chance.random() < 0.85:
        at, way = chance.randrange(len(tree)), chance.random()
        if way < 0.08:
            return tree[:at] + tree[at + 1 :]
        if way < 0.16:
            return tree[:at] + [tree[at]] * chance.choice((2, 3, 20)) + tree[at + 1 :]
        return [*tree[:at], other(tree[at], chance), *tree[at + 1 :]]
    return leaf(tree, chance)


def leaf(value: Any, chance: random.Random) -> Any:
    """Another value, near this one or not."""
    way = chance.random()
    if isinstance(value, int | float) and not isinstance(value, bool) and way < 0.3:
        return chance.choice(
            (value + 1, -value, value * 2, float(value), str(value), value * 1e300)
        )
    if way < 0.4:
        return chance.choice(TEXTS)
    if way < 0.5:
        return [value]
    if way < 0.53:
        nested: Any = value
        for _ in range(chance.choice((3, 50, 900))):
            nested = [nested]
        return nested
    return chance.choice(PLAIN)()


def _bit(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """One bit."""
    if not data:
        return b"\x01"
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def _byte(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """A few bytes in a row, from the ends of the range or any."""
    at, count = chance.randrange(len(data) + 1), chance.choice((1, 1, 2, 4, 8))
    some = (chance.choice(BYTES) if chance.random() < 0.6 else chance.randrange(256),) * count
    return data[:at] + bytes(some) + data[at + count :]


def _out(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """A run of bytes taken out."""
    at = chance.randrange(len(data) + 1)
    return data[:at] + data[at + chance.choice((1, 2, 4, 16, 200)) :]


def _cut(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """The beginning alone."""
    return data[: chance.randrange(len(data) + 1)]


def _twice(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """A run of bytes several times."""
    at = chance.randrange(len(data) + 1)
    end = at + chance.choice((1, 3, 9, 40))
    return data[:end] + data[at:end] * chance.choice((1, 2, 100)) + data[end:]


def _mixed(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """The beginning of this and the end of another seed."""
    another = chance.choice(seeds)
    return data[: chance.randrange(len(data) + 1)] + another[chance.randrange(len(another) + 1) :]


def _number(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    """A number that is written as text."""
    # Look at a part: a large file has very many.
    begin = chance.randrange(max(1, len(data) - 400)) if chance.random() < 0.5 else 0
    found = list(NUMBER.finditer(data, begin, begin + 1200))
    if not found:
        return _byte(data, seeds, chance)
    at = chance.choice(found)
    return data[: at.start()] + chance.choice(NUMBERS) + data[at.end() :]


CHANGES = (_bit, _byte, _byte, _out, _cut, _twice, _mixed, _number, _number, _number)
