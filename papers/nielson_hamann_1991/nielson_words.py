"""The sentences of the report that say what came out, each written from the results it is given.

A sentence whose condition does not hold is another sentence, or none: nothing here is known
beforehand but what the paper says.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from isoref.asymptotic_decider import VARIANTS, bits_of, drawing, moved_faces
from isoref.cube import ROTATIONS, moved_signs
from nielson_lists import SLIPS, Numbers, Pair, order, pairs, read_list, shown

OPPOSITE = (0b000011, 0b001100, 0b110000)
LETTERS = "ABCDEFGHIJ"


def misprints(printed: dict[str, int], ours: dict[str, int], voxels: int) -> dict[str, str]:
    """The rows of a column whose printed number alone keeps it from summing to its voxels.

    >>> misprints({"8": 5, "9": 304}, {"8": 5, "9": 340}, 345)
    {'9': 'two digits swapped: 304 does not make the column sum to its voxels'}
    >>> misprints({"8": 5, "9": 304}, {"8": 6, "9": 340}, 345), misprints({"9": 3}, {"9": 4}, 3)
    ({}, {})
    """
    wrong = [row for row in printed if printed[row] != ours[row]]
    total = sum(printed.values())
    if len(wrong) != 1 or total == voxels or total - printed[wrong[0]] + ours[wrong[0]] != voxels:
        return {}
    old, new = str(printed[wrong[0]]), str(ours[wrong[0]])
    swapped = sorted(old) == sorted(new) and sum(a != b for a, b in zip(old, new, strict=True)) == 2
    cause = "two digits swapped: " if swapped else ""
    return {wrong[0]: f"{cause}{old} does not make the column sum to its voxels"}


def factor(right: int, as_printed: int, rows: int) -> str:
    """Which factor gives the column, from how many of its rows each does."""
    if right > as_printed:
        which = "the factor is .75"
    else:
        which = "the factor is 75" if as_printed > right else "neither is nearer"
    return f"as printed in {as_printed} of {rows} rows, with .75 in {right}: {which}"


def barred() -> set[str]:
    """Variants of 13 that separate both of two opposite faces and join both of two others."""
    decisions = {name: bits_of(VARIANTS[name]) for name in VARIANTS if name.startswith("13")}
    return {
        name
        for name, d in decisions.items()
        if any(d & p == p for p in OPPOSITE) and any(not d & p for p in OPPOSITE)
    }


def reached(found: Counter[str]) -> str:
    """Which variants of 13 never occurred, and why where there is a reason."""
    never = {name for name in VARIANTS if name.startswith("13") and not found[name]}
    if not never:
        return "Every variant of 13 occurs."
    listed = sorted(never)
    told = f"Never {' or '.join([', '.join(listed[:-1]), listed[-1]] if listed[1:] else listed)}"
    if never == barred():
        return (
            f"{told}: a separated pair of opposite faces puts the product of the four inside "
            "values below that of the outside values, a joined pair does not, so no values have "
            "one pair of each."
        )
    reasoned = ", ".join(sorted(never & barred())) or "none"
    return f"{told}; of these, and of those that do occur, no values can have: {reasoned}."


def unlettered(found: Counter[str]) -> str:
    """The variants of 13 that the paper has no letter for, and its classes counted again."""
    target = drawing(13)
    turns = [move for move in ROTATIONS if moved_signs(target, move) == target]
    classes = {frozenset(moved_faces(d, move) for move in turns) for d in range(64)}
    three = sum(next(iter(own)).bit_count() == 3 for own in classes)
    named = {name: len(VARIANTS[name]) for name in VARIANTS if name.startswith("13")}
    printed = sum(named[f"13{letter}"] == 3 for letter in LETTERS)
    extra = [name for name in named if name[-1] not in LETTERS]
    seen = ", ".join(f"{name} ({found[name]:,} times)" for name in extra) or "none"
    return (
        f"Variants that section 3 has no letter for: {seen}. It counts {printed} classes with "
        f"three separated faces where there are {three} under rotation."
    )


def slips_of_the_scan(printed: Sequence[Numbers], derived: Sequence[Pair]) -> str:
    """Edges of Figure 12 that are scanned wrong, each with the only derived one it may stand for.

    >>> slips_of_the_scan([(3, 7), (10, 5)], [frozenset((3, 7)), frozenset((1, 5))])
    "The scan's e10e5 is e1e5."
    """
    right = {frozenset(edge) for edge in printed}
    left, told = [edge for edge in derived if edge not in right], []
    for edge in printed:
        if frozenset(edge) in derived:
            continue
        meant = [other for other in left if _may_be(edge, other)]
        told.append(f"{shown(edge)} is {shown(meant[0]) if len(meant) == 1 else 'not explained'}")
    return f"The scan's {', and its '.join(told)}." if told else "The scan has them all."


def _may_be(edge: Numbers, other: Pair) -> bool:
    """Whether one slip of the scan makes this edge of the other."""
    return any(
        frozenset((*edge[:i], meant, *edge[i + 1 :])) == other
        for i, number in enumerate(edge)
        for meant in SLIPS.get(number, ())
    )


def other_diagonal(replaced: str, by: str) -> str:
    """What the text says of the other diagonal of 3B, and what it must say."""
    old, new = read_list(replaced), read_list(by)
    every = Counter(side for triangle in old for side in pairs(triangle))
    (inner,) = (side for side, times in every.items() if times == 2)
    ends = frozenset().union(*old) - inner
    wanted = [frozenset((*ends, corner)) for corner in inner]
    told = (
        f"The other diagonal of 3B: the text replaces {' and '.join(map(shown, old))} by "
        f"{' and '.join(map(shown, new))}. The two fill a quadrilateral whose other diagonal is "
        f"{shown(ends)}"
    )
    absent = [triangle for triangle in wanted if triangle not in map(frozenset, new)]
    if not absent:
        return f"{told}, and so do these."
    return f"{told}, so that {', '.join(map(shown, order(set(absent))))} must be among these."


def by_choi(same: Collection[bool], smaller: Collection[bool]) -> str:
    """What Choi's criterion changes, over the volumes on which it was tried."""
    return (
        f"With Choi's criterion there are as many triangles on {sum(same)} of {len(same)} of these "
        f"fields, and the mean angle is smaller on {sum(smaller)}: it looks at one edge, not at "
        "its neighbours."
    )
