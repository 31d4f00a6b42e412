"""The fields on which exercises are judged: small, the same for ever, a few for each fault.

A case that is no evidence for a claim does no harm: every claim of an exercise must have failed or
passed somewhere before the exercise counts as mended (`isograde.exercises.judged`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref.field import Field

from isograde.cases.trilinear_cells import TUNNELS, far, near
from isograde.model import CONTOURS, CURVES, SURFACES, Case, Kind

LINE = Kind(1, 1)


def case(
    name: str,
    values: Any,
    isovalue: float = 0.0,
    kind: Kind = SURFACES,
    only: tuple[str, ...] = (),
) -> Case:
    """A case of the exercises: m components with one isovalue; judged by these claims, or all."""
    array = np.asarray(values, np.float64)
    return Case(
        f"exercise/{name}",
        lambda: Field.of(array, dimension=kind.n),
        (isovalue,) * kind.m,
        array.size // kind.m,
        frozenset({"noise"}),
        kind=kind,
        only=only,
    )


def lines() -> list[Case]:
    """Lines of samples, some of them equal to the isovalue."""
    rng = np.random.default_rng(1)
    found = [case(f"line-{k}", rng.normal(size=6 + k), 0.2, LINE) for k in range(8)]
    ties = [[0, 1, 2, 1, 0], [2, 1, 0, 1, 1, 0], [1, 0, 0, 2]]
    return found + [case(f"tie-{k}", line, 1.0, LINE) for k, line in enumerate(ties)]


def squares() -> list[Case]:
    """Fields of squares with every pattern, many of them ambiguous."""
    rng = np.random.default_rng(2)
    fields = [rng.normal(size=(4 + k % 3, 5)) for k in range(16)]
    saddles = [rng.uniform(0.1, 3, (2, 2)) * [[1, -1], [-1, 1]] * (-1) ** k for k in range(16)]
    return [case(f"squares-{k}", one, 0.0, CONTOURS) for k, one in enumerate(fields + saddles)]


def cells() -> list[Case]:
    """Each pattern of inside corners in the middle of outside and of inside samples."""
    found = []
    for signs in range(1, 255):
        for outer in (-1.0, 1.0):
            values = np.full((4, 4, 4), outer)
            for c in range(8):
                at = tuple(1 + (c >> a & 1) for a in range(3))
                values[at] = 1.0 if signs >> c & 1 else -1.0
            # No two values alike, and no sample tied.
            values *= 1 + np.random.default_rng(signs).uniform(0, 0.5, values.shape)
            side = "outside" if outer < 0 else "inside"
            found.append(case(f"pattern-{signs}-{side}", values))
    return found


def noise(count: int = 12) -> list[Case]:
    """Noise: two cells of every pair of patterns meet somewhere."""
    rng = np.random.default_rng(4)
    return [case(f"noise-{k}", rng.normal(size=(6, 6, 6))) for k in range(count)]


def faces() -> list[Case]:
    """Two cells with an ambiguous face between them, whose mean and saddle often disagree.

    And some on which a saddle that is computed corner by corner differs with the first corner.
    """
    rng = np.random.default_rng(5)
    found = []
    for k in range(24):
        values = rng.uniform(0.1, 1, (3, 2, 2)) * np.where(rng.random((3, 2, 2)) < 0.5, 1, -1)
        values[1] = rng.uniform(0.1, 4, (2, 2)) * [[1, -1], [-1, 1]]
        found.append(case(f"face-{k}", values))
    return found + noise(2) + saddles()[:24]


def saddles() -> list[Case]:
    """Noise; and two cells whose common face has its saddle on the isovalue, or as near as floats.

    Which side such a saddle is on hangs on the last digit, and so on the order of arithmetic. What
    is right there is not asked, only that both cells come to the same.
    """
    rng = np.random.default_rng(7)
    found = []
    for k in range(48):
        a, b, c = rng.uniform(0.1, 1, 3)
        values = rng.uniform(0.1, 1, (3, 2, 2))
        values[1] = [[a, -b], [-a * c / b, c]]
        values = np.moveaxis(values, 0, k % 3)
        found.append(case(f"saddle-{k}", values, only=("structure.*", "topology.closed")))
    return found + noise(12)


def tunnels() -> list[Case]:
    """Cells with a tunnel and without, far from the change and near to it, both ways round."""
    found = []
    kinds = ("tunnel", "none")
    for name in TUNNELS:
        for base in range(2):
            pairs = [far(name, 0, base), *([near(name, 0, 7)] if base == 0 else [])]
            cells = [one for pair in pairs for one in pair]
            found += [
                case(f"{kinds[k % 2]}-{name}-{base}-{k}-{'+' if sign > 0 else '-'}", sign * one)
                for k, one in enumerate(cells)
                for sign in (1, -1)
            ]
    return found + noise(2)


def voxels() -> list[Case]:
    """Two pairs of voxels that meet in an edge, nearly joined and nearly apart; and noise."""
    rng = np.random.default_rng(9)
    found = []
    for k in range(12):
        values = -rng.uniform(0.1, 1, (4, 4, 3))
        values[1, 1, 1], values[2, 2, 1] = rng.uniform(0.1, 1, 2)
        found.append(case(f"edge-{k}", np.moveaxis(values, 2, k % 3)))
    # The mean is 0 but for rounding, so it depends on the order in which the four are added. What
    # is right there is not asked, only that all paths come to the same.
    values = np.full((4, 4, 4), -1.0)
    values[1:3, 1:3, 1] = [[0.3, -0.6], [-0.4, 0.7]]
    found.append(case("mean-zero", values, only=("structure.*", "topology.closed")))
    return found + noise(4)


def dimensions() -> list[Case]:
    """Noise of each kind that the exercise declares."""
    rng = np.random.default_rng(10)
    shapes = {
        (2, 1): (5, 5),
        (3, 1): (4, 4, 4),
        (3, 2): (4, 4, 4),
        (4, 1): (3,) * 4,
        (4, 2): (3,) * 4,
    }
    found = []
    for (n, m), shape in shapes.items():
        for k in range(3):
            values = rng.normal(size=(m, *shape) if m > 1 else shape)
            found.append(case(f"kind-{n}-{m}-{k}", values, 0.1, Kind(n, m)))
    return found


def pairs_of_fields() -> list[Case]:
    """Two fields of noise each, whose surfaces meet.

    On some a face of the lattice tells the two faults apart (a test looks): where segments run, on
    "direction", or what they pass, on "between".
    """
    rng = np.random.default_rng(11)
    called = {0: "direction", 5: "direction", 7: "between", 10: "between"}
    return [
        case(f"{called.get(k, 'meeting')}-{k}", rng.normal(size=(2, *shape)), 0.1, CURVES)
        for k, shape in enumerate([(2, 2, 2)] * 12 + [(3, 3, 3)] * 4)
    ]


# Seeds of fields without two cells that pinch the same face (lesson 12); a test looks.
UNPINCHED = (0, 1, 3, 4, 5, 6, 7, 8)


def islands() -> list[Case]:
    """Noise in outside samples: pieces of surface that meet in one cell, and no border."""
    found = []
    for seed in UNPINCHED:
        values = -np.ones((5, 5, 5))
        values[1:4, 1:4, 1:4] = np.random.default_rng(seed).normal(size=(3, 3, 3))
        found.append(case(f"islands-{seed}", values))
    return found


def posed() -> list[Case]:
    """Contours in general position, contours through samples, and contours that pass close by."""
    rng = np.random.default_rng(13)
    found = [case(f"general-{k}", rng.normal(size=(5, 6)), 0.1, CONTOURS) for k in range(4)]
    whole = [rng.integers(0, 4, (5, 6)) for _ in range(4)]
    found += [case(f"whole-{k}", one, 2.0, CONTOURS) for k, one in enumerate(whole)]
    for k in range(4):
        values = rng.normal(size=(4, 4))
        values[1, 1], values[2, 2] = rng.uniform(1e-4, 4e-3, 2)
        found.append(case(f"close-{k}", values, 0.0, CONTOURS))
    return found
