"""Hold every implementation to the published verification set of Etiene and Custodio.

Run it from anywhere: ``python papers/custodio_2013/reproduce.py``. The set (`custodio.npz`) is
looked for in the folder that ISOGRADE_DATA names, or the set as it is published
(`custodio_files`); without it there is no report. ``--cases FILE`` writes the set as cases of the
grader instead.
"""

from __future__ import annotations

import argparse
import os
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import custodio_posed as posed
import numpy as np
from custodio_files import write_cases
from isograde.adapters import open_adapter, ready_made_names
from isograde.claims.cells import on_cell_edges
from isograde.model import SURFACES, AdapterError, Limits
from isograde.oracles.stratified_morse import euler
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_by_refinement import UnresolvedError, refine
from isograde.oracles.trilinear_grid import grid
from isograde.reproduction import Table, write_report

HERE = Path(__file__).parent
OPENING = """Made by `papers/custodio_2013/reproduce.py`. What is compared are the Euler
characteristics and Betti numbers that come with the verification set of Etiene and others (2012)
and Custodio and others (2013), and what the grader's oracles say of the same fields. Every
implementation is on [a page of its own](custodio_2013/implementations.md). A guided reading is in
`papers/custodio_2013/README.md`.
"""
OPENING_OF_IMPLEMENTATIONS = """Made by `papers/custodio_2013/reproduce.py --part implementations`.
"Right" is how often an implementation's mesh has the published numbers of
[the set](../custodio_2013.md).
"""
TITLE = "The published verification set"


@dataclass(frozen=True)
class Agreed:
    """What one implementation has right; None where it cannot be asked."""

    name: str
    version: str
    cells: int | None
    grids: int | None
    distinct: int | None
    why_not: str = ""


def main() -> None:
    """The pages, in reports/papers of this repository or in --out, or a file of cases."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--jobs", type=int, default=1, help="how many processes, default 1")
    told = "which page to write, default both: oracles, implementations"
    parser.add_argument("--part", choices=("oracles", "implementations"), help=told)
    told = "write no page, but the set as cases for `isograde grade NAME --cases FILE`"
    parser.add_argument("--cases", type=Path, metavar="FILE", help=told)
    told = "with --cases: every so many cells and distinct grids, default 100"
    parser.add_argument("--every", type=int, default=100, metavar="N", help=told)
    options = parser.parse_args()
    folder = Path(os.environ.get("ISOGRADE_DATA", ""))
    at_hand = posed.is_set(folder) or (folder / posed.NAME).is_file()
    if not os.environ.get("ISOGRADE_DATA") or not at_hand:
        raise SystemExit(
            f"set ISOGRADE_DATA to the folder that holds {posed.NAME}, or MarchingCubes_cases and "
            "Closed_Surfaces as they are published"
        )
    published = posed.Published.read(folder)
    if options.cases:
        some = slice(None, None, max(1, options.every))
        made = write_cases(options.cases, published.cells[some], published.grids[some])
        print(f"{options.cases} has {made} cases more")
        return
    if options.part != "implementations":
        page = options.out / "custodio_2013.md"
        write_report(page, TITLE, [OPENING, the_set(published), oracles(published)])
        print(f"wrote {page}")
    if options.part != "oracles":
        with ProcessPoolExecutor(options.jobs) as pool:
            rows = list(pool.map(partial(agreed, published=published), implementations()))
        page = options.out / "custodio_2013" / "implementations.md"
        parts = [OPENING_OF_IMPLEMENTATIONS, implementations_text(rows, published)]
        write_report(page, f"{TITLE}: implementations", parts)
        print(f"wrote {page}")


def the_set(published: posed.Published) -> Table:
    """What is in the set."""
    table = Table("The set")
    table.add("cells", None, len(published.cells))
    distinct = len(np.unique(published.cells.reshape(len(published.cells), -1), axis=0))
    table.add("distinct cells", None, distinct)
    table.add("grids of 5^3 samples, closed surfaces", None, int(published.times.sum()))
    note = f"one of them {int(published.times.max())} times"
    table.add("distinct grids", None, len(published.grids), note=note)
    for name, values in (("cells", published.cells), ("grids", published.grids)):
        table.add(f"samples of {name} equal to the isovalue", None, int((values == 0).sum()))
    for chi, number in sorted(Counter(published.euler.tolist()).items()):
        table.add(f"cells of Euler characteristic {chi}", None, number)
    for column, name in enumerate(("b0", "b1")):
        most = int(published.betti[:, column].max())
        table.add(f"largest {name} of a grid", None, most)
    return table


def oracles(published: posed.Published) -> Table:
    """The grader's oracles beside the published numbers."""
    table = Table("The grader's oracles beside the published numbers")
    truths = cells(published.cells)
    good = truths.ties == NONE
    agree = (truths.euler == published.euler) & good
    table.add("cells, by sweeping", None, int(agree.sum()), expected=len(agree))
    glued = [grid(one) for one in published.grids]
    right = np.array([_betti(one.components, one.euler) for one in glued]) == published.betti
    times = published.times
    table.add("grids, by gluing swept cells", None, int(times[right.all(axis=1)].sum()),
              expected=int(times.sum()))  # fmt: skip
    morse = np.array([euler(-one) for one in published.grids])
    alike = morse == 2 * published.betti[:, 0] - 2 * published.betti[:, 1]
    note = "what each critical point above the isovalue adds; after Etiene and others 2012"
    table.add("grids, by stratified Morse theory", None, int(times[alike].sum()),
              expected=int(times.sum()), note=note)  # fmt: skip
    for name, values, wanted in (
        ("cells", published.cells[::10], published.euler[::10]),
        ("distinct grids", published.grids[::10], published.betti[::10]),
    ):
        same = resolved = 0
        for one, own in zip(values, wanted, strict=True):
            try:
                found = refine(one)
            except UnresolvedError:
                continue
            resolved += 1
            mine = found.euler if own.ndim == 0 else _betti(found.components, found.euler)
            same += bool(np.all(mine == own))
        note = f"of {len(values):,} tried, a tenth; digital topology after Etiene and others 2012"
        table.add(f"{name}, by refinement", None, same, expected=resolved, note=note)
    return table


def _betti(components: int, euler: int) -> tuple[int, int]:
    """b0 and b1 of a closed surface, as the set counts them."""
    return components, components - euler // 2


def implementations() -> list[str]:
    """Every ready-made name, the reference last."""
    return sorted(ready_made_names(SURFACES), key=lambda name: (name.startswith("isoref"), name))


def agreed(name: str, published: posed.Published) -> Agreed:
    """What the implementation has right."""
    side, margin = posed.SIDES.get(name, posed.SIDE), posed.MARGINS.get(name, 0)
    adapter, version, in_cells = open_adapter(name), "", None
    try:
        said = adapter.open(Limits(seconds=300.0))
        version = said.version
        good = posed.right_grids(adapter, published.grids, published.betti, side, margin)
        distinct, grids = int(good.sum()), int(published.times[good].sum())
        why = "single cells: its vertices are not on the lattice's edges"
        if on_cell_edges(said):
            alike = posed.right_cells(adapter, published.cells, published.euler, side, margin)
            in_cells, why = int(alike.sum()), ""
        return Agreed(name, version, in_cells, grids, distinct, why)
    except AdapterError as error:
        return Agreed(name, version, in_cells, None, None, str(error).splitlines()[0])
    finally:
        adapter.close()


def implementations_text(rows: list[Agreed], published: posed.Published) -> str:
    """A line an implementation."""
    total = int(published.times.sum())
    lines = [
        "## Every implementation beside the published numbers",
        "",
        f"Right of {len(published.cells):,} cells (Euler characteristic), of {total:,} grids, and "
        f"of the {len(published.grids):,} grids that are distinct (pieces and handles). The set "
        "asks for the trilinear interpolant; who decides faces by a convention is not at fault, "
        "but does not draw it. MeshLab's filter, called as it is (`pymeshlab:raw`), leaves out the "
        "last two layers of cells along each axis: it is given two layers of samples more, so that "
        "what it draws is judged.",
        "",
        "| implementation | version | cells | grids | distinct grids | not asked |",
        "| --- | --- | ---: | ---: | ---: | --- |",
    ]
    for row in rows:
        numbers = ["" if n is None else f"{n:,}" for n in (row.cells, row.grids, row.distinct)]
        lines.append(f"| {row.name} | {row.version} | {' | '.join(numbers)} | {row.why_not} |")
    whole = [row.name for row in rows if row.cells == len(published.cells) and row.grids == total]
    lines += ["", f"Right throughout: {', '.join(whole) or 'none'}."]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
