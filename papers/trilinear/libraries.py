"""The tables of the report that compare implementations."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import geometry
import posing
from agreement import Agreement, Posed, agreement, implementations
from isograde.cases.trilinear_cells import TUNNELS
from isograde.model import AdapterError, Finding, Limits, Verdict
from isograde.oracles.sheets import Fault
from isograde.oracles.trilinear_cases import every_case
from smallest import Smallest, smallest_failures

LETTERS = {
    Fault.FACE: "F",
    Fault.FALSE: "T",
    Fault.MISSING: "M",
    Fault.OPEN: "H",
    Fault.EULER: "E",
    Fault.CROWDED: "C",
}
Mark = Callable[[Agreement, str], str]


@dataclass(frozen=True)
class Answered:
    """All that is asked of one implementation.

    near, orders : its lines of the tables beside topology
    """

    agreement: Agreement
    smallest: list[Smallest]
    near: str
    orders: list[str]

    @property
    def by_cells(self) -> bool:
        """Whether single cells could be judged."""
        return not (self.agreement.why_not or self.agreement.why_not_cells)


def answered(
    asked: Posed, limits: Sequence[int], pool: Executor, kept: Path | None = None
) -> list[Answered]:
    """What every implementation answers; what the folder `kept` has is not asked again."""
    ask = partial(_answered, asked=asked, limits=tuple(limits), kept=kept)
    return list(pool.map(ask, implementations()))


def _answered(name: str, asked: Posed, limits: tuple[int, ...], kept: Path | None) -> Answered:
    """What the implementation answers, read from its file or else written there."""
    path = None if kept is None else kept / f"{name.replace(':', '-')}-{len(asked.values)}.pickle"
    if path is not None and path.is_file():
        return pickle.loads(path.read_bytes())
    row = agreement(name, asked)
    faulty = row.faults and not row.why_not_cells and not name.startswith("isoref")
    small = smallest_failures(name, limits) if faulty else []
    made = Answered(row, small, *_measured(name))
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        whole = path.with_suffix(".part")
        whole.write_bytes(pickle.dumps(made))
        whole.replace(path)
    return made


def compared(found: list[Answered]) -> list[str]:
    """A row for each implementation, the tables of cases, and the smallest failing cells."""
    rows = [one.agreement for one in found]
    return [
        _summary(rows),
        _by_case([one.agreement for one in found if one.by_cells]),
        _by_island([row for row in rows if not row.why_not]),
        _smallest([small for one in found for small in one.smallest]),
    ]


SUMMARY = """## Who has the topology of the trilinear interpolant

Cell by cell: right cells among random ones, among the targeted ones of cases without and with a
tunnel; pairs of tunnels that meet on a face, out of 72, in which an edge has more than two
triangles. MeshLab, which takes small fields only, has a tenth of the random cells; where its filter
is called as it is (`pymeshlab:raw`) it leaves the last two layers of cells out along each axis, so
it is given two layers of samples more.

A triangle that lies in a face, as some of trimesh's do, whose vertices are halfway between samples,
may belong to the cell on either side: it is given to the one that leaves fewer cells wrong.

As a whole: the targeted cells amid low samples, so that each has a closed surface of its own; right
where its components and its Euler characteristic are. This can be asked of anybody. The row of an
implementation that cannot be judged cell by cell says why, in words.

Crossing: pairs of triangles that meet in more than they share, in the targeted cells, by exact
arithmetic; where single cells cannot be judged, on the first of them as wholes.
"""


def _summary(rows: list[Agreement]) -> str:
    """Every implementation's agreement in numbers."""
    lines = [
        SUMMARY,
        "| implementation | version | random cells | no tunnel | tunnel | crowded pairs "
        "| whole, no tunnel | whole, tunnel | crossing | not judged |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |",
    ]
    plain = [case for case in every_case() if case not in TUNNELS]
    for row in rows:
        if row.why_not:
            lines.append(f"| {row.name} | {row.version} | | | | | | | | {row.why_not} |")
            continue
        entries = [row.name, row.version]
        if row.why_not_cells:
            entries += ["", "", "", ""]
        else:
            entries.append(f"{row.random[0] / row.random[1]:.3%}")
            entries += [_share(row, row.right, cases) for cases in (plain, list(TUNNELS))]
            entries.append(str(row.crowded))
        entries += [_share(row, row.whole, cases) for cases in (plain, list(TUNNELS))]
        why = f"cell by cell: {row.why_not_cells}" if row.why_not_cells else ""
        lines.append(f"| {' | '.join([*entries, f'{row.crossing:,}', why])} |")
    return "\n".join(lines) + "\n"


def _share(row: Agreement, right: dict[str, int], cases: list[str]) -> str:
    """How many cells of these cases are right, of how many."""
    return f"{sum(right.get(c, 0) for c in cases):,} of {sum(row.total[c] for c in cases):,}"


def _by_case(rows: list[Agreement]) -> str:
    """The cases in which each implementation errs, cell by cell."""
    return (
        "## Agreement by case\n\n"
        "A tick: right in all targeted cells of the case. Else how many are right, of how many, "
        "and the faults: F wrong face, T false tunnel, M missing tunnel, H hole, E wrong Euler "
        "characteristic, C an edge with more than two triangles. Implementations that agree in "
        "every entry share a column.\n\n" + _grouped(rows, _mark)
    )


def _by_island(rows: list[Agreement]) -> str:
    """The cases in which each implementation errs, by whole surfaces."""
    return (
        "## Agreement by case, as a whole\n\n"
        "The same cells amid low samples: a tick where components and Euler characteristic of the "
        "closed surface are right for all cells of the case, else for how many of how many. Every "
        "implementation that answers is in this table.\n\n" + _grouped(rows, _island_mark)
    )


def _grouped(rows: list[Agreement], mark: Mark) -> str:
    """A table with a line a case and a column for implementations with the same marks."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for row in rows:
        marks = tuple(mark(row, case) for case in every_case())
        groups.setdefault(marks, []).append(row.name)
    heads = [chr(ord("A") + i) for i in range(len(groups))]
    lines = [
        *(f"- **{h}** {', '.join(names)}" for h, names in zip(heads, groups.values(), strict=True)),
        "",
        f"| case | {' | '.join(heads)} |",
        f"| --- | {' | '.join('---:' for _ in heads)} |",
    ]
    for i, case in enumerate(every_case()):
        lines.append(f"| {case} | {' | '.join(marks[i] for marks in groups)} |")
    return "\n".join(lines) + "\n"


def _mark(row: Agreement, case: str) -> str:
    """One entry of the table of cells."""
    right, total = row.right[case], row.total[case]
    if right == total:
        return "✓"
    letters = sorted({LETTERS[Fault(f)] for (c, f) in row.faults if c == case})
    return f"{right} of {total} {''.join(letters)}"


def _island_mark(row: Agreement, case: str) -> str:
    """One entry of the table of whole surfaces."""
    right, total = row.whole[case], row.total[case]
    return "✓" if right == total else f"{right} of {total}"


def _smallest(found: list[Smallest]) -> str:
    """The smallest failing cells."""
    lines = [
        "## The smallest failing cell of each fault",
        "",
        "Samples in C order, F(0,0,0), F(0,0,1), .. F(1,1,1); the isovalue is 0. Smallest by the "
        "largest number, then by the sum of sizes, among the whole numbers tried.",
        "",
        "| implementation | fault | case | samples |",
        "| --- | --- | --- | --- |",
        *(f"| {s.name} | {s.fault} | {s.case} | {' '.join(map(str, s.values))} |" for s in found),
    ]
    return "\n".join(lines) + "\n"


NEAR = """## Beside topology: distance, triangles, self-intersections

Smoothed noise of 24^3 samples. Distance of the middles of triangles and of their sides from the
trilinear level set, in spacings, along Newton's steps (an upper bound): mean, and what one in a
thousand exceeds; how many of the points are led nowhere. Median of the triangles' smallest angles,
share of triangles below 5 degrees. Pairs of triangles that meet in more than they share, by exact
arithmetic, and triangles that intersect others by MeshLab's count.

| implementation | mean | 99.9 % | astray | median angle | below 5° | pairs | MeshLab | triangles |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"""

ORDERS = """## Orders of convergence

Observed order with its 95 % confidence interval, spheres and tori at six resolutions (claims
`accuracy.*`). Formal: 2 for position, distance of the triangles from the trilinear surface, area
(`measure`) and volume, 1 for normals, those returned and total mean curvature. An entry is empty
where the claim is not made of what the implementation declares: distance of methods that cut other
cells than cubes, normals and curvature of those without linear crossings on edges.

"""


def beside_topology(found: list[Answered]) -> list[str]:
    """Distance to the level set, triangles, self-intersections; and orders of convergence."""
    names = [claim.id.split(".")[1] for claim in geometry.CLAIMS]
    near = [NEAR]
    far = [
        f"{ORDERS}| implementation | shape | {' | '.join(names)} |",
        f"| --- | --- | {' | '.join('---:' for _ in names)} |",
    ]
    for one in found:
        near.append(one.near)
        far += one.orders
    return ["\n".join(lines) + "\n" for lines in (near, far)]


def _measured(name: str) -> tuple[str, list[str]]:
    """The lines of one implementation: on smoothed noise, and its orders."""
    columns = len(geometry.CLAIMS)
    adapter = posing.posed_to(name)
    try:
        said = adapter.open(Limits(seconds=120))
        near = _near_row(name, adapter, geometry.smooth_noise())
        return near, _order_rows(name, geometry.orders(adapter, said))
    except AdapterError as error:
        why = f"| {name} | not measured: {_line(error)} |"
        return why + " |" * 7, [why + " |" * columns]
    finally:
        adapter.close()


def _near_row(name: str, adapter: geometry.Adapter, values: geometry.Floats) -> str:
    """The line of one implementation on smoothed noise."""
    try:
        found = geometry.measured(adapter, values)
    except AdapterError as error:
        return f"| {name} | not measured: {_line(error)} | | | | | | | |"
    return (
        f"| {name} | {found.mean:.4f} | {found.worst:.3f} | {found.astray:,} "
        f"| {found.shapes.median:.1f}° | {found.shapes.thin:.1%} | {found.crossing:,} "
        f"| {found.by_meshlab:,} | {found.triangles:,} |"
    )


def _line(told: object) -> str:
    """What is told, in a line that fits a table."""
    return (str(told).splitlines() or [""])[0].replace("|", "/")


def _order_rows(name: str, found: dict[str, dict[str, Finding] | str]) -> list[str]:
    """A line a shape with the orders of each claim, or one that says why there are none."""
    rows = []
    for shape, findings in found.items():
        if isinstance(findings, str):
            entries = [_line(findings), *[""] * (len(geometry.CLAIMS) - 1)]
        else:
            entries = [_order(findings.get(claim.id)) for claim in geometry.CLAIMS]
        rows.append(f"| {name} | {shape} | {' | '.join(entries)} |")
    return rows


def _order(finding: Finding | None) -> str:
    """The order of a claim with its interval; else what the claim says; empty if it is not made."""
    if finding is None:
        return ""
    if "order" in finding.numbers:
        return "{} ({} to {})".format(finding.numbers["order"], *finding.numbers["interval"])
    return "exact" if finding.verdict == Verdict.PASS else _line(finding.detail)
