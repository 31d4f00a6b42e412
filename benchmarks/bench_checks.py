"""Checking a mesh: the grader's truths beside the libraries', in turn, in one process.

Each contestant answers what it can of: closed, manifold, oriented, boundary loops, Euler
characteristic, components, area, volume. Ours answers all of them; what the others leave out is
said in the table. Writes ``reports/benchmarks/checks.md``.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from bench_extraction import gyroid, noise
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import near_pairs, self_intersections
from isograde.stopwatch import Timing, interleave
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.methods import METHODS
from pages import Page, table_of
from pages import profile as profile_of

Run = Callable[[], object]
# Who has taken so many seconds in two rounds is not asked in another.
ENOUGH = 6.0
# What each library was asked, beside the table.
ASKED = {
    "isograde": "edges, fans, orientation, boundary loops, Euler, components, area, volume",
    "trimesh": "watertight, winding, Euler, components, area, volume",
    "pymeshlab": "topological and geometric measures",
    "manifold3d": "its own check, genus, area, volume",
    "pyvista": "open edges, manifold, area, volume",
}


# A question to ours, and what of the mesh it asks; in this order each finds what it rests on.
PARTS: dict[str, Callable[[Complex], object]] = {
    "facets, uses, balance": lambda one: one.facets,
    "open, crowded, unbalanced": lambda one: (
        len(one.open_facets),
        len(one.crowded_facets),
        len(one.unbalanced_facets),
    ),
    "fans of vertices": lambda one: len(one.fans),
    "boundary loops": lambda one: one.boundary_pieces,
    "Euler, components": lambda one: (one.euler, one.components),
    "area, volume": lambda one: (one.measure, one.enclosed),
}
# What the peers' time over ours shall be at least.
GOALS = {"pymeshlab": 6.0, "trimesh": 4.0, "manifold3d": 2.5, "pyvista": 2.0}
CROSSINGS = 1.5
"""What our time for crossings over pymeshlab's shall be at most."""


def ours(mesh: Mesh) -> object:
    """Every property of the half-edge truth."""
    surface = Complex.of(mesh.vertices, mesh.simplices)
    return [ask(surface) for ask in PARTS.values()]


def profile(mesh: Mesh, rounds: int) -> dict[str, float]:
    """Milliseconds of the processor of each part of ours, the median of so many rounds.

    Beside them, what a part cannot do without: the sort of the sides by their ends, and one
    look-up a side.
    """
    spent: dict[str, list[float]] = {}

    def timed(name: str, run: Callable[[], object]) -> None:
        start = time.process_time()
        run()
        spent.setdefault(name, []).append(1000 * (time.process_time() - start))

    sides = mesh.simplices.astype(np.int64).reshape(-1)
    keys = sides * len(mesh.vertices) + np.roll(sides, 1)
    for _ in range(rounds):
        surface = Complex.of(mesh.vertices, mesh.simplices)
        for name, ask in PARTS.items():
            timed(name, partial(ask, surface))
        timed("one sort of the sides", lambda: np.sort(keys))
        timed("one look-up a side", lambda: sides[sides])
    return {name: statistics.median(each) for name, each in spent.items()}


def crossings(mesh: Mesh) -> dict[str, Run]:
    """The exact question for crossings, and MeshLab's, on the same mesh."""
    found: dict[str, Run] = {
        "isograde, exact": lambda: self_intersections(mesh.vertices, mesh.simplices)
    }
    if importlib.util.find_spec("pymeshlab"):
        import pymeshlab

        made = pymeshlab.MeshSet()
        made.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.simplices.astype(np.int32)))
        found["pymeshlab, in floating point"] = (
            made.compute_selection_by_self_intersections_per_face
        )
    return found


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
    if importlib.util.find_spec("pyvista"):
        import pyvista

        def by_pyvista() -> object:
            made = pyvista.PolyData.from_regular_faces(points, faces)
            return made.n_open_edges, made.is_manifold, made.area, made.volume

        found["pyvista"] = by_pyvista
    return found


def ask(page: Page, timings: Sequence[Timing]) -> None:
    """Note what was asked of each peer."""
    first, here = timings[0], {timing.name: timing for timing in timings[1:]}
    for name, bound in GOALS.items():
        found = here[name].over(first) if name in here else None
        what, absent = f"{name} over ours", f"{name} is not here"
        page.ask("checks", what, found, bound, most=False, absent=absent)


def reason(spent: dict[str, float]) -> str:
    """Why it is not faster, from the profile."""
    whole = sum(spent[name] for name in PARTS)
    sort, look = spent["one sort of the sides"], spent["one look-up a side"]
    return (
        f"Ours takes {whole:.0f} ms of the processor. To sort the sides, without which no facet "
        f"is known, takes {sort:.0f} of them, {sort / whole:.0%}; one look-up a side takes "
        f"{look:.1f}, so all of ours costs as much as {whole / look:.0f} look-ups a side. A "
        "compiled loop over half-edges looks up a side's twin and its vertex once and has "
        "orientation, fan and component of it in registers; in NumPy each step of a fan's turn, of "
        "the joining of components and of the counting is a pass of its own over all sides."
    )


def why_crossings(mesh: Mesh) -> list[str]:
    """Where the time of the exact question goes, and how many pairs it is asked of."""
    points, faces = mesh.vertices, mesh.simplices
    pairs = np.concatenate(list(near_pairs(points, faces)))
    one, other = faces[pairs[:, 0]], faces[pairs[:, 1]]
    beside = (one[:, :, None] == other[:, None, :]).any(axis=(1, 2)).mean()
    rows = profile_of(lambda: self_intersections(points, faces), "isograde")
    return [
        table_of(["function", "of its time"], rows),
        f"The boxes of {len(pairs):,} pairs of triangles meet, {len(pairs) / len(faces):.1f} for "
        f"each triangle; {beside:.0%} of them share a corner or a side. Each pair is asked for "
        "signs that floating point gives for certain, with a bound on its error, the neighbours "
        "too, for they can fold into each other; what that leaves open is asked in integers.",
    ]


def main() -> None:
    """Time the checks on one closed mesh, the crossings on another, and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=192, help="samples along each axis")
    parser.add_argument("--crossings", type=int, default=64, help="the same, of the second mesh")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/checks.md"))
    arguments = parser.parse_args()
    rounds = arguments.rounds
    page = Page(
        "Checking a mesh, one thread",
        f"medians of {rounds} rounds in turn, of two for who takes more than {ENOUGH:.0f} s in "
        "them. Goals are of ratios of processor time, round by round, with their quartiles.",
    )
    values = np.pad(gyroid(arguments.side), 1, constant_values=-1.0)
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    page.add(f"## All that can be counted: {len(mesh.simplices):,} triangles, closed")
    timings = interleave({"isograde": lambda: ours(mesh)} | peers(mesh), rounds, enough=ENOUGH)
    page.table(
        ["", "median s (least to most)", "time / ours", "asked"],
        [[one.name, one.shown(3), f"{one.ratio:.2f}", ASKED[one.name]] for one in timings],
    )
    ask(page, timings)
    small = METHODS["asymptotic-decider"](Field.of(noise(arguments.crossings)), 0.0)
    page.add(f"## Triangles that cross: {len(small.simplices):,} triangles, none do")
    timings = interleave(crossings(small), rounds)
    page.table(["", "median s (least to most)"], [[one.name, one.shown(3)] for one in timings])
    found = timings[0].over(timings[1]) if len(timings) > 1 else None
    what, absent = "our crossings over pymeshlab's", "pymeshlab is not here"
    page.ask("crossings", what, found, CROSSINGS, most=True, absent=absent)
    page.show_goals()
    spent = profile(mesh, rounds)
    for name in GOALS:
        page.explain(f"{name} over ours", reason(spent).split(" A compiled")[0].rstrip("."))
    why = why_crossings(small)
    page.explain(what, why[1].split(" Each pair")[0].rstrip("."))
    page.why(
        "All that can be counted:",
        table_of(["", "ms"], [[name, f"{each:.1f}"] for name, each in spent.items()]),
        reason(spent),
        "Triangles that cross:",
        *why,
    )
    page.write(arguments.out)


if __name__ == "__main__":
    main()
