"""Pictures of the other families: faces of voxels, dual surfaces, tetrahedra, labels."""

from __future__ import annotations

import numpy as np
from isoref import METHODS, Field, Mesh
from isoref.diconex import Mode, diconex
from isoref.label_cubes import surface as label_surface
from isoref.vesta import extract

from pictures import Picture, beside
from pictures.drawing import BLUE, RED, SAND, bare, flat, lines, panels, surface

IMAGE = np.array([
    [0, 0, 0, 0, 0, 0, 0],
    [0, 3, 3, 0, 0, 2, 0],
    [0, 3, 0, 3, 0, 0, 0],
    [0, 0, 3, 3, 1, 0, 0],
    [0, 0, 0, 1, 3, 3, 0],
    [0, 2, 0, 0, 3, 0, 0],
    [0, 0, 0, 0, 0, 0, 0],
], dtype=float)  # fmt: skip


@beside("isoref.diconex")
def contours_of_pixels() -> Picture:
    """The contours of one image in the three modes."""
    figure, axes = panels(3, 2.7, 2.9, space=False)
    counts = []
    modes: tuple[Mode, ...] = ("disconnect", "mixed", "connect")
    for axis, mode in zip(axes, modes, strict=True):
        found = diconex(IMAGE, 1.5, mode=mode)
        axis.imshow(IMAGE.T, cmap="Greys", vmin=-1, vmax=7, origin="lower")
        mesh = found.mesh
        for a, b in mesh.vertices[mesh.simplices]:
            axis.annotate(
                "",
                b,
                a,
                arrowprops={"arrowstyle": "-|>", "color": RED, "lw": 1.4, "mutation_scale": 7},
            )
        counts.append(_pieces(mesh))
        flat(axis, f"{mode}: {counts[-1]} contours")
    return Picture(
        figure,
        f"One image of {IMAGE.shape[0]} by {IMAGE.shape[1]} pixels, dark where it is active. "
        "Where two active pixels touch "
        f"in a corner the mode decides: {counts[0]}, {counts[1]} and {counts[2]} contours.",
    )


def _pieces(mesh: Mesh) -> int:
    """How many components the mesh has."""
    parent = list(range(len(mesh.vertices)))

    def root(v: int) -> int:
        while parent[v] != v:
            v = parent[v]
        return v

    for simplex in mesh.simplices.tolist():
        for v in simplex[1:]:
            parent[root(v)] = root(simplex[0])
    return len({root(v) for v in mesh.simplices.ravel().tolist()})


VOXELS = np.zeros((5, 5, 4))
VOXELS[1, 1, 1] = VOXELS[2, 2, 1] = 1.0
VOXELS[3, 2, 2] = 0.7
VOXELS[1, 2, 1] = VOXELS[2, 1, 1] = 0.3


@beside("isoref.vesta")
def modes_of_vesta() -> Picture:
    """The same voxels in three modes."""
    figure, axes = panels(3, 2.8, 2.4)
    counts = []
    for axis, mode in zip(axes, ("disconnect", "mixed", "connect"), strict=True):
        mesh = METHODS[f"vesta-{mode}-L"](Field.of(VOXELS), 0.5)
        counts.append(_pieces(mesh))
        surface(axis, mesh)
        bare(axis, (0.4, 0.4, 0.4), (3.6, 2.6, 2.6), f"{mode}: pieces {counts[-1]}", view=(28, -52))
    return Picture(
        figure,
        "Two voxels that touch in an edge, and a third that touches one of them in another: "
        f"{counts[0]}, {counts[1]} and {counts[2]} pieces.",
    )


@beside("isoref.vesta", "trace")
def cycle_lengths() -> Picture:
    """How long the cycles of a random volume are."""
    values = np.random.default_rng(5).random((14, 14, 14))
    values[[0, -1]] = values[:, [0, -1]] = values[:, :, [0, -1]] = 0
    figure, axes = panels(1, 5, 2.6, space=False)
    lengths = {}
    for mode in ("disconnect", "mixed"):
        found = extract(values, 0.5, mode=mode).lengths
        lengths[mode] = np.array([found.get(n, 0) for n in range(13)])
    places = np.arange(3, 13)
    axes[0].bar(places - 0.2, lengths["disconnect"][3:13], 0.4, color=BLUE, label="disconnect")
    axes[0].bar(places + 0.2, lengths["mixed"][3:13], 0.4, color=SAND, label="mixed")
    axes[0].set(xticks=places, xlabel="points of a cycle", yscale="symlog")
    axes[0].legend(frameon=False)
    axes[0].spines[["top", "right"]].set_visible(False)
    figure.subplots_adjust(left=0.1, bottom=0.2, top=0.97)
    long = int(lengths["mixed"][8:].sum())
    return Picture(
        figure,
        "Cycles of noise by their length. In the global mode none has more than "
        f"{int(np.nonzero(lengths['disconnect'])[0][-1])} "
        f"points; in the mixed mode {long} have 8, 9 or 12.",
    )


@beside("isoref.marching_vesta")
def low_and_high() -> Picture:
    """A torus in both resolutions."""
    x, y, z = np.meshgrid(*[np.linspace(-1.5, 1.5, 13)] * 3, indexing="ij")
    field = Field.of(0.45 - np.hypot(np.hypot(x, y) - 0.9, z))
    figure, axes = panels(2, 3, 2.4)
    counts = []
    for axis, resolution in zip(axes, "LH", strict=True):
        mesh = METHODS[f"marching-vesta-mixed-{resolution}"](field, 0.0)
        counts.append(len(mesh.simplices))
        surface(axis, mesh, SAND)
        bare(
            axis,
            (0.4, 0.4, 3),
            (11.6, 11.6, 9),
            f"{resolution}: {counts[-1]} triangles",
            view=(40, -50),
        )
    return Picture(
        figure,
        f"The same cycles, cut low ({counts[0]} triangles) and high ({counts[1]}), each about "
        "its middle.",
    )


TWO = np.full((4, 4, 4), -1.0)
TWO[1, 1, 1] = TWO[2, 2, 1] = 1.0


@beside("isoref.surface_nets")
def one_vertex() -> Picture:
    """The edge of four triangles, beside dual marching cubes."""
    return _nets()


@beside("isoref.dual_marching_cubes")
def one_vertex_a_piece() -> Picture:
    """The same, for the repair."""
    return _nets()


def _nets() -> Picture:
    figure, axes = panels(2, 3, 2.7)
    numbers = []
    for axis, name in zip(axes, ("surface-nets", "dual-marching-cubes"), strict=True):
        mesh = METHODS[name](Field.of(TWO), 0.0)
        sides: dict[frozenset[int], int] = {}
        for t in mesh.simplices.tolist():
            for i in range(3):
                key = frozenset((t[i], t[i - 1]))
                sides[key] = sides.get(key, 0) + 1
        crowded = [mesh.vertices[sorted(e)] for e, n in sides.items() if n > 2]
        numbers.append((len(crowded), len(mesh.vertices)))
        surface(axis, mesh, alpha=0.85)
        axis.computed_zorder = False  # the edge is drawn over the faces that hide it
        lines(axis, crowded, RED, 3.5)
        bare(axis, (0.4, 0.4, 0.4), (2.6, 2.6, 1.6), name, view=(38, -60))
    return Picture(
        figure,
        f"Two voxels that touch in an edge. One vertex a cell ({numbers[0][1]} vertices) makes "
        "an edge of four triangles, "
        f"in red; one for each piece ({numbers[1][1]} vertices) makes {numbers[1][0] or 'none'}.",
    )


@beside("isoref.dual")
def dual_of_a_circle() -> Picture:
    """A slice through both kinds: vertices on edges, vertices in cells."""
    i, j, k = np.meshgrid(*[np.arange(7.0)] * 3, indexing="ij")
    field = Field.of(2.4 - np.sqrt((i - 3) ** 2 + (j - 3.2) ** 2 + (k - 2.9) ** 2))
    figure, axes = panels(2, 3, 3)
    told = []
    for axis, name in zip(axes, ("asymptotic-decider", "dual-marching-cubes"), strict=True):
        mesh = METHODS[name](field, 0.0)
        told.append(len(mesh.simplices))
        surface(axis, mesh, SAND if name.startswith("dual") else BLUE)
        bare(axis, (0.5, 0.5, 0.5), (5.5, 5.5, 5.5), f"{name}: {told[-1]} triangles")
    return Picture(
        figure,
        "One ball by marching cubes and by its dual: triangles in cells, quadrilaterals across "
        "edges.",
    )


@beside("isoref.marching_tetrahedra")
def two_splits() -> Picture:
    """The same ball by two splits."""
    i, j, k = np.meshgrid(*[np.arange(8.0)] * 3, indexing="ij")
    field = Field.of(2.7 - np.sqrt((i - 3.4) ** 2 + (j - 3.6) ** 2 + (k - 3.5) ** 2))
    figure, axes = panels(3, 2.7, 2.8)
    counts = []
    for axis, name in zip(
        axes,
        ("asymptotic-decider", "marching-tetrahedra-five", "marching-tetrahedra-kuhn"),
        strict=True,
    ):
        mesh = METHODS[name](field, 0.0)
        counts.append(len(mesh.simplices))
        surface(axis, mesh, SAND if "tetra" in name else BLUE)
        bare(
            axis,
            (0.5, 0.5, 0.5),
            (6.5, 6.5, 6.5),
            f"{name.removeprefix('marching-')}: {counts[-1]}",
        )
    return Picture(
        figure,
        f"Triangles of one ball: {counts[0]} from cubes, {counts[1]} from five tetrahedra a "
        f"cube, {counts[2]} from Kuhn's six.",
    )


@beside("isoref.label_cubes")
def from_labels() -> Picture:
    """What is left of a ball when only inside and outside are seen."""
    i, j, k = np.meshgrid(*[np.arange(10.0)] * 3, indexing="ij")
    field = Field.of(3.6 - np.sqrt((i - 4.4) ** 2 + (j - 4.6) ** 2 + (k - 4.5) ** 2))
    figure, axes = panels(2, 3, 3)
    pairs = (
        (METHODS["asymptotic-decider"](field, 0.0), "values"),
        (label_surface(field, 0.0), "labels"),
    )
    for axis, (mesh, title) in zip(axes, pairs, strict=True):
        surface(axis, mesh, BLUE if title == "values" else SAND)
        bare(axis, (0.5, 0.5, 0.5), (8.5, 8.5, 8.5), f"from {title}")
    near = np.mean(np.abs(pairs[1][0].vertices - np.round(pairs[1][0].vertices)).max(axis=1) == 0.5)
    return Picture(
        figure,
        f"From labels every vertex ({near:.0%}) stands halfway between two samples, and steps "
        "remain.",
    )


@beside("isoref.degenerate")
def flat_triangles() -> Picture:
    """Triangles without area, where samples are on the isovalue."""
    from isoref.degenerate import degenerate, without_degenerate

    i, j, k = np.meshgrid(*[np.arange(7.0)] * 3, indexing="ij")
    field = Field.of(3.0 - (np.abs(i - 3) + np.abs(j - 3) + np.abs(k - 3)))
    mesh = METHODS["asymptotic-decider"](field, 1.0)
    removal = without_degenerate(mesh)
    figure, axes = panels(2, 3, 3)
    for axis, one, title in (
        (axes[0], mesh, "as it comes"),
        (axes[1], removal.mesh, "without them"),
    ):
        surface(axis, one)
        bare(axis, (0.9, 0.9, 0.9), (5.1, 5.1, 5.1), f"{title}: {len(one.simplices)} triangles")
    return Picture(
        figure,
        f"An octahedron through samples: {int(degenerate(mesh).sum())} of {len(mesh.simplices)} "
        "triangles have no area, "
        f"{int(degenerate(removal.mesh).sum())} after their removal.",
    )
