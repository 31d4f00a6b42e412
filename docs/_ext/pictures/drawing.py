"""What the pictures share: axes without a frame, cells, shaded surfaces, contours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from isoref import Mesh
from isoref.cube import CORNERS, EDGES
from isoref.field import Floats
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

BLUE, SAND, RED, INK = "#5b9bc8", "#e3b873", "#c8324b", "#22384a"


def panels(
    count: int, width: float = 2.6, height: float = 2.6, *, space: bool = True, rows: int = 1
) -> Any:
    """A figure with this many axes in rows; in space unless told otherwise."""
    columns = -(-count // rows)
    figure = Figure(figsize=(width * columns, height * rows))
    kind = {"projection": "3d"} if space else {}
    axes = figure.subplots(rows, columns, squeeze=False, subplot_kw=kind).ravel()
    for axis in axes[count:]:
        axis.set_axis_off()
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.88, wspace=0.05, hspace=0.2)
    return figure, axes[:count]


def bare(
    axis: Any,
    low: Sequence[float],
    high: Sequence[float],
    title: str = "",
    *,
    view: Any = (22, -58),
) -> None:
    """Make the box of these bounds fill the axes, without a frame."""
    margin = 0.04 * max(np.subtract(high, low))
    axis.set(
        xlim=(low[0] - margin, high[0] + margin),
        ylim=(low[1] - margin, high[1] + margin),
        zlim=(low[2] - margin, high[2] + margin),
    )
    axis.set_box_aspect(np.subtract(high, low) + 2 * margin, zoom=1.08)
    axis.view_init(*view)
    axis.set_axis_off()
    axis.set_title(title, fontsize=9, color=INK)


def flat(axis: Any, title: str = "") -> None:
    """Make a plane picture without ticks, in which lengths are equal both ways."""
    axis.set(xticks=[], yticks=[], aspect="equal")
    axis.set_title(title, fontsize=9, color=INK)
    for spine in axis.spines.values():
        spine.set_visible(False)


def lit(triangles: Floats, color: Any = BLUE, alpha: float = 1.0) -> Floats:
    """(T, 4) colours of triangles lit from above and from the reader's side, either side alike."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    lamp = np.array([0.35, -0.6, 0.72]) / np.linalg.norm([0.35, -0.6, 0.72])
    light = 0.42 + 0.58 * np.abs(normals @ lamp)
    base = (
        np.asarray([to_rgb(c) for c in color])
        if isinstance(color, list)
        else np.array(to_rgb(color))
    )
    shown: Floats = np.clip(light[:, None] * base + 0.1 * light[:, None] ** 8, 0, 1)
    return np.column_stack([shown, np.full(len(shown), alpha)])


def surface(
    axis: Any,
    mesh: Mesh,
    color: Any = BLUE,
    *,
    alpha: float = 1.0,
    edges: str | None = INK,
    width: float = 0.4,
) -> None:
    """Draw a mesh of triangles."""
    if not len(mesh.simplices):
        return
    triangles = mesh.vertices[mesh.simplices]
    drawn = Poly3DCollection(
        triangles,
        facecolors=lit(triangles, color, alpha),
        edgecolors=edges or "none",
        linewidths=width if edges else 0,
    )
    axis.add_collection3d(drawn)


def wire(
    axis: Any, at: Sequence[float] = (0, 0, 0), color: str = "#8a97a3", width: float = 0.8
) -> None:
    """Draw the twelve edges of a unit cell."""
    corners = np.array(CORNERS) + np.array(at)
    axis.add_collection3d(
        Line3DCollection([corners[list(e)] for e in EDGES], colors=color, linewidths=width)
    )


def corners(axis: Any, values: Floats, size: float = 26) -> None:
    """Draw samples as dots: full inside, empty outside."""
    places = np.array(list(np.ndindex(values.shape)), dtype=float)
    high = values.ravel() >= 0
    for chosen, face in ((high, INK), (~high, "white")):
        axis.scatter(
            *places[chosen].T, s=size, c=face, edgecolor=INK, linewidths=0.8, depthshade=False
        )


def open_edges(mesh: Mesh) -> list[Floats]:
    """The edges that one triangle alone has."""
    halves = {(t[i], t[(i + 1) % 3]) for t in mesh.simplices.tolist() for i in range(3)}
    return [mesh.vertices[[a, b]] for a, b in sorted(halves) if (b, a) not in halves]


def lines(axis: Any, pieces: Sequence[Floats], color: str = RED, width: float = 2.2) -> None:
    """Draw lines in space."""
    if len(pieces):
        axis.add_collection3d(Line3DCollection(list(pieces), colors=color, linewidths=width))
