"""Marching tetrahedra and dual surfaces beside the libraries, in turn, in one process, one thread.

Prints a Markdown table for each field and family: seconds, ratio to the first row, extra peak
memory, triangles. What a contestant is given ready-made is not timed: VTK's contour filter for
unstructured grids gets the tetrahedra, VTK's surface nets the labels. Run ``python
benchmarks/bench_families.py --help``; `make benchmarks` keeps the tables in
`reports/benchmarks/families.md`.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_extraction import gyroid, noise, sphere
from floor import dual_floor, leaves
from isograde.stopwatch import Timing, interleave, peak_memory
from isoref.fast.dual import quads
from isoref.field import Array, Field
from isoref.methods import DUAL_RULES, METHODS
from pages import Page, over, profile, table_of

Run = Callable[[], int]
FIELDS: dict[str, Callable[[], Array]] = {
    "sphere 96^3": lambda: sphere(96),
    "smoothed noise 96^3": lambda: noise(96),
    "gyroid 96^3": lambda: gyroid(96),
}
FAMILIES = {
    "Tetrahedra": ("marching-tetrahedra-five", "marching-tetrahedra-kuhn", "simplicial"),
    "Dual surfaces": ("dual-marching-cubes", "surface-nets"),
}


def ours(name: str, values: Array) -> Run:
    """A method of the catalogue; each run returns how many triangles it made."""
    field = Field.of(values)
    return lambda: len(METHODS[name](field, 0.0).simplices)


def skimage(values: Array) -> dict[str, Run]:
    """scikit-image's marching cubes, where it is installed."""
    if not importlib.util.find_spec("skimage"):
        return {}
    from skimage.measure import marching_cubes

    return {"skimage lewiner": lambda: len(marching_cubes(values, 0.0)[1])}


def vtk_tetrahedra(values: Array) -> dict[str, Run]:
    """VTK's contours of the volume cut into tetrahedra beforehand, five a cell."""
    if not importlib.util.find_spec("vtkmodules"):
        return {}
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkContourGrid
    from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter

    vtkSMPTools.Initialize(1)
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1)))
    cut = vtkDataSetTriangleFilter()
    cut.SetInputData(image)
    cut.Update()
    grid = cut.GetOutput()

    def run() -> int:
        contour = vtkContourGrid()
        contour.SetInputData(grid)
        contour.SetValue(0, 0.0)
        contour.ComputeNormalsOff()
        contour.GenerateTrianglesOn()
        contour.Update()
        return int(contour.GetOutput().GetNumberOfCells())

    return {"VTK contour grid": run}


def vtk_nets(values: Array) -> dict[str, Run]:
    """VTK's surface nets of the labels, without smoothing, in triangles."""
    if not importlib.util.find_spec("vtkmodules"):
        return {}
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

    vtkSMPTools.Initialize(1)
    labels = np.ascontiguousarray((values >= 0).astype(np.int16))
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(labels.reshape(-1)))

    def run() -> int:
        nets = vtkSurfaceNets3D()
        nets.SetInputData(image)
        nets.SetValue(0, 1)
        nets.SmoothingOff()
        nets.SetOutputMeshTypeToTriangles()
        nets.Update()
        return int(nets.GetOutput().GetNumberOfCells())

    return {"VTK surface nets": run}


PEERS = {"Tetrahedra": vtk_tetrahedra, "Dual surfaces": vtk_nets}


# The method of each family whose nearest peer shall take at least as long.
FIRST = {"Tetrahedra": "marching-tetrahedra-five", "Dual surfaces": "dual-marching-cubes"}


FLOOR = "the least passes"


def least(values: Array) -> Run:
    """The least passes towards dual marching cubes (`floor.dual_floor`), as a contestant."""
    field = Field.of(values)
    crossings = METHODS["lorensen-cline"](field, 0.0, provenance=True)
    _, rows = quads(DUAL_RULES[FIRST["Dual surfaces"]], field, 0.0)
    run = dual_floor(values, 0.0, crossings, rows)
    return lambda: 2 * len(run()[1])


def reasons(page: Page, name: str, values: Array, timings: list[Timing]) -> list[str]:
    """Where the time of dual marching cubes goes, and what its peer does at one go."""
    median = {one.name: statistics.median(one.processor) for one in timings}
    mine = median[f"isoref {FIRST['Dual surfaces']}"]
    lowest, peer = median[FLOOR], median.get("VTK surface nets")
    said = "VTK is not here." if peer is None else f"{leaves(peer, 1.0, lowest, mine)}."
    page.explain(f"VTK surface nets over isoref {FIRST['Dual surfaces']}, {name}", said[:-1])
    field = Field.of(values)
    rows = profile(lambda: METHODS[FIRST["Dual surfaces"]](field, 0.0), "isoref")
    return [
        table_of(["isoref dual-marching-cubes: function", "of its time"], rows),
        "The peer is given labels of two bytes ready-made, draws what lies between them halfway, "
        "and decides nothing; ours compares the samples, finds each crossing on its edge, decides "
        "ambiguous faces, and has a vertex for each sheet of a cell. The least passes towards our "
        f"mesh (`benchmarks/floor.py`), measured in turn with both: {said}",
    ]


def tetrahedra(page: Page, name: str, values: Array) -> list[str]:
    """Where the time of marching tetrahedra goes, where its peer is faster; else nothing."""
    first = FIRST["Tetrahedra"]
    what = f"VTK contour grid over isoref {first}, {name}"
    if what not in page.unexplained:
        return []
    field = Field.of(values)
    rows = profile(lambda: METHODS[first](field, 0.0), "isoref")
    page.explain(what, f"its profile: the largest part, {rows[0][0]}, takes {rows[0][1]}")
    return [table_of([f"isoref {first}, {name}: function", "of its time"], rows)]


def table(
    family: str, name: str, values: Array, rounds: int, page: Page
) -> tuple[str, list[Timing]]:
    """The Markdown table of one family on one field, and the times; the page notes the goals."""
    contestants = {f"isoref {method}": ours(method, values) for method in FAMILIES[family]}
    contestants |= PEERS[family](values)
    if family == "Dual surfaces":
        contestants[FLOOR] = least(values)
    contestants["isoref asymptotic-decider"] = ours("asymptotic-decider", values)
    contestants |= skimage(values)
    lines = [
        f"## {family}: {name}",
        "",
        "| | median s (least to most) | time / first | extra peak MiB | triangles |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    timings = interleave(contestants, rounds)
    mine = f"isoref {FIRST[family]}"
    nearest = PEERS[family](values)
    for peer in nearest:
        found = over(timings, peer, mine)
        page.ask("families", f"{peer} over {mine}, {name}", found, 1.0, most=False)
    if not nearest:
        absent = "VTK is not here"
        page.ask("families", f"VTK over {mine}, {name}", None, 1.0, most=False, absent=absent)
    for timing in timings:
        run = contestants[timing.name]
        memory = peak_memory(run) / 2**20
        lines.append(
            f"| {timing.name} | {timing.shown()} | {timing.ratio:.2f} | {memory:.0f} | {run():,} |"
        )
    return "\n".join(lines) + "\n", timings


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fields", nargs="*", choices=list(FIELDS), default=list(FIELDS))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/families.md"))
    arguments = parser.parse_args()
    page = Page(
        "Other families, one thread",
        f"medians of {arguments.rounds} rounds, contestants in turn. Only the ratios carry over.",
    )
    why: list[str] = []
    for name in arguments.fields:
        values = FIELDS[name]()
        for family in FAMILIES:
            shown, timings = table(family, name, values, arguments.rounds, page)
            page.add(shown)
            if family == "Dual surfaces":
                why += [f"### {name}", *reasons(page, name, values, timings)]
            else:
                why += tetrahedra(page, name, values)
    page.show_goals()
    page.why(*why)
    page.write(arguments.out)


if __name__ == "__main__":
    main()
