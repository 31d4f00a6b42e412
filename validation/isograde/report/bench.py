"""What was timed as a page, as Markdown with its plots, and as numbers.

The three say the same. Sentences are computed from the rows; every plot has its numbers in the
table, and every row its rounds in the file of numbers.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from isograde.adapters.child import TICK
from isograde.benching import FAMILIES, Bench, Contestant, Row, Side, Work
from isograde.report.lines import JSON
from isograde.report.markdown import plain
from isograde.report.page import environment
from isograde.report.plot import Bar, Series, bars, curves
from isograde.report.record import versions

# More processors at a time than one thread can use, with room for rounding; and so few that the
# call waited for others, and nothing can be told.
SEVERAL, WAITED = 1.2, 0.7
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


class Line(NamedTuple):
    """A row of the table in words; empty where there is nothing to say."""

    field: str
    samples: str
    active: str
    vertices: str
    time: str
    of_peer: str
    ratio: str
    spread: str
    clock: str
    memory: str
    memory_of_peer: str
    rounds: str
    failed: str


def headline(bench: Bench) -> str:
    """What was found, in a sentence."""
    if bench.ratio is None:
        return f"{bench.own.name} and {bench.peer.name} have no field that both answered"
    number = sum(row.ratio is not None for row in bench.rows)
    return (
        f"{bench.own.name} takes {bench.ratio:.2f} times the time of {bench.peer.name}, "
        f"the geometric mean over {number} field{'s' * (number != 1)}"
    )


def sentences(bench: Bench) -> list[str]:
    """What else was found: how it grows, its threads, what failed."""
    told = []
    for which, one in (("own", bench.own), ("peer", bench.peer)):
        if (work := bench.work(which)) is not None:
            told.append(f"{one.name}: {_work(work)}.")
        told.append(f"{one.name}: {_threads(bench.parallel(which))}.")
        sides: list[Side] = [getattr(row, which) for row in bench.rows]
        if failed := sum(bool(side.failed) for side in sides):
            told.append(
                f"{one.name} failed on {failed} of {len(sides)} fields; the table says how."
            )
    return told


def _work(work: Work) -> str:
    """What a call, a sample and an active cell cost, in words."""
    return (
        f"a call costs {_figure(work.call * 1e3)} ms, a sample {_figure(work.sample * 1e9)} ns and "
        f"an active cell {_figure(work.active * 1e9)} ns (fitted to the rows, of which the "
        f"farthest is {work.worst:.0%} off)"
    )


def _figure(number: float) -> str:
    """A number with three figures, and no power of ten.

    >>> _figure(4978.2), _figure(0.1834)
    ('4,978', '0.183')
    """
    return f"{number:,.0f}" if number >= 100 else f"{number:.3g}"


def _threads(parallel: float | None) -> str:
    """How many processors were used at a time, in words."""
    if parallel is None:
        return "a program is seen from outside, so its threads are not counted"
    if parallel < WAITED:
        waited = "it waited for others, so its threads cannot be told"
        return f"it got {parallel:.1f} of a processor on its largest field: {waited}"
    kind = "several threads" if parallel > SEVERAL else "one thread at a time"
    return f"at most {parallel:.1f} processors at a time on its largest field, {kind}"


def how(bench: Bench) -> list[str]:
    """What a number means, in sentences."""
    told = [
        f"Both were asked in turn, at most {bench.rounds} rounds a field after a first call, each "
        "in a process of its own. A ratio is of one round; its median and quartiles over the "
        "rounds are shown. Each call has an isovalue of its own, by a millionth, so that an answer "
        "that is remembered is of no use.",
        "Times are the processor's, of all threads, where both tell them, since others on the "
        "machine disturb these less; beside them stands the ratio by the clock.",
        "Memory is what one call added to its process at the highest, the answer included, after "
        "what earlier calls had left was given back to the system.",
    ]
    programs = [one for one in (bench.own, bench.peer) if one.program]
    for one in programs:
        told.append(
            f"{one.name} is a program: its time runs from the request to the end of its answer, "
            "unless the answer tells its own seconds, and is the clock's; its memory is all that "
            f"its process held, looked at every {TICK:g} s."
        )
    limits = [f"{name}={os.environ[name]}" for name in THREADS if name in os.environ]
    told.append(
        f"Threads are limited by {', '.join(limits)}."
        if limits
        else "No variable of the environment limited the number of threads."
    )
    return told


def table(bench: Bench) -> list[Line]:
    """The rows in words."""
    return [_line(row, bench) for row in bench.rows]


def _line(row: Row, bench: Bench) -> Line:
    """One row."""
    failed = [
        f"{one.name} {side.failed}"
        for one, side in ((bench.own, row.own), (bench.peer, row.peer))
        if side.failed
    ]
    ratio, clock = row.ratio, row.by_clock
    timing = row.own.timing or row.peer.timing
    return Line(
        row.name,
        f"{row.samples:,}",
        f"{row.active:,}",
        f"{row.own.vertices:,}" if row.own.timing else "",
        _milliseconds(row.own),
        _milliseconds(row.peer),
        "" if ratio is None else f"{ratio[0]:.2f}",
        "" if ratio is None else f"{ratio[1]:.2f} to {ratio[2]:.2f}",
        "" if clock is None else f"{clock:.2f}",
        _megabytes(row.own),
        _megabytes(row.peer),
        str(len(timing.seconds)) if timing else "",
        "; ".join(failed),
    )


def _milliseconds(side: Side) -> str:
    """A median time."""
    return _figure(side.seconds * 1e3) if side.timing else ""


def _megabytes(side: Side) -> str:
    """A memory."""
    return "" if side.megabytes is None or not side.timing else _figure(side.megabytes)


HEADS = {
    "field": "field",
    "samples": "samples",
    "active": "active cells",
    "vertices": "vertices",
    "time": "ms",
    "of_peer": "ms of the peer",
    "ratio": "ratio",
    "spread": "quartiles",
    "clock": "by the clock",
    "memory": "MB",
    "memory_of_peer": "MB of the peer",
    "rounds": "rounds",
}


def plots(bench: Bench) -> dict[str, str]:
    """The plots as SVG, by the name of a file; those for which there are numbers."""
    found = {}
    if bench.ratio is not None:
        rows = [
            Bar(row.name, *row.ratio, list(FAMILIES).index(row.family))
            for row in bench.rows
            if row.ratio is not None
        ]
        found["ratios"] = bars(
            "Time over the peer's", "smaller is faster; median and quartiles", rows
        )
    for name, across in (
        ("samples", "samples"),
        ("active", "active cells"),
        ("vertices", "its vertices"),
    ):
        found[name] = curves(
            f"Time against {across}", across, "milliseconds", _series(bench, name, _time)
        )
    found["memory"] = curves("Memory", "samples", "megabytes", _series(bench, "samples", _memory))
    return {name: svg for name, svg in found.items() if svg}


def _time(side: Side) -> float:
    """Milliseconds."""
    return side.seconds * 1e3


def _memory(side: Side) -> float:
    """Megabytes; 0 where they are not known."""
    return side.megabytes or 0.0


def _series(bench: Bench, across: str, up: Any) -> list[Series]:
    """The curves of both, a family each; what is not above 0 has no place on them."""
    found = []
    for which, named in (("own", "{}"), ("peer", "{}, the peer")):
        for colour, family in enumerate(FAMILIES):
            points = []
            for row in bench.rows:
                side: Side = getattr(row, which)
                if row.family != family or side.timing is None:
                    continue
                x = side.vertices if across == "vertices" else getattr(row, across)
                if x > 0 and up(side) > 0:
                    points.append((float(x), float(up(side))))
            found.append(Series(named.format(family), points, colour, which == "peer"))
    return found


def page(bench: Bench) -> str:
    """The page as HTML: nothing to load, for light and dark, wide and narrow."""
    return (
        environment()
        .get_template("bench.html")
        .render(
            bench=bench,
            headline=headline(bench),
            sentences=sentences(bench),
            how=how(bench),
            heads=HEADS,
            table=table(bench),
            plots=plots(bench),
            versions=versions(),
        )
    )


def markdown(bench: Bench, stem: str) -> str:
    """The page as Markdown, its plots in files beside it."""
    own, peer = (_named(one) for one in (bench.own, bench.peer))
    lines = [
        f"# {plain(bench.own.name)} beside {plain(bench.peer.name)}",
        f"**{plain(headline(bench))}.**",
        f"{own} and {peer}; {bench.machine}; {bench.seconds:.0f} s in all.",
        *(plain(said) for said in sentences(bench)),
        "\n".join(f"![{name}]({stem}-{name}.svg)" for name in plots(bench)),
        "\n".join(_markdown_table(table(bench))),
        *(plain(said) for said in how(bench)),
    ]
    return "\n\n".join(lines) + "\n"


def _named(one: Contestant) -> str:
    """A contestant with its version."""
    return plain(f"{one.name} {one.version}".strip())


def _markdown_table(rows: Sequence[Line]) -> list[str]:
    """The table."""
    heads = list(HEADS.values())
    lines = [f"| {' | '.join(heads)} |", "| --- |" + " ---: |" * (len(heads) - 1)]
    for row in rows:
        cells = [getattr(row, name) or "-" for name in HEADS]
        lines.append(f"| {' | '.join(cells)} |")
    failed = [f"- {row.field}: {plain(row.failed)}" for row in rows if row.failed]
    return [*lines, *(["", *failed] if failed else [])]


def numbers(bench: Bench) -> JSON:
    """Everything that was measured, every round of it."""
    found: dict[str, Any] = asdict(bench)
    for row, said in zip(bench.rows, found["rows"], strict=True):
        said["name"], said["kind"] = row.name, list(row.kind)
    found["kind"] = list(bench.kind)
    found["versions"] = dict(versions())
    return found


def write(bench: Bench, folder: Path, stem: str = "bench") -> Path:
    """The page, in a folder with its Markdown, plots and numbers."""
    from isograde.report import write_whole

    written: Mapping[str, str] = {
        f"{stem}.html": page(bench),
        f"{stem}.md": markdown(bench, stem),
        f"{stem}.json": json.dumps(numbers(bench), indent=1, allow_nan=False) + "\n",
        **{f"{stem}-{name}.svg": svg for name, svg in plots(bench).items()},
    }
    for name, text in written.items():
        write_whole(folder / name, text)
    return folder / f"{stem}.html"
