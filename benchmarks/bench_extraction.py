"""Extraction: our vectorised sweep beside the libraries, in turn, in one process, one thread.

Prints a Markdown table for each field: seconds, the ratio to ours in double and in single
precision (most libraries give single), extra peak memory, triangles. Ratios are of processor time,
round by round. Run ``python benchmarks/bench_extraction.py --help``; `make benchmarks` runs it with
the defaults and keeps the table in `reports/benchmarks/extraction.md`.
"""

from __future__ import annotations

import argparse
import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from isograde.cases.volumes import REGISTRY, find, read
from isograde.stopwatch import interleave, machine_state, peak_memory
from isoref.fast.sweep import sweep
from isoref.field import Array, Field
from isoref.methods import METHODS, RULES
from scipy.ndimage import gaussian_filter

Run = Callable[[], object]
DECIDER = RULES["asymptotic-decider"]
OURS, OURS_SINGLE = "isoref asymptotic-decider", "isoref asymptotic-decider, single"
ANEURISM = REGISTRY["aneurism"]


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


FIELDS: dict[str, Callable[[], Array]] = {
    "sphere 64^3": lambda: sphere(64),
    "sphere 128^3": lambda: sphere(128),
    "sphere 256^3": lambda: sphere(256),
    "sphere 384^3": lambda: sphere(384),
    "smoothed noise 128^3": lambda: noise(128),
    "dense noise 128^3": lambda: noise(128, 1.2),
    "gyroid 256^3": lambda: gyroid(256),
    "sphere 256^3 uint8": lambda: np.clip(sphere(256) * 200 + 128, 0, 255).astype(np.uint8),
    "angiography 8 times, 512^3 uint8": lambda: np.tile(aneurism(), (2, 2, 2)),
}


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


def table(name: str, values: Array, methods: list[str], rounds: int) -> str:
    """The Markdown table for one field."""
    isovalue = 128.0 if values.dtype.kind == "u" else 0.0
    field = Field.of(values)
    contestants: dict[str, Run] = {
        OURS: lambda: sweep(DECIDER, field, isovalue),
        OURS_SINGLE: lambda: sweep(DECIDER, field, isovalue, "single"),
    }
    contestants |= {
        f"isoref {method}": lambda run=METHODS[method]: run(field, isovalue)  # type: ignore[misc]
        for method in methods
    }
    contestants["one `values >= isovalue`"] = lambda: values >= isovalue
    contestants |= peers(values, isovalue)
    mesh = sweep(DECIDER, field, isovalue)
    lines = [
        f"## {name}: {len(mesh.vertices):,} vertices, {len(mesh.simplices):,} triangles",
        "",
        "| | median s (least to most) | time / ours | time / ours, single | extra peak MiB |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    timings = interleave(contestants, rounds)
    for timing in timings:
        memory = peak_memory(contestants[timing.name]) / 2**20
        double, single = (
            "{:.2f} ({:.2f} to {:.2f})".format(*timing.over(ours)) for ours in timings[:2]
        )
        lines.append(f"| {timing.name} | {timing.shown()} | {double} | {single} | {memory:.0f} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    offered = [n for n in FIELDS if not n.startswith("angio") or find(ANEURISM) is not None]
    parser.add_argument("--fields", nargs="*", choices=offered, default=offered)
    usual = [
        "lorensen-cline",
        "trilinear-cubes",
        "marching-vesta-mixed-L",
        "marching-vesta-mixed-H",
    ]
    parser.add_argument("--methods", nargs="*", choices=list(METHODS), default=usual)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/extraction.md"))
    arguments = parser.parse_args()
    parts = [
        "# Extraction, one thread",
        f"{machine_state()}; medians of {arguments.rounds} rounds, contestants in turn. Only the "
        f"ratios carry over: of processor time, round by round, with their quartiles. Ours is "
        f"`{OURS}`, its mesh float64 and int64; single precision is float32 and int32.",
    ]
    for name in arguments.fields:
        parts.append(table(name, FIELDS[name](), arguments.methods, arguments.rounds))
        print(parts[-1], flush=True)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text("\n\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
