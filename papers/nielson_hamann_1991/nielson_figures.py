"""The paper's figures, drawn by the code: 1 to 16 and 18, and 17 where a volume is at hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from isograde.cases import nielson_hamann
from isoref import asymptotic_decider as decider
from isoref import lorensen_cline
from isoref.cube import (
    CORNERS,
    EDGES,
    REPRESENTATIVES,
    ambiguous_faces,
    corner_at,
    inside,
)
from isoref.cycles import ALL_SEPARATED, Polygon, cycles
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats, Integers
from isoref.rule import Rule, Tile
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from nielson_drawing import (
    HOLE,
    INSIDE,
    LINE,
    OUTSIDE,
    Picture,
    draw_cube,
    draw_polygon,
    draw_tile,
    node_places,
    on_paper,
)
from PIL import Image

DPI = 96
SKULL = "figure-17-skull.png"
plt.rcParams["svg.hashsalt"] = "isograde"  # the same file every time

Drawer = Callable[[Axes], None]


def sheet(
    panels: Sequence[tuple[str, Drawer]], columns: int, size: float = 2.3, height: float = 1.02
) -> Figure:
    """A figure with a titled drawing in each place; height is that of a place by its width."""
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(size * columns, height * size * rows))
    for place in np.atleast_1d(axes).ravel():
        place.axis("off")
    for place, (title, draw) in zip(np.atleast_1d(axes).ravel(), panels, strict=False):
        draw(place)
        place.set_title(title, fontsize=10, pad=2)
    figure.tight_layout(pad=0.4, h_pad=1.2)
    return figure


def save(figure: Figure, path: Path) -> Path:
    """The figure as a file, small enough to keep; closed."""
    if path.suffix == ".svg":
        figure.savefig(path, metadata={"Date": None}, bbox_inches="tight", pad_inches=0.05)
    else:
        with BytesIO() as buffer:
            figure.savefig(buffer, format="png", dpi=DPI)
            Image.open(buffer).convert("RGB").quantize(200).save(path, optimize=True)
    plt.close(figure)
    return path


# Cells


def values(signs: int, faces: int = 0) -> Floats:
    """(8,) values with these signs and, where any have them, these decisions, as clear as can be.

    Clear is a cell whose saddles are far from the isovalue, of some thousand tried.
    """
    marks = np.array([1 if inside(signs, c) else -1 for c in range(8)])
    g = np.random.default_rng(1991).uniform(0.7, 1.6, (8, 4000)) * marks[:, None]
    asked = ambiguous_faces(signs)
    if not asked or not (fits := decider.decisions(g) == faces).any():
        return np.asarray(g[:, 0])
    clear = np.min([np.abs(decider.saddle_point(g, f)[1]) for f in asked], axis=0)
    return np.asarray(g[:, np.argmax(np.where(fits, clear, -1))])


def cell(signs: int, tile: Tile, polygons: Sequence[Polygon], faces: int = 0) -> Drawer:
    """A cell with its sheets."""

    def draw(axes: Axes) -> None:
        """Paint the cell."""
        picture = Picture()
        draw_cube(picture, signs)
        draw_tile(picture, tile, polygons, node_places(tile, values(signs, faces)))
        picture.paint(axes)

    return draw


def outline(signs: int, polygons: Sequence[Polygon]) -> Drawer:
    """A cell with its boundary polygons only."""

    def draw(axes: Axes) -> None:
        """Paint the cell."""
        picture = Picture()
        draw_cube(picture, signs)
        nodes = node_places(Tile(()), values(signs))
        for polygon, colour in zip(polygons, (LINE, HOLE, "#2f7d4f", "#7a4fa3"), strict=False):
            draw_polygon(picture, polygon, nodes, colour)
        picture.paint(axes)

    return draw


def variant(name: str) -> tuple[str, Drawer]:
    """The panel of a variant in its drawing."""
    signs, faces = decider.drawing(int(name[:-1])), decider.bits_of(decider.VARIANTS[name])
    return name, cell(signs, decider.tile(signs, faces), cycles(signs, faces), faces)


def figure_2() -> Figure:
    """The fifteen configurations, with the sheets of 1987."""
    panels = []
    for number, corners in enumerate(REPRESENTATIVES):
        drawn = number in decider.DRAWN
        signs = decider.drawing(number) if drawn else sum(1 << c for c in corners)
        polygons = lorensen_cline.polygons(signs)
        panels.append((str(number), cell(signs, lorensen_cline.tile(signs, 0), polygons)))
    return sheet(panels, 5)


def figure_9() -> Figure:
    """The paper's names of corners and edges."""
    figure, axes = plt.subplots(figsize=(3.6, 3.3))
    picture = Picture()
    draw_cube(picture, 0)
    picture.paint(axes)
    for v, c in decider.PAPER_CORNERS.items():
        spot = on_paper(np.array(CORNERS[c], float))
        axes.annotate(f"v{v}", spot, (5, 5), textcoords="offset points", fontsize=10)
    for n, e in decider.PAPER_EDGES.items():
        middle = np.mean([CORNERS[c] for c in EDGES[e]], axis=0)
        axes.text(*on_paper(middle), f"e{n}", fontsize=8, color=HOLE, ha="center", va="center",
                  bbox={"boxstyle": "round,pad=0.12", "fc": "white", "ec": "none"})  # fmt: skip
    figure.tight_layout(pad=0.3)
    return figure


def figure_12() -> Figure:
    """The boundary polygon of 10B that no triangles on its corners fill."""
    signs = decider.drawing(10)
    polygons = cycles(signs, decider.bits_of(decider.VARIANTS["10B"]))
    return sheet([("10B: eight corners, no triangulation", outline(signs, polygons))], 1, 3.4)


def figure_14() -> Figure:
    """The eight systems of boundary polygons of configuration 7."""
    signs = decider.drawing(7)
    faces = decider.VARIANTS["7A"]
    panels = []
    # In the paper b, c and e have two separated faces, d, f and h one.
    for letter, choice in zip("abcdefgh", (0, 1, 2, 3, 4, 5, 7, 6), strict=True):
        bits = decider.bits_of(tuple(f for i, f in enumerate(faces) if not choice >> i & 1))
        name = decider.variant(signs, bits)
        panels.append((f"{letter}: {name}", outline(signs, cycles(signs, bits))))
    return sheet(panels, 4)


def figure_16() -> Figure:
    """Configuration 13: the paper's ten variants and the one it misses."""
    names = [name for name in decider.VARIANTS if name.startswith("13")]
    remarks = dict.fromkeys(("13C", "13E", "13G"), " (no values have it)")
    remarks["13K"] = " (not in the paper)"
    panels = [variant(name) for name in names]
    return sheet([(name + remarks.get(name, ""), draw) for name, draw in panels], 4)


# The hole


def two_cells() -> Floats:
    """(3, 2, 2) samples: configuration 6 beside the complement of configuration 3."""
    samples = -np.ones((3, 2, 2))
    samples[0, 0, 0] = samples[1, 0, 0] = samples[1, 1, 1] = 1
    samples[2] = 1
    return samples


def pair(title: str, tiles: Callable[[int], tuple[Tile, Sequence[Polygon]]]) -> tuple[str, Drawer]:
    """Both cells, with the open edges of their common face in red."""
    samples = two_cells()
    signs = [
        sum(1 << corner_at(*c) for c in CORNERS if samples[c[0] + x, c[1], c[2]] > 0)
        for x in (0, 1)
    ]

    def draw(axes: Axes) -> None:
        """Paint both cells, then what is left open between them."""
        picture = Picture()
        lines: list[set[frozenset[tuple[float, ...]]]] = []
        for x in (0, 1):
            tile, polygons = tiles(signs[x])
            nodes = node_places(tile, np.sign(values(signs[x])))
            draw_cube(picture, signs[x], (x, 0, 0))
            draw_tile(picture, tile, polygons, nodes, (x, 0, 0))
            places = nodes + np.array([x, 0, 0])
            found = {
                frozenset((tuple(places[a].tolist()), tuple(places[b].tolist())))
                for p in polygons
                for a, b in zip(p, p[1:] + p[:1], strict=True)
            }
            lines.append({s for s in found if all(point[0] == 1 for point in s)})
        for side in lines[0] ^ lines[1]:
            a, b = (np.array(point) for point in side)
            picture.line(a, b, 0.04, HOLE, lift=0.3)
        picture.paint(axes)

    return title, draw


def figure_3_4() -> Figure:
    """The hole between two cells, and the two repairs."""

    def of_1987(signs: int) -> tuple[Tile, Sequence[Polygon]]:
        """What the drawings of 1987 have."""
        return lorensen_cline.tile(signs, 0), lorensen_cline.polygons(signs)

    def repaired(faces: int) -> Callable[[int], tuple[Tile, Sequence[Polygon]]]:
        """The same decision on both sides."""
        return lambda signs: (decider.tile(signs, faces), cycles(signs, faces))

    panels = [
        pair("1987: four open edges", of_1987),
        pair("repaired, separated", repaired(ALL_SEPARATED)),
        pair("repaired, joined", repaired(0)),
    ]
    return sheet(panels, 3, 3.6, 0.65)


def figure_18() -> Figure:
    """Example 3 with the drawings of 1987, and repaired: the same neighbourhood of a hole."""
    samples, isovalue = nielson_hamann.example_3().values, nielson_hamann.ISOVALUE_3
    n = 9
    first = torn_cells(Field.of(samples), isovalue)[0]
    low = np.clip(first - n // 2 + 1, 0, np.array(samples.shape) - n)
    block = Field.of(samples[tuple(slice(i, i + n) for i in low)])
    panels = [
        ("1987", surface(lorensen_cline.RULE, block, isovalue)),
        ("asymptotic decider", surface(decider.RULE, block, isovalue)),
    ]
    return sheet(panels, 2, 4.2)


def torn_cells(field: Field, isovalue: float) -> Integers:
    """(n, 3) cells at a hole of the surface of 1987, off the border."""
    mesh = sweep(lorensen_cline.RULE, field, isovalue, provenance=True)
    cells = mesh.traced().cells
    owner = np.repeat(cells, 3)[loose_edges(mesh.simplices)]
    places = np.stack(np.unravel_index(owner, [s - 1 for s in field.shape]), axis=1)
    inner = ((places > 0) & (places < np.array(field.shape) - 2)).all(axis=1)
    return np.asarray(places[inner])


def loose_edges(triangles: Integers) -> Integers:
    """Flat index of each half-edge that has no partner."""
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    halves = list(zip(start.tolist(), end.tolist(), strict=True))
    there = set(halves)
    return np.array([i for i, (a, b) in enumerate(halves) if (b, a) not in there])


def surface(rule: Rule, field: Field, isovalue: float) -> Drawer:
    """A surface with its inner open edges in red."""

    def draw(axes: Axes) -> None:
        """Paint the triangles, their edges, and the holes."""
        mesh = sweep(rule, field, isovalue)
        picture = Picture()
        last = np.array(field.shape) - 1
        for t in mesh.simplices:
            picture.triangle(mesh.vertices[t])
            for a, b in ((0, 1), (1, 2), (2, 0)):
                picture.line(mesh.vertices[t[a]], mesh.vertices[t[b]], 0.02, LINE)
        for i in loose_edges(mesh.simplices):
            t, k = divmod(int(i), 3)
            a, b = mesh.vertices[mesh.simplices[t][[k, (k + 1) % 3]]]
            if not (((a == 0) & (b == 0)) | ((a == last) & (b == last))).any():
                picture.line(a, b, 0.16, HOLE, lift=0.5)
        picture.paint(axes)

    return draw


# Faces


def face(corners: Sequence[float], title: str) -> tuple[str, Drawer]:
    """The contour of the interpolant, its asymptotes, and the face; corners B00 B10 B11 B01."""
    a, b, c, d = (np.array(v) for v in corners)
    D = float(a + c - b - d)
    S, T = (float(a - d) / D, float(a - b) / D) if D else (np.inf, np.inf)

    def draw(axes: Axes) -> None:
        """Paint the region above alpha, the contour, the asymptotes, the corners."""
        s, t = np.meshgrid(np.linspace(-0.5, 1.5, 241), np.linspace(-0.5, 1.5, 241))
        B = decider.bilinear(s, t, a, b, c, d)
        within = (np.abs(s - 0.5) <= 0.5) & (np.abs(t - 0.5) <= 0.5)
        axes.contourf(
            s, t, np.where(within, B, np.nan), levels=[0, 1e9], colors=[INSIDE], alpha=0.5
        )
        axes.contour(s, t, B, levels=[0], colors=[OUTSIDE], linewidths=1.8)
        if np.isfinite(S):
            axes.plot([S, S], [-0.5, 1.5], ":", color=EDGE_COLOUR, lw=1)
            axes.plot([-0.5, 1.5], [T, T], ":", color=EDGE_COLOUR, lw=1)
            axes.plot([S], [T], "+", color=HOLE, ms=8, clip_on=True)
        axes.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=LINE, lw=1.2)
        for (x, y), v in zip(((0, 0), (1, 0), (1, 1), (0, 1)), corners, strict=True):
            axes.plot([x], [y], "o", mfc=LINE if v >= 0 else "white", mec=LINE, ms=6)
        if a * b < 0 and c * d < 0 and a * d < 0:
            label_crossings(axes, [float(v) for v in corners])
        axes.set_xlim(-0.45, 1.45)
        axes.set_ylim(-0.45, 1.45)
        axes.set_aspect("equal")
        axes.axis("off")

    return title, draw


EDGE_COLOUR = "#7c8894"


def label_crossings(axes: Axes, corners: Sequence[float]) -> None:
    """The names Figure 7 gives to the points where the contour crosses the edges of the face."""
    a, b, c, d = corners
    labels = [
        ("(S0, 0)", a / (a - b), 0.0, (-5, -13), "right"),
        ("(S1, 1)", d / (d - c), 1.0, (6, 5), "left"),
        ("(0, T0)", 0.0, a / (a - d), (-6, -14), "right"),
        ("(1, T1)", 1.0, b / (b - c), (6, 6), "left"),
    ]
    for text, s, t, offset, side in labels:
        axes.plot([s], [t], "o", color=OUTSIDE, ms=3.5)
        axes.annotate(
            text, (s, t), offset, textcoords="offset points", ha=side, va="bottom", fontsize=7,
            bbox={"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.85},
        )  # fmt: skip


def figure_6_8() -> Figure:
    """The hyperbola and the face: Figures 6, 7 and 8."""
    panels = [
        face((0.8, -1.3, 0.7, -1.0), "ambiguous, separated:\nsaddle below the isovalue"),
        face((1.3, -0.8, 1.0, -0.6), "ambiguous, not separated:\nsaddle above it"),
        face((1.0, -1.0, 1.0, -1.0), "saddle on the isovalue:\nnot separated"),
        face((1.0, -0.6, -0.4, -1.0), "one branch in the face"),
        face((1.0, 0.6, -0.5, -0.9), "one branch, other corners"),
        face((1.0, 0.2, -0.8, 0.0), "B00 + B11 = B01 + B10:\na line, no saddle"),
    ]
    return sheet(panels, 3, 2.7, 1.25)


def figure_5() -> Figure:
    """The bilinear interpolant over the face, with its level at alpha and its saddle."""
    figure = plt.figure(figsize=(4.2, 3.6))
    axes = figure.add_subplot(projection="3d", computed_zorder=False)
    corners = [np.array(v) for v in (1.0, -1.1, 0.9, -0.7)]
    s, t = np.meshgrid(np.linspace(0, 1, 25), np.linspace(0, 1, 25))
    B = decider.bilinear(s, t, *corners)
    axes.plot_surface(s, t, B, color=OUTSIDE, alpha=0.6, edgecolor="white", linewidth=0.2)
    axes.contour(s, t, B, levels=[0], colors=[LINE], linewidths=2.5, zorder=5)
    S, T, value = (float(x) for x in decider.saddle(*corners))
    axes.scatter([S], [T], [value], color=HOLE, s=40, depthshade=False, zorder=6)
    axes.text(S + 0.07, T + 0.07, value, "B(S, T)", fontsize=10, zorder=7, va="center")
    for name, x, y, v in zip(
        ("B00", "B10", "B11", "B01"), (0, 1, 1, 0), (0, 0, 1, 1), corners, strict=True
    ):
        height = float(v) + (0.0 if name == "B10" else 0.12)
        if name == "B01":
            # The surface hides this corner: hold its name above it.
            height = float(v) + 1.7
            axes.plot([x, x], [y, y], [float(v), height], ":", color=EDGE_COLOUR, lw=1, zorder=0)
        side = "right" if name == "B10" else "center"
        axes.text(x, y, height, name, fontsize=9, ha=side)
    axes.set_xlabel("s", fontsize=9)
    axes.set_ylabel("t", fontsize=9)
    axes.tick_params(labelsize=7)
    axes.view_init(32, -38)
    figure.tight_layout(pad=0.2)
    return figure


def figure_1() -> Figure:
    """Cuberille grid data: samples at the corners of a lattice of cubes, one cell of it marked."""
    figure, axes = plt.subplots(figsize=(3.4, 3.0))
    axes.axis("off")
    axes.set_aspect("equal")
    shape = (4, 3, 3)
    for index in np.ndindex(*shape):
        here = on_paper(np.array(index, float))
        for axis in range(3):
            if index[axis] + 1 < shape[axis]:
                there = on_paper(np.array(index, float) + np.eye(3)[axis])
                axes.plot(*np.transpose([here, there]), color=EDGE_COLOUR, lw=0.7, zorder=1)
        axes.plot(*here, "o", color=OUTSIDE, ms=4, zorder=2)
    axes.plot([], [], "o", color=OUTSIDE, ms=4, label="samples")
    for k, corner in enumerate(CORNERS):
        label = None if k else "those of one cell"
        axes.plot(
            *on_paper(np.array(corner, float)), "o", color=INSIDE, ms=5, zorder=3, label=label
        )
    axes.legend(fontsize=8, frameon=False, loc="upper center", ncol=2, bbox_to_anchor=(0.5, 1.12))
    at = on_paper(np.array((shape[0] - 1.0, shape[1] - 1.0, shape[2] - 1.0)))
    axes.annotate("F$_{ijk}$", at, (5, -13), textcoords="offset points", fontsize=10)
    figure.tight_layout(pad=0.2)
    return figure


def figure_7() -> Figure:
    """The notation of the test: the crossings of the sides, and the meeting of the asymptotes."""
    panels = [
        face((0.8, -1.3, 0.7, -1.0), "a: (S1, 1) to (1, T1),\n(S0, 0) to (0, T0)"),
        face((-0.8, 1.3, -0.7, 1.0), "b: the other two corners\nare inside"),
    ]
    return sheet(panels, 2, 3.2, 1.2)


def figure_17(field: Field, isovalue: float) -> Figure:
    """The isovalue surface of a skull: a CT head in place of the paper's, which is not public."""
    mesh = sweep(decider.RULE, field, isovalue, provenance=True)
    corners = mesh.vertices[mesh.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    # Seen along the second axis from its low end, the first axis downwards: back to front.
    order = np.argsort(-corners[:, :, 1].mean(axis=1))
    flat, lit = corners[order][:, :, [2, 0]] * [1, -1], normals[order] @ np.array([0.3, -0.85, 0.4])
    figure, axes = plt.subplots(figsize=(4.4, 4.4))
    axes.axis("off")
    axes.set_aspect("equal")
    shades = plt.get_cmap("bone")(0.25 + 0.7 * np.clip(lit, 0, 1))
    axes.add_collection(PolyCollection(flat, facecolors=shades, edgecolors="face", linewidths=0.2))
    axes.autoscale()
    told = f"a CT head at {isovalue:g}, {len(mesh.simplices):,} triangles"
    axes.set_title(told, fontsize=9)
    figure.tight_layout(pad=0.2)
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "figure-01-cuberille-grid.svg": figure_1,
    "figure-02-configurations.png": figure_2,
    "figure-03-04-hole-and-repairs.png": figure_3_4,
    "figure-05-bilinear.svg": figure_5,
    "figure-06-08-hyperbolas.svg": figure_6_8,
    "figure-07-notation-of-the-test.svg": figure_7,
    "figure-09-notation.png": figure_9,
    "figure-10-configuration-3.png": lambda: sheet([variant("3A"), variant("3B")], 2),
    "figure-04-configuration-6.png": lambda: sheet([variant("6A"), variant("6B")], 2),
    "figure-11-configuration-12.png": lambda: sheet([variant(f"12{x}") for x in "ABCD"], 4),
    "figure-12-octagon.png": figure_12,
    "figure-13-configuration-10.png": lambda: sheet([variant(f"10{x}") for x in "ABCD"], 4),
    "figure-14-eight-polygons-of-7.png": figure_14,
    "figure-15-configuration-7.png": lambda: sheet([variant(f"7{x}") for x in "ABCD"], 4),
    "figure-16-configuration-13.png": figure_16,
    "figure-18-example-3.png": figure_18,
}


#: What each picture shows, by the beginning of its name.
CAPTIONS = {
    "figure-01": "Fig. 1: cuberille grid data, with the eight samples of one cell.",
    "figure-02": "Fig. 2: the fifteen configurations with the sheets of 1987. Marked corners are "
    "dark, and seen through the sheets; of a sheet the side towards low values is blue, that "
    "towards high values brown.",
    "figure-03": "Figs. 3 and 4: the hole that the drawings of 1987 leave between two cells, and "
    "the repairs: the same decision on both sides.",
    "figure-04": "Fig. 4: configuration 6, its ambiguous face joined (6A) and separated (6B).",
    "figure-05": "Fig. 5: the bilinear interpolant over a face, its level at alpha and its saddle; "
    "B01 lies behind the surface.",
    "figure-06": "Figs. 6 and 8: hyperbolas and the face. Shaded is what lies above alpha; the red "
    "cross is where the asymptotes meet.",
    "figure-07": "Figs. 7a and 7b: the notation of the test.",
    "figure-09": "Fig. 9: the paper's names of corners and edges.",
    "figure-10": "Fig. 10: configuration 3.",
    "figure-11": "Fig. 11: configuration 12.",
    "figure-12": "Fig. 12: the polygon that no triangles on its own corners fill.",
    "figure-13": "Fig. 13: configuration 10; the point inside 10B and 10D is e0.",
    "figure-14": "Fig. 14: the eight systems of boundary polygons of configuration 7.",
    "figure-15": "Fig. 15: configuration 7; the point inside 7C is e0.",
    "figure-16": "Fig. 16: configuration 13, with the three variants that no values have, and the "
    "one that the paper has no letter for.",
    "figure-17": "Fig. 17: the isovalue surface of a head, of another scan than the paper's.",
    "figure-18": "Fig. 18: a hole in Example 3 with the drawings of 1987, and none by the decider.",
}


def caption(path: Path) -> str:
    """What the picture shows."""
    return CAPTIONS[path.stem[: len("figure-00")]]


def draw_all(folder: Path, skull: tuple[Field, float] | None = None) -> list[Path]:
    """Every figure, written to the folder; Figure 17 of this volume at this isovalue."""
    folder.mkdir(parents=True, exist_ok=True)
    made = [save(make(), folder / name) for name, make in FIGURES.items()]
    return [*made, save(figure_17(*skull), folder / SKULL)] if skull else made
