"""Intersection curves: marching faces beside the explicit way and VTK, one thread.

Prints a Markdown table for each size of random waves of a fixed geometry: median seconds, ratio to
marching faces, extra peak memory, what was found. `make benchmarks` keeps the tables in
`reports/benchmarks/marching_faces.md`. What the fields themselves hold (16 bytes a voxel) is not
counted as extra memory; the peak of the whole process is printed too.
"""

from __future__ import annotations

import argparse
import importlib.util
import resource
import statistics
from collections.abc import Callable
from pathlib import Path

import numpy as np
from isograde.stopwatch import Timing, interleave, peak_memory
from isoref.curves import real_and_imaginary
from isoref.fast import surface_intersection
from isoref.fast.marching_faces import intersection_curves, marching_faces
from isoref.field import Field
from isoref.plane_waves import random_waves
from pages import Page, of_numpy, one_call, over, own_times, profiled, table_of

Run = Callable[[], object]

VTK, POINTS = "VTK: contour, contour", "marching faces, points"
COMPARED = "one `values >= 0` of both fields"

# The wave number at which 128^3 samples leave about 88 % of the voxels empty.
WAVE_NUMBER = 27.0


def contestants(first: Field, second: Field) -> dict[str, Run]:
    """Each way to the curves, as a call without arguments."""
    surfaces = [surface_intersection.enhanced_marching_cubes(f, 0.0) for f in (first, second)]
    segments = surface_intersection.surface_intersection(*surfaces)
    found: dict[str, Run] = {
        POINTS: lambda: marching_faces(first, second),
        "marching faces, curves": lambda: intersection_curves(first, second),
        "enhanced marching cubes, twice": lambda: [
            surface_intersection.enhanced_marching_cubes(f, 0.0) for f in (first, second)
        ],
        "triangle intersection": lambda: surface_intersection.surface_intersection(*surfaces),
        "joining by identity": lambda: surface_intersection.join_segments(segments),
        COMPARED: lambda: (first.values >= 0, second.values >= 0),
    }
    if importlib.util.find_spec("vtkmodules"):
        from isograde.adapters.libraries.vtk import contour_twice

        found[VTK] = lambda: contour_twice(first.values, second.values, 0.0, 0.0, first.spacing)
    return found


GOAL, JOINING = 4.0, 1.0
"""What VTK's time over Marching Faces' shall be at least, and the joining's at most."""


def reasons(page: Page, side: int, first: Field, second: Field, timings: list[Timing]) -> list[str]:
    """Where the time of Marching Faces goes, and what part of it grows with the volume."""
    entries = profiled(lambda: marching_faces(first, second))
    rows, calls = own_times(entries, "isoref"), of_numpy(entries)
    faces = 3 * first.values.size
    points = len(marching_faces(first, second))
    median = {one.name: statistics.median(one.processor) for one in timings}
    if VTK in median:
        allowed = median[VTK] / GOAL
        page.explain(
            f"{VTK}, over {POINTS}, {side}^3",
            f"{calls:,} calls of NumPy take {calls * one_call() / allowed:.2f} of what it allows "
            "if they did nothing; one comparison of the samples of both fields takes "
            f"{median[COMPARED] / allowed:.2f} of it; the largest part, {rows[0][0]}, is "
            f"{rows[0][1]} of ours",
        )
    return [
        table_of(["marching faces, points: function", "of its time"], rows),
        f"There are {faces:,} faces for {points:,} points. VTK's time grows with the volume, ours "
        "with the faces on which both fields change sign: so the ratio grows with the side, and a "
        "small volume is where the fixed cost of NumPy's calls, and of a few hundred passes over "
        "small arrays, counts most.",
    ]


def table(side: int, rounds: int, page: Page) -> tuple[str, list[str]]:
    """The Markdown table for one size, and its profile; the page notes what was asked."""
    psi = random_waves((side, side, side), WAVE_NUMBER)
    first, second = real_and_imaginary(psi, 1 / (side - 1))
    first, second = (Field.of(np.ascontiguousarray(f.values), f.spacing) for f in (first, second))
    del psi
    points, curves = len(marching_faces(first, second)), intersection_curves(first, second)
    closed = sum(curve.closed for curve in curves)
    lines = [
        f"## {side}^3: {points:,} points, {len(curves)} curves, {closed} closed",
        "",
        "| | median s (least to most) | time / marching faces | extra peak MiB |",
        "| --- | ---: | ---: | ---: |",
    ]
    runs = contestants(first, second)
    timings = interleave(runs, rounds)
    faces = POINTS
    by_vtk = over(timings, VTK, faces) if VTK in runs else None
    what = f"{VTK}, over {faces}, {side}^3"
    page.ask("faces", what, by_vtk, GOAL, most=False, absent="VTK is not here")
    found = over(timings, "joining by identity", faces)
    page.ask("joining", f"joining over {faces}, {side}^3", found, JOINING, most=True)
    shares = f"{timings[4].ratio:.2f} of the time of {faces}, in {timings[4].name}"
    page.explain(f"joining over {faces}, {side}^3", shares)
    for timing in timings:
        memory = peak_memory(runs[timing.name]) / 2**20
        lines.append(f"| {timing.name} | {timing.shown()} | {timing.ratio:.2f} | {memory:.0f} |")
    whole = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    lines.append(f"\nPeak of the whole process so far, fields and all: {whole:.2f} GiB.")
    return "\n".join(lines), [f"### {side}^3", *reasons(page, side, first, second, timings)]


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="*", type=int, default=[64, 128, 256])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/marching_faces.md"))
    arguments = parser.parse_args()
    page = Page(
        "Intersection curves, one thread",
        f"random waves, wave number {WAVE_NUMBER:g}; medians of "
        f"{arguments.rounds} rounds, contestants in turn. Only the ratios carry over.",
    )
    told: list[str] = []
    for side in arguments.sides:
        shown, why = table(side, arguments.rounds, page)
        page.add(shown)
        told += why
    page.show_goals()
    page.why(*told)
    page.write(arguments.out)


if __name__ == "__main__":
    main()
