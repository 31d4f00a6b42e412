"""Hold every implementation to the published verification set of Etiene and Custodio.

Run it from anywhere: ``python papers/custodio_2013/reproduce.py``. The set (`custodio.npz`) is
looked for in the folder that ISOGRADE_DATA names; without it there is no report.
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
from isograde.adapters import open_adapter, ready_made_names
from isograde.claims.cells import on_cell_edges
from isograde.model import SURFACES, AdapterError, Limits
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_by_refinement import UnresolvedError, refine
from isograde.oracles.trilinear_grid import grid
from isograde.reproduction import Table, write_report

HERE = Path(__file__).parent
OPENING = """Made by `papers/custodio_2013/reproduce.py`. What is compared are the Euler
characteristics and Betti numbers that come with the verification set of Etiene and others (2012)
and Custodio and others (2013); "right" is how often an implementation's mesh has the same. A guided
reading is in `papers/custodio_2013/README.md`.
"""


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
    """The report, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--jobs", type=int, default=1, help="how many processes, default 1")
    options = parser.parse_args()
    folder = Path(os.environ.get("ISOGRADE_DATA", ""))
    if not os.environ.get("ISOGRADE_DATA") or not (folder / posed.NAME).is_file():
        raise SystemExit(f"set ISOGRADE_DATA to the folder that holds {posed.NAME}")
    published = posed.Published.read(folder)
    parts: list[Table | str] = [OPENING, the_set(published)]
    with ProcessPoolExecutor(options.jobs) as pool:
        truths = pool.submit(oracles, published)
        rows = list(pool.map(partial(agreed, published=published), implementations()))
        parts += [truths.result(), implementations_text(rows, published)]
    write_report(options.out / "custodio_2013.md", "The published verification set", parts)
    print(f"wrote {options.out / 'custodio_2013.md'}")


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
    """The grader's two oracles beside the published numbers."""
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
    side = posed.SIDES.get(name, posed.SIDE)
    adapter, version, in_cells = open_adapter(name), "", None
    try:
        said = adapter.open(Limits(seconds=300.0))
        version = said.version
        good = posed.right_grids(adapter, published.grids, published.betti, side)
        distinct, grids = int(good.sum()), int(published.times[good].sum())
        why = "single cells: its vertices are not on the lattice's edges"
        if on_cell_edges(said):
            alike = posed.right_cells(adapter, published.cells, published.euler, side)
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
        "but does not draw it.",
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
