"""Reproduce Table 1, Figures 1, 5 and 6 and Appendix A of Ljung & Ynnerman.

Writes ``reports/papers/ljung_ynnerman.md`` and pictures beside it. The paper does not give its wave
numbers; they are found from the one number it prints, the share of empty voxels. Every number in
the column "paper" is read from ``tables.json``; every other one is computed here.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from isograde.reproduction import Table, write_report
from isograde.truths.space_curves import phase_winding
from isoref import lorensen_cline, marching_faces, surface_intersection
from isoref.curves import Curve, real_and_imaginary
from isoref.field import Field, Floats
from isoref.plane_waves import Complex, bounded_waves, nodal_density, random_waves
from isoref.surface_intersection import IndexedSurface, enhanced_marching_cubes
from scipy import stats

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


# --- figures 5 and 6, appendix A -----------------------------------------------------------------


@dataclass(frozen=True)
class Measured:
    """What Figures 5 and 6 plot, for one size and one seed; s is the side in voxels."""

    s: int
    seed: int
    n1: int
    n2: int
    trisect: int
    xface: int
    emc_seconds: float
    isect_seconds: float
    faces_seconds: float


def measure(side: int, seed: int, k: float) -> Measured:
    """Tests and times of both methods, for waves of a fixed geometry on this lattice."""
    first, second = real_and_imaginary(random_waves((side,) * 3, k, seed=seed), 1 / (side - 1))
    start = time.perf_counter()
    one, two = (enhanced_marching_cubes(field, 0.0) for field in (first, second))
    made = time.perf_counter()
    segments = surface_intersection.surface_intersection(one, two)
    met = time.perf_counter()
    marching_faces.marching_faces(first, second)
    marched = time.perf_counter()
    pair = marching_faces.Pair(first, second, (0.0, 0.0), "gradient")
    return Measured(
        s=side - 1,
        seed=seed,
        n1=len(one.mesh.simplices),
        n2=len(two.mesh.simplices),
        trisect=segments.tests,
        xface=sum(len(voxels) for voxels, _ in pair.candidates()),
        emc_seconds=made - start,
        isect_seconds=met - made,
        faces_seconds=marched - met,
    )


def exponent(rows: Sequence[Measured], of: str, against: str) -> tuple[float, float]:
    """The slope of log(of) over log(against): mean over the seeds, half its 95 % interval."""
    slopes = []
    for seed in sorted({row.seed for row in rows}):
        own = [row for row in rows if row.seed == seed]
        x = np.log([getattr(row, against) for row in own])
        y = np.log([getattr(row, of) for row in own])
        slopes.append(float(np.polyfit(x, y, 1)[0]))
    return interval(slopes)


def interval(numbers: Sequence[float]) -> tuple[float, float]:
    """Mean, and half the width of its 95 % interval by Student's t."""
    n = len(numbers)
    half = stats.t.ppf(0.975, n - 1) * np.std(numbers, ddof=1) / np.sqrt(n)
    return float(np.mean(numbers)), float(half)


def shown(value: tuple[float, float]) -> str:
    """Mean and half width, with as many digits as they deserve."""
    return f"{value[0]:.3f} ± {value[1]:.3f}"


def scaling(rows: Sequence[Measured]) -> Table:
    """The fitted slopes of Figures 5 and 6."""
    table = Table("Figures 5 and 6: exponents, fitted over sizes, for several seeds")
    middle = float(np.median([row.s for row in rows]))
    large = [row for row in rows if row.s >= middle]
    for of, against, claimed in (
        ("trisect", "s", 1.0),
        ("xface", "s", 1.0),
        ("trisect", "n1", 0.5),
        ("xface", "n1", 0.5),
        ("n1", "s", 2.0),
    ):
        for some, sizes in ((rows, "all sizes"), (large, f"s from {min(r.s for r in large)}")):
            mean, half = exponent(some, of, against)
            note = f"{sizes}; 95 % interval ± {half:.3f}"
            what = f"{of} over {against}"
            table.add(what, claimed, round(mean, 3), tolerance=round(half, 3), note=note)
    for of in ("emc_seconds", "isect_seconds", "faces_seconds"):
        note = "time over triangles, this machine; a share of it is constant"
        table.add(f"{of} over n1", None, shown(exponent(rows, of, "n1")), note=note)
    sides = sorted({row.s for row in rows})
    fastest = sum(_faces_fastest([row for row in rows if row.s == s]) for s in sides)
    what = f"sizes, of {len(sides)}, at which Marching Faces takes the least time"
    table.add(what, len(sides), fastest, note="the paper: Figure 5; medians over the seeds")
    ratio = interval([row.trisect / row.xface for row in rows])
    note = "the paper: Marching Faces has a smaller constant"
    table.add("trisect / xface", None, shown(ratio), note=note)
    return table


def _faces_fastest(rows: Sequence[Measured]) -> bool:
    """Whether Marching Faces takes less time than either half of the explicit way, by medians."""
    emc, isect, faces = (
        float(np.median([getattr(row, f"{name}_seconds") for row in rows]))
        for name in ("emc", "isect", "faces")
    )
    return faces < min(emc, isect)


def appendix_a(rows: Sequence[Measured], k: float) -> Table:
    """c1 and c2, the predicted number of tests, and the extreme cases."""
    table = Table("Appendix A: the probability argument, measured")
    largest = max(row.s for row in rows)
    own = [row for row in rows if row.s == largest]
    for name in ("n1", "n2"):
        c = interval([getattr(row, name) / row.s**2 for row in own])
        table.add(f"c{name[1]} = N{name[1]} / s^2", None, shown(c), note=f"s = {largest}")
    ratios = [row.trisect * row.s**3 / (row.n1 * row.n2) for row in rows]
    mean, half = interval(ratios)
    note = f"independent surfaces, all sizes and seeds; 95 % interval ± {half:.3f}"
    what = "tests / (c1 c2 s)"
    table.add(what, 1.0, round(mean, 3), tolerance=round(half, 3), note=note)
    triangles = interval([row.n1 / row.s**3 for row in own])
    note = "eq. 7 calls it a probability; it is the mean number of triangles"
    table.add("N1 / s^3", None, shown(triangles), note=note)
    table.rows += _extremes(largest + 1, k).rows
    return table


def _extremes(side: int, k: float) -> Table:
    """Identical surfaces, and surfaces that never meet."""
    table = Table("")
    first, _ = real_and_imaginary(random_waves((side,) * 3, k), 1 / (side - 1))
    surface = enhanced_marching_cubes(first, 0.0)
    n = len(surface.mesh.simplices)
    tests = surface_intersection.surface_intersection(surface, surface).tests
    note = "of order N, as the appendix says; a voxel of n triangles has n^2 tests"
    table.add("identical surfaces: tests / N", None, round(tests / n, 3), note=note)
    away = enhanced_marching_cubes(first, float(first.values.max()) + 1)
    tests = surface_intersection.surface_intersection(surface, away).tests
    table.add("surfaces that never meet: tests", 0, tests)
    return table


# --- joining -------------------------------------------------------------------------------------


def joining(side: int, k: float, seeds: Sequence[int]) -> Table:
    """Table 3's greedy joining beside joining by identity, and marching faces beside both."""
    table = Table("Joining: greedy (Table 3), by identity, and Marching Faces")
    for seed in seeds:
        fields = real_and_imaginary(random_waves((side,) * 3, k, seed=seed), 1 / (side - 1))
        one, two = (enhanced_marching_cubes(field, 0.0) for field in fields)
        segments = surface_intersection.surface_intersection(one, two)
        exact = surface_intersection.join_segments(segments)
        greedy = surface_intersection.combine_line_segments(segments, one.shape, 1e-3 / side)
        faces = marching_faces.intersection_curves(*fields, rule="asymptotic")
        for name, curves in (("identity", exact), ("greedy", greedy), ("faces", faces)):
            length = sum(curve.length for curve in curves)
            closed = sum(curve.closed for curve in curves)
            what = f"{len(curves)} curves, {closed} closed, length {length:.4f}"
            table.add(f"seed {seed}, {name}", None, what)
        table.add(f"seed {seed}, length by theory", None, round(nodal_density(k), 4))
    return table


# --- pictures ------------------------------------------------------------------------------------


def figure_6(rows: Sequence[Measured], path: Path) -> None:
    """Tests over the side of the volume, each seed a thin line, with the paper's slope."""
    from matplotlib import pyplot as plt
    from matplotlib.ticker import NullFormatter

    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    for of, colour in (("trisect", "tab:red"), ("xface", "tab:blue")):
        for panel, against in zip(axes, ("s", "n1"), strict=True):
            for seed in sorted({row.seed for row in rows}):
                own = [row for row in rows if row.seed == seed]
                label = of if seed == rows[0].seed else None
                x, y = ([getattr(row, name) for row in own] for name in (against, of))
                panel.plot(x, y, "o-", color=colour, alpha=0.5, ms=3, lw=0.8, label=label)
    axes[0].set(xlabel="side of the volume (voxels)", ylabel="intersection tests")
    axes[0].set(xlim=(0, None), ylim=(0, None), title="linear in the side")
    reach = np.array([min(row.n1 for row in rows), max(row.n1 for row in rows)])
    start = np.mean([row.trisect for row in rows if row.s == rows[0].s])
    axes[1].plot(reach, start * np.sqrt(reach / reach[0]), "k--", lw=1, label=r"$\sqrt{N}$")
    axes[1].set(xlabel="triangles of the first surface", xscale="log", yscale="log")
    axes[1].set(title="a square root in the triangles")
    axes[1].xaxis.set_minor_formatter(NullFormatter())
    for panel in axes:
        panel.legend(frameon=False)
        panel.grid(alpha=0.2)
    _save(figure, path)


def figure_5(rows: Sequence[Measured], path: Path) -> None:
    """Times over the number of triangles, median over the seeds."""
    from matplotlib import pyplot as plt

    figure, panel = plt.subplots(figsize=(6, 4))
    sizes = sorted({row.s for row in rows})
    for name, label in (
        ("emc_seconds", "EMC x 2"),
        ("isect_seconds", "MC-Isect"),
        ("faces_seconds", "MF-Points"),
    ):
        own = [[row for row in rows if row.s == s] for s in sizes]
        x = [np.median([row.n1 for row in some]) for some in own]
        y = [np.median([getattr(row, name) for row in some]) for some in own]
        panel.loglog(x, y, "o-", ms=4, label=label)
    panel.set(xlabel="triangles of the first surface", ylabel="seconds, this machine")
    panel.legend(frameon=False)
    panel.grid(alpha=0.2, which="both")
    _save(figure, path)


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
    _save(figure, path)


def _save(figure: Any, path: Path) -> None:
    """The figure is written, without a date so that it only changes when its content does."""
    from matplotlib import pyplot as plt

    path.parent.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    plt.rcParams["svg.hashsalt"] = "isograde"
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=90)
    plt.close(figure)


COLOURS = np.array(
    [(230, 75, 53), (77, 187, 213), (0, 160, 135), (60, 84, 136), (243, 155, 127), (220, 180, 50),
     (126, 97, 72), (145, 100, 190), (110, 170, 60), (200, 90, 150)], np.uint8
)  # fmt: skip


def figure_1(waves: Waves, curves: Sequence[Curve], path: Path) -> str | None:
    """The four pictures of Figure 1; None, or why they could not be made."""
    try:
        import pyvista as pv
    except ImportError as error:
        return f"Figure 1 needs pyvista: {error}"
    plotter = pv.Plotter(off_screen=True, shape=(2, 2), window_size=[1000, 1000], border=False)
    for panel, (surface, colour) in enumerate(
        zip(waves.surfaces, ("#d9a441", "#5b8fc7"), strict=True)
    ):
        plotter.subplot(0, panel)
        mesh = pv.PolyData.from_regular_faces(surface.mesh.vertices, surface.mesh.simplices)
        plotter.add_mesh(mesh, color=colour, smooth_shading=True, specular=0.3)
    plotter.subplot(1, 0)
    plotter.add_mesh(tubes(curves, 0.004), scalars="colour", rgb=True)
    plotter.subplot(1, 1)
    plotter.add_mesh(shaded_points(waves), scalars="light", cmap="bone", point_size=4.5,
                     render_points_as_spheres=False, show_scalar_bar=False)  # fmt: skip
    for row, column in np.ndindex(2, 2):
        plotter.subplot(row, column)
        plotter.set_background("#15202b")
        plotter.camera_position = [(2.75, 2.2, 1.8), (0.5, 0.5, 0.47), (0, 0, 1)]
    _screenshot(plotter, path)
    return None


def tubes(curves: Sequence[Curve], radius: float) -> Any:
    """Four-sided tubes around the curves, each curve in a colour of its own."""
    import pyvista as pv

    blocks = []
    for number, curve in enumerate(sorted(curves, key=lambda c: -c.length)):
        line = pv.lines_from_points(curve.polyline).strip()
        tube = line.tube(radius=radius, n_sides=4)
        tube.point_data.clear()
        tube["colour"] = np.tile(COLOURS[number % len(COLOURS)], (tube.n_points, 1))
        blocks.append(tube)
    return pv.merge(blocks)


def shaded_points(waves: Waves) -> Any:
    """The points of Marching Faces, lit as fine hairs along their tangents (Zöckler et al.)."""
    import pyvista as pv

    points = marching_faces.marching_faces(*waves.fields)
    light = np.array([0.6, 0.5, 0.62])
    along = points.tangents @ (light / np.linalg.norm(light))
    cloud = pv.PolyData(points.positions)
    cloud["light"] = 0.25 + 0.75 * points.confidence * np.sqrt(np.maximum(1 - along**2, 0)) ** 4
    return cloud


def _screenshot(plotter: Any, path: Path) -> None:
    """The picture is written with a palette, so that it stays small."""
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = plotter.screenshot(return_img=True)
    plotter.close()
    Image.fromarray(pixels).quantize(128).save(path, optimize=True)


# --- phase vortices in real data -----------------------------------------------------------------


def vortices(folder: Path, picture: Path) -> tuple[Table, str | None]:
    """Nodal lines of a complex MRI of three echoes, checked by the winding of the phase."""
    import nibabel

    magnitude, phase = (
        np.asarray(nibabel.load(folder / f"romeo_{name}.nii").dataobj, np.float64)
        for name in ("Mag", "Phase")
    )
    psi = magnitude * np.exp(1j * np.pi * phase / np.abs(phase).max())
    spacing = nibabel.load(folder / "romeo_Mag.nii").header.get_zooms()[:3]
    table = Table("Phase vortices in a complex gradient-echo MRI")
    inside, lines = [], []
    for echo in range(psi.shape[3]):
        fields = real_and_imaginary(psi[..., echo], spacing)
        points = marching_faces.marching_faces(*fields)
        curves = marching_faces.intersection_curves(*fields)
        closed = sum(curve.closed for curve in curves)
        table.add(f"echo {echo + 1}: points", None, len(points))
        table.add(f"echo {echo + 1}: curves", None, f"{len(curves)}, {closed} closed")
        length = round(sum(curve.length for curve in curves), 1)
        table.add(f"echo {echo + 1}: length", None, length, note="in the file's units (mm)")
        wrong = winding_mismatches(psi[..., echo], points)
        note = "first column: what must be, for the phase turns once around each line"
        table.add(f"echo {echo + 1}: faces whose winding differs", 0, wrong, note=note)
        lines.append(curves)
        inside.append(magnitude[..., echo])
    problem = vortex_picture(inside[-1], lines[-1], spacing, picture)
    return table, problem


def winding_mismatches(psi: Complex, points: marching_faces.FacePoints) -> int:
    """On how many lattice faces the headings of the points do not add up to the phase's winding."""
    corner = np.stack(np.unravel_index(points.voxels, points.cells), axis=1)
    wrong = 0
    for axis in range(3):
        winding = phase_winding(np.angle(psi), axis)
        across = points.faces // 2 == axis
        place = corner[across]
        place[:, axis] += points.faces[across] % 2
        np.add.at(winding, tuple(place.T), -points.headings[across])
        wrong += int((winding != 0).sum())
    return wrong


def vortex_picture(
    magnitude: Floats, curves: Sequence[Curve], spacing: Sequence[float], path: Path
) -> str | None:
    """The vortex lines above the slice of the magnitude through their lowest point."""
    try:
        import pyvista as pv
    except ImportError as error:
        return f"the picture of the vortices needs pyvista: {error}"
    grid = pv.ImageData(dimensions=magnitude.shape, spacing=tuple(map(float, spacing)))
    grid["magnitude"] = magnitude.ravel(order="F")
    plotter = pv.Plotter(off_screen=True, window_size=[900, 700])
    points = np.concatenate([curve.points for curve in curves])
    floor = np.array(grid.center)
    floor[2] = max(points[:, 2].min(), 0.01 * spacing[2])
    plotter.add_mesh(grid.slice(normal="z", origin=floor), cmap="gray", show_scalar_bar=False,
                     lighting=False)  # fmt: skip
    plotter.add_mesh(tubes(curves, 0.2 * min(spacing)), scalars="colour", rgb=True)
    plotter.set_background("white")
    reach = max(grid.length, 1e-9)
    eye = floor + reach * np.array([0.28, -0.42, 0.5])
    plotter.camera_position = [eye, floor, (0, 0, 1)]
    plotter.camera.zoom(1.05)
    _screenshot(plotter, path)
    return None


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
The intervals are narrow enough to see that the smallest lattices, which miss details, bend the
exponents by up to one percent. "Linear in the side" and "square root of the triangles" hold.
In the paper's Figure 5 the triangle tests are cheap beside making the surfaces. Here they cost
more, since every sign is made certain; but they grow as slowly as the paper says. On small lattices
the fixed cost of array calls decides the times, not the work.
""",
    "Appendix A": """
The predicted number of tests is right because real and imaginary part are independent at a point.
""",
}


def main(
    side: int = 128,
    sides: Sequence[int] = (25, 33, 49, 65, 97, 129),
    seeds: int = 8,
    report: Path = REPORT,
) -> list[Table]:
    """Compute everything, write the report and its pictures; the tables."""
    folder = report.with_suffix("")
    tables, means = table_1(side, range(3))
    figure_table_1(means, folder / "table1.svg")
    k = 27.0 * side / 128
    rows = [measure(one, seed, k) for one in sides for seed in range(seeds)]
    figure_5(rows, folder / "figure5.svg")
    figure_6(rows, folder / "figure6.svg")
    chosen = matching_wave_number(bounded_waves, side, 0, empty_share_of_figure_1())
    waves = Waves.of(bounded_waves((side,) * 3, chosen, seed=0), chosen, side)
    curves = surface_intersection.join_segments(waves.segments)
    notes = [figure_1(waves, curves, folder / "figure1.png")]
    tables += [consistency(), scaling(rows), appendix_a(rows, k)]
    tables += [joining(side // 2, k, range(2)), figure_1_counts(waves, curves)]
    real, note = _real_data(folder / "vortices.png")
    tables += real
    notes.append(note)
    skipped = [f"Skipped: {note}." for note in notes if note]
    write_report(
        report, "Ljung & Ynnerman: where two isosurfaces meet", _parts(tables, skipped, folder)
    )
    return tables


def _parts(tables: Sequence[Table], skipped: Sequence[str], folder: Path) -> list[Table | str]:
    """The report's parts in order."""
    pictures = [
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
    parts: list[Table | str] = [INTRODUCTION, *skipped]
    for table in tables:
        parts.append(table)
        parts += [text.strip() for start, text in READINGS.items() if table.title.startswith(start)]
    return [*parts, *pictures]


def figure_1_counts(waves: Waves, curves: Sequence[Curve]) -> Table:
    """The captions of Figure 1 beside the field of our pictures."""
    printed = PRINTED["figure_1"]
    table = Table("Figure 1: the captions beside our pictures")
    note = "found from the number of triangles of the real surface"
    table.add("wave number, radians a side", None, round(waves.k, 2), note=note)
    points = len(marching_faces.marching_faces(*waves.fields))
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


def _real_data(picture: Path) -> tuple[list[Table], str | None]:
    """The tables of the real data, or why there are none."""
    folder = os.environ.get("ISOGRADE_DATA")
    if not folder or not (Path(folder) / "romeo_Mag.nii").is_file():
        return [], "phase vortices in real data: set ISOGRADE_DATA to the folder of romeo_Mag.nii"
    try:
        table, problem = vortices(Path(folder), picture)
    except ImportError as error:
        return [], f"phase vortices in real data need nibabel: {error}"
    return [table], problem


if __name__ == "__main__":
    for table in main():
        print(table.markdown())
    print(f"written: {REPORT.relative_to(ROOT)}")
