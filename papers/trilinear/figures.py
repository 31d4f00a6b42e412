"""Pictures of what can happen in a cell."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from isograde.cases.trilinear_cells import cell_of, far
from isograde.oracles.trilinear_cases import Topology, case_name, classes, exchanged
from isoref.cube import EDGES
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.methods import METHODS
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

CORNERS = np.array([(c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8)], float)
PLAIN, TUNNEL, HIGH = "#a9cdec", "#f2b276", "#1f3b57"
LIGHT = LightSource(azdeg=200, altdeg=55)


def draw_cases(path: Path) -> int:
    """All classes up to rotation and exchange, as the reference draws them; how many there are."""
    found = sorted(map(_few_high, classes(mirror=False)), key=_order)
    figure = plt.figure(figsize=(11, 11))
    for number, one in enumerate(found, start=1):
        axes = figure.add_subplot(6, 6, number, projection="3d")
        values = cell_of(one, 0)
        draw_cell(axes, values, METHODS["trilinear-cubes"](Field.of(values), 0.0), one.tunnels)
        axes.set_title(case_name(one), fontsize=10, pad=-4)
    figure.subplots_adjust(0, 0, 1, 0.97, wspace=0, hspace=0.08)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=70)
    plt.close(figure)
    return len(found)


def _few_high(one: Topology) -> Topology:
    """The topology or, where it has more high corners than low ones, that of -F."""
    return one if sum(one.signs) <= 0 else exchanged(one)


def _order(one: Topology) -> list[int]:
    """Cases in the order of their numbers."""
    return [int(part) for part in case_name(one).split(".")]


def draw_cell(axes: object, values: NDArray[np.float64], mesh: Mesh, tunnels: int) -> None:
    """The cell's frame, its high corners and the triangles of the mesh."""
    assert hasattr(axes, "add_collection3d")
    frame = [CORNERS[[a, b]] for a, b in EDGES]
    axes.add_collection3d(Line3DCollection(frame, colors="#777777", linewidths=0.6))
    triangles = mesh.vertices[mesh.simplices]
    surface = Poly3DCollection(
        triangles,
        facecolors=TUNNEL if tunnels else PLAIN,
        edgecolors="#40566b",
        linewidths=0.4,
        alpha=0.9,
        shade=len(triangles) > 0,
        lightsource=LIGHT,
    )
    axes.add_collection3d(surface)
    high = np.array([values[tuple(c.astype(int))] > 0 for c in CORNERS])
    axes.scatter(*CORNERS[high].T, s=14, color=HIGH, depthshade=False)  # type: ignore[attr-defined]
    _frame(axes)


def _frame(axes: object) -> None:
    """The same view of every cell."""
    for name in ("set_xlim", "set_ylim", "set_zlim"):
        getattr(axes, name)(0, 1)
    axes.set_box_aspect((1, 1, 1), zoom=1.05)  # type: ignore[attr-defined]
    axes.view_init(elev=18, azim=-62)  # type: ignore[attr-defined]
    axes.set_axis_off()  # type: ignore[attr-defined]


def refined(values: NDArray[np.float64], n: int = 40) -> Mesh:
    """The level set of the trilinear interpolant, drawn on a fine lattice of the cell."""
    t = np.linspace(0, 1, n)
    weights = np.stack([1 - t, t])
    fine = np.einsum("ijk,ia,jb,kc->abc", values, weights, weights, weights)
    return METHODS["asymptotic-decider"](Field.of(fine, spacing=1 / (n - 1)), 0.0)


def draw_tunnel(path: Path) -> None:
    """Case 4.2 and its neighbour 4.1: the level set, the reference, the asymptotic decider."""
    inside, outside = far("4.2", 0)
    rows = [("4.2", inside, 1), ("4.1", outside, 0)]
    figure = plt.figure(figsize=(8.4, 5.8))
    for row, (name, values, tunnels) in enumerate(rows):
        meshes = {
            f"{name}: the level set": refined(values),
            "trilinear cubes": METHODS["trilinear-cubes"](Field.of(values), 0.0),
            "asymptotic decider": METHODS["asymptotic-decider"](Field.of(values), 0.0),
        }
        for column, (title, mesh) in enumerate(meshes.items()):
            axes = figure.add_subplot(2, 3, 3 * row + column + 1, projection="3d")
            shown = tunnels if column < 2 else 0
            draw_cell(axes, values, mesh, shown)
            if column == 0:
                axes.collections[1].set_linewidth(0)
            axes.set_title(title, fontsize=11, pad=-2)
    figure.subplots_adjust(0, 0, 1, 0.95, wspace=0, hspace=0.06)
    figure.savefig(path, dpi=80)
    plt.close(figure)
