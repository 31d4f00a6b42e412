"""Count, compare, draw: what is true of a cell, and who has it right.

Run it from anywhere: ``python papers/trilinear/reproduce.py``. It writes the reports
reports/papers/trilinear.md and trilinear/implementations.md, and pictures beside them; ``--part``
writes one of the two. Real volumes are looked for in the folder that
ISOGRADE_DATA names; libraries that are not installed get a row that says so. The cells take some
ten minutes on an idle core, the implementations an hour or more: ``--resume FOLDER`` goes on where
it was cut off. ``--quick`` uses a twentieth of the cells and says so.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import agreement
import figures
import libraries
import numpy as np
import posing
from isograde.adapters import open_adapter
from isograde.cases.trilinear_cells import TUNNELS
from isograde.cases.volumes import REGISTRY, find, read
from isograde.model import Limits
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_by_refinement import UnresolvedError, refine
from isograde.oracles.trilinear_cases import (
    Topology,
    case_name,
    case_names,
    classes,
    every_case,
    every_topology,
    representative,
)
from isograde.oracles.trilinear_grid import active_cells, grid
from isograde.reproduction import Table, write_report
from isoref.cycles import cycles
from isoref.field import Field
from isoref.methods import METHODS

HERE = Path(__file__).parent
# Pose so many cells in a row at once. The judge takes places for one within a tolerance that grows
# with the field: in a row of 300 a crossing of a scan stood within it of a corner.
ROW = 60
PRINTED = json.loads((HERE / "printed.json").read_text(encoding="utf-8"))
OPENING = """Made by `papers/trilinear/reproduce.py`, which computes every number but those under
"paper", which are printed, and the zeros under "expected"; of the other numbers under "expected"
one is the length of a list of names, and says so, the others are totals of this run. The truth is
`isograde.oracles.trilinear`, its list of cases `isograde.oracles.trilinear_cases`, the extractor
`isoref.trilinear_cubes`. What is asked of every implementation is
[a page of its own](trilinear/implementations.md). A guided reading is in
`papers/trilinear/README.md`.
"""
OPENING_OF_IMPLEMENTATIONS = """Made by `papers/trilinear/reproduce.py --part implementations`,
which asks every ready-made implementation and computes every number. The truth is
[the page beside it](../trilinear.md).
"""


def main() -> None:
    """The reports and their pictures, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--quick", action="store_true", help="a twentieth of the cells")
    parser.add_argument("--jobs", type=int, default=2, help="how many processes, default 2")
    told = "which page to write, default both: cells (the truth, and isoref), implementations"
    parser.add_argument("--part", choices=("cells", "implementations"), help=told)
    told = "keep each implementation's answers here and ask none again that is there; begin a new "
    told += "folder after a change of the code"
    parser.add_argument("--resume", type=Path, metavar="FOLDER", help=told)
    options = parser.parse_args()
    share = 20 if options.quick else 1
    if options.part != "implementations":
        write_cells(options.out, share, options.jobs)
    if options.part != "cells":
        write_implementations(options.out, share, options.jobs, options.resume)


def write_cells(out: Path, share: int, jobs: int) -> None:
    """The page on the truth, its checks and trilinear cubes is written; every share-th cell."""
    folder = out / "trilinear"
    figures.draw_cases(folder / "cases.png")
    figures.draw_tunnel(folder / "tunnel.png")
    with ProcessPoolExecutor(jobs) as pool:
        truth = [pool.submit(part, share) for part in (checked_by_refinement, reference_agrees)]
        real = pool.submit(real_volumes)
        counted = how_many_cases(share)
        parts = [*counted, *(part.result() for part in truth), real.result()]
    opening = [OPENING, *quick(share)]
    _write(out / "trilinear.md", "The topology of the trilinear interpolant", [*opening, *parts])


def write_implementations(out: Path, share: int, jobs: int, kept: Path | None) -> None:
    """The page that asks every implementation is written; every share-th cell."""
    limits = (2, 3, 4, 6) if share == 1 else (4, 8)
    with ProcessPoolExecutor(jobs) as pool:
        found = libraries.answered(agreement.posed(share), limits, pool, kept)
    parts = [*libraries.compared(found), *libraries.beside_topology(found)]
    opening = [OPENING_OF_IMPLEMENTATIONS, *quick(share)]
    title = "Implementations beside the trilinear interpolant"
    _write(out / "trilinear" / "implementations.md", title, [*opening, *parts])


def quick(share: int) -> list[str]:
    """What is said of a run of a part of the cells."""
    return ["**A quick run: a twentieth of the cells.**"] if share > 1 else []


def _write(path: Path, title: str, parts: Sequence[Table | str]) -> None:
    """The page is written, and said to be."""
    write_report(path, title, parts)
    print(f"wrote {path}")


def how_many_cases(share: int) -> list[Table | str]:
    """The derived numbers beside the printed ones, and a line for each case."""
    table = Table("How many cases there are")
    table.add(
        "up to rotation and exchange of high and low",
        PRINTED["chernyaev"]["cases"],
        len(classes(mirror=False)),
    )
    table.add("the same, mirror images as one", None, len(classes()))
    table.add("up to rotation alone", None, len(classes(mirror=False, exchange=False)))
    table.add("topologies of a cell with numbered corners", None, len(every_topology()))
    named = [case_name(one) for one in classes(mirror=False)]
    listed = set(PRINTED["names"]["list"])
    note = "the list in `printed.json`, from software after Chernyaev"
    table.add("names of cases in use", None, len(set(named)), expected=len(listed), note=note)
    table.add(
        "names that are not ours, or ours that are no name",
        None,
        len(listed ^ set(named)),
        expected=0,
    )
    twice = sorted(name for name, number in Counter(named).items() if number > 1)
    table.add("names of two classes", None, len(twice), note=", ".join(twice))
    faces = {(one.signs, one.faces) for one in every_topology()}
    table.add("signs and decisions on faces that can occur", None, len(faces))
    thirteen = {one.faces for one in every_topology() if all(one.faces)}
    printed = PRINTED["nielson_hamann_1991"]
    table.add(
        "face decisions of configuration 13",
        printed["choices of 13"],
        len(thirteen),
        note="opposite pairs of faces cannot contradict each other",
    )
    kinds = {representative(one, mirror=False, exchange=False) for one in every_topology()}
    kinds = {one for one in kinds if all(one.faces)}
    without = {(one.signs, one.faces) for one in kinds}
    table.add("classes of these under the rotations", printed["classes of 13"], len(without),
              note=of_three(without))  # fmt: skip
    shown = f"![the cases](trilinear/cases.png)\n\n{caption(classes(mirror=False))}\n\n{TUNNEL}"
    return [table, _each_case(share), shown]


Decided = tuple[tuple[int, ...], tuple[int, ...]]


def of_three(decided: Iterable[Decided]) -> str:
    """The classes of configuration 13 with three faces separated, by their polygons' sides."""
    lengths = []
    for signs, faces in decided:
        if sum(face < 0 for face in faces) == 3:
            corners = sum(1 << c for c, sign in enumerate(signs) if sign > 0)
            separated = sum(1 << f for f, face in enumerate(faces) if face < 0)
            lengths.append(sorted(map(len, cycles(corners, separated))))
    shown = ", ".join("+".join(map(str, own)) for own in sorted(lengths))
    return f"{len(lengths)} of them with three faces separated, polygons of {shown or 'none'} sides"


def caption(drawn: Iterable[Topology]) -> str:
    """How many classes are drawn, and which of them are mirror images of each other."""
    every = list(drawn)
    together: dict[Topology, list[str]] = {}
    for one in every:
        together.setdefault(representative(one), []).append(case_name(one))
    pairs = sorted(names for names in together.values() if len(names) > 1)
    told = [
        f"the two {names[0]}" if len(set(names)) == 1 else " and ".join(sorted(names))
        for names in pairs
    ]
    return (
        f"The {len(every)} classes as trilinear cubes draws them; tunnels in orange, dots on high "
        f"corners.\nMirror images of each other: {', '.join(told) or 'none'}."
    )


TUNNEL = """![a tunnel](trilinear/tunnel.png)

Two opposite corners joined through the middle of the cell, and not: the level set, the reference,
and the asymptotic decider, which looks at faces only.
"""


def _each_case(share: int) -> str:
    """Signs, faces and bodies that make each case, and its share among random cells."""
    drawn = 500_000 // share
    found: Counter[str] = Counter()
    for start in range(0, drawn, 100_000):
        values = posing.random_cells(min(100_000, drawn - start), start)
        found.update(case_names(cells(values)).tolist())
    labelled = Counter(case_name(one) for one in every_topology())
    sheets = {case_name(one): one.sheets for one in every_topology()}
    lines = [
        "## Case by case",
        "",
        f"Sheets are written by the numbers of sides of their boundary curves: 3+6 is a tunnel "
        f"between a triangle and a hexagon. The last column counts {drawn:,} random cells.",
        "",
        "| case | sheets | topologies | among random cells |",
        "| --- | --- | ---: | ---: |",
    ]
    for name in every_case():
        shown = ", ".join("+".join(map(str, sheet)) for sheet in sheets[name]) or "none"
        lines.append(f"| {name} | {shown} | {labelled[name]} | {found[name] / drawn:.5%} |")
    tunnels = sum(n for name, n in found.items() if name in TUNNELS)
    lines += ["", f"Cells with a tunnel: {tunnels:,} of {drawn:,} ({tunnels / drawn:.3%})."]
    return "\n".join(lines) + "\n"


def checked_by_refinement(share: int) -> Table:
    """The truth beside refinement and digital topology."""
    table = Table("The truth, checked by refinement and digital topology")
    for title, values in (
        ("random cells", posing.random_cells(10_000 // share, 1)),
        ("targeted cells", posing.targeted()[1][:: 2 * share]),
    ):
        truths = cells(values)
        agreed = unresolved = 0
        for i, cell in enumerate(values):
            try:
                found = refine(cell, limit=300_000)
            except UnresolvedError:
                unresolved += 1
                continue
            mine = (truths.components[i], truths.euler[i], truths.curves[i])
            agreed += (found.components, found.euler, found.curves) == mine
        table.add(f"{title}: cells that refinement resolves", None, len(values) - unresolved)
        table.add(f"{title}: agreeing", None, agreed, expected=len(values) - unresolved)
    agreed, resolved = _grids_by_refinement(300 // share)
    table.add("grids of 4^3 samples that refinement resolves", None, resolved)
    table.add("grids agreeing", None, agreed, expected=resolved)
    return table


def _grids_by_refinement(number: int) -> tuple[int, int]:
    """Grids of noise whose glued truth refinement confirms, and grids that it resolves."""
    rng = np.random.default_rng(2)
    agreed = resolved = 0
    for _ in range(number):
        values = rng.uniform(-1, 1, (4, 4, 4))
        try:
            found = refine(values)
        except UnresolvedError:
            continue
        resolved += 1
        truth = grid(values)
        mine = (truth.components, truth.euler, truth.curves)
        agreed += (found.components, found.euler, found.curves) == mine
    return agreed, resolved


def reference_agrees(share: int) -> Table:
    """isoref:trilinear-cubes beside the truth, at length."""
    table = Table("isoref:trilinear-cubes beside the truth")
    adapter = open_adapter(posing.REFERENCE)
    adapter.open(Limits(seconds=120))
    try:
        for title, values in (
            ("random cells", posing.random_cells(100_000 // share, 3)),
            ("targeted cells", posing.targeted()[1]),
        ):
            right = sum(fault is Fault.NONE for fault in posing.faults(adapter, values))
            table.add(f"{title} right", None, right, expected=len(values))
            some = values[: 10_000 // share]
            crossing = agreement.crossing(adapter, some, posing.side_of(posing.REFERENCE))
            what = f"pairs of triangles that cross in {len(some):,} {title}"
            table.add(what, None, crossing, expected=0)
        grids = 2_000 // share
        total, wrong, crowds = agreement.grids_of_noise(adapter, grids, 8)
        what = f"cells of {grids:,} grids of 8^3 noise right"
        table.add(what, None, total - wrong, expected=total)
        table.add("grids with an edge of more than two triangles", None, crowds, expected=0)
        crossing = agreement.crossing_in_grids(adapter, grids // 10, 8)
        what = f"pairs of triangles that cross in {grids // 10:,} of the grids"
        table.add(what, None, crossing, expected=0)
        crowded = sum(posing.crowded(adapter, pair) for pair in posing.tunnel_pairs())
        table.add("pairs of tunnels with such an edge", None, crowded, expected=0)
    finally:
        adapter.close()
    return table


def real_volumes() -> Table | str:
    """Every cell of the real volumes that signs alone do not decide."""
    table = Table("Real volumes: cells that signs alone do not decide")
    for name, volume in REGISTRY.items():
        place = find(volume)
        if place is not None:
            values = np.asarray(read(place, volume=volume).values)
            for isovalue in volume.isovalues[:1]:
                _add_volume(table, f"{name} at {isovalue + 0.5:g}", values, isovalue + 0.5)
    if not table.rows:
        return "## Real volumes\n\nSkipped: ISOGRADE_DATA names no folder with volumes.\n"
    return table


def _add_volume(
    table: Table,
    title: str,
    values: np.ndarray[tuple[int, ...], np.dtype[np.generic]],
    level: float,
) -> None:
    """Two lines of the table: the cells right, and those with tunnels."""
    blocks = _undecided_blocks(values, level)
    total = right = tunnels = ties = 0
    for corners in blocks:
        truths = cells(corners, level)
        good = truths.ties == NONE
        ties += int((~good).sum())
        field = Field.of(posing.in_line(corners, level))
        mesh = METHODS["trilinear-cubes"](field, level)
        found = judge(mesh.vertices, mesh.simplices, posing.line(len(corners)), truths, field.shape)
        total += int(good.sum())
        right += sum(f is Fault.NONE for f, g in zip(found, good, strict=True) if g)
        tunnels += int((truths.tunnels[good] > 0).sum())
    table.add(
        f"{title}: right",
        None,
        right,
        expected=total,
        note=f"{tunnels:,} with a tunnel; {ties:,} ties left out",
    )


def _undecided_blocks(
    values: np.ndarray[tuple[int, ...], np.dtype[np.generic]], level: float
) -> list[np.ndarray[tuple[int, ...], np.dtype[np.generic]]]:
    """The undecided cells in blocks of at most `ROW`, read slab by slab."""
    found = []
    for start in range(0, values.shape[0] - 1, 32):
        _, corners = active_cells(values[start : start + 33], level)
        if len(corners):
            high = corners.reshape(-1, 8) > level
            found.append(corners[~agreement.decided(high)])
    if not found:
        return []
    together = np.concatenate(found)
    return [together[i : i + ROW] for i in range(0, len(together), ROW)]


if __name__ == "__main__":
    main()
