"""Ambiguous faces: which rule joins as the true field does.

A face of the lattice with opposite inside corners is asked of the field itself: the function is
sampled on a fine grid over the face, and the parts of its two sides tell whether the inside corners
hang together there, or the outside ones. Where neither do, or both seem to, the face says nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from isoref.fast.marching_faces import AMBIGUOUS, FACE_VERTICES, Pair
from isoref.field import Booleans, Field, Floats, Integers
from isoref.marching_faces import FaceRule
from isoref.plane_waves import directions
from scipy.ndimage import label

RULES: tuple[FaceRule, ...] = ("gradient", "middle", "asymptotic", "separated", "joined")
SIDE = 48
FINE = 41
WAVES = 100
Function = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Right:
    """How often each rule was right, of how many faces that say something."""

    faces: int
    silent: int
    right: dict[str, int]


def real_waves(k: float, seed: int) -> Function:
    """The real part of eq. 5 at any points (.., 3) of the unit cube."""
    chance = np.random.default_rng(seed)
    vectors = k * directions(WAVES, chance)
    amplitudes, phases = chance.normal(size=WAVES), chance.uniform(0, 2 * np.pi, WAVES)

    def psi(points: Floats) -> Floats:
        return np.asarray(np.cos(points @ vectors.T + phases) @ amplitudes / np.sqrt(WAVES))

    return psi


def ambiguous_faces(pair: Pair) -> tuple[Integers, Integers]:
    """Voxels and faces with opposite corners on one side, away from the lattice's border."""
    inside = pair.first.values >= 0
    voxels, faces = [], []
    for f in (0, 2, 4):
        shape = np.array(pair.cells)
        index = np.stack(np.meshgrid(*(np.arange(1, n - 1) for n in shape), indexing="ij"), -1)
        corners = index.reshape(-1, 1, 3) + FACE_VERTICES[f]
        c = inside[tuple(corners.transpose(2, 0, 1))] @ np.array([1, 2, 4, 8])
        own = index.reshape(-1, 3)[AMBIGUOUS[c]]
        voxels.append(np.ravel_multi_index(tuple(own.T), pair.cells))
        faces.append(np.full(len(own), f))
    return np.concatenate(voxels), np.concatenate(faces)


def truth(psi: Function, corners: Floats) -> tuple[Booleans, Booleans]:
    """Of faces with corners (F, 4, 3) along the walk: whether inside corners are separated; known.

    Known is a face on which exactly one of the two pairs of corners hangs together.
    """
    t = np.linspace(0, 1, FINE)
    s, u = np.meshgrid(t, t, indexing="ij")
    weights = np.stack([(1 - s) * (1 - u), s * (1 - u), s * u, (1 - s) * u], axis=-1)
    separated, known = np.zeros(len(corners), bool), np.zeros(len(corners), bool)
    for i, own in enumerate(corners):
        high = psi(weights @ own) >= 0
        parts_high, parts_low = label(high)[0], label(~high)[0]
        walk = [(0, 0), (-1, 0), (-1, -1), (0, -1)]
        first = 0 if high[walk[0]] else 1
        one, two, three, four = (walk[(first + j) % 4] for j in range(4))
        joined = parts_high[one] == parts_high[three] != 0
        apart = parts_low[two] == parts_low[four] != 0
        separated[i], known[i] = apart, joined != apart
    return separated, known


def compared(k: float, seeds: Sequence[int]) -> Right:
    """The rules beside the true field, on waves of this wave number."""
    faces_asked = silent = 0
    right = dict.fromkeys(RULES, 0)
    for seed in seeds:
        psi = real_waves(k, seed)
        t = np.linspace(0, 1, SIDE)
        grid = np.stack(np.meshgrid(t, t, t, indexing="ij"), axis=-1)
        field = Field.of(psi(grid), 1 / (SIDE - 1))
        pairs = {rule: Pair(field, field, (0.0, 0.0), rule) for rule in RULES}
        voxels, faces = ambiguous_faces(pairs["gradient"])
        vertices = pairs["gradient"].vertices(voxels, faces)
        wanted, known = truth(psi, vertices / (SIDE - 1))
        faces_asked += int(known.sum())
        silent += int((~known).sum())
        samples = field.values[tuple(vertices.transpose(2, 0, 1))]
        c = (samples >= 0) @ np.array([1, 2, 4, 8])
        for rule, pair in pairs.items():
            found = pair.separated(field, samples, c, vertices, faces)
            right[rule] += int((found == wanted)[known].sum())
    return Right(faces_asked, silent, right)


def report(numbers: Sequence[float], seeds: Sequence[int]) -> str:
    """A line a wave number, and which rule is right most often."""
    lines = [
        "## Ambiguous faces: the rules beside the true field",
        "",
        f"Random waves of eq. 5 on {SIDE}^3 samples, {len(seeds)} seeds each; the field itself, on "
        f"{FINE} x {FINE} points of each ambiguous face, says which corners hang together. Share "
        "of faces that a rule has right. `gradient` interpolates gradients at the four points p_j, "
        "`middle` takes the one in the middle of the face.",
        "",
        f"| wave number | radians a voxel | faces | silent | {' | '.join(RULES)} |",
        f"| ---: | ---: | ---: | ---: |{' ---: |' * len(RULES)}",
    ]
    total = dict.fromkeys(RULES, 0)
    asked = 0
    for k in numbers:
        found = compared(k, seeds)
        asked += found.faces
        shares = [f"{found.right[rule] / max(found.faces, 1):.3f}" for rule in RULES]
        for rule in RULES:
            total[rule] += found.right[rule]
        lines.append(
            f"| {k:g} | {k / (SIDE - 1):.2f} | {found.faces:,} | {found.silent} "
            f"| {' | '.join(shares)} |"
        )
    best = max(total, key=lambda rule: total[rule])
    worse = [rule for rule in RULES if 2 * total[rule] < asked]
    lines += [
        "",
        f"Over all of them `{best}` is right most often ({total[best] / max(asked, 1):.3f}); worse "
        f"than tossing a coin: {', '.join(f'`{rule}`' for rule in worse) or 'none'}.",
    ]
    return "\n".join(lines) + "\n"
