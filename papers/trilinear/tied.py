"""What the label "equal" does for samples that equal the isovalue, before and after.

Run it from anywhere: ``python papers/trilinear/tied.py``. It writes
reports/papers/trilinear/tied.md: trilinear cubes and the asymptotic decider on fields full of ties,
as they are and with crossings at a sample made one vertex or moved off it (`isoref.ties`). What is
counted is counted by position: vertices at one place are one.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isoref import extract
from isoref.degenerate import state
from isoref.field import Array
from isoref.mesh import Mesh
from isoref.ties import NEARNESS, separated

HERE = Path(__file__).parent
METHODS = ("trilinear-cubes", "asymptotic-decider")
SIDE, SEEDS = 12, range(3)


def whole(limit: int) -> Callable[[int], Array]:
    """Whole numbers from -limit to limit at random."""

    def make(seed: int) -> Array:
        return np.random.default_rng(seed).integers(-limit, limit + 1, size=(SIDE,) * 3)

    return make


def plates(seed: int) -> Array:
    """Plates of ties, one sample thick, along each axis, among samples below the isovalue."""
    values = np.full((SIDE,) * 3, -1)
    values[2:-2, 2:-2, 3 + seed] = 0
    values[2:-2, 3 + seed, 2:-2] = 0
    values[3 + seed, 2:-2, 2:-2] = 0
    return values


def blocks(seed: int) -> Array:
    """Blocks of one and minus one, of two samples a side, some with a tie at each corner."""
    random = np.random.default_rng(seed)
    values = np.kron(random.choice([-1, 1], size=(SIDE // 2,) * 3), np.ones((2, 2, 2), np.int64))
    values[::2, ::2, ::2] *= random.choice([0, 1], size=(SIDE // 2,) * 3)
    return np.asarray(values)


def nearly(seed: int) -> Array:
    """Noise of which three samples in ten are within a billionth of the isovalue."""
    random = np.random.default_rng(seed)
    values = random.normal(size=(SIDE,) * 3)
    values[random.random(values.shape) < 0.3] *= 1e-9
    return values


FIELDS: dict[str, Callable[[int], Array]] = {
    "whole numbers -1 .. 1": whole(1),
    "whole numbers -2 .. 2": whole(2),
    "whole numbers -5 .. 5": whole(5),
    "plates of ties": plates,
    "blocks of -1 and 1 with ties": blocks,
    "noise, a third nearly tied": nearly,
}
COLUMNS = (
    "triangles",
    "without area",
    "vertices at a place of others",
    "edges of more than two",
    "crossings",
)


def counted(mesh: Mesh) -> list[int]:
    """The numbers of `COLUMNS`."""
    _, first, number = np.unique(mesh.vertices, axis=0, return_index=True, return_inverse=True)
    rows = number.reshape(-1)[mesh.simplices]
    whole_ones = (rows != np.roll(rows, 1, axis=1)).all(axis=1)
    placed = Complex.of(mesh.vertices[first], rows[whole_ones])
    return [
        len(mesh.simplices),
        state(mesh).degenerate,
        len(mesh.vertices) - len(first),
        len(placed.crowded_facets),
        len(self_intersections(mesh.vertices, mesh.simplices)),
    ]


def report() -> str:
    """The table and what follows from it."""
    lines = [
        "# Samples that equal the isovalue",
        "",
        f"Made by `papers/trilinear/tied.py`: {len(SEEDS)} fields of {SIDE}^3 samples each, "
        f"isovalue 0, as drawn and with `nearness=1/{round(1 / NEARNESS)}` (`isoref.ties`, after "
        "Custodio, Pesco and Silva 2019). Edges are counted after vertices at one place have "
        "become one; crossings by exact arithmetic. The last columns: samples that became "
        "vertices, crossings moved off a sample, and whether Euler characteristic, pieces and "
        "pinched vertices by index stayed as they were.",
        "",
        f"| field | method | ties | {' | '.join(COLUMNS)} | labelled | moved | topology |",
        f"| --- | --- | --- |{' ---: |' * (len(COLUMNS) + 2)} --- |",
    ]
    left = np.zeros(len(COLUMNS), np.int64)
    by_field: dict[str, int] = {}
    kept = True
    for name, make in FIELDS.items():
        for method in METHODS:
            before, after = np.zeros((2, len(COLUMNS)), np.int64)
            labelled = moved = 0
            same = True
            for seed in SEEDS:
                mesh = extract(make(seed), 0, method=method, provenance=True)
                done = separated(mesh)
                before += counted(mesh)
                after += counted(done.mesh)
                labelled, moved = labelled + done.labelled, moved + done.moved
                one, other = state(mesh), state(done.mesh)
                same &= (one.euler, one.crowded, one.pinched) == (
                    other.euler,
                    other.crowded,
                    other.pinched,
                )
                same &= pieces(mesh) == pieces(done.mesh)
            lines.append(_row(name, method, "as drawn", before, "", "", ""))
            lines.append(
                _row(
                    name, method, "apart", after, labelled, moved, "the same" if same else "DIFFERS"
                )
            )
            left += after
            by_field[name] = by_field.get(name, 0) + int(after[4])
            kept &= same
    crossed = [name for name, count in by_field.items() if count]
    lines += [
        "",
        f"Set apart, {left[1]} triangles are without area, {left[2]} vertices stand where another "
        f"does, and {left[3]} edges have more than two triangles; the topology "
        f"{'is the same everywhere' if kept else 'is not the same everywhere'}. Triangles cross "
        + (f"on: {', '.join(crossed)}." if crossed else "nowhere."),
        "",
    ]
    return "\n".join(lines)


def pieces(mesh: Mesh) -> int:
    """How many pieces the surface has, by index."""
    return Complex.of(mesh.vertices, mesh.simplices).components


def _row(name: str, method: str, ties: str, numbers: Array, *more: int | str) -> str:
    """One line of the table."""
    cells = [f"{n:,}" for n in numbers.tolist()]
    said = [f"{m:,}" if isinstance(m, int) else m for m in more]
    return f"| {' | '.join([name, method, ties, *cells, *said])} |"


def main() -> None:
    """The report, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    path = parser.parse_args().out / "trilinear" / "tied.md"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(report(), encoding="utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
