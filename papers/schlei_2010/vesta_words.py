"""The sentences of the report that say what came out, each written from the results it is given."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from isoref.cube import REPRESENTATIVES, ambiguous_faces, configuration, is_exchanged

Lengths = tuple[int, ...]


def decisions(
    ways: int, left_out: Counter[Lengths], every: Sequence[int], averaged: Sequence[int], paper: int
) -> str:
    """What decisions by averages reach.

    left_out : the lengths of the cycles of each way that they do not reach
    every, averaged : the lengths of the types over all decisions, and over those by averages
    """
    missed = Counter(every) - Counter(averaged)
    types = [f"{n} of the {every.count(length)} types of {length}-cycle" for length, n in
             sorted(missed.items())]  # fmt: skip
    cells = [f"{n} of {'+'.join(map(str, own))}" for own, n in sorted(left_out.items())]
    told = (
        f"There are {ways} ways to give a cell signs and decisions. The averages of\nfour voxels "
        f"reach {ways - left_out.total()} of them: the averages of two opposite faces have the "
        "same sum for all\nthree pairs, so not every set of decisions can be taken together. "
    )
    if left_out:
        told += f"By their cycles they\nleave out {listed(cells)}; of types, {listed(types)}. "
    same = "as many as" if len(averaged) == paper else "not as many as"
    return (
        f"{told}The\npaper's {paper} types are {same} those of its own mixed mode; a decider that "
        f"looks at more than the\naverage meets {len(every)}. Starred cells below need such a "
        "decider."
    )


def differing(connect: Sequence[int], inverted: Sequence[int]) -> str:
    """Which configurations differ from the templates in section II.G.

    connect, inverted : those in connect, and those whose complement differs in disconnect
    """
    signs = {n: sum(1 << c for c in corners) for n, corners in enumerate(REPRESENTATIVES)}
    asked = [n for n, s in signs.items() if ambiguous_faces(s) or ambiguous_faces(255 - s)]
    own = [n for n in inverted if configuration(255 - signs[n]) == n
           and is_exchanged(255 - signs[n]) == is_exchanged(signs[n])]  # fmt: skip
    all_of = "are all" if list(connect) == asked else f"are {len(connect)} of the {len(asked)}"
    told = f"Those that differ in connect {all_of} configurations with an ambiguous face."
    if own:
        names = listed([str(n) for n in own])
        it = "Configuration {} is its own complement up to a rotation, and its inverted template"
        they = "Configurations {} are their own complements up to a rotation, and their templates"
        told += (
            f" {(it if len(own) == 1 else they).format(names)} still "
            f"{'differs' if len(own) == 1 else 'differ'}: what matters is which corners are cut "
            "apart, not which class the cell belongs to."
        )
    return told


def stacked(problems: Mapping[str, int]) -> str:
    """Where stacked contours leave open which continues which, by planes."""
    some = [f"{name} ({n})" for name, n in problems.items() if n]
    none = [name for name, n in problems.items() if not n]
    told = (
        f"Stacking contours leaves open which contour continues which, in {listed(some)}"
        if some
        else "Stacking contours leaves nothing open here"
    )
    rest = (
        f"; in {listed(none)}, and in three dimensions, nothing has to be matched" if none else ""
    )
    return f"{told}{rest}."


def without_fan(uncut: Mapping[int, tuple[int, int]]) -> str:
    """Which types of long cycle no fan cuts: of each length, how many of how many."""
    shown = ", ".join(f"{n} of the {of} types of {N}-cycle" for N, (n, of) in uncut.items())
    reason = "There is a reason for a point in L" if any(n for n, _ in uncut.values()) else (
        "There is no need of a point in L"
    )  # fmt: skip
    return (
        f"{reason}: without a chord between two cells, no fan from one corner cuts {shown} "
        "(`isoref.vesta.fan_start`)."
    )


def listed(items: Sequence[str]) -> str:
    """The items as a sentence lists them; ``none`` where there is none."""
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items) or "none"
