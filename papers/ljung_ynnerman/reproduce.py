"""Reproduce Table 1, Figures 1, 5 and 6 and Appendix A of Ljung & Ynnerman.

Writes ``reports/papers/ljung_ynnerman.md`` and pictures beside it. The paper does not give its wave
numbers; they are found from the one number it prints, the share of empty voxels. Every number in
the column "paper" is read from ``tables.json``; every other one is computed here.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ljung_joining as joinings
import ljung_scaling as scalings
import numpy as np
from isograde.reproduction import Table, write_report
from isoref import lorensen_cline, surface_intersection
from isoref.curves import Curve, real_and_imaginary
from isoref.fast import marching_faces
from isoref.field import Field, Floats
from isoref.plane_waves import Complex, bounded_waves, random_waves
from isoref.surface_intersection import IndexedSurface, enhanced_marching_cubes
from ljung_pictures import figure_1, save
from ljung_vortices import complex_mri, vortices

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
REPORT = ROOT / "reports" / "papers" / "ljung_ynnerman.md"
# The largest lattice, in samples a side, on which times are taken.
CLOCKED = 129
PRINTED: dict[str, Any] = json.loads((HERE / "tables.json").read_text(encoding="utf-8"))

Sampler = Callable[..., Complex]
SAMPLERS: dict[str, Sampler] = {"eq. 6": bounded_waves, "eq. 5": random_waves}


# --- the wave number -----------------------------------------------------------------------------


def empty_share(psi: Complex) -> float:
    """Percentage of voxels that the nodal surface of Re psi and that of Im psi leave empty."""
    shares = []
    for part in (psi.real, psi.imag):
        b = marching_faces.voxel_configurations(part >= 0)
        shares.append(np.mean((b == 0) | (b == 255)))
    return 100 * float(np.mean(shares))


def matching_wave_number(sampler: Sampler, side: int, seed: int, wanted: float) -> float:
    """The k whose waves leave `wanted` percent of the voxels empty, nearly.

    The area of a nodal surface is proportional to k, and so is the share of its voxels. In a box
    k comes in steps, so the nearest of the k that were tried is taken.
    """
    k = 0.21 * side
    tried: dict[float, float] = {}
    for _ in range(8):
        share = empty_share(sampler((side,) * 3, k, seed=seed))
        tried[k] = share
        if abs(share - wanted) < 0.005:
            break
        k *= (100 - wanted) / (100 - share)
    return min(tried, key=lambda one: abs(tried[one] - wanted))


# --- table 1 -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Waves:
    """One field, its surfaces and their intersection."""

    k: float
    fields: tuple[Field, Field]
    surfaces: tuple[IndexedSurface, IndexedSurface]
    segments: surface_intersection.Segments

    @classmethod
    def of(cls, psi: Complex, k: float, side: int) -> Waves:
        """Everything that Table 1 counts, for the lattice of this side over the unit cube."""
        fields = real_and_imaginary(psi, 1 / (side - 1))
        first, second = (enhanced_marching_cubes(f, 0.0, lorensen_cline.RULE) for f in fields)
        segments = surface_intersection.surface_intersection(first, second)
        return cls(k, fields, (first, second), segments)

    def rows(self) -> dict[str, Floats]:
        """Table 1 of this field: percentages of voxels with 0, 1, 2, .. primitives."""
        voxels = int(np.prod(self.surfaces[0].shape))
        lines = np.bincount(np.bincount(self.segments.cells))
        lines[0] = voxels - lines[1:].sum()
        counts = [*(surface.histogram() for surface in self.surfaces), lines]
        return {
            name: 100 * np.pad(count, (0, 9 - len(count))) / voxels
            for name, count in zip(("real", "imaginary", "lines"), counts, strict=True)
        }


def table_1(side: int, seeds: Sequence[int]) -> tuple[list[Table], dict[str, dict[str, Floats]]]:
    """Table 1 beside ours, once for each equation; mean over the seeds, and the means."""
    printed = PRINTED["table_1"]
    tables, means = [], {}
    for name, sampler in SAMPLERS.items():
        found = []
        for seed in seeds:
            k = matching_wave_number(sampler, side, seed, printed["real"][0])
            found.append(Waves.of(sampler((side,) * 3, k, seed=seed), k, side))
        table = Table(f"Table 1: percentage of voxels by number of primitives, {name}")
        rows = [waves.rows() for waves in found]
        means[name] = {part: np.mean([r[part] for r in rows], axis=0) for part in rows[0]}
        spread = {part: np.std([r[part] for r in rows], axis=0, ddof=1) for part in rows[0]}
        table.add("voxels", printed["voxels"], int(np.prod(found[0].surfaces[0].shape)))
        ks = ", ".join(f"{waves.k:.2f}" for waves in found)
        table.add("wave number, radians a side", None, ks, note="found from the empty share")
        for part in rows[0]:
            for n, paper in enumerate(printed[part]):
                ours = round(float(means[name][part][n]), 2)
                note = f"deviation over {len(seeds)} seeds {spread[part][n]:.2f}"
                table.add(f"{part}, {n}", paper, ours, tolerance=0.1, note=note)
        tables.append(table)
    return tables, means


def consistency() -> Table:
    """What the printed numbers say about each other."""
    table = Table("Table 1 and Figure 1 are not of the same data")
    printed, figure = PRINTED["table_1"], PRINTED["figure_1"]
    for part, name in (
        ("real", "real_triangles"),
        ("imaginary", "imaginary_triangles"),
        ("lines", "line_segments"),
    ):
        mean = sum(n * share / 100 for n, share in enumerate(printed[part]))
        implied = round(mean * printed["voxels"])
        note = "first: caption of Figure 1; second: what the row of Table 1 adds up to"
        table.add(f"primitives, {part}", figure[name], implied, note=note)
    voxels = (printed["side"] - 1) ** 3
    table.add("voxels of a 128^3 cube", printed["voxels"], voxels, note="127^3")
    return table


def empty_share_of_figure_1() -> float:
    """Percentage of voxels that the surfaces of Figure 1 leave empty, by their triangles.

    A mixed voxel has as many triangles in the mean as in Table 1.
    """
    table, figure = PRINTED["table_1"], PRINTED["figure_1"]
    triangles = sum(n * share for n, share in enumerate(table["real"])) / 100 * table["voxels"]
    return float(100 - (100 - table["real"][0]) * figure["real_triangles"] / triangles)


def figure_table_1(means: dict[str, dict[str, Floats]], path: Path) -> None:
    """The rows of Table 1 without the empty voxels, the paper's beside ours."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
    for panel, part in zip(axes, ("real", "lines"), strict=True):
        n = np.arange(1, 6)
        panel.bar(n - 0.27, PRINTED["table_1"][part][1:6], 0.26, label="paper", color="0.3")
        for shift, (name, rows) in zip((0.0, 0.27), means.items(), strict=True):
            panel.bar(n + shift, rows[part][1:6], 0.26, label=name)
        panel.set(xlabel=f"{'lines' if part == 'lines' else 'triangles'} in a voxel", xticks=n)
        panel.set(ylabel="% of voxels")
        panel.legend(frameon=False)
    save(figure, path)


# --- the report ----------------------------------------------------------------------------------

INTRODUCTION = """
Made by `python papers/ljung_ynnerman/reproduce.py`. The paper gives neither its wave numbers nor
its random numbers, so its counts cannot be met exactly; the wave number is chosen so that the
share of empty voxels is the printed one, and the rest of the table is then compared.
""".strip()


# What a table says, by the first words of its title.
READINGS = {
    "Table 1: percentage of voxels by number of primitives, eq. 6": """
One number, the wave number, is fitted to one number, the share of empty voxels. With eq. 6 the rest
of the table follows within the scatter of realisations.
""",
    "Table 1: percentage of voxels by number of primitives, eq. 5": """
Plane waves without walls do not fit as well: too few voxels with two triangles. A likely reason is
that nodal surfaces in a box prefer the directions of its walls, and a surface across a lattice axis
has two triangles a voxel. The printed table agrees with eq. 6, the bounded cube.
""",
    "Table 1 and Figure 1": """
Both are said to be of a 128^3 cube of random waves. The figure must show a field of smaller wave
number: the tables below find one wave number for each, and both then agree with the print.
""",
    "Figures 5 and 6": """
A power and nothing else misses the paper's exponents by up to one percent, more than its interval
allows. The law is not wrong: lattices are finite. Small ones miss details of the wave, and the
faces of the border are tested too. The rows that allow for both are the ones to compare; of five
intervals of 95 % one may well miss. Against the triangles, the plain power has the same fault.
In the paper's Figure 5 the triangle tests are cheap beside making the surfaces. Here they cost
more, since every sign is made certain; but they grow as slowly as the paper says. On small lattices
the fixed cost of array calls decides the times, not the work.
""",
    "Size by size": """
From s = 64 on the triangles are those of s^2. The tested faces divided by s still fall, and divided
by s + 1 they do not: 3 s^2 (s + 1) faces, not 3 s^3, are there to be tested.
""",
    "The greedy joining's threshold": """
h is the longest edge of a voxel; "right" means the curves of the exact joining: as many, of the
same segments, closed where they close. Ends that ought to match differ in their last bits, so a
threshold of nothing breaks curves. From 1e-12 h on greedy is right, until the threshold reaches
from one curve to the next. Smooth fields leave it much room; in noise, where curves pass within a
hundredth of a voxel, it merges them, or shuts one that should end on the border. The real MRI
lies between: curves of a few voxels that begin and end near each other are shut from 0.3 h on. The
exact joining has no such number to choose.
""",
    "Appendix A": """
The predicted number of tests is right because real and imaginary part are independent at a point.
""",
}


def main(
    side: int = 128,
    sides: Sequence[int] = (25, 33, 49, 65, 97, 129, 193, 257),
    seeds: int = 16,
    report: Path = REPORT,
) -> list[Table]:
    """Compute everything, write the report and its pictures; the tables."""
    folder = report.with_suffix("")
    tables, means = table_1(side, range(3))
    figure_table_1(means, folder / "table1.svg")
    k = 27.0 * side / 128
    parts: list[Table | str] = [*tables, consistency(), *growth(sides, seeds, k, folder)]
    parts += [joinings.joining(side // 2, k, range(2))]
    chosen = matching_wave_number(bounded_waves, side, 0, empty_share_of_figure_1())
    waves = Waves.of(bounded_waves((side,) * 3, chosen, seed=0), chosen, side)
    curves = surface_intersection.join_segments(waves.segments)
    points = marching_faces.marching_faces(*waves.fields)
    surfaces = [surface.mesh for surface in waves.surfaces]
    notes = [figure_1(surfaces, curves, points, folder / "figure1.png")]
    pairs = joinings.fields(side // 2, k, range(2))
    real, note = _real_data(folder / "vortices.png", pairs)
    parts += [joinings.thresholds(pairs), figure_1_counts(waves, curves, len(points)), *real]
    skipped = [f"Skipped: {note}." for note in [*notes, note] if note]
    write_report(
        report,
        "Ljung & Ynnerman: where two isosurfaces meet",
        [INTRODUCTION, *skipped, *_explained(parts), *_pictures(folder)],
    )
    return [part for part in parts if isinstance(part, Table)]


def growth(sides: Sequence[int], seeds: int, k: float, folder: Path) -> list[Table | str]:
    """Figures 5 and 6 and Appendix A; times are taken on the smaller lattices only."""
    counted = [scalings.count(one, seed, k) for one in sides for seed in range(seeds)]
    clocked = [one for one in sides if one <= CLOCKED]
    timed = [scalings.clock(one, seed, k) for one in clocked for seed in range(max(2, seeds // 2))]
    scalings.figure_5(timed, folder / "figure5.svg")
    scalings.figure_6(counted, folder / "figure6.svg")
    return [
        scalings.scaling(counted, timed),
        scalings.approach(counted),
        scalings.appendix_a(counted, clocked[-1], k),
    ]


def _explained(parts: Sequence[Table | str]) -> list[Table | str]:
    """The parts, each followed by what it says."""
    found: list[Table | str] = []
    for part in parts:
        title = part.title if isinstance(part, Table) else part.removeprefix("## ")
        found.append(part)
        found += [text.strip() for start, text in READINGS.items() if title.startswith(start)]
    return found


def _pictures(folder: Path) -> list[str]:
    """The pictures that were made."""
    return [
        f"![{text}]({folder.name}/{name})"
        for name, text in (
            ("figure1.png", "Figure 1: both surfaces, coloured curves, tangent-shaded points"),
            ("table1.svg", "Table 1 as bars"),
            ("figure5.svg", "Figure 5: times"),
            ("figure6.svg", "Figure 6: tests"),
            ("vortices.png", "Phase vortices of the third echo"),
        )
        if (folder / name).exists()
    ]


def figure_1_counts(waves: Waves, curves: Sequence[Curve], points: int) -> Table:
    """The captions of Figure 1 beside the field of our pictures."""
    printed = PRINTED["figure_1"]
    table = Table("Figure 1: the captions beside our pictures")
    note = "found from the number of triangles of the real surface"
    table.add("wave number, radians a side", None, round(waves.k, 2), note=note)
    for what, key, ours in (
        ("triangles, real", "real_triangles", len(waves.surfaces[0].mesh.simplices)),
        ("triangles, imaginary", "imaginary_triangles", len(waves.surfaces[1].mesh.simplices)),
        ("line segments", "line_segments", len(waves.segments.cells)),
        ("points", "points", points),
    ):
        apart = 100 * (ours / printed[key] - 1)
        note = f"{apart:+.1f} %; one realisation of random waves beside another"
        table.add(what, printed[key], ours, tolerance=round(0.05 * printed[key]), note=note)
    ratio = printed["line_segments"] / printed["points"]
    own = round(len(waves.segments.cells) / points, 3)
    table.add("segments a point", round(ratio, 3), own, tolerance=0.1, note="hardly depends on k")
    table.add("curves", None, len(curves))
    return table


def _real_data(picture: Path, pairs: joinings.Pairs) -> tuple[list[Table], str | None]:
    """The tables of the real data, or why there are none; its fields are added to `pairs`."""
    folder = os.environ.get("ISOGRADE_DATA")
    if not folder or not (Path(folder) / "romeo_Mag.nii").is_file():
        return [], "phase vortices in real data: set ISOGRADE_DATA to the folder of romeo_Mag.nii"
    try:
        psi, spacing = complex_mri(Path(folder))
    except ImportError as error:
        return [], f"phase vortices in real data need nibabel: {error}"
    for echo in (1, 2):
        fields = real_and_imaginary(psi[..., echo], spacing)
        pairs[f"complex MRI, echo {echo + 1}"] = fields, (0.0, 0.0)
    table, problem = vortices(psi, spacing, picture)
    return [table], problem


if __name__ == "__main__":
    for table in main():
        print(table.markdown())
    print(f"written: {REPORT.relative_to(ROOT)}")
