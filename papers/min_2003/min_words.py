"""The sentences of the report that say what came out, each written from the results it is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import pi

import numpy as np

# Of how many parts a number may be off and still be called one of the ends of a range.
CLOSE = 1e-6


def recipe(unlike: Sequence[int], staircase: bool) -> str:
    """Whether the tables made by Delaunay agree on facets, and are the staircase.

    `unlike` : the pairs of facets that are cut unlike, for each n
    """
    made = (
        "Made by Delaunay from a section whose values grow along the order of the vertices "
        "(`isoref.simplex_section.delaunay`), the tables "
    )
    if not any(unlike):
        agree = f"agree, and are {'' if staircase else 'not '}the staircase"
        return f"{made}{agree}: the recipe of section 3 is sound where the section is chosen well."
    return f"{made}disagree on {sum(unlike):,} pairs of facets too."


def no_gap(rows: Sequence[tuple[tuple[int, int], str, int, int, str]]) -> str:
    """What the check of conformity says: ((n, m), rule, open facets, of these covered, volume)."""
    told = (
        "A facet with one simplex that is *covered* lies on facets of another cut of the same face"
    )
    left = sum(alone - doubled for _, _, alone, doubled, _ in rows)
    volumes: dict[tuple[int, int], set[str]] = {}
    for kind, _, _, _, volume in rows:
        volumes.setdefault(kind, set()).add(volume)
    same = all(len(own) == 1 for own in volumes.values())
    gap = "there is no gap" if left == 0 else f"{left:,} are not covered"
    volume = "the volume is the same" if same else "the volumes are not the same"
    torn = ", but the union is no simplicial complex" if any(row[2] for row in rows) else ""
    return f"{told}: {gap}, {volume}{torn}."


def table_5(rows: Sequence[Sequence[int]], segment: int) -> str:
    """What the printed bytes of Table 5 are; rows of N, .., curve (3), phi (4)."""
    sizes = "The samples of phi are two 8-byte numbers each, on N^3 and not (N+1)^3 of them"
    if any(row[4] != 16 * row[0] ** 3 for row in rows):
        sizes = "The bytes of phi are not those of two 8-byte numbers on N^3 samples"
    growth = _listed([f"{b[3] / a[3]:.2f}" for a, b in pairwise(rows)])
    odd = sum(row[3] % segment != 0 for row in rows)
    return (
        f"{sizes}. A curve takes twice the bytes at twice the samples a side; the printed bytes "
        f"grow by {growth}, and {odd} of the {len(rows)} are no multiple of the {segment} bytes "
        "that a segment takes in Table 6."
    )


def table_6(printed: Mapping[int, Sequence[int]], ours: Mapping[int, int], segment: int) -> str:
    """What the printed bytes of Table 6 are, and where our curve (bytes by N) is the paper's."""
    whole = all(row[3] % segment == 0 for row in printed.values())
    takes = f"A segment takes {segment} bytes, two points of three 4-byte numbers"
    if not whole:
        takes = f"Not all sizes of the curve are multiples of {segment} bytes"
    met = [f"N = {N}" for N in ours if N in printed and printed[N][3] == ours[N]]
    exact = f"the curve of {_listed(met)} is the paper's to the byte" if met else "no curve is met"
    first, step = 3 * segment, 8 * segment
    regular = all((row[4] - first) % step == 0 for row in printed.values())
    stored = f"its sizes are {first} + {step} k, {segment} bytes for each of the 8 parts of a box"
    if not regular:
        stored = f"its sizes are not {first} + {step} k"
    return (
        f"{takes}: so {exact}. Our bytes of phi count 16 for each distinct corner of a box of the "
        f"tree, with the paper's bound. How the paper's tree is stored is not told; {stored}."
    )


def leaves_cut_off(ends: int) -> str:
    """Whether the printed square holds the curve of section 7.2; `ends` of its level set there."""
    there = f"the level set has {ends} ends, where leaves are cut off"
    return (
        "The printed square is [-1, 1]^2, a_i = -1 + 2 i / N for i from 1 to N, but the curve r = "
        f"1 + sin(7 theta) reaches r = 2: there {there if ends else 'it has no end all the same'}."
    )


def lifted_leaf(square: str, lifted: int, ends: Sequence[float], flat: int) -> str:
    """The lifted curve beside the level set: pieces of both, and the angles at its ends."""
    whole = [pi * 2 * turn for turn in (0, 1)]
    at = np.sort(np.asarray(ends, float))
    known = len(at) == 2 and bool(np.all(np.abs(at - whole) < CLOSE))
    where = ", those at theta = 0 and 2 pi" if known else ""
    apart = (
        f"has {flat} pieces, as its lattice has it at the origin, where 14 branches meet"
        if flat != lifted
        else f"has as many pieces, {flat}"
    )
    return (
        f"On {square} the lifted curve has {lifted} piece(s) and {len(at)} ends{where}; the level "
        f"set {apart}."
    )


def table_7(phi: Sequence[int], surface: Sequence[int], triangle: int) -> str:
    """What the printed bytes of Table 7 are."""
    first, step = 6 * 24, 32 * 24
    parts = "; ".join(f"{(size - first) / step:,.10g}" for size in phi)
    regular = all((size - first) % step == 0 for size in phi)
    why = ": as in Table 6, 24 bytes for each part of a box, of which there are 32 in R^5"
    whole = sum(size % triangle == 0 for size in surface)
    of = "All" if whole == len(surface) else f"{whole} of {len(surface)}"
    return (
        f"The sizes of phi in Table 7 are {first} + {step} k, with k = {parts}"
        f"{why if regular else ', not all whole'}. {of} sizes of the surface are multiples of "
        f"{triangle} bytes: a triangle is three points and three normals in space, in 4-byte "
        "numbers."
    )


def constant(printed: float, true: Sequence[float]) -> str:
    """Whether a printed Lipschitz constant bounds every equation, in the maximum norm."""
    largest = int(np.argmax(true))
    safe = "safe" if printed >= true[largest] else "too small"
    return (
        f"The constant {printed:g} is {safe}: in the maximum norm the true one is "
        f"{true[largest]:.4g}, from equation {largest + 1} of {len(true)}."
    )


def of_second_order(spans: Sequence[tuple[float, float]]) -> str:
    """Whether errors over h^2, least and largest for each N, stay of one size as N grows."""
    low, high = min(low for low, _ in spans), max(high for _, high in spans)
    sizes = [max(abs(low), abs(high)) for low, high in spans]
    constant_ = max(sizes) < 2 * min(sizes)
    told = ", whatever N: second order point by point" if constant_ else ", and grows or falls by N"
    return f"It is between {low:.2f} and {high:.2f}{told}."


def outside(number: int, every: int) -> str:
    """How many vertices lie outside the sphere; where none does, why."""
    why = ": phi is convex, so that its interpolant lies above it" if number == 0 else ""
    return f"Of {every:,} vertices {number:,} are outside the sphere{why}."


def _listed(items: Sequence[str]) -> str:
    """The items as a sentence lists them."""
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)
