"""The figures of the text with the paper's letters: 1 to 6, 10 and 15 to 18.

They are drawn from what the modules compute: paths, cycles, contours and meshes. The binary image
of Fig. 1a and the values behind Fig. 18 are ours, as the paper does not print its own. Fig. 33 is
that of a fireball, on the page of the tables.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isograde.reproduction import write_report
from isoref.cube import CORNERS, EDGES, ambiguous_faces, axis_of, inside
from isoref.diconex import diconex
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.marching_vesta import CENTRES, JUNCTURES, cell_paths, cycles, paper_number, rule
from vesta_faces import connection_diagrams, figure_2, figure_3, figure_5
from vesta_figures import (
    COLOURS,
    TONES,
    at,
    draw_box,
    draw_triangles,
    face_quarters,
    finish,
    flat,
    panels,
    plt,
    save,
)

#: Corners of the cell by the paper's numbers 0 .. 7, Fig. 15b.
SITES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
#: Eleven active pixels round a hole, with points of ambiguity.
IMAGE = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [0, 1, 1, 1, 0, 0],
        [0, 1, 0, 1, 0, 0],
        [0, 1, 1, 0, 1, 0],
        [0, 1, 0, 1, 1, 0],
        [0, 0, 0, 0, 0, 0],
    ]
)


def signs_of(*numbers: int) -> int:
    """The signs of a cell whose active sites have these numbers of the paper."""
    return sum(1 << CORNERS.index(SITES[n]) for n in numbers)


def arrow(ax, start: Floats, stop: Floats, colour: str = "0.35", width: float = 0.9) -> None:
    """A vector in space."""
    (a, b), (c, d) = flat(np.array([start, stop]))
    style = {"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": 0, "shrinkB": 0}
    depth = at(np.array([start, stop]), 0.3)["zorder"]
    style["mutation_scale"] = 5
    ax.annotate("", (c, d), (a, b), arrowprops=style, zorder=depth, annotation_clip=False)
    ax.plot([a, c], [b, d], alpha=0)  # so that the panel holds it


def dot(ax, place: Floats, colour: str = "k", size: float = 2.6) -> None:
    """A point in space."""
    ax.plot(*flat(place), "o", color=colour, ms=size, mec="k", mew=0.4, **at(place[None], 0.4))


def label(ax, place: Floats, text: object, below: bool = False) -> None:
    """A small text at a point in space, above it or below."""
    x, y = flat(place) + ((-0.09, -0.09) if below else (0.03, 0.03))
    around = {"boxstyle": "round,pad=0.05", "fc": "w", "ec": "none", "alpha": 0.85}
    ax.text(x, y, str(text), fontsize=6, zorder=20, bbox=around)


def square(ax, corners: Floats, axis: int) -> None:
    """A face in the tone of its axis."""
    ax.fill(*flat(corners).T, fc=TONES[axis], ec="0.5", lw=0.5, alpha=0.75, **at(corners))


def cube(ax, middle: tuple[float, ...]) -> None:
    """A voxel by its six faces."""
    for axis in range(3):
        for side in (-0.5, 0.5):
            square(ax, _face(np.array(middle, float), axis, side), axis)


def _face(middle: Floats, axis: int, side: float) -> Floats:
    """(4, 3) the corners of a voxel's face."""
    u, v = np.delete(np.eye(3), axis, axis=0)
    centre = middle + side * np.eye(3)[axis]
    return np.array([centre + (p * u + q * v) / 2 for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def wire(ax, points: Floats, closed: bool = True, colour: str = COLOURS[0]) -> None:
    """A line through points in space."""
    line = np.array([*points, points[0]]) if closed else np.asarray(points)
    ax.plot(*flat(line).T, "-", color=colour, lw=1.3, **at(line, 0.2))


def lettered(count: int, columns: int, path: Path, draw, size: float = 1.5) -> Path:
    """A figure of panels (a), (b), .., each drawn by the function of its number."""
    figure, axes = panels(count, columns, size)
    for n, ax in enumerate(axes):
        draw(n, ax)
        ax.set_title(f"({'abcdefgh'[n]})", pad=2)
        finish(ax)
    return save(figure, path)


# --- Fig. 1: contours in two dimensions ---------------------------------------------------------


def figure_1(path: Path) -> Path:
    """DICONEX: image, vectors of a pixel, vectors and junctures, the choice, both contours."""
    figure, axes = panels(6, 3, 1.9)
    for n, (letter, ax) in enumerate(zip("abcdef", axes, strict=True)):
        if n in (0, 2, 4, 5):
            ax.imshow(1 - 0.35 * IMAGE, cmap="gray", vmin=0, vmax=1, origin="lower")
        ax.set_title(f"({letter})", pad=2)
        finish(ax)
    for start, stop in _vectors(np.pad(np.ones((1, 1), int), 1)):
        _flat_arrow(axes[1], start, stop)
    for k, place in enumerate(((1, 0.62), (1.38, 1), (1, 1.38), (0.62, 1))):
        axes[1].text(*place, k, ha="center", va="center", fontsize=6)
    axes[1].fill([0.5, 1.5, 1.5, 0.5], [0.5, 0.5, 1.5, 1.5], fc="0.65")

    # Draw the vectors of the image; a juncture with two in and two out is a point of ambiguity.
    vectors = _vectors(IMAGE)
    for start, stop in vectors:
        _flat_arrow(axes[2], start, stop)
    for place in {start for start, _ in vectors}:
        ambiguous = sum(start == place for start, _ in vectors) == 2
        axes[2].plot(
            *place, "o", ms=3.6, color="w" if ambiguous else "k", mec="k", mew=0.5, zorder=5
        )
    _choice(axes[3])
    for ax, mode in ((axes[4], "disconnect"), (axes[5], "connect")):
        for contour in diconex(Field.of(IMAGE.T.astype(float)), 0.5, mode=mode).polygons():
            ax.plot(*np.asarray(contour).T, "o-", ms=2, lw=1.2, color=COLOURS[0])
    return save(figure, path)


def _vectors(image) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """The initial contour vectors (x, y): the active pixel is on the left of each."""
    found = []
    for y, x in zip(*np.nonzero(image), strict=True):
        around = (((0, -1), (-1, -1), (1, -1)), ((1, 0), (1, -1), (1, 1)),
                  ((0, 1), (1, 1), (-1, 1)), ((-1, 0), (-1, 1), (-1, -1)))  # fmt: skip
        for (dx, dy), start, stop in around:
            if not image[y + dy, x + dx] if _within(image, y + dy, x + dx) else True:
                a, b = ((x + p / 2, y + q / 2) for p, q in (start, stop))
                found.append(((float(a[0]), float(a[1])), (float(b[0]), float(b[1]))))
    return found


def _within(image, y: int, x: int) -> bool:
    """Whether the image has such a pixel."""
    return 0 <= y < image.shape[0] and 0 <= x < image.shape[1]


def _flat_arrow(ax, start, stop) -> None:
    """A vector in the plane, a little inside its pixel's edge."""
    a, b = np.array(start), np.array(stop)
    inwards = np.array([a[1] - b[1], b[0] - a[0]]) * 0.05
    style = {"arrowstyle": "-|>", "color": "k", "lw": 0.8, "mutation_scale": 5}
    ax.annotate("", b * 0.96 + a * 0.04 + inwards, a * 0.96 + b * 0.04 + inwards, arrowprops=style)
    ax.plot(*np.array([a, b]).T, alpha=0)


def _choice(ax) -> None:
    """A point of ambiguity: left turns disconnect (white), right turns connect (black)."""
    ax.fill([-1, 0, 0, -1], [-1, -1, 0, 0], fc="0.65")
    ax.fill([0, 1, 1, 0], [0, 0, 1, 1], fc="0.65")
    for (x, y), (u, v), bend, colour in (
        ((0, -0.9), (-0.9, 0), 0.5, "w"),
        ((0, 0.9), (0.9, 0), 0.5, "w"),
        ((0, -0.9), (0.9, 0), -0.5, "k"),
        ((0, 0.9), (-0.9, 0), -0.5, "k"),
    ):
        # Draw each a little to its own side, white ones with a dark rim.
        start, stop = (x + 0.06 * np.sign(u), y), (u, v + 0.06 * np.sign(y))
        for width, tone in ((2.6, "k"), (1.2, colour)):
            style = {"arrowstyle": "-|>", "color": tone, "lw": width, "mutation_scale": 8}
            style["connectionstyle"] = f"arc3,rad={bend}"
            ax.annotate("", stop, start, arrowprops=style)
    ax.plot(0, 0, "o", ms=5, color="w", mec="k")


# --- Figs. 4, 6, 10: voxels -----------------------------------------------------------------------


def surface(active: list[tuple[int, int, int]], mode: str, tube: bool = False):
    """The surface of marching VESTA, L, round these voxels; the first has its middle at 0."""
    values = np.zeros((5, 5, 5))
    for voxel in active:
        values[tuple(np.add(voxel, 1))] = 1.0
    mesh = sweep(rule(mode, "L", tube=tube), Field.of(values, 1.0, (-1, -1, -1)), 0.5)
    return mesh.vertices[mesh.simplices]


def wires(ax, triangles: Floats) -> None:
    """The sides of triangles, each once."""
    for triangle in triangles:
        wire(ax, triangle)


def figure_4(path: Path) -> Path:
    """A single voxel, from its faces to the octahedron."""
    octahedron = surface([(0, 0, 0)], "disconnect")
    cycle = 0.5 * np.eye(3)[[0, 1, 2]] * (1, -1, 1)

    def draw(n: int, ax) -> None:
        if n == 0:
            cube(ax, (0, 0, 0))
        if n in (1, 2):
            for axis in range(3):
                for side in (-1, 1):
                    middle = np.eye(3)[axis] * side * (0.25 if n == 1 else 0)
                    square(ax, _face(middle, axis, side / 2), axis)
                    dot(ax, middle + np.eye(3)[axis] * side / 2)
        if n == 2:
            ring = [
                p
                for a, b in zip(cycle, np.roll(cycle, -1, axis=0), strict=True)
                for p in (a, a + b)
            ]
            for start, stop in zip(ring, ring[1:] + ring[:1], strict=True):
                arrow(ax, start, stop)
        if n == 3:
            cube(ax, (0, 0, 0))
            for start, stop in zip(cycle, np.roll(cycle, -1, axis=0), strict=True):
                arrow(ax, start, stop, "k", 1.4)
        if n == 4:
            wires(ax, octahedron)
        if n == 5:
            draw_triangles(ax, octahedron, [COLOURS[0]] * len(octahedron))
            for triangle in octahedron:
                normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
                if at(normal[None])["zorder"] > 5:
                    arrow(ax, triangle.mean(axis=0), triangle.mean(axis=0) + 0.6 * normal)

    return lettered(6, 6, path, draw)


def figure_6(path: Path) -> Path:
    """Two voxels that share an edge: both modes, as cycles and as wire frames."""
    pair = [(0, 0, 0), (1, 1, 0)]
    signs = signs_of(0, 2)
    (face,) = ambiguous_faces(signs)

    def draw(n: int, ax) -> None:
        mode, separated = (("disconnect", 1 << face), ("connect", 0))[n % 2]
        if n == 0:
            for voxel in pair:
                cube(ax, voxel)
            dot(ax, JUNCTURES[face] / 2, "w", 4)
        if n == 1:
            connection_diagrams(ax)
        if n in (2, 3):
            _quadrants(ax, signs)
            for cycle in cycles(signs, separated):
                wire(ax, CENTRES[list(cycle)] / 2)
        if n in (4, 5):
            wires(ax, surface(pair, mode))

    return lettered(6, 3, path, draw, 2.0)


def figure_10(path: Path) -> Path:
    """Two voxels that share a point, and the tube that can join them; pairs in both modes."""
    corner = [(0, 0, 0), (1, 1, 1)]
    edge = [(0, 0, 0), (1, 1, 0)]

    def draw(n: int, ax) -> None:
        if n == 0:
            for voxel in corner:
                cube(ax, voxel)
        if n == 1:
            wires(ax, surface(corner, "disconnect"))
            plain = {tuple(sorted(map(tuple, t))) for t in surface(corner, "disconnect")}
            for triangle in surface(corner, "disconnect", tube=True):
                if tuple(sorted(map(tuple, triangle))) not in plain:
                    line = np.array([*triangle, triangle[0]])
                    ax.plot(*flat(line).T, ":", color="k", lw=1, zorder=9)
        for shift, mode in ((0.0, "disconnect"), (2.6, "connect")):
            right = np.array([shift, 0, 0])
            if n == 2:
                for voxel in edge:
                    cube(ax, tuple(right + voxel))
            if n == 3:
                wires(ax, surface(edge, mode) + right)

    return lettered(4, 4, path, draw, 2.0)


# --- Figs. 15 to 18: the marching cell ------------------------------------------------------------


def _quadrants(ax, signs: int, only: int | None = None) -> None:
    """The quarters of boundary faces in the cell, with their two voxel face vectors."""
    draw_box(ax)
    for e, (begin, _, end) in cell_paths(signs).items():
        if only in (None, e):
            inner = next(q for q in face_quarters(e) if ((q >= 0) & (q <= 1)).all())
            square(ax, inner, axis_of(e))
            arrow(ax, JUNCTURES[begin] / 2, CENTRES[e] / 2)
            arrow(ax, CENTRES[e] / 2, JUNCTURES[end] / 2)
            dot(ax, CENTRES[e] / 2)
    for c in range(8):
        if inside(signs, c):
            dot(ax, np.array(CORNERS[c], float), "0.6", 5)
    for f in ambiguous_faces(signs):
        dot(ax, JUNCTURES[f] / 2, "w", 4)


def _octants(ax, signs: int) -> None:
    """The parts of active voxels in the cell."""
    draw_box(ax)
    for c in range(8):
        if inside(signs, c):
            middle = np.array(CORNERS[c]) * 0.5 + 0.25
            for axis in range(3):
                for side in (-0.5, 0.5):
                    square(ax, middle + 0.5 * (_face(np.zeros(3), axis, side)), axis)
            dot(ax, np.array(CORNERS[c], float), "0.6", 5)


def figure_15(path: Path) -> Path:
    """The conventions: axes, sites, centres, junctures, and the vectors of all eight voxels."""

    def draw(n: int, ax) -> None:
        draw_box(ax)
        if n == 0:
            for axis, name in enumerate("xyz"):
                arrow(ax, np.zeros(3), 1.35 * np.eye(3)[axis], "k")
                label(ax, 1.35 * np.eye(3)[axis], name)
            x, y = flat(np.zeros(3))
            ax.text(x + 0.02, y - 0.14, "(i, j, k)", fontsize=6, zorder=20)
        if n == 1:
            for number, site in enumerate(SITES):
                dot(ax, np.array(site, float), "0.6", 5)
                label(ax, np.array(site, float), number)
        if n == 2:
            for centre in CENTRES:
                dot(ax, centre / 2)
                label(ax, centre / 2, paper_number(centre), below=paper_number(centre) in (3, 6))
        if n == 3:
            for juncture in JUNCTURES:
                dot(ax, juncture / 2, "w", 4)
                label(ax, juncture / 2, paper_number(juncture))
                for e in range(12):
                    if np.abs(CENTRES[e] - juncture).sum() == 1:
                        line = np.array([CENTRES[e], juncture]) / 2
                        ax.plot(*flat(line).T, "--", color="0.5", lw=0.6)
        if n in (4, 5):
            for number in ((0, 2, 5, 7), (1, 3, 4, 6))[n - 4]:
                for e, (begin, _, end) in cell_paths(signs_of(number)).items():
                    arrow(ax, JUNCTURES[begin] / 2, CENTRES[e] / 2)
                    arrow(ax, CENTRES[e] / 2, JUNCTURES[end] / 2)
                    dot(ax, CENTRES[e] / 2)

    return lettered(6, 3, path, draw, 2.2)


def figure_16(path: Path) -> Path:
    """One active site, no. 7: its octant, and its three quadrants one by one."""
    signs = signs_of(7)
    centres = sorted(cell_paths(signs), key=lambda e: (9, 6, 11).index(paper_number(CENTRES[e])))

    def draw(n: int, ax) -> None:
        if n == 0:
            _octants(ax, signs)
        else:
            _quadrants(ax, signs, centres[n - 1])
            label(ax, CENTRES[centres[n - 1]] / 2, paper_number(CENTRES[centres[n - 1]]))

    return lettered(4, 4, path, draw, 1.8)


def figure_17(path: Path) -> Path:
    """Three active sites: octants, quadrants with a point of ambiguity, and both solutions."""
    signs = next(
        s for s in range(256) if s.bit_count() == 3
        and len(cell_paths(s)) == 7 and len(ambiguous_faces(s)) == 1
        and len(cycles(s, 0)) == 1
    )  # fmt: skip

    def draw(n: int, ax) -> None:
        if n == 0:
            _octants(ax, signs)
        if n == 1:
            _quadrants(ax, signs)
        if n in (2, 3):
            draw_box(ax)
            for i, cycle in enumerate(cycles(signs, (0b111111, 0)[n - 2])):
                wire(ax, CENTRES[list(cycle)] / 2, colour=COLOURS[i])

    return lettered(4, 4, path, draw, 1.8)


def figure_18(path: Path) -> Path:
    """Two active sites: the 4-cycle, moved, and cut with an average point or without."""
    signs = signs_of(0, 1)
    (cycle,) = cycles(signs, 0)
    moved = CENTRES[list(cycle)] / 2
    for e, t, place in zip(cycle, (0.3, 0.75, 0.6, 0.2), moved, strict=True):
        place[axis_of(e)] = t
    middle = moved.mean(axis=0)

    def draw(n: int, ax) -> None:
        draw_box(ax)
        if n < 2:
            for e in cycle:
                a, b = EDGES[e]
                ends = (a, b) if inside(signs, a) else (b, a)
                arrow(ax, *(np.array(CORNERS[c], float) for c in ends))
        wire(ax, moved if n else CENTRES[list(cycle)] / 2)
        if n in (2, 3):
            for place in moved:
                wire(ax, np.array([place, middle]), closed=False, colour="0.5")
            dot(ax, middle, "0.6")
        if n == 3:
            draw_triangles(ax, np.array([[p, q, middle] for p, q in zip(
                moved, np.roll(moved, -1, axis=0), strict=True)]), COLOURS[:4])  # fmt: skip
        if n in (4, 5):
            k = n - 4
            ring = np.roll(moved, -k, axis=0)
            draw_triangles(ax, ring[[[0, 1, 2], [0, 2, 3]]], COLOURS[:2])

    return lettered(6, 6, path, draw, 1.6)


def draw_all(folder: Path) -> list[Path]:
    """Every figure of this module, in the order of the paper."""
    drawn = (
        figure_1, figure_2, figure_3, figure_4, figure_5, figure_6, figure_10, figure_15, figure_16,
        figure_17, figure_18,
    )  # fmt: skip
    paths = [one(folder / f"{one.__name__}.svg") for one in drawn]
    plt.close("all")
    return paths


CAPTIONS = {
    "figure_1": """Fig. 1: an image of ours with eleven active pixels (a); the vectors of a pixel
(b); vectors, junctures (black) and points of ambiguity (white) (c); left turns keep pixels apart
(white), right turns join them (black) (d); the contours in disconnect (e) and connect (f).""",
    "figure_2": """Fig. 2: an active voxel (disc), an inactive one, their face and its range vector
(a); a face with its junctures 1 to 4, its vectors and the range vector r (b); the contour of level
100 between 133 and 0, moved from the middle, where the level is 66.5 (c); the face's centre moved
as far (d).""",
    "figure_3": """Fig. 3: two faces in a plane (a to e), round one active voxel (f to i) and
between three (j to m, of which the two beside the faces are shown), with their range vectors:
vectors through the juncture (a, f, j), the cycle vectors that replace them (b, g, k), and both as
lines. What (c, d, e, h, i, l, m) show is read off the caption: (c, h, l) are vectors, (d, i, m)
cycle vectors, and (e) is drawn with moved centres.""",
    "figure_4": """Fig. 4: a voxel (a), its faces, here drawn apart (b), six of its vectors (c), the
3-cycle they give (d), all cycles (e), the octahedron with normals (f).""",
    "figure_5": """Fig. 5: the nine chains of boundary faces with their voxel face vectors, in the
order of Figs. 7 and 8; points of ambiguity are white. Which of two 4-cycles, and of two 6-cycles,
the paper has first is ours to guess.""",
    "figure_6": """Fig. 6: voxels that share an edge and its point of ambiguity (a); for each of the
four ways in (grey), seen along the edge, the way out on the same voxel (white, disconnect) and on
the other (black, connect) (b); the cycles in disconnect (c) and connect (d), and the wire frames
(e, f).""",
    "figure_10": """Fig. 10: voxels that share a point (a) and the tube (b); two pairs that share an
edge (c), the left one in disconnect, the right one in connect (d).""",
    "figure_15": """Fig. 15: the cell (a), sites (b), centres (c), junctures (d), and the vectors of
sites 0, 2, 5, 7 (e) and 1, 3, 4, 6 (f).""",
    "figure_16": """Fig. 16: site 7 alone: its octant (a), the paths round 9, 6 and 11 (b to d).""",
    "figure_17": """Fig. 17: three active sites, up to a turn of the cell: octants (a), quadrants
and vectors (b), a 4-cycle and a 3-cycle in disconnect (c), a 7-cycle in connect (d).""",
    "figure_18": """Fig. 18: two active sites: range vectors and 4-cycle (a), moved (b), an average
point (c), four triangles (d), and the two ways without it (e, f).""",
}


def main() -> None:
    """The figures and a page that shows them, in reports/papers of this repository."""
    folder = Path(__file__).parents[2] / "reports" / "papers" / "schlei_2010"
    made = draw_all(folder)
    parts = ["Made by `papers/schlei_2010/vesta_lettered.py`, with the letters of the paper."]
    parts += [f"![{p.stem}]({p.name})\n\n{CAPTIONS[p.stem]}" for p in made]
    write_report(folder / "figures.md", "Schlei 2010: the figures of the text", parts)
    print(f"wrote {folder / 'figures.md'}")


if __name__ == "__main__":
    main()
