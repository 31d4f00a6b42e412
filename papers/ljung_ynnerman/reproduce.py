"""Reproduce Table 1, Figures 1, 5 and 6 and Appendix A of Ljung & Ynnerman.

Writes ``reports/papers/ljung_ynnerman.md`` and, beside its pictures, ``ljung_ynnerman/methods.md``:
what is drawn of random waves, half an hour of one core, and what is shown of the two methods,
minutes. ``--part waves`` or ``--part methods`` writes one of the two. The paper does not give its
wave numbers; they are found from the one number it prints, the share of empty voxels. Every number
in the column "paper" is read from ``tables.json``; every other one is computed here.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import ljung_curves as curves_of_higher_order
import ljung_faces as faces
import ljung_joining as joinings
import ljung_lines as lines
import ljung_misprints as misprints
import ljung_scaling as scalings
import ljung_words as words
import numpy as np
from isograde.reproduction import Table, write_report
from isoref import lorensen_cline
from isoref.curves import real_and_imaginary
from isoref.fast import marching_faces, surface_intersection
from isoref.fast.surface_intersection import enhanced_marching_cubes
from isoref.field import Field, Floats
from isoref.plane_waves import Complex, bounded_waves, random_waves
from isoref.surface_intersection import IndexedSurface, Segments
from ljung_pictures import figure_1, save
from ljung_vortices import complex_mri, vortices

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
REPORT = ROOT / "reports" / "papers" / "ljung_ynnerman.md"
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


@cache
def matching_wave_number(sampler: Sampler, side: int, seed: int, wanted: float) -> float:
    """The k whose waves leave `wanted` percent of the voxels empty, nearly.

    The area of a nodal surface is proportional to k, and so is the share of its voxels. In a box
    k comes in steps, so the nearest of the k that were tried is taken.
    """
    k = 0.21 * side
    tried: dict[float, float] = {}
    for _ in range(5):
        share = empty_share(sampler((side,) * 3, k, seed=seed))
        tried[k] = share
        if abs(share - wanted) < 0.005:
            break
        # Where no voxel is crossed at all, the waves are too long by far.
        k *= (100 - wanted) / (100 - share) if share < 100 else 2.0
    return min(tried, key=lambda one: abs(tried[one] - wanted))


# --- table 1 -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Waves:
    """One field, its surfaces and their intersection."""

    k: float
    fields: tuple[Field, Field]
    surfaces: tuple[IndexedSurface, IndexedSurface]
    segments: Segments

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
        in_lines = np.bincount(np.bincount(self.segments.cells))
        in_lines[0] = voxels - in_lines[1:].sum()
        counts = [*(surface.histogram() for surface in self.surfaces), in_lines]
        return {
            name: 100 * np.pad(count, (0, 9 - len(count))) / voxels
            for name, count in zip(("real", "imaginary", "lines"), counts, strict=True)
        }


def table_1(side: int, seeds: Sequence[int]) -> tuple[list[Table], dict[str, dict[str, Floats]]]:
    """Table 1 beside ours, once for each equation, with z-scores over the seeds; and the means."""
    printed = PRINTED["table_1"]
    tables, means = [], {}
    for name, sampler in SAMPLERS.items():
        ks, rows = [], []
        for seed in seeds:
            k = matching_wave_number(sampler, side, seed, printed["real"][0])
            ks.append(k)
            rows.append(Waves.of(sampler((side,) * 3, k, seed=seed), k, side).rows())
        table = Table(f"Table 1: percentage of voxels by number of primitives, {name}")
        means[name] = {part: np.mean([r[part] for r in rows], axis=0) for part in rows[0]}
        table.add("voxels", printed["voxels"], (side - 1) ** 3)
        note = "found from the empty share, seed by seed"
        table.add("wave number, radians a side", None, f"{min(ks):.2f} to {max(ks):.2f}", note=note)
        family = sum(len(printed[part]) for part in rows[0]) - 1
        for part in rows[0]:
            for n, paper in enumerate(printed[part]):
                draws = [float(row[part][n]) for row in rows]
                if (part, n) == ("real", 0):
                    # The one number the wave number is fitted to, in steps that a box allows.
                    table.add("real, 0", None, float(np.mean(draws)), note=f"fitted to {paper}")
                else:
                    table.add_draws(f"{part}, {n}", paper, draws, step=0.01, family=family)
        tables.append(table)
    return tables, means


# The rows of Table 1, and the captions of Figure 1 that count the same.
BOTH = {"real": "real_triangles", "imaginary": "imaginary_triangles", "lines": "line_segments"}


def consistency() -> Table:
    """What the printed numbers say about each other."""
    printed, (captions, implied) = PRINTED["table_1"], of_both()
    table = Table(words.one_field(captions, implied))
    note = "first: caption of Figure 1; second: what the row of Table 1 adds up to"
    for part, name in BOTH.items():
        table.add(f"primitives, {part}", captions[name], implied[name], note=note)
    voxels = (printed["side"] - 1) ** 3
    table.add("voxels of a 128^3 cube", printed["voxels"], voxels, note="127^3")
    return table


def of_both() -> tuple[dict[str, int], dict[str, int]]:
    """Primitives by the captions of Figure 1, and as the rows of Table 1 add up."""
    printed, figure = PRINTED["table_1"], PRINTED["figure_1"]
    implied = {}
    for part, name in BOTH.items():
        mean = sum(n * share / 100 for n, share in enumerate(printed[part]))
        implied[name] = round(mean * printed["voxels"])
    return {name: figure[name] for name in BOTH.values()}, implied


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
share of empty voxels is the printed one, and the rest of the table is then compared. A printed
share fits where it can be one more draw: the verdict shows how many standard deviations (those of
a further draw, rounding included) lie between it and the mean over the seeds; the level of 5 % is
shared by all rows of a table. "expected" holds what theory, or the paper's own words, let expect.
[A page of its own](ljung_ynnerman/methods.md) shows what the two methods do.
""".strip()
INTRODUCTION_OF_METHODS = """
Made by `python papers/ljung_ynnerman/reproduce.py --part methods`. "paper" holds what the paper
prints, "expected" what theory, or the paper's own words, let expect. [The page on random
waves](../ljung_ynnerman.md) has Table 1 and the figures.
""".strip()


CAPTIONS = {
    "real_triangles": "triangles, real",
    "imaginary_triangles": "triangles, imaginary",
    "line_segments": "line segments",
    "points": "points",
}
# What a table says, by the first words of its title.
READINGS = {
    "Figures 5 and 6": """
The law is of large volumes. Small lattices miss details of the wave, and the faces of the border
are tested too: the rows that allow for both are the ones to compare.
""",
    "Size by size": """
There are 3 s^2 (s + 1) faces, not 3 s^3: hence the last column.
""",
    "Appendix A": """
Real and imaginary part are independent at a point, which is what the prediction assumes.
""",
}


def main(
    side: int = 128,
    sides: Sequence[int] = (25, 33, 49, 65, 97, 129, 193, 257),
    seeds: int = 16,
    report: Path = REPORT,
    part: str | None = None,
) -> list[Table]:
    """Compute everything, or this part, write the pages and their pictures; the tables."""
    tables: list[Table] = []
    if part != "methods":
        tables += of_waves(side, sides, seeds, report)
    if part != "waves":
        tables += of_methods(side, sides[len(sides) // 2], seeds, report.with_suffix(""))
    return tables


def of_waves(side: int, sides: Sequence[int], seeds: int, report: Path) -> list[Table]:
    """The tables drawn of random waves: Table 1, Figures 1, 5 and 6, Appendix A; their page."""
    folder = report.with_suffix("")
    tables, means = table_1(side, range(seeds))
    figure_table_1(means, folder / "table1.svg")
    printed = PRINTED["table_1"]

    def match(sampler: Sampler, side: int, seed: int) -> float:
        return matching_wave_number(sampler, side, seed, printed["real"][0])

    every = lines.readings(SAMPLERS, side, range(seeds), printed, match)
    same = words.of_which_waves(*of_both())
    parts: list[Table | str] = [*tables, every, consistency(), same]
    parts += growth(sides, max(2, seeds // 2), 27.0 * side / 128, folder)
    chosen = matching_wave_number(bounded_waves, side, 0, empty_share_of_figure_1())
    waves = Waves.of(bounded_waves((side,) * 3, chosen, seed=0), chosen, side)
    curves = surface_intersection.join_segments(waves.segments)
    points = marching_faces.marching_faces(*waves.fields)
    surfaces = [surface.mesh for surface in waves.surfaces]
    note = figure_1(surfaces, curves, points, folder / "figure1.png")
    parts.append(figure_1_counts(side, range(seeds)))
    title = "Ljung & Ynnerman: where two isosurfaces meet"
    return _written(report, title, [INTRODUCTION, *_skipped(note)], parts, _pictures(folder))


def of_methods(side: int, middle: int, seeds: int, folder: Path) -> list[Table]:
    """The tables of what the two methods do, and their page; costs on `middle` samples."""
    k = 27.0 * side / 128
    numbers = (15.0, 20.0, 30.0, 45.0) if seeds > 2 else (30.0,)
    pairs = joinings.fields(side // 2, k, range(2))
    real, note = _real_data(folder / "vortices.png", pairs)
    parts: list[Table | str] = [
        faces.report(numbers, range(max(1, seeds // 4))),
        curves_of_higher_order.report(),
        misprints.report(),
        scalings.costs(middle, min(seeds, 3), k),
        joinings.joining(side // 2, k, range(2)),
        joinings.thresholds(pairs),
        joinings.ties(min(side // 8, 12), range(2)),
        *real,
    ]
    picture = "![Phase vortices of the third echo](vortices.png)"
    pictures = [picture] if (folder / "vortices.png").exists() else []
    title = "Ljung & Ynnerman: what the two methods do"
    opening = [INTRODUCTION_OF_METHODS, *_skipped(note)]
    return _written(folder / "methods.md", title, opening, parts, pictures)


def _skipped(note: str | None) -> list[str]:
    """What was left out, and why."""
    return [f"Skipped: {note}."] if note else []


def _written(
    path: Path,
    title: str,
    opening: Sequence[str],
    parts: Sequence[Table | str],
    pictures: Sequence[str],
) -> list[Table]:
    """The tables among the parts; the page is written."""
    write_report(path, title, [*opening, *_explained(parts), *pictures])
    return [part for part in parts if isinstance(part, Table)]


def growth(sides: Sequence[int], seeds: int, k: float, folder: Path) -> list[Table | str]:
    """Figures 5 and 6 and Appendix A, on every size."""
    counted = [scalings.count(one, seed, k) for one in sides for seed in range(seeds)]
    # Time each once unseen: the first call of a process pays for what later ones find ready.
    scalings.clock(sides[0], 0, k)
    timed = [scalings.clock(one, seed, k) for one in sides for seed in range(min(seeds, 3))]
    scalings.figure_5(timed, folder / "figure5.svg")
    scalings.figure_6(counted, folder / "figure6.svg")
    return [
        scalings.scaling(counted, timed),
        scalings.approach(counted),
        scalings.appendix_a(counted, sides[-1] // 2 + 1, k),
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
        )
        if (folder / name).exists()
    ]


def figure_1_counts(side: int, seeds: Sequence[int]) -> Table:
    """The captions of Figure 1 beside draws of eq. 6, the first of which is in our pictures."""
    printed, wanted = PRINTED["figure_1"], empty_share_of_figure_1()
    draws: dict[str, list[float]] = {"k": [], **{key: [] for key in CAPTIONS}, "ratio": []}
    for seed in seeds:
        k = matching_wave_number(bounded_waves, side, seed, wanted)
        waves = Waves.of(bounded_waves((side,) * 3, k, seed=seed), k, side)
        points = len(marching_faces.marching_faces(*waves.fields))
        made = [len(surface.mesh.simplices) for surface in waves.surfaces]
        counts = [*made, len(waves.segments.cells), points]
        for name, count in zip(draws, [k, *counts, counts[2] / points], strict=True):
            draws[name].append(count)
    table = Table("Figure 1: the captions beside draws of eq. 6")
    note = "found from the number of triangles of the real surface, seed by seed"
    ks = f"{min(draws['k']):.2f} to {max(draws['k']):.2f}"
    table.add("wave number, radians a side", None, ks, note=note)
    for key, what in CAPTIONS.items():
        if key == "real_triangles":  # What is fitted cannot fail to fit.
            mean = float(np.mean(draws[key]))
            table.add(what, None, mean, note=f"fitted to {printed[key]:,}")
        else:
            table.add_draws(what, printed[key], draws[key], step=1.0, family=len(CAPTIONS))
    ratio = printed["line_segments"] / printed["points"]
    note = "the quotient of both captions"
    table.add_draws(
        "segments a point", ratio, draws["ratio"], step=0.0, family=len(CAPTIONS), note=note
    )
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
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--part", choices=("waves", "methods"), help="one page, default both")
    for table in main(part=parser.parse_args().part):
        print(table.markdown())
    print(f"written: {REPORT.relative_to(ROOT)}")
