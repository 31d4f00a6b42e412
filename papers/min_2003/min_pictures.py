"""Pictures of curves, trees of boxes and projected surfaces, each to one file.

Surfaces are drawn without a graphics library: every triangle is covered with points, the nearest
point of each pixel wins, and light falls by the absolute cosine of the normal (equation 6),
because a projected surface has two sides and may pass through itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from isoref.dyadic import Tree, clipped
from isoref.field import Floats, Integers
from isoref.mesh import Mesh
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection

# The same picture gives the same file.
plt.rcParams["svg.hashsalt"] = "min_2003"
INK, BOXES, WARM, COOL = "#1b2a41", "#5b7083", np.array([0.86, 0.45, 0.28]), "#2a6f97"


def save(figure: plt.Figure, path: Path) -> None:
    """The figure in a file, without the date that would change it every time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if path.suffix == ".svg" else None
    figure.savefig(path, dpi=110, metadata=metadata)
    plt.close(figure)


def boxes_2d(axes: Axes, tree: Tree, shape: tuple[int, ...], kept: Sequence[int] = (0, 1)) -> None:
    """All boxes of a tree, seen along the other axes."""
    drawn: set[tuple[int, ...]] = set()
    for side, low in zip(tree.sides, tree.boxes, strict=True):
        high = clipped(low, side, shape)
        seen = np.unique(np.hstack([low[:, kept], high[:, kept]]), axis=0)
        drawn |= {tuple(row) for row in seen.tolist()}
    patches = [Rectangle((a, b), c - a, d - b) for a, b, c, d in sorted(drawn)]
    axes.add_collection(PatchCollection(patches, facecolor="none", edgecolor=BOXES, linewidth=0.35))
    axes.set(xlim=(0, shape[kept[0]] - 1), ylim=(0, shape[kept[1]] - 1), aspect="equal")
    axes.set_xticks([])
    axes.set_yticks([])


def segments_2d(axes: Axes, mesh: Mesh, kept: Sequence[int] = (0, 1)) -> None:
    """The segments of a mesh, seen along the other axes."""
    lines = list(mesh.vertices[:, kept][mesh.simplices])
    axes.add_collection(LineCollection(lines, colors=INK, linewidths=1.2))
    axes.set_aspect("equal")


def segments_3d(
    axes: Axes, mesh: Mesh, low: Floats, high: Floats, names: tuple[str, str, str]
) -> None:
    """The segments of a mesh in a box whose axes have these names."""
    axes.add_collection3d(  # type: ignore[attr-defined]
        Line3DCollection(list(mesh.vertices[mesh.simplices]), colors=COOL, linewidths=1.4)
    )
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set(xlabel=names[0], ylabel=names[1], zlabel=names[2])
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):  # type: ignore[attr-defined]
        # Two ends of axes meet at a corner of the box: keep their numbers apart.
        axis.set_major_locator(MaxNLocator(4, prune="both"))


def render(mesh: Mesh, normals: Floats, eye: Sequence[float], pixels: int = 360) -> Floats:
    """An image (pixels, pixels, 3) of triangles in space, seen from the direction `eye`.

    normals : (S, 3) of any length, to either side
    """
    fine = 2 * pixels
    frame = camera(eye)
    place = (mesh.vertices - mesh.vertices.mean(axis=0)) @ frame.T
    place *= 0.94 * pixels / np.linalg.norm(place[:, :2], axis=1).max()
    corners = place[mesh.simplices]
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    light = np.array([-0.35, 0.5, 0.8]) / np.linalg.norm([-0.35, 0.5, 0.8])
    shade = 0.25 + 0.75 * abs(unit @ frame.T @ light)
    depth, colour = np.full(fine * fine, -np.inf), np.full(fine * fine, np.nan)
    for points, owner in covering(corners):
        column = np.clip((points[:, 0] + pixels).astype(int), 0, fine - 1)
        row = np.clip((pixels - points[:, 1]).astype(int), 0, fine - 1)
        pixel, z = row * fine + column, points[:, 2]
        order = np.argsort(z)
        nearer = order[z[order] > depth[pixel[order]]]
        depth[pixel[nearer]] = z[nearer]
        colour[pixel[nearer]] = shade[owner[nearer]]
    empty = np.isnan(colour)[:, None]
    image = np.where(empty, 1.0, np.outer(np.nan_to_num(colour), 1.12 * WARM))
    image = np.clip(image, 0, 1).reshape(pixels, 2, pixels, 2, 3).mean(axis=(1, 3))
    return np.asarray(image)


def camera(eye: Sequence[float]) -> Floats:
    """Rows right, up and toward the eye, for an eye that does not look straight down."""
    toward = np.asarray(eye, float) / np.linalg.norm(eye)
    right = np.cross([0, 0, 1], toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), toward])


def covering(corners: Floats) -> Iterator[tuple[Floats, Integers]]:
    """Points that leave no pixel of the triangles (S, 3, 3) out, and the triangle of each."""
    longest = np.linalg.norm(corners[..., :2] - np.roll(corners[..., :2], 1, axis=1), axis=2)
    steps = 1 << np.ceil(np.log2(np.maximum(1.5 * longest.max(axis=1), 1))).astype(int)
    for count in np.unique(steps):
        i, j = np.tril_indices(count + 1)
        weights = np.stack([i - j, j, count - i], axis=1) / count
        own = np.flatnonzero(steps == count)
        block = max(1, 2_000_000 // len(weights))
        for start in range(0, len(own), block):
            part = own[start : start + block]
            points = np.einsum("wc,scd->swd", weights, corners[part]).reshape(-1, 3)
            yield points, np.repeat(part, len(weights))


def gallery(path: Path, images: Sequence[tuple[str, Floats]]) -> None:
    """Images side by side with their titles."""
    figure, axes = plt.subplots(1, len(images), figsize=(4 * len(images), 4.2), squeeze=False)
    for ax, (title, image) in zip(axes[0], images, strict=True):
        ax.imshow(image)
        ax.set_title(title, fontsize=10)
        ax.axis("off")
    figure.tight_layout()
    save(figure, path)


def sphere(path: Path, title: str, image: Floats, off: Mapping[int, tuple[Floats, Floats]]) -> None:
    """A sphere's image, and for each N how far its vertices are off, over their heights."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2))
    left.imshow(image)
    left.set_title(title, fontsize=10)
    left.axis("off")
    shades = plt.get_cmap("viridis_r")(np.linspace(0.15, 0.95, len(off)))
    for colour, (N, (height, error)) in zip(shades, reversed(off.items()), strict=True):
        right.plot(height, error, ".", ms=3, mew=0, color=colour, label=f"N = {N}", rasterized=True)
    right.axhline(0, color=INK, lw=1)
    right.set(xlabel="z of the vertex", ylabel="(radius - sqrt(3)/2) / (edge of a cell)^2")
    right.set_ylim(top=0.12)
    right.legend(markerscale=3, fontsize=8, ncol=len(off), loc="upper center")
    figure.tight_layout()
    save(figure, path)
