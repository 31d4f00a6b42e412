"""Recompute Schlei's tables and figures; write reports/papers/schlei_2010.md and its folder.

Run it from anywhere: ``python papers/schlei_2010/reproduce.py``. Parts that need the real volumes
look for them in the folder ISOGRADE_DATA names; without it they say that they were skipped, and
Table II is still checked, from the histogram of the bunny's cells kept in bunny_cells.json.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import fireball
import numpy as np
import vesta_bourke as bourke
import vesta_census as census
import vesta_counts as counts
import vesta_faces as faces
import vesta_figures as figures
import vesta_twelve as twelve
import vesta_words as words
from isograde.cases.volumes import REGISTRY, find, read
from isograde.proof import prove
from isograde.reproduction import Table, write_report
from isoref.cube import CORNERS, EDGES, configuration, is_exchanged
from isoref.fast.sweep import sweep
from isoref.fast.vesta import Surface, extract, fan_start
from isoref.field import Field
from isoref.freeze_out import (
    contour_stack,
    correspondence_problems,
    cycle_elements,
    hypersurface,
    physical,
    physical_triangles,
    triangle_elements,
)
from isoref.marching_vesta import CENTRES, JUNCTURES, PATHS, RULES, cycles, paper_number, rule
from isoref.mesh import Mesh
from isoref.methods import METHODS

HERE = Path(__file__).parent
PRINTED = json.loads((HERE / "tables.json").read_text(encoding="utf-8"))
MODES = ("disconnect", "connect", "mixed")
PAPER_TYPES = 14  # of cycles, Figs. 7 and 12
Printed = dict[str, Any]
BUNNY_ISOVALUE = 1807  # of the 12-bit scan; the paper's 150 of 8 bits


def main() -> None:
    """The report and its pictures, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--without-volumes", action="store_true", help="as if no data were here")
    options = parser.parse_args()
    folder = options.out / "schlei_2010"
    volumes = {} if options.without_volumes else present_volumes()
    parts: list[Table | str] = [OPENING, paths(), *census_report(folder), *section_g(folder)]
    parts += [
        *bourke.report(),
        proofs(),
        *bunny(volumes, folder),
        *identities(),
        *real_volumes(volumes),
    ]
    parts += [*fireball_report(folder), *table_4()]
    write_report(options.out / "schlei_2010.md", "Schlei 2010: VESTA", parts)
    print(f"wrote {options.out / 'schlei_2010.md'}")


OPENING = """Made by `papers/schlei_2010/reproduce.py`. The modules are `isoref.diconex`,
`isoref.vesta`, `isoref.marching_vesta` and `isoref.freeze_out`; a guided reading is in
`papers/schlei_2010/README.md`. Every number under "ours" was computed in this run; "paper" holds
what the paper prints, "expected" what must be true of any closed surface.
"""


def present_volumes() -> dict[str, Field]:
    """The real volumes of the project that are on this machine, by name."""
    return {n: read(find(v), volume=v) for n, v in REGISTRY.items() if find(v) is not None}


def paths() -> Table:
    """Table I beside the paths the right-hand rule gives."""
    table = Table("Table I: the paths")
    ours = {}
    for (begin, centre, end), _ in PATHS:
        numbers = (paper_number(JUNCTURES[begin]), paper_number(JUNCTURES[end]))
        ours[paper_number(CENTRES[centre])] = numbers
    for centre, (begin, end) in PRINTED["I"]["paths"].items():
        got = ours[int(centre)]
        table.add(
            f"plus path of {centre}", f"{begin} {centre} {end}", f"{got[0]} {centre} {got[1]}"
        )
    return table


# --- Cycles ------------------------------------------------------------------------------------


def census_report(folder: Path) -> list[Table | str]:
    """Which cycles there are, counted and drawn."""
    every, uniform = census.types(), census.types(global_modes_only=True)
    averaged = census.types(averages_only=True)
    signatures = counts.all_signatures()
    left_out = Counter(
        tuple(sorted(map(len, cycles(*s)))) for s in signatures if not census.attainable(*s)
    )
    table = Table("The census of cycles (sections II.C and II.E)")
    table.add("types in a global mode (Fig. 7)", 9, len(uniform))
    table.add("longest cycle in a global mode", 7, max(map(len, uniform)))
    table.add("types in mixed mode (Figs. 7, 12)", PAPER_TYPES, len(averaged))
    table.add("types over all decisions", None, len(every))
    lengths = sorted({len(cycle) for cycle in every})
    table.add("lengths that occur", "3 4 5 6 7 8 9 12", " ".join(map(str, lengths)))
    split = [way[1:] for way in figures.resolutions() if len(cycles(*way[1:])) > 1]
    never = [way for way in split if not census.attainable(*way)]
    table.add("ways to split a longer cycle (Fig. 13, a to l)", 12, len(split))
    sizes = "; ".join("+".join(str(len(c)) for c in cycles(*way)) for way in never)
    table.add("of these never created (Fig. 13l)", 1, len(never), note=sizes)
    for mode, separated in counts.GLOBAL.items():
        found = counts.lengths({(signs, separated): 1 for signs in range(256)})
        for length, number in found.items():
            table.add(f"{length}-cycles over the 256 cells, {mode}", None, number)
    sizes_of = [[len(cycle) for cycle in found] for found in (every, averaged)]
    told = words.decisions(len(signatures), left_out, *sizes_of, PAPER_TYPES)
    figures.draw_types(folder / "cycles.svg", None)
    figures.draw_types(folder / "low.svg", "L", 3, 7)
    figures.draw_types(folder / "high.svg", "H")
    figures.draw_resolutions(folder / "resolutions.svg")
    return [
        table,
        f"""{told}

The types of cycle on their boundary face chains, Figs. 7 and 12. All faces of a chain have one
corner in common, the middle of the cell; grey discs are the centres of active voxels:

![types of cycle](schlei_2010/cycles.svg)

Cut without further points (L), Fig. 8. A chord never joins two faces of one voxel edge: it would
lie between two cells, where the neighbour may put another.

![cycles cut in low resolution](schlei_2010/low.svg)

Cut with the average point (H), Figs. 9 and 14:

![cycles cut in high resolution](schlei_2010/high.svg)

All ways to resolve the ambiguous configurations, Fig. 13:

![resolutions](schlei_2010/resolutions.svg)
""",
    ]


def section_g(folder: Path) -> list[Table | str]:
    """VESTA beside the templates of 1987."""
    entries = census.comparison()
    lines = [
        "## Section II.G: VESTA beside the templates of 1987",
        "",
        "Lengths of cycles; `=` where the perimeters are those of the template, which a cell and",
        "its complement share, `x` where they are not.",
        "",
        "| configuration | template | disconnect | connect | inverted, disconnect "
        "| inverted, connect |",
        "| ---: | --- | --- | --- | --- | --- |",
    ]
    columns = ("disconnect", "connect", "inverted disconnect", "inverted connect")
    for entry in entries:
        cells = [f"{_sum(entry[c][0])} {'=' if entry[c][1] else 'x'}" for c in columns]
        template = _sum(entry["template"])
        lines.append(f"| {entry['configuration']} | {template} | {' | '.join(cells)} |")
    table = Table("What section II.G says of them")
    differ = {c: [e["configuration"] for e in entries if not e[c][1]] for c in columns}
    table.add("differ: disconnect (Fig. 21)", 0, len(differ["disconnect"]))
    table.add("differ: inverted, connect (Fig. 24)", 0, len(differ["inverted connect"]))
    note = "the paper's d, g, h, l, m, n; ours " + " ".join(map(str, differ["connect"]))
    table.add(
        "differ: inverted, disconnect (Fig. 22)", 6, len(differ["inverted disconnect"]), note=note
    )
    table.add("differ: connect (Fig. 23)", 6, len(differ["connect"]), note=note)
    pair = Field.of(census.hole())
    cells = [(0, 0, 0), (0, 0, 1)]
    names = {"1987 templates": "lorensen-cline", "VESTA, disconnect": "vesta-disconnect-L",
             "VESTA, connect": "vesta-connect-L"}  # fmt: skip
    meshes = [(title, METHODS[name](pair, 0.5)) for title, name in names.items()]
    figures.draw_meshes(folder / "hole.svg", meshes, cells)
    for title, mesh in meshes:
        edges = len(figures.inner_boundary(mesh, np.array(cells)))
        hole = "the hole of Fig. 25.a has four sides" if title.startswith("1987") else ""
        wanted = 4 if hole else 0
        table.add(f"open edges in Fig. 25: {title}", None, edges, expected=wanted, note=hole)
    return [
        "\n".join(lines),
        table,
        words.differing(differ["connect"], differ["inverted disconnect"])
        + "\n\n![the hole of Fig. 25](schlei_2010/hole.svg)\n",
    ]


def _sum(sizes: list[int]) -> str:
    """Lengths as a sum."""
    return "+".join(map(str, sizes)) or "none"


def proofs() -> str:
    """The six surfaces held to the proof by enumeration."""
    lines = [
        "## Section IV: no holes, whatever the field",
        "",
        "The proof by enumeration of `isograde.proof` for the six rules of marching VESTA: every",
        "tile, every two tiles that can meet at a face, and, in mixed mode, which alone compares",
        "numbers, decisions on random pairs of cells.",
        "The original VESTA makes the same mesh (a property test).",
        "",
        "| rule | tiles | meetings | tears | checks | broken | pairs tried | closed, manifold |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |",
    ]
    for one in RULES:
        proof = prove(one)
        lines.append(
            f"| {one.name} | {len(proof.tiles)} | {proof.meetings} | {len(proof.tears)} "
            f"| {len(proof.checks)} | {len(proof.broken)} | {proof.trials:,} "
            f"| {'proved' if proof.holds else 'not proved'} |"
        )
    return "\n".join(lines) + "\n"


# --- Table II ----------------------------------------------------------------------------------


def bunny(volumes: dict[str, Field], folder: Path) -> list[Table | str]:
    """Table II, from the scan where it is, and from the histogram of its cells everywhere."""
    kept = json.loads((HERE / "bunny_cells.json").read_text(encoding="utf-8"))
    parts: list[Table | str] = [from_histogram(kept["histogram"])]
    if "bunny" not in volumes:
        return [*parts, "Table II from the scan: skipped, the scan is not on this machine."]
    field = volumes["bunny"]
    table = Table("Table II from the scan")
    table.add("active voxels", PRINTED["II"]["active"], int((field.values >= BUNNY_ISOVALUE).sum()))
    again = counts.histogram(field, BUNNY_ISOVALUE)
    same = sum(a == b for a, b in zip(again.tolist(), kept["histogram"], strict=True))
    what = "kinds of cell whose count in the kept histogram is right"
    table.add(what, None, same, expected=len(kept["histogram"]))
    for mode in MODES:
        surface = extract(field, BUNNY_ISOVALUE, mode=mode, border="closed")
        add_original(table, f"original, {mode}", surface, PRINTED["II"][mode])
        marching = counts.lengths(counts.signatures(field, BUNNY_ISOVALUE, mode))
        add_marching(table, f"marching, {mode}", marching, PRINTED["II"][mode])
    mesh = sweep(rule("disconnect", "L"), field, BUNNY_ISOVALUE)
    low = len(mesh.simplices)
    name = "extended marching cubes, L points: 3 a triangle"
    table.add(name, PRINTED["II"]["extended marching cubes L points"], 3 * low)
    figures.draw_rendering(
        folder / "bunny.png",
        figures.render(surface.mesh("L"), np.array([0, 0, 1]), np.array([-1, 0, 0])),
    )
    text = f"""{ambiguity(kept["histogram"])}

![Fig. 26: the bunny](schlei_2010/bunny.png)
"""
    return [*parts, table, text, times(field)]


def ambiguity(histogram: list[int]) -> str:
    """Why the three modes of Table II agree."""
    crossed = sum(histogram[1:255])
    kinds: dict[tuple[int, bool], int] = {}
    sizes: dict[tuple[int, bool], list[str]] = {}
    totals = [Counter[int](), Counter[int]()]
    for signs, n in enumerate(histogram):
        if n and counts.ambiguous_faces(signs):
            key = (configuration(signs), is_exchanged(signs))
            kinds[key] = kinds.get(key, 0) + n
            made = [sorted(map(len, cycles(signs, way))) for way in counts.GLOBAL.values()]
            sizes[key] = [_sum(own) for own in made]
            for total, own in zip(totals, made, strict=True):
                total.update(own * n)
    listed = ", ".join(
        f"{n} of configuration {c}{' inverted' if inverted else ''} "
        f"({' against '.join(sizes[c, inverted])})"
        for (c, inverted), n in sorted(kinds.items())
    )
    return f"""Of the {crossed:,} cells of the bunny that the surface crosses
{sum(kinds.values())} have an ambiguous face (cycles, disconnect against connect): {listed}. The
surfaces of the two modes differ in these cells, and their counts of cycles
{"agree all the same" if totals[0] == totals[1] else "differ"}."""


def from_histogram(histogram: list[int]) -> Table:
    """Table II from 256 numbers."""
    table = Table("Table II from the kept histogram of the bunny's cells")
    printed = PRINTED["II"]
    for mode, separated in counts.GLOBAL.items():
        cells = {(signs, separated): n for signs, n in enumerate(histogram) if n}
        found = counts.lengths(cells)
        add_marching(table, mode, found, printed[mode])
        points = counts.support_points(cells)
        table.add(f"{mode}: original, L points", printed[mode]["L points"], points)
        high = points + counts.averages(found, "H")
        table.add(f"{mode}: original, H points", printed[mode]["H points"], high)
    return table


def add_original(table: Table, name: str, surface: Surface, printed: dict) -> None:
    """The rows of one column of the original VESTA, from the surface itself."""
    for length, number in printed["cycles"].items():
        table.add(f"{name}: {length}-cycles", number, surface.lengths.get(int(length), 0))
    table.add(f"{name}: cycle sum", printed["sum"], sum(surface.lengths.values()))
    for resolution in ("L", "H"):
        mesh = surface.mesh(resolution)
        for what, made in (("points", mesh.vertices), ("triangles", mesh.simplices)):
            row = f"{resolution} {what}"
            table.add(f"{name}: {row}", printed[row], len(made))


def add_marching(table: Table, name: str, found: dict[int, int], printed: dict) -> None:
    """The rows of one column of the marching VESTA, from the cells' cycles by Table I."""
    for length, number in printed["cycles"].items():
        table.add(f"{name}: {length}-cycles", number, found.get(int(length), 0))
    for resolution in ("L", "H"):
        points = counts.marching_points(found, resolution)
        table.add(f"{name}: marching {resolution} points",
                  printed[f"marching {resolution} points"], points)  # fmt: skip
        made = counts.triangles(found, resolution)
        table.add(f"{name}: {resolution} triangles", printed[f"{resolution} triangles"], made)


def times(field: Field) -> str:
    """Seconds of the three codes in one run, as ratios (Table II, L, disconnect)."""
    codes = {
        "original": lambda: METHODS["vesta-disconnect-L"](field, BUNNY_ISOVALUE),
        "marching": lambda: METHODS["marching-vesta-disconnect-L"](field, BUNNY_ISOVALUE),
    }
    try:
        codes["extended marching cubes (VTK)"] = vtk_marching_cubes(field)
    except ImportError:
        codes["extended marching cubes (VTK: not installed)"] = lambda: None
    seconds = dict.fromkeys(codes, float("inf"))
    for _ in range(3):
        for name, run in codes.items():
            start = time.perf_counter()
            run()
            seconds[name] = min(seconds[name], time.perf_counter() - start)
    first, load = seconds["original"], os.getloadavg()[0]
    paper = PRINTED["II"]["seconds, L, disconnect"]
    lines = ["## Times on the bunny, as ratios to the original VESTA", ""]
    lines += ["| code | paper | here |", "| --- | ---: | ---: |"]
    for (name, took), printed in zip(seconds.items(), paper.values(), strict=True):
        lines.append(f"| {name} | {printed / paper['original']:.2f} | {took / first:.2f} |")
    lines.append("")
    lines.append("Best of three interleaved runs in this process, disconnect and L, at a load of")
    lines.append(
        f"{load:.1f} on {os.cpu_count()} processors. The paper's marching codes share no points"
    )
    lines.append("between cells (section III.A, and its counts); ours and VTK's do.")
    return "\n".join(lines)


def vtk_marching_cubes(field: Field):
    """A call of VTK's marching cubes on this volume."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkMarchingCubes

    image = vtkImageData()
    image.SetDimensions(field.shape[::-1])
    flat = numpy_to_vtk(np.ascontiguousarray(field.values).ravel())
    image.GetPointData().SetScalars(flat)

    def run() -> None:
        contour = vtkMarchingCubes()
        contour.SetInputData(image)
        contour.SetValue(0, BUNNY_ISOVALUE)
        contour.ComputeNormalsOff()
        contour.ComputeGradientsOff()
        contour.Update()

    return run


# --- Tables III and IV -------------------------------------------------------------------------


def identities() -> list[Table | str]:
    """Tables II to IV held to the identities that tie their rows together."""
    table = Table("Tables II to IV checked by their own identities")
    for number in ("II", "III", "IV"):
        for mode in MODES:
            rows = PRINTED[number][mode]
            found = {int(N): n for N, n in rows["cycles"].items()}
            name = f"{number}, {mode}"
            table.add(f"{name}: cycle sum", rows["sum"], sum(found.values()))
            for resolution in ("L", "H"):
                key = f"{resolution} triangles"
                table.add(f"{name}: {key}", rows[key], counts.triangles(found, resolution))
                key = f"marching {resolution} points"
                table.add(f"{name}: {key}", rows[key], counts.marching_points(found, resolution))
            supports = rows["L points"]
            high = supports + counts.averages(found, "H")
            table.add(f"{name}: H points", rows["H points"], high)
            with_averages = PRINTED[number]["disconnect"]["L points"] + counts.averages(found, "L")
            table.add(f"{name}: L points", rows["L points"], with_averages)
        key = "extended marching cubes L points"
        thrice = 3 * PRINTED[number]["disconnect"]["L triangles"]
        table.add(f"{number}: {key}", PRINTED[number][key], thrice)
    return [table, explained(), borders()]


def explained() -> str:
    """What the printed triangles and points say of cycles of eight points and more."""
    lines = []
    for number, mode in product(("II", "III", "IV"), MODES):
        rows = PRINTED[number][mode]
        found = {int(N): n for N, n in rows["cycles"].items()}
        long = {N: n for N, n in found.items() if N > 7}
        if sum(long.values()):
            lines.append(long_cycles(f"Table {number}, {mode}", rows, found, long))
    lines.append(words.without_fan({N: _without_fan(N) for N in (8, 9, 12)}))
    return "\n\n".join(lines) + "\n"


def long_cycles(name: str, rows: Printed, found: dict[int, int], long: dict[int, int]) -> str:
    """What one column's triangles and points say of its long cycles, sentence by sentence."""
    total = sum(long.values())
    listed = ", ".join(f"{n:,} of {N}" for N, n in long.items())
    plain = sum(n * (N - 2) for N, n in found.items())
    with_points = counts.triangles(found, "L")
    which = {plain: "without one", with_points: "with one"}.get(rows["L triangles"], "neither way")
    told = [
        f"{name} has cycles of more than seven points: {listed}. Without an average point in each "
        f"the L triangles are {plain:,}, with one {with_points:,}; the paper prints "
        f"{rows['L triangles']:,}, so its program cuts them {which}.",
    ]
    corners = sum(n * N for N, n in found.items())
    for column, bare in (("marching L points", corners), ("L points", None)):
        if bare is None:
            bare = rows["H points"] - sum(n for N, n in found.items() if N > 3)
        extra = rows[column] - bare
        said = {0: "do not contain", total: "contain"}.get(extra, f"are off by {extra:,} and lack")
        told.append(
            f"Its {column}, {rows[column]:,}, {said} these {total:,} points (there are {bare:,} "
            f"points on edges), and {'are right' if extra == total else 'should read'}"
            + (f" {bare + total:,}." if extra != total else ".")
        )
    return " ".join(told)


def _without_fan(length: int) -> tuple[int, int]:
    """Of all types of cycle of this length, how many have no safe fan, and how many there are."""
    every = [cycle for cycle in census.types(averages_only=True) if len(cycle) == length]
    none = 0
    for cycle in every:
        centres = np.array([np.add(*(CORNERS[c] for c in EDGES[edge])) for edge in cycle])
        try:
            fan_start(centres[None])
        except ValueError:
            none += 1
    return none, len(every)


def borders() -> str:
    """What the tables tell of the border of the volume."""
    lines = []
    for number in ("II", "III", "IV"):
        rows = PRINTED[number]["disconnect"]
        incidences = sum(int(N) * n for N, n in rows["cycles"].items())
        lines.append(
            f"Table {number}: {incidences:,} / 4 = {incidences / 4:,.2f}, and "
            f"{rows['L points']:,} points ({_whether(incidences == 4 * rows['L points'])})."
        )
    return (
        "On a closed surface each support point lies on four cycles, so the sum of N times the\n"
        "N-cycles is four times the points. "
        + " ".join(lines)
        + "\nWhere the two are not equal the surface is cut open by the border of the volume: the "
        'paper\'s programs drop the cycles that leave the samples (our `border="open"`).\n'
    )


def _whether(closed: bool) -> str:
    """In a word."""
    return "closed" if closed else "open"


# --- Other volumes -----------------------------------------------------------------------------


def real_volumes(volumes: dict[str, Field]) -> list[Table | str]:
    """Cycles of both codes in the three modes, for each volume at hand."""
    if not volumes:
        return ["## Real volumes\n\nSkipped: no real volume is on this machine."]
    lines = [
        "## Real volumes",
        "",
        "Cycles by length with an open border, original and marching (from the cells by Table I);",
        "`equal` says that both gave the same numbers.",
        "",
        "| volume | isovalue | mode | 3 | 4 | 5 | 6 | 7 | 8 | 9 | 12 | L points | L triangles "
        "| H points | H triangles | marching |",
        "| --- | ---: | --- " + "| ---: " * 12 + "| --- |",
    ]
    saddles = [
        "",
        "How often the average of four voxels and the saddle of the bilinear interpolant",
        "(Nielson & Hamann) decide differently, over the ambiguous faces of all cells",
        "(a face between two cells counts twice):",
        "",
        "| volume | ambiguous faces | decided differently | share |",
        "| --- | ---: | ---: | ---: |",
    ]
    runs = [(name, REGISTRY[name].isovalues[0]) for name in volumes]
    if "fiberform" in volumes:
        # Go down to the noise in the pores, where long cycles are.
        runs.append(("fiberform", 3.0))
    for name, isovalue in runs:
        field = volumes[name]
        for mode in MODES:
            lines.append(volume_row(name, field, isovalue, mode))
        faces, differ = counts.differing_decisions(field, isovalue)
        share = f"{100 * differ / faces:.2f} %" if faces else "-"
        saddles.append(f"| {name}, {isovalue:g} | {faces:,} | {differ:,} | {share} |")
    return ["\n".join(lines + saddles), twelve_cycles(volumes)]


def twelve_cycles(volumes: dict[str, Field]) -> str:
    """Which volumes have a 12-cycle at any isovalue at all."""
    lines = [
        "## 12-cycles, for every isovalue at once",
        "",
        "A 12-cycle needs a cell whose one tetrahedron of corners lies above the other: it",
        "alternates. Seven numbers then say for which isovalues its averages give a 12-cycle",
        "(`vesta_twelve.py`). The last columns count the long cycles at the isovalue that has most",
        "12-cycles, cell by cell by Table I, with an open border.",
        "",
        "| volume | cells | alternating | with a 12-cycle at some isovalue | most, at isovalue "
        "| 8 there | 9 there | 12 there |",
        "| --- " + "| ---: " * 7 + "|",
    ]
    none = []
    for name, field in volumes.items():
        found = twelve.scan(field.values)
        lines.append(twelve_row(name, field, found))
        if not len(found.spans):
            none.append(
                f"`{name}` has no 12-cycle at any isovalue: {found.alternating:,} of its "
                f"{found.cells:,} cells alternate."
            )
    return "\n".join([*lines, "", *none])


def twelve_row(name: str, field: Field, found: twelve.Twelve) -> str:
    """One line of the table of 12-cycles."""
    row = f"| {name} | {found.cells:,} | {found.alternating:,} | {len(found.spans):,} |"
    if not len(found.spans):
        return f"{row} - | - | - | - |"
    isovalue, most = found.richest()
    there = counts.lengths(counts.signatures(field, isovalue, "mixed", border="open"))
    numbers = " | ".join(f"{there.get(N, 0):,}" for N in (8, 9, 12))
    return f"{row} {most:,} at {isovalue:g} | {numbers} |"


def volume_row(name: str, field: Field, isovalue: float, mode: str) -> str:
    """One line of the table of real volumes."""
    surface = extract(field, isovalue, mode=mode)
    marching = counts.lengths(counts.signatures(field, isovalue, mode, border="open"))
    found = surface.lengths
    cycles = [f"{found.get(N, 0):,}" for N in (3, 4, 5, 6, 7, 8, 9, 12)]
    points = len(surface.points)
    made = [
        points + counts.averages(found, "L"),
        counts.triangles(found, "L"),
        points + counts.averages(found, "H"),
        counts.triangles(found, "H"),
    ]
    agreed = "equal" if marching == found else "differs"
    numbers = [*cycles, *(f"{n:,}" for n in made)]
    return f"| {name} | {isovalue:g} | {mode} | {' | '.join(numbers)} | {agreed} |"


# --- The application ---------------------------------------------------------------------------


def fireball_report(folder: Path) -> list[Table | str]:
    """Freeze-out of a fireball that splits in two."""
    field = fireball.temperature()
    surface = hypersurface(field, fireball.FREEZE_OUT)
    stacks = [contour_stack(field, fireball.FREEZE_OUT, axis) for axis in range(3)]
    whole, kept = surface.mesh("H"), physical(surface, axes=(0, 1))
    triangles = physical_triangles(whole, axes=(0, 1))
    table = Table("The application: freeze-out at 139 MeV")
    open_: dict[str, int] = {}
    for axis, name in enumerate(
        ("z-r planes at fixed t", "z-t planes at fixed r", "r-t planes at fixed z")
    ):
        problems = correspondence_problems(stacks[axis])
        open_[name] = len(problems)
        note = "between " + ", ".join(f"{k} and {k + 1}" for k in problems) if problems else ""
        table.add(f"correspondence problems, {name}", None, len(problems), note=note)
    for length, number in surface.lengths.items():
        table.add(f"{length}-cycles of the closed surface", None, number)
    table.add("triangles, H", None, len(whole.simplices))
    table.add("physical triangles", None, len(triangles.simplices))
    table.add("physical cycles: normals dSigma instead", None, sum(kept.lengths.values()))
    fine, coarse = triangle_elements(whole), cycle_elements(surface)
    volume = fine.flux(lambda x: x / 3)
    table.add("volume: flux of x / 3 by dsigma", None, volume)
    table.add("the same by dSigma (eq. 1)", None, coarse.flux(lambda x: x / 3))
    rest = float(np.abs(coarse.normals.sum(axis=0)).max())
    scale = np.finfo(float).eps * float(np.abs(coarse.normals).sum())
    what = "largest component of the sum of dSigma, closed"
    note = "tolerance: one rounding of the sum of sizes"
    table.add(what, None, rest, expected=0.0, tolerance=scale, note=note)
    draw_frames(folder / "frames.png", field, stacks[0])
    draw_hypersurface(folder / "freeze_out.png", whole, triangles)
    return [
        table,
        f"""The field is `papers/schlei_2010/fireball.py`, a formula of our own with the topology
change of the paper's Fig. 30. {words.stacked(open_)}

Fig. 30: temperature and contours, frames 0 to 32, z to the right, r upwards:

![temperature and freeze-out contours, frames 0 to 32](schlei_2010/frames.png)

Fig. 33: the closed surface from its axis (a), without its unphysical triangles, so that its inside
is seen, darker (b), the same from outside (c); a 5-cycle in five triangles with the normal of each
(d):

![the freeze-out hypersurface](schlei_2010/freeze_out.png)
""",
    ]


def draw_hypersurface(path: Path, whole: Mesh, triangles: Mesh) -> None:
    """Fig. 33: the surface before and after unphysical triangles are left out, and turned."""
    views = []
    for mesh, right, eye, told in (
        (whole, (0, -0.35, -1.0), (-0.3, -1, 0.35), "closed"),
        (triangles, (0, -0.35, -1.0), (-0.3, -1, 0.35), "physical"),
        (triangles, (0, -0.5, 1.0), (0.45, 1, 0.5), "turned"),
    ):
        halved = Mesh(mesh.vertices * [0.5, 1, 1], mesh.simplices)
        views.append((halved, np.array(right), np.cross(eye, right), told))
    figures.draw_views(path, views, "trz", faces.draw_five_cycle)


def table_4() -> list[Table | str]:
    """Table IV beside a fireball of the paper's size with as many active voxels."""
    printed = PRINTED["IV"]
    radii, lengths = 81, 241
    hottest = fireball.hottest_with(printed["active"], radii, lengths)
    field = fireball.temperature(radii, lengths, hottest)
    active = int((field.values >= fireball.FREEZE_OUT).sum())
    table = Table("Table IV: the paper's simulation beside a fireball of its size")
    table.add("voxels", 33 * radii * lengths, int(field.values.size), note="33 x 241 x 81")
    note = f"fitted, by the hottest temperature: {hottest:.1f} MeV"
    table.add("active voxels", printed["active"], active, note=note)
    for mode in MODES:
        surface = extract(field, fireball.FREEZE_OUT, mode=mode, border="open")
        add_original(table, f"original, {mode}", surface, printed[mode])
    return [
        table,
        "The simulation is not published; one number of ours, the temperature, is fitted to one "
        f"of the paper's. {len(table.differing())} of {len(table.rows)} rows differ.\n",
    ]


def draw_frames(path: Path, field: Field, stack: list) -> None:
    """Every frame with its contours, z to the right and r upwards (Fig. 30)."""
    figure, axes = figures.plt.subplots(5, 7, figsize=(8.4, 3.6))
    for ax in axes.ravel():
        ax.axis("off")
    half = 0.25
    z0, z1 = field.origin[2], field.origin[2] + 0.5 * (field.shape[2] - 1)
    box = (z0 - half, z1 + half, -half, 0.5 * (field.shape[1] - 1) + half)
    for frame, ax in zip(range(field.shape[0]), axes.ravel(), strict=False):
        ax.imshow(field.values[frame], cmap="gray", vmin=0, vmax=255, origin="lower", extent=box)
        for contour in stack[frame]:
            r, z = np.where((contour[:, :1] < 0).repeat(2, axis=1), np.nan, contour).T
            ax.plot(z, r, color="#e8a33d", lw=1)
        ax.set_title(str(frame), fontsize=6, pad=1)
    figure.subplots_adjust(wspace=0.06, hspace=0.3)
    figures.save(figure, path)


if __name__ == "__main__":
    main()
