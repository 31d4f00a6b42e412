"""Table 3's greedy joining beside the exact one, as the threshold grows.

Both joinings get the same segments. Two things can go wrong with the greedy one: an end finds no
partner within the threshold, and the curve is *broken*; or it finds the end of another curve, or
the other end of its own, and curves are *merged*, or one that should end on the border is *closed*.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from isograde.oracles.space_curves import KNOWN
from isograde.reproduction import Table
from isoref.curves import Curve, real_and_imaginary
from isoref.fast import marching_faces, surface_intersection
from isoref.fast.surface_intersection import enhanced_marching_cubes, segment_chains
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.plane_waves import nodal_density, random_waves
from isoref.surface_intersection import Segments, combine_line_segments, greedy_chains

# In longest edges of a voxel.
THRESHOLDS = (0.0, 1e-15, 1e-12, 1e-6, 1e-2, 0.1, 0.3, 1.0, 2.0)
# Samples along each axis of a known field.
SHAPE = (24, 27, 25)

Pair = tuple[Field, Field]
Pairs = dict[str, tuple[Pair, tuple[float, float]]]


@dataclass(frozen=True)
class Comparison:
    """What the greedy joining made of the exact curves.

    curves, closed : how many it found, and how many of them closed
    merged : its curves that hold segments of several exact ones
    broken : exact curves that it has in pieces, or open though they are closed
    shut : its closed curves that hold segments of an open one
    """

    curves: int
    closed: int
    merged: int
    broken: int
    shut: int

    @property
    def right(self) -> bool:
        """Whether it found the exact curves."""
        return not (self.merged or self.broken or self.shut)

    def __str__(self) -> str:
        if self.right:
            return "right"
        faults = {"merged": self.merged, "broken": self.broken, "shut": self.shut}
        told = ", ".join(f"{count} {fault}" for fault, count in faults.items() if count)
        return f"{self.curves}: {told}"


def compare(segments: Segments, shape: tuple[int, ...], threshold: float) -> Comparison:
    """The greedy curves beside the exact ones."""
    exact = segment_chains(segments)
    owner = np.full(len(segments.cells), -1)
    for number, (chain, _) in enumerate(exact):
        owner[chain] = number
    should_close = np.array([closed for _, closed in exact], bool)
    whole, merged, shut, closed_count = np.zeros(len(exact), bool), 0, 0, 0
    pieces = np.zeros(len(exact), int)
    greedy = greedy_chains(segments, shape, threshold)
    for trace, closed in greedy:
        owners = np.setdiff1d(owner[[segment for segment, _ in trace]], [-1])
        pieces[owners] += 1
        whole[owners] |= closed
        merged += len(owners) > 1
        shut += closed and not should_close[owners].all()
        closed_count += closed
    broken = int(((pieces != 1) | (should_close & ~whole)).sum())
    return Comparison(len(greedy), closed_count, merged, broken, shut)


def fields(side: int, k: float, seeds: Sequence[int]) -> Pairs:
    """Pairs of fields with their isovalues: the known curves, random waves, and noise."""
    found: Pairs = {}
    for known in (make() for make in KNOWN):
        first, second, spacing = known.sample(SHAPE)
        pair = Field.of(first, spacing.tolist()), Field.of(second, spacing.tolist())
        found[known.name.replace("-", " ")] = pair, known.levels
    for seed in seeds:
        found[f"random waves, seed {seed}"] = _waves(side, k, seed), (0.0, 0.0)
    noise = np.random.default_rng(1).normal(size=(2, 12, 12, 12))
    found["noise"] = (Field.of(noise[0]), Field.of(noise[1])), (0.0, 0.0)
    return found


def _waves(side: int, k: float, seed: int) -> Pair:
    """Real and imaginary part of plane waves on the unit cube."""
    return real_and_imaginary(random_waves((side,) * 3, k, seed=seed), 1 / (side - 1))


def thresholds(pairs: Pairs) -> str:
    """A row a field, a column a threshold, as a Markdown table."""
    names = " | ".join(f"{share:g} h" for share in THRESHOLDS)
    lines = [
        "## The greedy joining's threshold",
        "",
        f"| | segments | exact curves (closed) | {names} |",
        "| --- | ---: | ---: |" + " --- |" * len(THRESHOLDS),
    ]
    right: dict[str, list[float]] = {}
    for name, (pair, isovalues) in pairs.items():
        surfaces = [
            enhanced_marching_cubes(field, isovalue)
            for field, isovalue in zip(pair, isovalues, strict=True)
        ]
        segments = surface_intersection.surface_intersection(*surfaces)
        exact = segment_chains(segments)
        h = max(pair[0].spacing)
        found = [compare(segments, surfaces[0].shape, share * h) for share in THRESHOLDS]
        cells = " | ".join(map(str, found))
        right[name] = [t for t, one in zip(THRESHOLDS, found, strict=True) if one.right]
        count = f"{len(exact)} ({sum(closed for _, closed in exact)})"
        lines.append(f"| {name} | {len(segments.cells):,} | {count} | {cells} |")
    return "\n".join([*lines, "", joined_sentence(right)]) + "\n"


def joined_sentence(right: dict[str, list[float]]) -> str:
    """What the table says: the thresholds that are right, and on which fields."""
    always = [t for t in THRESHOLDS if all(t in own for own in right.values())]
    told = [
        'h is the longest edge of a voxel; "right" means the curves of the exact joining: as many, '
        "of the same segments, closed where they close. "
        f"Thresholds that are right on every field: {_listed(always)}."
    ]
    for threshold in THRESHOLDS:
        wrong = [name for name, own in right.items() if threshold not in own]
        if wrong:
            told.append(f"{threshold:g} h is wrong on {len(wrong)} of {len(right)}.")
    return " ".join([*told, "The exact joining has no such number to choose."])


def ties(side: int, seeds: Sequence[int]) -> Table:
    """Whole numbers, a fifth or a third of them on the isovalue: ends of curves inside the volume.

    Without the motion: the same surfaces, of which nothing says on which edges their vertices are.
    """
    title = "Ties: ends of curves inside the volume, on whole numbers at random"
    table = Table(title)
    for limit in (1, 2):
        explicit = still = faces = curves = 0
        for seed in seeds:
            random = np.random.default_rng(seed)
            numbers = random.integers(-limit, limit + 1, size=(2, side, side, side))
            pair = Field.of(numbers[0]), Field.of(numbers[1])
            one, two = (enhanced_marching_cubes(field, 0.0) for field in pair)
            fixed = [replace(x, mesh=Mesh(x.mesh.vertices, x.mesh.simplices)) for x in (one, two)]
            found = surface_intersection.join_segments(
                surface_intersection.surface_intersection(one, two)
            )
            curves += len(found)
            explicit += loose(found, side)
            still += loose(
                surface_intersection.join_segments(
                    surface_intersection.surface_intersection(*fixed)
                ),
                side,
            )
            faces += loose(marching_faces.intersection_curves(*pair), side)
        what = f"{len(seeds)} pairs of {side}^3 samples, -{limit} .. {limit}"
        table.add(f"{what}: explicit method", None, explicit, expected=0, note=f"{curves} curves")
        table.add(f"{what}: the same without the infinitesimal motion", None, still)
        table.add(f"{what}: Marching Faces", None, faces, expected=0)
    return table


def loose(curves: Sequence[Curve], side: int) -> int:
    """How many ends of open curves are not on the border of a lattice with spacing 1."""
    ends = [curve.points[[0, -1]] for curve in curves if not curve.closed]
    places = np.concatenate([np.empty((0, 3)), *ends])
    return int((~((places == 0) | (places == side - 1)).any(axis=1)).sum())


def _listed(numbers: Sequence[float]) -> str:
    """Numbers in words."""
    return ", ".join(f"{x:g} h" for x in numbers) or "none"


def joining(side: int, k: float, seeds: Sequence[int]) -> Table:
    """Table 3's greedy joining beside joining by identity, and marching faces beside both."""
    table = Table("Joining: greedy (Table 3), by identity, and Marching Faces")
    for seed in seeds:
        pair = _waves(side, k, seed)
        one, two = (enhanced_marching_cubes(field, 0.0) for field in pair)
        segments = surface_intersection.surface_intersection(one, two)
        exact = surface_intersection.join_segments(segments)
        greedy = combine_line_segments(segments, one.shape, 1e-3 / side)
        faces = marching_faces.intersection_curves(*pair, rule="asymptotic")
        for name, curves in (("identity", exact), ("greedy", greedy), ("faces", faces)):
            length = sum(curve.length for curve in curves)
            closed = sum(curve.closed for curve in curves)
            what = f"{len(curves)} curves, {closed} closed, length {length:.4f}"
            table.add(f"seed {seed}, {name}", None, what)
        table.add(f"seed {seed}, mean length by theory", None, round(nodal_density(k), 4))
    return table
