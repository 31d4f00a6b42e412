"""Extraction: our vectorised sweep beside the libraries, in turn, one thread.

Prints a Markdown table for each field: seconds, the ratio to ours in double and in single
precision (most libraries give single), extra peak memory, what the mesh is made of. Ratios are of
processor time, round by round. Libraries of the league have a process of their own (`outside`). Run
``python benchmarks/bench_extraction.py --help``; `make benchmarks` runs it with
the defaults and keeps the table in `reports/benchmarks/extraction.md`.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from dataclasses import field as entry
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from floor import PASSES, Spent, floor, leaves
from isograde.cases.volumes import REGISTRY, find, read
from isograde.report.plot import Bar, bars
from isograde.stopwatch import Cost, Timing, in_turn, interleave, peak_memory, timed
from isoref.fast._bits import Bits
from isoref.fast.sweep import PART_CELLS, SLAB_POINTS, _Sweep, sweep
from isoref.field import Array, Field, least_inside
from isoref.mesh import Precision
from isoref.methods import METHODS, RULES
from outside import PEERS, AbsentError, Outside, library, version
from pages import Page, of_numpy, one_call, own_times, profiled, table_of
from scipy.ndimage import gaussian_filter

Run = Callable[[], object]
SWEEP = sys.modules[sweep.__module__]
DECIDER = RULES["asymptotic-decider"]
OURS, OURS_SINGLE = "isoref asymptotic-decider", "isoref asymptotic-decider, single"
ANEURISM, BUNNY = REGISTRY["aneurism"], REGISTRY["bunny"]
# No further round is begun after so many seconds of a field, and who has taken so many in two
# rounds is not asked in another: a call of seconds differs little from the next one.
SECONDS, ENOUGH = 20.0, 4.0


def sphere(n: int) -> Array:
    """A ball of radius 0.7 in a cube of side 2, float32."""
    x = np.linspace(-1, 1, n, dtype=np.float32)
    r2 = x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None] ** 2
    return np.asarray(np.float32(0.7) - np.sqrt(r2))


def noise(n: int, sigma: float = 2) -> Array:
    """White noise smoothed by so many samples, float32: a folded surface."""
    white = np.random.default_rng(1).normal(size=(n, n, n)).astype(np.float32)
    return np.asarray(gaussian_filter(white, sigma))


def gyroid(n: int) -> Array:
    """Four periods of the gyroid along each axis, float32."""
    x = np.linspace(0, 8 * np.pi, n, dtype=np.float32)
    a, b, c = x[:, None, None], x[None, :, None], x[None, None]
    return np.asarray(np.sin(a) * np.cos(b) + np.sin(b) * np.cos(c) + np.sin(c) * np.cos(a))


def aneurism() -> Array:
    """The samples of a real angiography, 256^3."""
    place = find(ANEURISM)
    assert place is not None, "main offers the angiography only where it is"
    return read(place, volume=ANEURISM).values


def bunny() -> Array:
    """The samples of the bunny's scan."""
    place = find(BUNNY)
    assert place is not None, "main offers the bunny only where it is"
    return read(place, volume=BUNNY).values


FIELDS: dict[str, Callable[[], Array]] = {
    "sphere 64^3": lambda: sphere(64),
    "sphere 128^3": lambda: sphere(128),
    "sphere 256^3": lambda: sphere(256),
    "sphere 384^3": lambda: sphere(384),
    "smoothed noise 128^3": lambda: noise(128),
    "dense noise 128^3": lambda: noise(128, 1.2),
    "gyroid 256^3": lambda: gyroid(256),
    "sphere 256^3 uint8": lambda: np.clip(sphere(256) * 200 + 128, 0, 255).astype(np.uint8),
    "bunny CT, 361 x 512 x 512": bunny,
    "angiography 8 times, 512^3 uint8": lambda: np.tile(aneurism(), (2, 2, 2)),
}
#: The isovalue of a field, where it is not 0.
ISOVALUES = {
    "sphere 256^3 uint8": 128.0,
    "bunny CT, 361 x 512 x 512": 1807.0,
    "angiography 8 times, 512^3 uint8": 128.0,
}


def here(name: str) -> bool:
    """The field's samples can be had: scans stand where ISOGRADE_DATA says."""
    scan = {"bunny": BUNNY, "angio": ANEURISM}.get(name[:5])
    return scan is None or find(scan) is not None


def peers(values: Array, isovalue: float) -> dict[str, Run]:
    """The libraries that are installed, each as a call without arguments on this volume."""
    found: dict[str, Run] = {}
    if importlib.util.find_spec("skimage"):
        from skimage.measure import marching_cubes

        found["skimage lewiner"] = lambda: marching_cubes(values, isovalue)
    if importlib.util.find_spec("mcubes"):
        import mcubes

        found["PyMCubes"] = lambda: mcubes.marching_cubes(values, isovalue)
    if importlib.util.find_spec("vtkmodules"):
        found |= vtk_peers(values, isovalue)
    return found


def vtk_peers(values: Array, isovalue: float) -> dict[str, Run]:
    """VTK's three contour filters, without normals and gradients, on one thread."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkFlyingEdges3D, vtkMarchingCubes

    vtkSMPTools.Initialize(1)
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1)))

    def filtered(kind: type[Any]) -> Run:
        def run() -> object:
            contour = kind()
            contour.SetInputData(image)
            contour.SetValue(0, isovalue)
            contour.ComputeNormalsOff()
            contour.ComputeGradientsOff()
            contour.Update()
            return contour.GetOutput()

        return run

    return {
        "VTK flying edges": filtered(vtkFlyingEdges3D),
        "VTK contour filter": filtered(vtkContourFilter),
        "VTK marching cubes": filtered(vtkMarchingCubes),
    }


#: What flying edges' time over ours shall be at least, with the row of the table of goals.
FLYING = {
    "sphere 64^3": ("flying-spheres", 0.8),
    "sphere 128^3": ("flying-spheres", 1.4),
    "sphere 256^3": ("flying-spheres", 2.0),
    "sphere 384^3": ("flying-spheres", 2.5),
    "gyroid 256^3": ("flying-folded", 1.4),
    "dense noise 128^3": ("flying-folded", 1.1),
    "sphere 256^3 uint8": ("flying-scans", 2.0),
    "bunny CT, 361 x 512 x 512": ("flying-scans", 1.5),
    "angiography 8 times, 512^3 uint8": ("flying-scans", 1.5),
}
#: The same of Open3D's.
OPEN3D = {
    "sphere 64^3": 1.0,
    "sphere 128^3": 2.0,
    "sphere 256^3": 3.0,
    "gyroid 256^3": 2.0,
    "dense noise 128^3": 1.3,
}
#: What our time over one comparison of all samples shall be at most.
OVER_COMPARISON = {"sphere 384^3": 3.0}
#: What other peers' time over ours shall be at least: everywhere, and on noise.
PEER_GOALS = {
    "skimage lewiner": (4.0, 4.0),
    "PyMCubes": (3.0, 1.2),
    "meshlib": (6.0, 6.0),
    "zmesh": (4.0, 4.0),
    "VTK contour filter": (1.3, 1.3),
}
#: What the time of these methods over ours shall be at most, on noise and on real volumes.
METHOD_GOALS = {
    "isoref trilinear-cubes": ("rules", 1.2),
    "isoref marching-vesta-mixed-L": ("rules", 1.2),
    "isoref marching-vesta-disconnect-L": ("rules", 1.2),
    "isoref marching-vesta-mixed-H": ("mixed-H", 1.5),
}
#: What an extraction may take beside its output, MiB.
MEMORY = 25.0
STAGES = (
    "bits of samples, edges, cells",
    "crossings",
    "signs",
    "decisions",
    "triangles",
    "other work on cells",
    "points inside cells",
    "rest",
    "mesh copied once",
    "one look-up a vertex",
)
PEER, COMPARISON = "VTK flying edges", "one `values >= isovalue`"
FLOOR, FLOOR_SINGLE = "the least passes", "the least passes, single"
UNASKED = "VTK marching cubes"
FLOORS = {OURS: FLOOR, OURS_SINGLE: FLOOR_SINGLE}
BESIDE = (OURS, OURS_SINGLE, COMPARISON, FLOOR, FLOOR_SINGLE)


@dataclass
class Measured:
    """What was found on one field.

    timings : of all contestants, by name
    memory : bytes by which a call raised the resident memory, by contestant
    output : bytes of our mesh in double and in single precision
    made : what the mesh of a contestant is made of
    absent : contestants that are not here, and why
    least : the least passes, which add the seconds of each stage to what they are given
    """

    name: str
    vertices: int
    triangles: int
    timings: dict[str, Timing]
    memory: dict[str, int]
    output: tuple[int, int]
    made: dict[str, str]
    absent: dict[str, str] = entry(default_factory=dict)
    least: Callable[..., object] = entry(default=lambda spent: None)

    def over(self, one: str, other: str) -> tuple[float, float, float] | None:
        """The ratio of two contestants' times, or None where one is not here."""
        if one not in self.timings or other not in self.timings:
            return None
        return self.timings[one].over(self.timings[other])

    def seconds(self, one: str) -> float:
        """The median of a contestant's seconds of the processor."""
        return statistics.median(self.timings[one].processor)

    def why_absent(self, peer: str) -> str:
        """Why a contestant is not here."""
        return self.absent.get(peer, "not installed here")


def ask(page: Page, found: Measured) -> None:
    """Note what was asked of a field."""
    name = found.name
    rough = "noise" in name or name.startswith(("angio", "bunny"))

    def peer(row: str, whose: str, bound: float, ours: str) -> None:
        what = f"{whose} over {ours.replace('isoref asymptotic-decider', 'ours')}, {name}"
        absent = found.why_absent(whose)
        page.ask(row, what, found.over(whose, ours), bound, most=False, absent=absent)
        if page.goals[-1].met is False:
            lowest = found.seconds(FLOORS[ours])
            said = leaves(found.seconds(whose), bound, lowest, found.seconds(ours))
            page.explain(what, said)

    for ours in (OURS, OURS_SINGLE):
        if name in FLYING:
            peer(FLYING[name][0], PEER, FLYING[name][1], ours)
        if name in OPEN3D:
            peer("open3d", "open3d", OPEN3D[name], ours)
    for whose, (usual, on_noise) in PEER_GOALS.items():
        peer("libraries", whose, on_noise if "noise" in name else usual, OURS)
    if name in OVER_COMPARISON:
        ratio, bound = found.over(OURS, COMPARISON), OVER_COMPARISON[name]
        page.ask("comparison", f"ours over {COMPARISON}, {name}", ratio, bound, most=True)
    for method, (row, bound) in METHOD_GOALS.items():
        if rough and method in found.timings:
            ratio = found.over(method, OURS)
            page.ask(row, f"{method} over ours, {name}", ratio, bound, most=True)
    for ours, output in zip((OURS, OURS_SINGLE), found.output, strict=True):
        beside = max(0, found.memory[ours] - output) / 2**20
        what = f"{ours.replace('isoref asymptotic-decider', 'ours')}, {name}"
        page.ask("memory", what, (beside,) * 3, MEMORY, most=True)


def absent(page: Page, name: str) -> None:
    """Note what was asked of a field that is not here."""
    said = "the scan is not here: ISOGRADE_DATA names its folder"
    row, bound = FLYING[name]
    page.ask(row, f"{PEER} over ours, {name}", None, bound, most=False, absent=said)
    for whose, (usual, _) in PEER_GOALS.items():
        page.ask("libraries", f"{whose} over ours, {name}", None, usual, most=False, absent=said)
    for method, (row, bound) in METHOD_GOALS.items():
        page.ask(row, f"{method} over ours, {name}", None, bound, most=True, absent=said)


def least(found: Measured) -> list[str]:
    """A row of a table: our time and the peers' over the least passes."""
    shown = [found.over(ours, lowest) for ours, lowest in FLOORS.items()]
    shown += [found.over(peer, FLOOR) for peer in (PEER, "open3d")]
    return [found.name, *("-" if one is None else f"{one[0]:.2f}" for one in shown)]


def small(values: Array, found: Measured) -> str:
    """What the calls of NumPy alone take of our time on a small field."""
    field = Field.of(values)
    calls = of_numpy(profiled(lambda: sweep(DECIDER, field, 0.0)))
    seconds = found.seconds(OURS)
    return (
        f"On the field {found.name} ours makes {calls:,} calls of NumPy's functions in C, besides "
        f"operators. One such call on eight numbers takes {one_call() * 1e6:.2f} microseconds, so "
        f"what they cost if they did nothing is {calls * one_call() / seconds:.0%} of our "
        f"{seconds * 1e3:.1f} ms."
    )


#: The finest of the surfaces, and what it is compared with.
FINE = "isoref marching-vesta-mixed-H"


def fine(page: Page, values: Array, found: Measured) -> list[str]:
    """A row of a table: how much more of a mesh VESTA mixed H makes, in how much more time."""
    isovalue = ISOVALUES.get(found.name, 0.0)
    field = Field.of(values)
    meshes = [METHODS[method](field, isovalue) for method in (FINE.split()[1], OURS.split()[1])]
    sizes = [
        (len(one.vertices), len(one.simplices), one.vertices.nbytes + one.simplices.nbytes)
        for one in meshes
    ]
    more = [f"{one / other:.2f}" for one, other in zip(*sizes, strict=True)]
    ratio = found.over(FINE, OURS)
    assert ratio is not None
    bound, larger = METHOD_GOALS[FINE][1], sizes[0][2] / sizes[1][2]
    page.explain(
        f"{FINE} over ours, {found.name}",
        f"its mesh has {larger:.2f} times the bytes, so where they cost what ours do it takes "
        f"{larger:.2f} times our time, {'more' if larger > bound else 'less'} than the "
        f"{bound:g} that was asked",
    )
    return [found.name, *more, f"{ratio[0]:.2f}"]


def profile_of(method: str, values: Array, isovalue: float) -> dict[Any, Any]:
    """What the profiler counts of a method on a field."""
    field = Field.of(values)
    return profiled(lambda: METHODS[method.split()[1]](field, isovalue))


def why_slow(method: str, found: dict[Any, Any]) -> list[str]:
    """Where the time of a method goes, by module and by function."""
    return [
        table_of([f"{method}: module", "of its time"], own_times(found, "isoref", modules=True)),
        table_of([f"{method}: function", "of its time"], own_times(found, "isoref")),
    ]


WHY_FINE = """\
A vertex of ours stands on an edge of the lattice and is had from two samples. One in the middle of
a polygon is the mean of all the polygon's nodes, which have to be there before; and there is one
for each polygon of more than three sides. The table says how much larger the mesh is, in bytes:
where that alone is more than a goal of 1.5 allows, each of those vertices and triangles would have
to cost less than one of the others does."""
WHY_RULES = """\
What another rule does and the decider does not are its decisions, of trilinear-cubes those inside a
cell as well as on its faces; they are the modules other than `sweep`, `_bits`, `_fans` and
`_growing`, which carry every rule. And it has more points inside polygons and cells: those are
placed by `sweep._add_interior`, `_average`, `_mean` and `_place_deferred`, looked up and drawn."""


#: The stages of a sweep by the methods that make them; some lie within others.
WATCHED = {
    "bits": (Bits, "slab"),
    "crossings": (_Sweep, "_make_crossings"),
    "cells": (_Sweep, "_make_cells"),
    "signs": (Bits, "cells"),
    "keys": (_Sweep, "_keys"),
    "drawing": (_Sweep, "_draw"),
    "placing": (_Sweep, "_place_deferred"),
}


def stages(field: Field, isovalue: float) -> dict[str, float]:
    """Seconds of the processor in each stage of one sweep, and in all; besides, in other things."""
    spent: dict[str, float] = {}
    made = _Sweep(DECIDER, field, isovalue, "double", False)
    with ExitStack() as stack:
        for stage, (owner, method) in WATCHED.items():
            call = _timed(spent, stage, getattr(owner, method))
            stack.enter_context(patch.object(owner, method, call))
        mesh = _timed(spent, "all", made.mesh)()
    count, flat = len(mesh.vertices), mesh.simplices.reshape(-1)
    _timed(spent, "copy", lambda: (mesh.vertices.copy(), mesh.simplices.copy()))()
    _timed(spent, "look-up", lambda: np.arange(count).take(flat[:count], mode="clip"))()
    return spent


def _timed(spent: dict[str, float], stage: str, call: Callable[..., Any]) -> Callable[..., Any]:
    """The call, whose processor time is added to a stage."""

    def run(*arguments: Any) -> Any:
        start = time.process_time()
        result = call(*arguments)
        spent[stage] = spent.get(stage, 0.0) + time.process_time() - start
        return result

    return run


def profile(name: str, values: Array, rounds: int) -> list[str]:
    """A row of the table that says where our time goes, in per cent of it."""
    isovalue = ISOVALUES.get(name, 0.0)
    runs = [stages(Field.of(values), isovalue) for _ in range(rounds + 1)][1:]

    def share(stage: str) -> float:
        return statistics.median(run.get(stage, 0.0) / run["all"] for run in runs)

    within = share("signs"), share("keys"), share("drawing")
    shown = (
        share("bits"),
        share("crossings"),
        *within,
        share("cells") - sum(within),
        share("placing"),
        1 - share("bits") - share("crossings") - share("cells") - share("placing"),
        share("copy"),
        share("look-up"),
    )
    return [name, *(f"{100 * one:.1f}" for one in shown)]


STAGED = """\
The columns up to "rest", which is among other things the growing of arrays, add up to our time but
for medians. The last two are beside it, for comparison: to copy the finished arrays of the mesh
once, and to make one look-up a vertex."""
LEAST = """\
*The least passes* are measured in turn with all others (`benchmarks/floor.py` says each of them).
Some find where the surface is: all samples are compared once and packed into bits, bits compared
with their neighbours along three axes, the number and the place of each crossing and each cell had
from its bit, a cell's tile from its signs. Others draw it: for each crossing its number is written
into a table, both samples are looked up and made doubles, five steps of arithmetic place it, three
coordinates are written; for each corner of a triangle its edge is added up, its vertex looked up
and written. All else is given for nothing. We know of no program in NumPy that draws this mesh
without these passes, so a peer's time over them is the most that we think a ratio to such a program
can be; it is no proof, for somebody may know fewer. A compiled loop does to a crossing at one go,
its numbers in registers, what these passes do. Where a goal asks for more than they allow, it is
called out of reach; where it does not, what is between is ours beside them: which cells have which
decisions, the kinds of their fans, the seams of slabs and parts, arrays that are made and grow.
The stages of the least passes, in per cent of our time:"""


def passed(found: Measured, rounds: int) -> list[str]:
    """A row of a table: the stages of the least passes, in per cent of our time."""
    runs: list[Spent] = []
    for _ in range(rounds):
        runs.append({})
        found.least(runs[-1])
    ours = found.seconds(OURS)
    each = [statistics.median(run.get(stage, 0.0) for run in runs) / ours for stage in PASSES]
    return [found.name, *(f"{100 * one:.1f}" for one in (*each, sum(each)))]


OURS_OF: dict[Precision, str] = {"double": "ours", "single": "ours, single"}
#: The arrays that a sweep works in, whole and by halves: places of a slab, cells of a part.
ROOMS = {"as it is": (SLAB_POINTS, PART_CELLS), "by halves": (SLAB_POINTS // 2, PART_CELLS // 2)}


def rooms(
    page: Page, values: Array, found: Measured, precision: Precision, output: int
) -> list[str]:
    """A row of a table: memory beside the output and time, with whole and with half rooms."""
    field, isovalue = Field.of(values), ISOVALUES.get(found.name, 0.0)

    def run(places: int, cells: int) -> None:
        with (
            patch.object(SWEEP, "SLAB_POINTS", places),
            patch.object(SWEEP, "PART_CELLS", cells),
        ):
            sweep(DECIDER, field, isovalue, precision)

    calls = {name: partial(run, *sizes) for name, sizes in ROOMS.items()}
    memory = [(peak_memory(call) - output) / 2**20 for call in calls.values()]
    whole, half = interleave(calls, 5)
    ratio = half.over(whole)[0]
    what = f"{OURS_OF[precision]}, {found.name}"
    page.explain(
        what,
        f"{memory[0]:.0f} MiB in another run; with arrays half as large {memory[1]:.0f} MiB, in "
        f"{ratio:.2f} times the time",
    )
    return [what, *(f"{one:.0f}" for one in memory), f"{ratio:.2f}"]


WHY_MEMORY = f"""\
Beside its output a sweep has a table of the vertices on the edges of a slab, of
{3 * 4 * SLAB_POINTS / 2**20:.0f} MiB, and some forty arrays of a number for each cell or crossing
of a part, of about {PART_CELLS:,} cells. Memory comes in pages of 2 MiB where the system has them.
With half the slab and half the part it is less, and the last column says what that costs:"""


@contextmanager
def league(values: Array, isovalue: float) -> Iterator[tuple[dict[str, Outside], dict[str, str]]]:
    """The libraries of the league that are built, each in its process; and why others are not."""
    with ExitStack() as stack:
        found: dict[str, Outside] = {}
        absent: dict[str, str] = {}
        for name in PEERS:
            try:
                found[name] = stack.enter_context(library(name, values, isovalue))
            except AbsentError as error:
                absent[name] = str(error)
        yield found, absent


def made_of(result: Any) -> str:
    """What the arrays of a result are made of, vertices and triangles."""
    if hasattr(result, "simplices"):
        return f"{result.vertices.dtype}, {result.simplices.dtype}"
    if isinstance(result, tuple):
        return f"{result[0].dtype}, {result[1].dtype}"
    if hasattr(result, "GetPolys"):
        from vtkmodules.util.numpy_support import vtk_to_numpy

        points, polygons = result.GetPoints(), result.GetPolys()
        return (
            f"{vtk_to_numpy(points.GetData()).dtype}, "
            f"{vtk_to_numpy(polygons.GetConnectivityArray()).dtype}"
        )
    return ""


def measured(name: str, values: Array, methods: list[str], rounds: int) -> Measured:
    """What all contestants take on one field."""
    isovalue = ISOVALUES.get(name, 0.0)
    field = Field.of(values)
    mesh = sweep(DECIDER, field, isovalue, provenance=True)
    runs: dict[str, Run] = {
        OURS: lambda: sweep(DECIDER, field, isovalue),
        OURS_SINGLE: lambda: sweep(DECIDER, field, isovalue, "single"),
    }
    runs |= {
        f"isoref {method}": lambda run=METHODS[method]: run(field, isovalue)  # type: ignore[misc]
        for method in methods
    }
    level = least_inside(values.dtype, isovalue)  # of the samples' type: nothing is converted
    runs[COMPARISON] = lambda: values >= level
    runs[FLOOR] = lowest = floor(values, isovalue, mesh)
    runs[FLOOR_SINGLE] = floor(values, isovalue, mesh, "single")
    # Of VTK's marching cubes nothing is asked.
    runs |= {one: run for one, run in peers(values, isovalue).items() if one != UNASKED}
    made = {one: made_of(run()) for one, run in runs.items()}  # warms up, too
    with league(values, isovalue) as (others, absent):
        costs = {one: timed(run) for one, run in runs.items()}
        costs |= {one: _asked(other) for one, other in others.items()}
        timings = in_turn(costs, rounds, seconds=SECONDS, enough=ENOUGH)
        memory = {one: peak_memory(run) for one, run in runs.items()}
        memory |= {one: other.memory() for one, other in others.items()}
        made |= {one: other.made for one, other in others.items()}
    sizes = mesh.vertices.size + mesh.simplices.size
    return Measured(
        name,
        len(mesh.vertices),
        len(mesh.simplices),
        {timing.name: timing for timing in timings},
        memory,
        (8 * sizes, 4 * sizes),
        made,
        absent,
        lowest,
    )


def _asked(other: Outside) -> Callable[[], Cost]:
    """What a call in another process costs."""

    def run() -> Cost:
        seconds, processor, _ = other.call()
        return Cost(seconds, processor)

    return run


def table(found: Measured) -> str:
    """The Markdown table of one field."""
    rows = []
    for name, timing in found.timings.items():
        double, single = (
            "{:.2f} ({:.2f} to {:.2f})".format(*timing.over(found.timings[ours]))
            for ours in (OURS, OURS_SINGLE)
        )
        memory = f"{found.memory[name] / 2**20:.0f}"
        rows.append([name, timing.shown(), double, single, memory, found.made[name]])
    heads = ["", "median s (least to most)", "time / ours", "time / ours, single"]
    return table_of([*heads, "extra peak MiB", "made of"], rows)


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    offered = [name for name in FIELDS if here(name)]
    parser.add_argument("--fields", nargs="*", choices=offered, default=offered)
    usual = [
        "lorensen-cline",
        "trilinear-cubes",
        "marching-vesta-disconnect-L",
        "marching-vesta-mixed-L",
        "marching-vesta-mixed-H",
    ]
    parser.add_argument("--methods", nargs="*", choices=list(METHODS), default=usual)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/extraction.md"))
    arguments = parser.parse_args()
    page = Page(
        "Extraction, one thread",
        f"medians of {arguments.rounds} rounds, three at least where a field takes longer than "
        f"{SECONDS:.0f} s, contestants in turn; of two rounds for who takes more than "
        f"{ENOUGH:.0f} s in them. Only the ratios carry over: of processor time, round by round, "
        f"with their quartiles. Ours is `{OURS}`, its mesh float64 and int64; single precision is "
        "float32 and int32.",
        *(version(name) for name in PEERS),
    )
    profiles, fines, floors, halves = [], [], [], []
    told, stages_of_floor = [], []
    slow: list[str] = []
    ratios: dict[str, list[Bar]] = {}
    for name in arguments.fields:
        values = FIELDS[name]()
        found = measured(name, values, arguments.methods, arguments.rounds)
        page.add(
            f"## {name}: {found.vertices:,} vertices, {found.triangles:,} triangles", table(found)
        )
        ask(page, found)
        profiles.append(profile(name, values, arguments.rounds))
        floors.append(least(found))
        if FINE in found.timings:
            fines.append(fine(page, values, found))
        slow += reasons(page, values, found)
        stages_of_floor.append(passed(found, arguments.rounds))
        if name == arguments.fields[0]:
            told.append(small(values, found))
        for precision, ours, output in zip(OURS_OF, FLOORS, found.output, strict=True):
            if found.memory[ours] - output > MEMORY * 2**20:
                halves.append(rooms(page, values, found, precision, output))
        for peer in found.timings.keys() - set(BESIDE):
            ratio = found.timings[peer].over(found.timings[OURS])
            ratios.setdefault(peer, []).append(Bar(name, *ratio))
        del values
    for name in FIELDS:
        if not here(name):
            absent(page, name)
    page.show_goals()
    page.why("In per cent of our time, stage by stage:", table_of(["", *STAGES], profiles), STAGED)
    page.add("### The least passes")
    heads = ["", "ours / least", "ours / least, single", f"{PEER} / least", "Open3D / least"]
    page.table(heads, floors)
    page.add(LEAST)
    page.table(["", *PASSES, "together"], stages_of_floor)
    page.add(*told)
    if fines:
        page.add("### A point inside each polygon: VESTA mixed H over ours")
        page.table(["", "vertices", "triangles", "bytes of the mesh", "time"], fines)
        page.add(WHY_FINE)
    if halves:
        page.add("### Memory beside the output, where it is more than was asked", WHY_MEMORY)
        heads = ["", "MiB beside the output", "MiB, by halves", "time by halves over time"]
        page.table(heads, halves)
    if slow:
        page.add("### Other rules, where their goals are not met", WHY_RULES, *slow)
    page.add("## Every field")
    for peer in sorted(ratios):
        stem = "".join(letter if letter.isalnum() else "-" for letter in peer)
        page.plot(stem, bars(f"{peer} over ours", "larger: ours is faster", ratios[peer]))
    page.write(arguments.out)


def reasons(page: Page, values: Array, found: Measured) -> list[str]:
    """Profiles of the methods that miss their goals on a field; the page has why."""
    parts = []
    if found.name in OVER_COMPARISON:
        least_of_all = found.over(FLOOR, COMPARISON)
        assert least_of_all is not None
        said = f"the least passes alone take {least_of_all[0]:.2f} times one comparison"
        page.explain(f"ours over {COMPARISON}, {found.name}", said)
    for method, (_, bound) in METHOD_GOALS.items():
        ratio = found.over(method, OURS)
        rough = "noise" in found.name or found.name.startswith(("angio", "bunny"))
        if rough and ratio is not None and ratio[0] > bound:
            parts.append(f"**{found.name}**: {method} takes {ratio[0]:.2f} times ours.")
            entries = profile_of(method, values, ISOVALUES.get(found.name, 0.0))
            parts += why_slow(method, entries)
            if method != FINE:
                (first, share), *_ = own_times(entries, "isoref")
                said = f"its profile: the largest part, {first}, takes {share}"
                page.explain(f"{method} over ours, {found.name}", said)
    return parts


if __name__ == "__main__":
    main()
