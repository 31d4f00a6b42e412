"""Nielson & Hamann 1991, recomputed: Table 1, the printed triangulations, the figures.

Writes ``reports/papers/nielson_hamann_1991.md`` and the pictures beside it. Real volumes are
counted where they are found (ISOGRADE_DATA); the report says which were not.
"""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from itertools import product
from pathlib import Path

import nielson_words as words
import numpy as np
from isograde.cases import nielson_hamann
from isograde.cases.volumes import REGISTRY, Volume, find, load
from isograde.frequencies import frequencies
from isograde.oracles.complexes import Complex
from isograde.reproduction import Table, write_report
from isoref import asymptotic_decider, diagonals, lorensen_cline
from isoref.asymptotic_decider import VARIANTS, saddle
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from nielson_figures import SKULL, caption, draw_all
from nielson_lists import (
    OTHER_DIAGONAL,
    Checked,
    barred_edges,
    check_all,
    polygons_of,
    shown,
)
from nielson_table1 import PRINTED, ROWS, faces, printed_column, table, variants

REPORTS = Path(__file__).parent.parent.parent / "reports" / "papers"
NAME = "nielson_hamann_1991"
# Meshes of this many triangles and more are not turned edge by edge.
LARGE = 100_000


def examples() -> dict[str, tuple[Field, float]]:
    """The two analytic examples with the isovalues that reproduce them."""
    return {
        "Example 2": (nielson_hamann.example_2(), nielson_hamann.ISOVALUE_2),
        "Example 3": (nielson_hamann.example_3(), nielson_hamann.ISOVALUE_3),
    }


def table_of(example: str, field: Field, isovalue: float) -> Table:
    """A column of Table 1 beside the count, its sum last."""
    printed, ours = printed_column(example), table(variants(field, isovalue))
    found = Table(f"Table 1, {example}, isovalue {isovalue}")
    voxels = voxels_of(example)
    notes = words.misprints(printed, ours, voxels)
    for row in ROWS:
        found.add(row, printed[row], ours[row], note=notes.get(row, ""))
    found.add("sum of the column", voxels, sum(ours.values()), note="the paper's number of voxels")
    note = "; ".join(notes.values())
    found.add("sum of the printed column", voxels, sum(printed.values()), note=note)
    return found


def voxels_of(example: str) -> int:
    """The number of voxels of the lattice that the paper gives."""
    return int(np.prod(PRINTED["voxels"][example]))


def first_example() -> Table:
    """What can be checked of Example 1, whose data is not public."""
    printed = printed_column("Example 1")
    found = Table("Table 1, Example 1 (its data is not public)")
    voxels = voxels_of("Example 1")
    found.add("sum of the column", voxels, sum(printed.values()), note="its 69 x 65 x 65 voxels")
    return found


def isovalues_that_fit(example: str, field: Field, around: float, step: float) -> list[float]:
    """Isovalues at which every row but a misprint is as printed."""
    printed, ours = printed_column(example), table(variants(field, around))
    wrong = words.misprints(printed, ours, voxels_of(example))
    rows = [row for row in ROWS if row not in wrong]
    tried = [round(around + i * step, 7) for i in range(-30, 31)]
    return [a for a in tried if agrees(table(variants(field, a)), printed, rows)]


def agrees(ours: dict[str, int], printed: dict[str, int], rows: Iterable[str]) -> bool:
    """Whether the counts are the same in these rows."""
    return all(ours[row] == printed[row] for row in rows)


def isovalue_text() -> str:
    """What the printed isovalues give, and the range that gives the table."""
    lines = ["## The isovalues", ""]
    for example, (field, isovalue) in examples().items():
        fitting = isovalues_that_fit(example, field, isovalue, 5e-6)
        printed = PRINTED["isovalues as printed"][example]
        ours, column = table(variants(field, printed)), printed_column(example)
        off = [
            f"{row}: {ours[row]:,} for {column[row]:,}" for row in ROWS if ours[row] != column[row]
        ]
        lines += [
            f"{example}: of isovalues {5e-6:g} apart, those from {min(fitting):.6f} to "
            f"{max(fitting):.6f} give the column (all rows without a note). At the printed "
            f"{printed} the counts are {'; '.join(off)}.",
            "",
        ]
    field, isovalue = examples()["Example 2"]
    column = printed_column("Example 2")
    printed, ours = (table(variants(f, isovalue)) for f in (with_factor_75(field), field))
    right, as_printed = (sum(t[row] == column[row] for row in ROWS) for t in (ours, printed))
    return "\n".join(lines) + (
        f"\nWith the factor 75 of Example 2 as printed, {printed['0']:,} cells are of "
        f"configuration 0 and {printed['1']:,} of configuration 1, at {isovalue}, and the counts "
        f"are {words.factor(right, as_printed, len(ROWS))}.\n"
    )


def with_factor_75(field: Field) -> Field:
    """Example 2 with the factor of its second term as printed."""
    x, y, z = np.meshgrid(*(np.linspace(0, 1, n) for n in field.shape), indexing="ij")
    blob = np.exp(-16 * ((x - 0.25) ** 2 + (y - 0.25) ** 2 + (z - 0.25) ** 2))
    return Field.of(field.values + (75 - 0.75) * blob)


def present() -> list[tuple[Volume, float]]:
    """The real volumes at hand, with their isovalues."""
    found = [volume for volume in REGISTRY.values() if find(volume) is not None]
    return [(volume, isovalue) for volume in found for isovalue in volume.isovalues]


def volumes_text() -> str:
    """Table 1 for the real volumes, counted twice, and what their ambiguous faces decide."""
    counted = [(v.name, isovalue, load(v.name)) for v, isovalue in present()]
    absent = sorted({v.name for v in REGISTRY.values() if find(v) is None})
    full = [variants(field, isovalue) for _, isovalue, field in counted]
    tables = [table(counts) for counts in full]
    heads = [f"{name} {isovalue:g}" for name, isovalue, _ in counted]
    lines = ["## Table 1 for real volumes", "", "| | " + " | ".join(heads) + " |"]
    lines.append("| --- |" + " ---: |" * len(heads))
    for row in ROWS:
        lines.append(f"| {row} | " + " | ".join(f"{t[row]:,}" for t in tables) + " |")
    shares = []
    for t in tables:
        active = sum(t.values()) - t["0"]
        some = sum(
            n for row, n in t.items() if row.rstrip("ABCD,") in ("3", "6", "7", "10", "12", "13")
        )
        shares.append(f"{100 * some / active:.2f} %")
    lines.append("| ambiguous share of active cells | " + " | ".join(shares) + " |")
    same = [
        t == frequencies(field, a).counts for t, (_, a, field) in zip(tables, counted, strict=True)
    ]
    lines += [
        "",
        "The grader's own count (`isograde frequencies`), which shares no code with the "
        f"reference, agrees in every row on {sum(same)} of {len(same)}.",
        "",
        f"Absent here: {', '.join(absent) or 'none'}.",
        "",
        thirteen_text(full),
        *faces_lines(counted),
    ]
    return "\n".join(lines) + "\n"


def triangles_text() -> list[Table | str]:
    """Section 4: "no significant effect on the running time or the total number of triangles"."""
    lines = [
        "## Section 4: the cost of the modifications",
        "",
        "Triangles and seconds of the drawings of 1987 and of the asymptotic decider on the same "
        "volume, and of the decider with Choi's criterion on the smaller ones "
        "(`isoref.diagonals`): the mean angle between neighbours with the table's diagonals, then "
        "with his. Least CPU "
        f"seconds of three runs in turn, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} "
        "processors.",
        "",
        "| volume | triangles, 1987 | decider | more | time, decider / 1987 | mean angle, table "
        "| mean angle, Choi |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    more: list[float] = []
    same: list[bool] = []
    smaller: list[bool] = []
    volumes = [(v.name, a, load(v.name)) for v, a in present()]
    analytic = [(name, a, field) for name, (field, a) in examples().items()]
    for name, isovalue, field in [*analytic, *volumes]:
        meshes, seconds = timed(field, isovalue)
        old, new = (len(mesh.simplices) for mesh in meshes)
        more.append(100 * (new / old - 1))
        angles = ["", ""]
        if new < LARGE:
            chosen = diagonals.extract(asymptotic_decider.RULE, field, isovalue)
            bends = [mean_bend(mesh) for mesh in (meshes[1], chosen)]
            angles = [f"{bend:.2f}°" for bend in bends]
            same.append(len(chosen.simplices) == new)
            smaller.append(bends[1] < bends[0])
        lines.append(
            f"| {name} {isovalue:g} | {old:,} | {new:,} | {more[-1]:+.2f} % "
            f"| {seconds[1] / seconds[0]:.2f} | {' | '.join(angles)} |"
        )
    table = Table('Section 4: "no significant effect on the total number of triangles"')
    table.add("least change in triangles, per cent", None, round(min(more), 3))
    table.add("largest change in triangles, per cent", None, round(max(more), 3))
    return ["\n".join([*lines, "", words.by_choi(same, smaller)]) + "\n", table]


def timed(field: Field, isovalue: float) -> tuple[list[Mesh], list[float]]:
    """The meshes of 1987 and of the decider, and the least CPU seconds of three runs in turn."""
    meshes: list[Mesh] = []
    seconds = [float("inf")] * 2
    for _ in range(3):
        meshes = []
        for i, rule in enumerate((lorensen_cline.RULE, asymptotic_decider.RULE)):
            start = time.process_time()
            meshes.append(sweep(rule, field, isovalue))
            seconds[i] = min(seconds[i], time.process_time() - start)
    return meshes, seconds


def mean_bend(mesh: Mesh) -> float:
    """The mean angle, in degrees, between the normals of triangles that share an edge."""
    surface = Complex.of(mesh.vertices, mesh.simplices)
    sizes = np.linalg.norm(surface.normals, axis=1)
    edges = surface.facets
    pairs = [edges.sides[edges.start[edges.uses == 2] + i] // 3 for i in (0, 1)]
    flat = (sizes[pairs[0]] > 0) & (sizes[pairs[1]] > 0)
    n, m = (surface.normals[own[flat]] / sizes[own[flat], None] for own in pairs)
    return float(np.degrees(np.arccos(np.clip((n * m).sum(axis=1), -1, 1))).mean())


def thirteen_text(full: list[Counter[str]]) -> str:
    """How the cells of configuration 13 decide in the real volumes."""
    found = sum(full, Counter[str]())
    cells = {name: found[name] for name in VARIANTS if name.startswith("13")}
    listed = ", ".join(f"{name} {count}" for name, count in cells.items() if count)
    return (
        f"Cells of configuration 13 in these volumes: {listed or 'none'}. 13K, for which the paper "
        f"has no letter, occurs {cells['13K']} times; those that no values have (below), together "
        f"{sum(cells[name] for name in words.barred())} times.\n"
    )


def faces_lines(counted: list[tuple[str, float, Field]]) -> list[str]:
    """What the ambiguous faces decide, and how many saddles lie on the isovalue."""
    lines = [
        "### Ambiguous faces",
        "",
        "| | faces of cells | separated | saddle on the isovalue |",
        "| --- | ---: | ---: | ---: |",
    ]
    for name, isovalue, field in counted:
        total, separated, on_it = faces(field, isovalue)
        lines.append(f"| {name} {isovalue:g} | {total:,} | {separated:,} | {on_it:,} |")
    return [
        *lines,
        "",
        "A saddle on the isovalue is where the choice for degenerate faces matters.",
    ]


def lists_text(checked: list[Checked]) -> str:
    """Each printed list with its verdict."""
    fit = [c for c in checked if not c.wrong]
    repaired = [c for c in checked if c.wrong and c.fitting is not None]
    lines = [
        "## The triangulations printed in section 3",
        "",
        f"{len(fit)} of {len(checked)} lists fill their boundary polygons as scanned, "
        f"{len(repaired)} do once slips of the scan are undone, "
        f"{len(checked) - len(fit) - len(repaired)} cannot be right. Every repair takes the "
        "fewest slips that make the list fit.",
        "",
        "| variant | polygons | verdict | other readings |",
        "| --- | --- | --- | ---: |",
    ]
    for c in checked:
        polygons = ", ".join(shown(p) for p in polygons_of(c.name))
        lines.append(f"| {c.name} | {polygons} | {c.verdict} | {max(c.choices - 1, 0)} |")
    printed, derived = barred_edges()
    lines += [
        "",
        "Edges not allowed in Figure 12, as scanned: " + ", ".join(map(shown, printed)) + ".",
        f"Derived: {', '.join(map(shown, derived))}. {words.slips_of_the_scan(printed, derived)}",
        "",
        words.other_diagonal(*OTHER_DIAGONAL),
    ]
    return "\n".join(lines) + "\n"


def formula_table() -> Table:
    """B(S, T) by the formula with plus and with minus, beside the interpolant at the saddle.

    In rational numbers: the interpolant is level at its saddle, so what S and T are off by counts
    by its square, below the digits of the number that is shown.
    """
    corners = [np.array(v) for v in (1.0, -1.5, 2.0, -0.25)]
    S, T = (Fraction(float(v)) for v in saddle(*corners)[:2])
    a, b, c, d = (Fraction(float(v)) for v in corners)
    at_saddle = (1 - S) * ((1 - T) * a + T * d) + S * ((1 - T) * b + T * c)
    found = Table("B(S, T) of the face B00 = 1, B10 = -1.5, B11 = 2, B01 = -0.25")
    D = a + c - b - d
    for what, by_formula in (
        ("(B00 B11 + B10 B01) / D, as scanned", (a * c + b * d) / D),
        ("(B00 B11 - B10 B01) / D", (a * c - b * d) / D),
    ):
        found.add(what, None, float(at_saddle), expected=float(by_formula))
    return found


def reachable() -> str:
    """Which variants of 13 random values reach, and why others are out of reach."""
    signs = np.array([1 if sum(c) % 2 else -1 for c in product((0, 1), repeat=3)])
    values: Floats = np.random.default_rng(13).exponential(size=(20, 20, 20, 8)) ** 2 * signs
    found: Counter[str] = Counter()
    for cell in values.reshape(-1, 2, 2, 2):
        found += variants(Field.of(cell), 0.0)
    names = ", ".join(f"{name} {found[name]:,}" for name in VARIANTS if found[name])
    return (
        "## Configuration 13\n\n"
        f"{sum(found.values()):,} random cells: {names}. {words.reached(found)} "
        f"{words.unlettered(found)}\n"
    )


def figures_text(made: list[Path]) -> str:
    """The pictures, and which is not there."""
    absent = "" if any(path.name == SKULL for path in made) else f"\n{SKULL}: no CT head here.\n"
    shown = (f"{caption(path)}\n\n![{path.stem}]({NAME}/{path.name})\n" for path in sorted(made))
    return "## Figures\n\n" + "\n".join(shown) + absent


def skull() -> tuple[Field, float] | None:
    """A CT head with the isovalue of its bone, where it is at hand."""
    volume = REGISTRY["headsq"]
    return (load("headsq"), volume.isovalues[0]) if find(volume) is not None else None


def main() -> None:
    """Write the report and the figures."""
    made = draw_all(REPORTS / NAME, skull())
    parts: list[Table | str] = [
        'Recomputed by `papers/nielson_hamann_1991/reproduce.py`. "paper" holds printed numbers. '
        "What the findings mean is told in the folder's README.",
        *(table_of(example, *rest) for example, rest in examples().items()),
        first_example(),
        isovalue_text(),
        volumes_text(),
        *triangles_text(),
        lists_text(check_all()),
        formula_table(),
        reachable(),
        figures_text(made),
    ]
    write_report(REPORTS / f"{NAME}.md", "Nielson & Hamann 1991: the asymptotic decider", parts)
    print(f"wrote {REPORTS / NAME}.md and {len(made)} figures")


if __name__ == "__main__":
    main()
