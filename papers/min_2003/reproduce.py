"""Recompute Min's tables and figures; write reports/papers/min_2003.md and its folder.

Run it from anywhere: ``python papers/min_2003/reproduce.py``. It needs no data. With ``--small``
it stops at lower resolutions and takes seconds.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import log2, pi
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import min_examples as examples
import min_growth as growth
import min_pictures as pictures
import min_sections as counts
import min_words as words
import numpy as np
from isograde.oracles import complexes as oracle
from isograde.oracles.covering import covered, inner_open_facets
from isograde.reproduction import Table, write_report
from isoref.dyadic import Tree
from isoref.fast.dyadic import dyadic_tree, section_of_leaves
from isoref.fast.simplicial import extract, section_of_field
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.projection import normals, project
from isoref.simplex_section import (
    PRINTED,
    RULES,
    disagreements,
    haiman_count,
    induced,
    printed,
    section_types,
)
from isoref.simplicial import Complex, gradients, to_mesh

HERE = Path(__file__).parent
TABLES: dict[str, Any] = json.loads((HERE / "tables.json").read_text(encoding="utf-8"))

# What the paper stores, as its sizes show: they are multiples of these.
SEGMENT_BYTES = 24  # two points of three 4-byte numbers
EVERY_CELL = """Of the time nothing has to be counted: a uniform grid of N samples a side has
(N - 1)^3 cells, and each is looked at once.
"""
TRIANGLE_BYTES = 72  # three points and three normals of three 4-byte numbers
VALUE_BYTES = 8


def main() -> None:
    """The report and its pictures, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--small", action="store_true", help="lower resolutions only")
    options = parser.parse_args()
    folder = options.out / "min_2003"
    parts: list[Table | str] = [OPENING]
    steps = (
        sections, counted_sections, conformity, dyadic_grids, helix, leaf, spindle,
        table_7_by_rules, complex_circle, spheres,
    )  # fmt: skip
    for step in steps:
        print(f"-- {step.__name__}")
        parts += step(folder, options.small)
    write_report(options.out / "min_2003.md", "Min 2003: simplicial isosurfacing", parts)
    print(f"wrote {options.out / 'min_2003.md'}")


OPENING = """Made by `papers/min_2003/reproduce.py`. "paper" holds printed numbers; "expected" what
theory says must come out, which the paper's own numbers are fitted against too. The modules are
`isoref.kuhn`, `isoref.simplex_section`, `isoref.simplicial`, `isoref.dyadic` and
`isoref.projection`; what is said of a mesh is counted by `isograde.oracles.complexes`, which shares
no code with them. Times are CPU times of one thread on the machine that made this report: compare
rates, not milliseconds. The paper's are of a 2.2 GHz PC of 2003 in C++.
"""


def rows_of(headers: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A plain Markdown table."""
    lines = ["| " + " | ".join(headers) + " |", "| " + " | ".join("---:" for _ in headers) + " |"]
    lines += ["| " + " | ".join(shown(x) for x in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def shown(x: object) -> str:
    """A number as a table shows it."""
    if isinstance(x, int):
        return f"{x:,}"
    return "" if x is None else f"{x:.3g}" if isinstance(x, float) else str(x)


def clocked(run: Callable[[], Any], rounds: int = 3) -> tuple[float, Any]:
    """The least CPU seconds of a few runs, and what the last one gave."""
    least, result = np.inf, None
    for _ in range(rounds):
        start = time.process_time()
        result = run()
        least = min(least, time.process_time() - start)
    return least, result


def rates(numbers: Sequence[float]) -> list[float | None]:
    """log2 of each number over the one before: the exponent between two sizes."""
    return [None, *(log2(b / a) for a, b in pairwise(numbers))]


def exponent(sizes: Sequence[int], numbers: Sequence[float]) -> float:
    """The slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log2(sizes), np.log2(numbers), 1)[0])


def sections(folder: Path, small: bool) -> Iterator[Table | str]:
    """Tables 1 to 4 and corollary 3.2: counts, validity, agreement of neighbours."""
    table = Table("Tables 1 to 4: simplices in each section, beside corollary 3.2")
    for n in (2, 3, 4, 5):
        for p, q in section_types(n):
            table.add(f"n = {n}, type ({p}, {q})", len(PRINTED[p, q]), haiman_count(p, q))
    yield table
    rows = []
    for rule in RULES:
        last = 5 if rule == "printed" else 7
        rows.append(
            [rule, *("{} of {}".format(*disagreements(rule, n)) for n in range(2, last + 1))]
        )
        rows[-1] += ["not printed"] * (7 - last)
    yield "## Do neighbours agree on the facet they share?\n"
    yield (
        "A table for (p, q) leaves a cut on each facet of the simplex. Two n-simplices may meet in"
        " any of their facets, so all cuts of equal signs should be equal. Pairs of facets that are"
        " cut unlike, of all pairs with equal signs:\n"
    )
    yield rows_of(["rule", *(f"n = {n}" for n in range(2, 8))], rows)
    ours = {frozenset((i, j) for i, j in row) for row in printed(3, 2).tolist()}
    good = sum(induced("printed", 4, 2, 0, k) == ours for k in range(4))
    bad = sum(induced("printed", 3, 3, 1, k) == ours for k in range(3))
    yield (
        f"Rows (4, 2) of Table 4 leave rows (3, 2) of Table 3 on {good} of their 4 facets of that"
        f" type, rows (3, 3) on {bad} of 3. {words.recipe(*delaunay_tables())}\n"
    )


def delaunay_tables() -> tuple[list[int], bool]:
    """Facets that Delaunay's tables cut unlike, n = 2 .. 7; whether all are the staircase."""
    every = range(2, 8)
    same = all(
        {frozenset(map(tuple, row)) for row in RULES["delaunay"](p, q).tolist()}
        == {frozenset(map(tuple, row)) for row in RULES["staircase"](p, q).tolist()}
        for n in every
        for p, q in section_types(n)
    )
    return [disagreements("delaunay", n)[0] for n in every], same


def counted(mesh: Mesh) -> oracle.Complex:
    """The mesh with what is true of it."""
    return oracle.Complex.of(mesh.vertices, mesh.simplices)


def counted_sections(folder: Path, small: bool) -> Iterator[Table | str]:
    """The bounds of section 4, Weigle and Banks' recursion, and cubes in three and four axes."""
    yield from counts.bounds(20_000 if small else 200_000)
    yield from counts.recursion()
    yield from counts.cubes()


def table_7_by_rules(folder: Path, small: bool) -> Iterator[Table | str]:
    """Table 7 with the paper's own tables beside the staircase, flat triangles counted."""
    example = examples.lifted_spindle()
    paper = {row[0]: row for row in TABLES["table_7"]["rows"]}
    lines = [
        "## Table 7 by both rules: triangles, with and without those of no area",
        "",
        "| N | paper | printed tables | staircase | paper / printed | paper / staircase "
        "| flat, printed | flat, staircase |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    sizes, found = [8, 16] if small else [8, 16, 32], []
    for N in sizes:
        samples = example.samples(N)
        tree = dyadic_tree(samples, example.bound(N))
        row, flat = [paper[N][3] // TRIANGLE_BYTES], []
        for rule in ("printed", "staircase"):
            complex_ = section_of_leaves(samples, tree, rule=rule)
            row.append(len(complex_.simplices))
            flat.append(counts.flat_rows(complex_.points, complex_.simplices) / row[-1])
        found.append(row)
        lines.append(
            f"| {N} | {row[0]:,} | {row[1]:,} | {row[2]:,} | {row[0] / row[1]:.4f} "
            f"| {row[0] / row[2]:.4f} | {flat[0]:.0%} | {flat[1]:.0%} |"
        )
    nearer = sum(abs(a - b) < abs(a - c) for a, b, c in found)
    lines += [
        "",
        f"The printed tables are nearer to the paper's counts at {nearer} of {len(sizes)} sizes.",
    ]
    yield "\n".join(lines) + "\n"


def conformity(folder: Path, small: bool) -> Iterator[Table | str]:
    """The conformity check on meshes: facets met by two different cuts."""
    rows, alone_in_5 = [], {"printed": 0, "staircase": 0}
    found: list[tuple[tuple[int, int], str, int, int, str]] = []
    for n, m in ((3, 1), (4, 1), (5, 1), (5, 2), (5, 3)):
        shape = (3, 3, 3, 2, 2)[:n] if small else (4, 4, 3, 3, 2)[:n]
        values = np.random.default_rng(n).normal(size=(m, *shape))
        field = Field.of(values, dimension=n)
        for rule in ("staircase", "printed"):
            mesh = extract(field, rule=rule)
            box = [[0.0] * n, [N - 1.0 for N in shape]]
            alone = inner_open_facets(counted(mesh), box)
            doubled = int(covered(mesh.vertices, alone).sum())
            volume = float(counted(mesh).measure)
            every = len(counted(mesh).facets.uses)
            alone_in_5[rule] += len(alone) if n == 5 else 0
            found.append(((n, m), rule, len(alone), doubled, f"{volume:.9g}"))
            rows.append([n, m, rule, len(mesh.simplices), every, *found[-1][2:]])
    yield "## The conformity check: random samples, facets away from the border\n"
    yield rows_of(
        ["n", "m", "rule", "simplices", "facets", "with one simplex", "of these covered", "volume"],
        rows,
    )
    yield (
        f"{words.no_gap(found)} In dimension 5 the printed tables leave {alone_in_5['printed']:,}"
        f" facets with one simplex, the staircase {alone_in_5['staircase']:,}.\n"
    )


def dyadic_grids(folder: Path, small: bool) -> Iterator[Table | str]:
    """Figure 3."""
    example = examples.cone()
    figure, axes = plt.subplots(1, 3, figsize=(10.5, 3.7))
    for ax, N in zip(axes, (8, 16, 32), strict=True):
        tree = dyadic_tree(example.samples(N), example.paper_bound(N), test="corners")
        pictures.boxes_2d(ax, tree, (N + 1, N + 1))
        ax.set_title(f"N = {N}: {sum(map(len, tree.boxes))} boxes", fontsize=10)
    figure.tight_layout()
    pictures.save(figure, folder / "dyadic_grids.svg")
    yield "## Section 6, Figure 3: dyadic grids of max(|x|, |y|)\n"
    yield "![Dyadic grids for N = 8, 16, 32](min_2003/dyadic_grids.svg)\n"


def from_tree(example: examples.Example, N: int) -> tuple[Tree, Complex]:
    """The tree by the tighter bound, and the isosurface in its leaves."""
    samples = example.samples(N)
    tree = dyadic_tree(samples, example.bound(N))
    return tree, section_of_leaves(samples, tree)


def helix(folder: Path, small: bool) -> Iterator[Table | str]:
    """Section 7.1: Tables 5 and 6, Figures 4 to 6."""
    example = examples.helix()
    sizes = [32, 64] if small else [32, 64, 128, 256]
    printed_5 = {row[0]: row for row in TABLES["table_5"]["rows"]}
    printed_6 = {row[0]: row for row in TABLES["table_6"]["rows"]}
    uniform, dyadic = [], []
    for N in sizes:
        field = example.field(N - 1)
        seconds, mesh = clocked(lambda field=field: extract(field), 9)
        uniform.append((seconds, len(mesh.simplices), field.values.nbytes))
    larger = sizes if small else [*sizes, 512, 1024, 2048, 4096]
    for N in larger:
        seconds, (tree, complex_) = clocked(lambda N=N: from_tree(example, N))
        paper_tree = dyadic_tree(example.samples(N), example.paper_bound(N), test="corners")
        stored = paper_tree.stored_samples((N + 1,) * 3)
        dyadic.append((seconds, len(complex_.simplices), stored, paper_tree.tested, tree.tested))
    yield from table_5(sizes, uniform, printed_5)
    yield from table_6(larger, dyadic, printed_6)
    yield from helix_pictures(folder, example)


def table_5(sizes: list[int], uniform: list[Any], paper: dict[int, Any]) -> Iterator[Table | str]:
    """Uniform grid: time, bytes and rates beside the paper's."""
    sizes_table = Table("Table 5, uniform grid: bytes")
    for N, (_, segments, phi_bytes) in zip(sizes, uniform, strict=True):
        sizes_table.add(f"N = {N}, phi", paper[N][4], phi_bytes)
        note = "" if paper[N][3] % SEGMENT_BYTES == 0 else "no multiple of 24"
        ours = segments * SEGMENT_BYTES
        sizes_table.add(f"N = {N}, isosurface", paper[N][3], ours, note=note)
        sizes_table.add(f"N = {N}, total", paper[N][5], phi_bytes + ours)
    yield sizes_table
    seconds = [row[0] for row in uniform]
    yield rows_of(
        ["N", "paper ms", "rate", "ours ms", "rate"],
        [
            [N, paper[N][1], paper[N][2], 1e3 * s, r]
            for N, s, r in zip(sizes, seconds, rates(seconds), strict=True)
        ],
    )
    table = Table("Table 5: fitted exponents, n = 3")
    growth.add_slope(table, "time, the paper's numbers", sizes, [paper[N][1] for N in sizes], 3)
    growth.add_slope(table, "time, ours", sizes, seconds, None)
    totals = [row[2] + row[1] * SEGMENT_BYTES for row in uniform]
    growth.add_slope(table, "total space, ours", sizes, totals, 3)
    growth.add_slope(
        table, "total space, the paper's numbers", sizes, [paper[N][5] for N in sizes], 3
    )
    yield table
    yield EVERY_CELL
    yield words.table_5(list(paper.values()), SEGMENT_BYTES) + "\n"


def table_6(sizes: list[int], dyadic: list[Any], paper: dict[int, Any]) -> Iterator[Table | str]:
    """Dyadic grid: time, bytes and rates beside the paper's."""
    curve = Table("Table 6, dyadic grid: bytes of the curve")
    for N, (_, segments, *_) in zip(sizes, dyadic, strict=True):
        ours = segments * SEGMENT_BYTES
        printed = paper[N][3] if N in paper else None
        note = f"{(ours - printed) / SEGMENT_BYTES:+g} segments" if printed else ""
        curve.add(f"N = {N}", printed, ours, note=note)
    yield curve
    seconds, _, stored, paper_tested, tested = zip(*dyadic, strict=True)
    none = [None] * 7
    columns = (seconds, rates(seconds), stored, rates(stored), paper_tested, tested)
    yield rows_of(
        ["N", "paper ms", "rate", "paper bytes of phi", "ours ms", "rate", "ours bytes of phi",
         "rate", "boxes tested, paper's bound", "boxes tested, tighter bound"],
        [
            [N, *(paper.get(N, none)[i] for i in (1, 2, 4)), 1e3 * s, r, 16 * a, ra, b, c]
            for N, s, r, a, ra, b, c in zip(sizes, *columns, strict=True)
        ],
    )  # fmt: skip
    table = Table("Table 6: fitted exponents, n - m = 1")
    known = [N for N in sizes if N in paper]
    for what, column in (("time", 1), ("bytes of phi", 4), ("total space", 5)):
        numbers = [paper[N][column] for N in known]
        growth.add_slope(table, f"{what}, the paper's numbers", known, numbers, 1)
    growth.add_slope(table, "time, ours", sizes, seconds, None)
    yield table
    counted = {
        "segments": [row[1] for row in dyadic],
        "samples stored, the paper's bound": stored,
        "boxes tested, the paper's bound": paper_tested,
        "boxes tested, tighter bound": tested,
        "bytes of phi and of the curve": [
            16 * s + SEGMENT_BYTES * row[1] for s, row in zip(stored, dyadic, strict=True)
        ],
    }
    if len(sizes) > 2:
        yield growth.laws("Table 6: N or N log N", sizes, counted, 1)
    curves = {N: row[1] * SEGMENT_BYTES for N, row in zip(sizes, dyadic, strict=True)}
    yield words.table_6(paper, curves, SEGMENT_BYTES) + "\n"


def helix_pictures(folder: Path, example: examples.Example) -> Iterator[str]:
    """Figures 4, 5 and 6."""
    figure = plt.figure(figsize=(8.5, 4.2))
    tree, complex_ = from_tree(example, 64)
    mesh = to_mesh(complex_, tuple(example.spacing(64)), tuple(example.low))
    pictures.segments_3d(
        figure.add_subplot(1, 2, 1, projection="3d"), mesh, example.low, example.high,
        ("x", "y", "theta"),
    )  # fmt: skip
    figure.axes[0].set_box_aspect(None, zoom=0.85)  # type: ignore[call-arg]
    flat = figure.add_subplot(1, 2, 2)
    pictures.segments_2d(flat, mesh)
    flat.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), xlabel="x", ylabel="y")
    figure.tight_layout()
    pictures.save(figure, folder / "helix.png")
    figure, axes = plt.subplots(2, 4, figsize=(13.5, 7.2))
    sizes = (32, 64, 128)
    trees = [dyadic_tree(example.samples(N), example.paper_bound(N), test="corners") for N in sizes]
    uniform = Tree([1], [np.indices((32,) * 3).reshape(3, -1).T], 32**3)
    columns = zip(axes.T, (32, *sizes), [uniform, *trees], strict=True)
    for column, N, tree in columns:
        for ax, kept in zip(column, ((2, 0), (0, 1)), strict=True):
            pictures.boxes_2d(ax, tree, (N + 1,) * 3, kept)
        name = "uniform grid, " if tree is uniform else ""
        cells = "cells" if tree is uniform else "leaves"
        column[0].set_title(f"{name}N = {N}, {len(tree.leaves):,} {cells}", fontsize=10)
        column[0].set(xlabel="theta")
        column[1].set(xlabel="x")
    axes[0, 0].set_ylabel("side view: x", fontsize=11)
    axes[1, 0].set_ylabel("front view: y", fontsize=11)
    figure.tight_layout()
    pictures.save(figure, folder / "helix_boxes.png")
    yield "## Section 7.1, Figures 4 to 6\n"
    yield "![The curve and its projection](min_2003/helix.png)\n"
    yield "![Uniform and dyadic grids, from the side and the front](min_2003/helix_boxes.png)\n"


def leaf(folder: Path, small: bool) -> Iterator[Table | str]:
    """Section 7.2, Figures 7 and 8: on the printed lattice, and where no leaf is cut off."""
    N, half = (64 if small else 128), 2.1
    large, large_lifted = examples.leaf(half), examples.lifted_leaf(half)
    curve = to_mesh(from_tree(large_lifted, N)[1], tuple(large_lifted.spacing(N)),
                    tuple(large_lifted.low))  # fmt: skip
    square = f"[-{half}, {half}]^2"
    meshes = {
        ("printed", "level set, psi letter for letter"): _on_samples(examples.printed_leaf(N), N),
        ("printed", "level set, by the whole angle"): _on_samples(
            examples.on_printed_lattice(examples.leaf(1.0), N), N
        ),
        (square, "level set, by the whole angle"): extract(large.field(N)),
        ("printed", "lifted, projected"): _on_samples(
            examples.on_printed_lattice(examples.lifted_leaf(1.0), N), N
        ),
        (square, "lifted, projected"): curve,
    }
    rows, told = [], {}
    for (domain, name), mesh in meshes.items():
        ends = int((counted(mesh).facets.uses == 1).sum())
        told[domain, name] = pieces, _ = counted(mesh).components, ends
        rows.append([domain, name, len(mesh.simplices), pieces, ends])
    leaf_pictures(folder, meshes, large_lifted)
    yield f"## Section 7.2: a singular curve and its lift, N = {N}\n"
    yield rows_of(["square", "curve", "segments", "pieces", "ends"], rows)
    (lifted, _), (flat, _) = (
        told[square, name] for name in ("lifted, projected", "level set, by the whole angle")
    )
    rim = counted(curve).facets
    angles = curve.vertices[rim.rows[rim.uses == 1].reshape(-1), 2].tolist()
    yield (
        f"{words.leaves_cut_off(told['printed', 'level set, by the whole angle'][1])} Letter for"
        " letter psi has arctan(y / x), which is the angle on the right half only; on the left half"
        " sin(7 theta) changes its sign, and other leaves are drawn."
        f" {words.lifted_leaf(square, lifted, angles, flat)}\n"
    )
    yield "![Figures 7 and 8: level sets, the lifted curve flat and in space](min_2003/leaf.png)\n"


def _on_samples(example: examples.Example, N: int) -> Mesh:
    """The zero set on the example's lattice of N samples a side."""
    return extract(example.field(N - 1))


def leaf_pictures(
    folder: Path, meshes: dict[tuple[str, str], Mesh], lifted: examples.Example
) -> None:
    """Figures 7 and 8."""
    figure = plt.figure(figsize=(12, 8.2))
    for place, ((domain, name), mesh) in enumerate(meshes.items(), 1):
        ax = figure.add_subplot(2, 3, place)
        pictures.segments_2d(ax, Mesh(mesh.vertices[:, :2], mesh.simplices))
        half = 1.0 if domain == "printed" else lifted.high[0]
        square = "[-1, 1]^2 as printed" if domain == "printed" else domain
        ax.set(xlim=(-half, half), ylim=(-half, half), xlabel="x", ylabel="y")
        ax.set_title(f"{name}\n{square}", fontsize=10)
    space = figure.add_subplot(2, 3, len(meshes) + 1, projection="3d")
    pictures.segments_3d(space, mesh, lifted.low, lifted.high, ("x", "y", "theta"))
    space.set_title(f"lifted, in space\n{domain}", fontsize=10)
    space.set_box_aspect(None, zoom=0.82)  # type: ignore[attr-defined]
    figure.tight_layout()
    pictures.save(figure, folder / "leaf.png")


def spindle(folder: Path, small: bool) -> Iterator[Table | str]:
    """Section 7.3: Table 7 and Figure 9."""
    example = examples.lifted_spindle()
    paper = {row[0]: row for row in TABLES["table_7"]["rows"]}
    sizes = [8, 16] if small else [8, 16, 32, 64]
    seconds, triangles, stored, tested, leaves = [], [], [], [], []
    for N in sizes:
        rounds = 3 if N < 64 else 1
        took, (tree, complex_) = clocked(lambda N=N: from_tree(example, N), rounds)
        seconds.append(took)
        triangles.append(len(complex_.simplices))
        stored.append(tree.stored_samples((N + 1,) * 5))
        tested.append(tree.tested)
        leaves.append(len(tree.leaves))
        if N == sizes[min(2, len(sizes) - 1)]:
            shown_at = N
            picture_of(folder, example, complex_, N)
            box = [list(example.low), list(example.high)]
            mesh = to_mesh(complex_, tuple(example.spacing(N)), tuple(example.low))
            euler = oracle.Complex.of(mesh.vertices, complex_.simplices).euler
            holes = len(inner_open_facets(counted(mesh), box))
    surface = [TRIANGLE_BYTES * t for t in triangles]
    table = Table("Table 7: bytes of the lifted surface")
    for N, ours in zip(sizes, surface, strict=True):
        note = f"{(ours - paper[N][3]) / TRIANGLE_BYTES:+,g} triangles"
        table.add(f"N = {N}", paper[N][3], ours, note=note)
    yield table
    samples = [3 * VALUE_BYTES * s for s in stored]
    yield rows_of(
        ["N", "paper bytes of phi", "rate", "ours", "rate",
         "paper bytes of surface", "rate", "ours", "rate", "triangles", "seconds", "rate"],
        [
            [N, paper[N][1], paper[N][2], s, rs, paper[N][3], paper[N][4], g, rg, t, w, rw]
            for N, s, rs, g, rg, t, w, rw in zip(
                sizes, samples, rates(samples), surface, rates(surface), triangles,
                seconds, rates(seconds), strict=True,
            )
        ],
    )  # fmt: skip
    yield from spindle_exponents(paper, sizes, stored, tested, leaves, triangles, seconds)
    known = Table(f"Section 7.3, N = {shown_at}: the lifted surface is a disc over the two angles")
    known.add("Euler characteristic", None, euler, expected=1)
    known.add("open edges away from the border", None, holes, expected=0)
    yield known
    columns = ([paper[N][i] for N in sizes] for i in (1, 3))
    yield (
        f"{words.table_7(*columns, TRIANGLE_BYTES)} Section 7.3 writes phi into R^2 and lists"
        " three equations: m = 3. Its psi has the angle about the axis where the angle from the"
        f" axis is meant. {words.constant(TABLES['constant_7_3'], examples.spindle_constants())}\n"
    )
    yield (
        f"Figure 9 below is drawn for N = {shown_at} as the paper's: the level set on the printed"
        " lattice, a_i = -2 + 4 i / N for i from 1 to N, letter for letter and with the angle that"
        " is meant, and the lifted surface by the dyadic grid. The speckle at the pole is explained"
        " on [a page of its own](min_2003/pole.md).\n"
    )
    yield "![Figure 9: level sets in space and the projected lift](min_2003/spindle.png)\n"


def spindle_exponents(
    paper: dict[int, Any],
    sizes: list[int],
    stored: list[int],
    tested: list[int],
    leaves: list[int],
    triangles: list[int],
    seconds: list[float],
) -> Iterator[Table | str]:
    """The exponents of Table 7, the paper's and ours, beside n - m = 2, and both laws."""
    fits = Table("Table 7: fitted exponents, n - m = 2")
    if len(sizes) < 3:
        return
    growth.add_slope(fits, "bytes of phi, paper", sizes, [paper[N][1] for N in sizes], 2)
    growth.add_slope(fits, "bytes of surface, paper", sizes, [paper[N][3] for N in sizes], 2)
    growth.add_slope(fits, "time, ours", sizes, seconds, None)
    yield fits
    counted = {
        "the paper's bytes of phi": [paper[N][1] for N in sizes],
        "the paper's bytes of surface": [paper[N][3] for N in sizes],
        "samples stored, ours": stored,
        "boxes tested, ours": tested,
        "leaves, ours": leaves,
        "triangles, ours": triangles,
    }
    yield growth.laws("Table 7: N^2 or N^2 log N", sizes, counted, 2)


def picture_of(folder: Path, example: examples.Example, complex_: Complex, N: int) -> None:
    """Figure 9: psi = 0 in space, twice, beside the projection of the lifted surface."""
    eye = (1.0, -0.55, 0.42)
    images = [
        (
            f"{name}, N = {N}",
            shaded(examples.printed_spindle(N, letter).field(N - 1), (0, 1, 2), eye),
        )
        for name, letter in (
            ("level set, psi letter for letter", True),
            ("level set, angle from the axis", False),
        )
    ]
    mesh = project(to_mesh(complex_, tuple(example.spacing(N)), tuple(example.low)), (0, 1, 2))
    samples = example.samples(N)
    g = gradients(complex_.parents, samples.at, samples.shape, samples.spacing)
    images.append(
        (f"lifted, projected from R^5, N = {N}", pictures.render(mesh, normals(g, (0, 1, 2)), eye))
    )
    pictures.gallery(folder / "spindle.png", images)


def shaded(field: Field, kept: Sequence[int], eye: Sequence[float]) -> Any:
    """A picture of the isosurface of a field in R^(m+2), projected to three axes."""
    complex_ = section_of_field(field)
    flat = field.values.reshape(field.components, -1)
    g = gradients(complex_.parents, lambda i: flat[:, i].T, field.shape, field.spacing)
    mesh = project(to_mesh(complex_, field.spacing, field.origin), kept)
    return pictures.render(mesh, normals(g, kept), eye)


def complex_circle(folder: Path, small: bool) -> Iterator[Table | str]:
    """Section 7.4, Figure 10."""
    example = examples.complex_circle()
    N = 16 if small else 32
    field = example.field(N - 1)
    mesh = extract(field)
    table = Table(f"Section 7.4: z1^2 + z2^2 = 1 on {N}^4 samples, a tube")
    euler = counted(mesh).euler
    table.add("Euler characteristic", None, euler, expected=0)
    table.add("pieces", None, counted(mesh).components, expected=1)
    rim = counted(mesh).facets
    rims = oracle.Complex.of(mesh.vertices, rim.rows[rim.uses == 1]).components
    table.add("closed curves at its rim", None, rims, expected=2)
    yield table
    half = float(example.high[0])
    where = f"{N}^4 samples of [-{half:g}, {half:g}]^4"
    views = [(f"(x, y, p), {where}", (0, 1, 2)), (f"(x, y, q), {where}", (0, 1, 3))]
    images = [(name, shaded(field, kept, (0.9, -0.7, 0.55))) for name, kept in views]
    pictures.gallery(folder / "complex_circle.png", images)
    yield (
        f"The paper names {N}^4 samples and no domain; [-{half:g}, {half:g}]^4 is ours.\n"
        if N == 32
        else f"The paper has 32^4 samples; these are {N}^4.\n"
    )
    yield "![Figure 10: two projections of the complex circle](min_2003/complex_circle.png)\n"


def spheres(folder: Path, small: bool) -> Iterator[Table | str]:
    """Section 7.5, Figure 11, with the error the true solution allows to measure."""
    example = examples.two_spheres()
    sizes = [10, 20] if small else [10, 20, 40, 80]
    rows, worst, area, off = [], [], [], {}
    for N in sizes:
        field = example.field(N - 1)
        mesh = extract(field)
        sphere = project(mesh, (0, 1, 2))
        radius = np.linalg.norm(sphere.vertices, axis=1)
        off[N] = (sphere.vertices[:, 2], (radius - 0.75**0.5) / field.spacing[0] ** 2)
        worst.append(float(abs(radius - 0.75**0.5).max()))
        area.append(float(abs(counted(mesh).measure - 3 * pi)))
        height = float(abs(mesh.vertices[:, 3]).max())
        euler = counted(mesh).euler
        rows.append([N, len(mesh.simplices), worst[-1], area[-1], height, euler])
        if N == sizes[-2]:
            image = shaded(field, (0, 1, 2), (0.9, -0.7, 0.55))
    pictures.sphere(folder / "two_spheres.png", f"N = {sizes[-2]}", image, off)
    yield "## Section 7.5: two spheres of R^4 meet in a sphere of radius sqrt(3)/2\n"
    yield rows_of(
        ["N", "triangles", "largest error of the radius", "error of the area 3 pi",
         "largest |w|", "Euler characteristic"], rows,
    )  # fmt: skip
    table = Table("Section 7.5: order of convergence")
    cells = [N - 1 for N in sizes]
    for what, errors in (("radius", worst), ("area", area)):
        if len(cells) > 2:
            growth.add_slope(table, what, cells, [1 / e for e in errors], 2)
    yield table
    yield "![The intersection, projected, and its radius](min_2003/two_spheres.png)\n"
    outside = sum(int((error > 0).sum()) for _, error in off.values())
    every = sum(len(error) for _, error in off.values())
    spans = [(float(error.min()), float(error.max())) for _, error in off.values()]
    yield (
        "On the right every vertex of every N: its distance from the exact sphere over the square"
        f" of the cell's edge. {words.of_second_order(spans)} {words.outside(outside, every)}\n"
    )


if __name__ == "__main__":
    main()
