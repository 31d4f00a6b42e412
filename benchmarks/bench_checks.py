"""Checking a mesh: the grader's truths beside the libraries', in turn, in one process.

Each contestant answers what it can of: closed, manifold, oriented, boundary loops, Euler
characteristic, components, area, volume. Ours answers all of them; what the others leave out is
said in the table. Writes ``reports/benchmarks/checks.md``.
"""

from __future__ import annotations

import argparse
import importlib.util
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_extraction import gyroid
from isograde.oracles.complexes import Complex
from isograde.stopwatch import Machine, interleave
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.methods import METHODS

Run = Callable[[], object]
# What each library was asked, beside the table.
ASKED = {
    "isograde": "edges, fans, orientation, boundary loops, Euler, components, area, volume",
    "trimesh": "watertight, winding, Euler, components, area, volume",
    "pymeshlab": "topological and geometric measures",
    "manifold3d": "its own check, genus, area, volume",
}


def ours(mesh: Mesh) -> object:
    """Every property of the half-edge truth."""
    surface = Complex.of(mesh.vertices, mesh.simplices)
    return (
        len(surface.open_facets),
        len(surface.crowded_facets),
        len(surface.unbalanced_facets),
        len(surface.fans),
        surface.boundary_pieces,
        surface.euler,
        surface.components,
        surface.measure,
        surface.enclosed,
    )


def peers(mesh: Mesh) -> dict[str, Run]:
    """The libraries that are installed, each as a call without arguments on this mesh."""
    found: dict[str, Run] = {}
    points, faces = mesh.vertices, mesh.simplices
    if importlib.util.find_spec("trimesh"):
        import trimesh

        def by_trimesh() -> object:
            made = trimesh.Trimesh(points, faces, process=False)
            numbers = (made.euler_number, made.body_count, made.area, made.volume)
            return made.is_watertight, made.is_winding_consistent, numbers

        found["trimesh"] = by_trimesh
    if importlib.util.find_spec("pymeshlab"):
        import pymeshlab

        def by_pymeshlab() -> object:
            made = pymeshlab.MeshSet()
            made.add_mesh(pymeshlab.Mesh(points, faces.astype(np.int32)))
            return made.get_topological_measures(), made.get_geometric_measures()

        found["pymeshlab"] = by_pymeshlab
    if importlib.util.find_spec("manifold3d"):
        import manifold3d

        def by_manifold() -> object:
            arrays = (points.astype(np.float32), faces.astype(np.uint32))
            made = manifold3d.Manifold(manifold3d.Mesh(*arrays))
            return made.status(), made.genus(), made.surface_area(), made.volume()

        found["manifold3d"] = by_manifold
    return found


def main() -> None:
    """Time the checks on one closed mesh and write the table down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=192, help="samples along each axis")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/checks.md"))
    arguments = parser.parse_args()
    machine = Machine()
    values = np.pad(gyroid(arguments.side), 1, constant_values=-1.0)
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    lines = [
        "# Checking a mesh, one thread",
        "",
        f"{len(mesh.simplices):,} triangles, closed; medians of {arguments.rounds} rounds in turn.",
        "",
        "| | median s (least to most) | time / ours | asked |",
        "| --- | ---: | ---: | --- |",
    ]
    for timing in interleave({"isograde": lambda: ours(mesh)} | peers(mesh), arguments.rounds):
        numbers = f"{timing.shown(3)} | {timing.ratio:.2f}"
        lines.append(f"| {timing.name} | {numbers} | {ASKED[timing.name]} |")
    lines[2:2] = [f"{machine.state()}.", ""]
    text = "\n".join(lines) + "\n"
    print(text)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
