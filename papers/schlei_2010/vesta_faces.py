"""The figures of single faces with the paper's letters: 2, 3, 5, and the diagrams of Fig. 6b.

A voxel face has four junctures, the middles of its edges, and on each quarter one path: from a
juncture over the face's centre to the next juncture, clockwise round the range vector (Fig. 2b).
That one rule draws all of them; it is that of `isoref.marching_vesta`, which the tests hold it to.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isoref.cube import CORNERS, ambiguous_faces
from isoref.field import Floats
from isoref.marching_vesta import CENTRES, JUNCTURES, cell_paths, cycles
from vesta_census import kind
from vesta_figures import COLOURS, at, draw_chain, examples, finish, flat, panels, save

X, Y, Z = np.eye(3)
GREY, INK = "0.6", "k"
#: How far a vector is drawn beside the line from a face's centre to a juncture.
BESIDE = 0.09


def numbered_junctures(r: Floats, first: Floats) -> Floats:
    """(4, 3) junctures 1 .. 4 of the face round the origin, counterclockwise round r (Fig. 2b)."""
    return np.array([first, np.cross(r, first), -first, -np.cross(r, first)]) / 2


def face_paths(r: Floats, first: Floats) -> list[tuple[int, int]]:
    """The four internal paths, as numbers of junctures: 4 -> 3, 3 -> 2, 2 -> 1, 1 -> 4."""
    junctures = numbered_junctures(r, first)
    found = []
    for begin, a in enumerate(junctures, 1):
        end = next(k for k, b in enumerate(junctures, 1) if np.cross(b, a) @ r > 1e-9)
        found.append((begin, end))
    return sorted(found, reverse=True)


def vector(ax, start: Floats, stop: Floats, colour: str = INK, width: float = 0.9) -> None:
    """A vector in space, over everything."""
    (a, b), (c, d) = flat(np.array([start, stop]))
    style = {"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": 0, "shrinkB": 0}
    style["mutation_scale"] = 5
    ax.annotate("", (c, d), (a, b), arrowprops=style, zorder=12, annotation_clip=False)
    ax.plot([a, c], [b, d], alpha=0)


def spot(ax, place: Floats, fill: str, size: float = 2.8) -> None:
    """A point in space, over everything."""
    ax.plot(*flat(place), "o", color=fill, ms=size, mec="k", mew=0.5, zorder=15, clip_on=False)


def line(ax, points: Floats, style: str = "-", colour: str = INK, width: float = 1.2) -> None:
    """A line in space, over everything."""
    ax.plot(*flat(np.asarray(points)).T, style, color=colour, lw=width, zorder=11)


def face(ax, centre: Floats, r: Floats) -> None:
    """A voxel face that is perpendicular to r."""
    u, v = (e for e in np.eye(3) if abs(e @ r) < 0.5)
    corners = [centre + (p * u + q * v) / 2 for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    ax.fill(*flat(np.array(corners)).T, fc="0.93", ec="0.7", lw=0.5, **at(np.array(corners)))


def box(ax, middle: Floats) -> None:
    """The edges of a voxel."""
    for axis in range(3):
        u, v = (e for k, e in enumerate(np.eye(3)) if k != axis)
        for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            start = middle + (p * u + q * v - np.eye(3)[axis]) / 2
            ends = np.array([start, start + np.eye(3)[axis]])
            ax.plot(*flat(ends).T, "-", color="0.7", lw=0.6, zorder=3)


def figure_2(path: Path) -> Path:
    """A range vector, a face with its vectors, a moved contour, and a moved centre."""
    figure, axes = panels(4, 4, 1.9)
    for letter, ax in zip("abcd", axes, strict=True):
        ax.set_title(f"({letter})", pad=2)
    isovalue, active = 100.0, 133.0
    moved = (active - isovalue) / active
    for ax, t in ((axes[0], 0.5), (axes[3], moved)):
        for middle in (0 * X, X):
            box(ax, middle)
        face(ax, X / 2, X)
        for juncture in X / 2 + numbered_junctures(X, Z):
            line(ax, np.array([t * X, juncture]), "--", "0.5", 0.8)
        vector(ax, 0 * X, X, GREY, 1.4)
        spot(ax, 0 * X, GREY, 6)
        spot(ax, t * X, INK)
    _one_face(axes[1])
    _pixels(axes[2], moved)
    for ax in axes:
        finish(ax)
    return save(figure, path)


def _one_face(ax) -> None:
    """Fig. 2b: junctures by their numbers, and the four paths through the centre."""
    r, first = -Y, Z
    face(ax, 0 * X, r)
    junctures = numbered_junctures(r, first)
    vector(ax, 0 * r, 0.8 * r, GREY, 1.4)
    x, y = flat(0.8 * r)
    ax.text(x + 0.03, y - 0.06, "r", fontsize=7, zorder=20)
    for begin, end in face_paths(r, first):
        a, b = junctures[begin - 1], junctures[end - 1]
        corner = BESIDE * 2 * (a + b) / 2
        line(ax, np.array([0 * a, a]), "--", "0.5", 0.8)
        vector(ax, 0.92 * a + corner, corner)
        vector(ax, corner, 0.92 * b + corner)
    for number, juncture in enumerate(junctures, 1):
        spot(ax, juncture, "w")
        ax.text(*flat(1.22 * juncture), number, ha="center", va="center", fontsize=7)
    spot(ax, 0 * X, INK)
    ax.plot(*flat(1.3 * junctures).T, alpha=0)


def _pixels(ax, moved: float) -> None:
    """Fig. 2c: grey levels 133 and 0; the contour of level 100 leaves the middle."""
    ax.fill([-0.5, 0.5, 0.5, -0.5], [-0.5, -0.5, 0.5, 0.5], fc="0.75", ec="0.4", lw=0.6)
    ax.plot([0.5, 1.5, 1.5, 0.5], [-0.5, -0.5, 0.5, 0.5], "-", color="0.4", lw=0.6)
    ax.plot([0.5, 0.5], [-0.5, 0.5], ":", color="k", lw=1.4)
    ax.plot([moved, moved], [-0.5, 0.5], "-", color="k", lw=1.4)
    ax.annotate("", (1, 0), (0, 0), arrowprops={"arrowstyle": "-|>", "color": GREY, "lw": 1.4})
    ax.plot([0.5, moved], [0, 0], "o", color="k", ms=2.8)
    for x, text in ((-0.2, "133"), (1.2, "0")):
        ax.text(x, -0.3, text, ha="center", va="center", fontsize=7)
    for x, text, side in ((moved, "100", "right"), (0.5, "66.5", "left")):
        ax.text(x, 0.54, text, ha=side, va="bottom", fontsize=6)
    ax.plot([0, 0], [0, 0.8], alpha=0)


#: Fig. 3: the centre and range vector of two faces with the juncture at the origin, and the panels.
PAIRS = (
    (((-X / 2, Z), (X / 2, Z)), "abcde"),
    (((-X / 2, Z), (-Z / 2, X)), "fghi"),
    (((X / 2, Z), (Z / 2, X)), "jklm"),
)


def figure_3(path: Path) -> Path:
    """Two faces that share a juncture: in a plane, round one voxel, between three voxels."""
    figure, axes = panels(15, 5, 1.6)
    for row, (pair, letters) in enumerate(PAIRS):
        for place in range(5):
            ax = axes[5 * row + place]
            if place < len(letters):
                ax.set_title(f"({letters[place]})", pad=2)
                _pair(ax, pair, place)
            finish(ax)
    return save(figure, path)


def _pair(ax, pair, shown: int) -> None:
    """Vectors through the juncture (0), cycle vectors (1), both as lines (2, 3), moved (4)."""
    move = 0.3 if shown == 4 else 0.0
    centres = [centre - move * r for centre, r in pair]
    for (centre, r), point in zip(pair, centres, strict=True):
        face(ax, centre, r)
        vector(ax, centre - r / 2, centre + r / 2, "0.8", 1.2)
        spot(ax, centre - r / 2, GREY, 5)
        if shown == 4:
            line(ax, np.array([point, 0 * X]), "--", "0.6", 0.8)
    for (one, r), (a, b) in zip(pair, (centres, centres[::-1]), strict=True):
        # The way from the centre to the juncture lies on the side of r x u.
        side = BESIDE * np.cross(r, -2 * one)
        if shown == 0:
            vector(ax, a + side, side, "0.5")
            vector(ax, side, b + side, "0.5")
        if shown == 1:
            vector(ax, a + side, b + side, INK, 1.2)
    if shown == 2:
        line(ax, np.array([centres[0], 0 * X, centres[1]]), "-", "0.5", 2)
    if shown in (3, 4):
        line(ax, np.array(centres), "-", INK, 2)
    for point in centres:
        spot(ax, point, INK)
    if shown in (0, 2):
        spot(ax, 0 * X, "w", 3.6)


def chains() -> list[tuple[int, tuple[int, ...]]]:
    """(signs, cycle) in the order of Figs. 5, 7 and 8: 3, 4, 4, 5 and 7 points, then 6.

    Of the 6-cycles the planar one is first (f), then that with a point of ambiguity (g).
    """
    found = []
    for wanted, signs, separated in examples():
        if len(wanted) <= 7:
            found.append((signs, next(c for c in cycles(signs, separated) if kind(c) == wanted)))

    def rank(one: tuple[int, tuple[int, ...]]) -> tuple[bool, int, bool, bool]:
        """Where the paper has it."""
        signs, cycle = one
        places = CENTRES[list(cycle)]
        flat_one = np.linalg.matrix_rank(places - places[0]) == 2
        return len(cycle) == 6, len(cycle), not flat_one, not ambiguous_faces(signs)

    return sorted(found, key=rank)


def figure_5(path: Path) -> Path:
    """The nine chains of boundary faces with their voxel face vectors, without directions."""
    shown = chains()
    figure, axes = panels(len(shown), 5, 1.7)
    for letter, ax, (signs, cycle) in zip("abcdefghi", axes, shown, strict=True):
        draw_chain(ax, signs, cycle, vectors=True)
        for f in ambiguous_faces(signs):
            spot(ax, JUNCTURES[f] / 2, "w", 4)
        ax.set_title(f"({letter})", pad=2)
    return save(figure, path)


#: The arms of Fig. 6b by the way in, and where the way out is: on the same voxel, on the other.
TURNS = (((0, 1), (1, 0), (-1, 0)), ((0, -1), (-1, 0), (1, 0)),
         ((1, 0), (0, 1), (0, -1)), ((-1, 0), (0, -1), (0, 1)))  # fmt: skip


def connection_diagrams(ax) -> None:
    """Fig. 6b: for each way into a point of ambiguity the two ways out, seen along the edge."""
    for n, (come, same, other) in enumerate(TURNS):
        middle = 2.7 * np.array([n % 2, -(n // 2)], float)
        for x, y in ((0, 0), (-1, -1)):
            square = middle + np.array([[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]])
            ax.fill(*square.T, fc="0.8", lw=0)
        way_in, *ways_out = (np.array(arm, float) for arm in (come, same, other))
        ax.annotate("", middle + 0.5 * way_in, middle + 1.15 * way_in,
                    arrowprops={"arrowstyle": "-|>", "color": "0.4", "lw": 1.6,
                                "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0})  # fmt: skip
        for out, colour in zip(ways_out, ("w", "k"), strict=True):
            # Draw a quarter of a circle, the white one with a dark rim.
            angle = np.linspace(0, np.pi / 2, 20)[:, None]
            arc = middle + 0.15 * way_in + 0.35 * out
            arc = arc + 0.35 * (np.cos(angle) * -out + np.sin(angle) * -way_in) + 0.35 * way_in
            bend = np.concatenate([arc, [middle + 0.15 * way_in + 0.9 * out]])
            for width, tone in ((2.4, "k"), (1.1, colour)):
                ax.plot(*bend.T, "-", color=tone, lw=width, solid_capstyle="butt", zorder=7)
            head = {"arrowstyle": "-|>", "fc": colour, "ec": "k", "lw": 0.6, "mutation_scale": 8}
            ax.annotate("", bend[-1] + 0.15 * out, bend[-1] - 0.1 * out,
                        arrowprops={**head, "shrinkA": 0, "shrinkB": 0}, zorder=8)  # fmt: skip
        ax.plot(*middle, "o", ms=3.6, color="w", mec="k", mew=0.6, zorder=9)
    ax.plot([-1.3, 4.0], [-4.0, 1.3], alpha=0)


def five_cycle() -> tuple[int, tuple[int, ...]]:
    """(signs, cycle) of the 5-cycle that shows its front most broadly."""
    best = (-np.inf, 0, ())
    for signs in range(256):
        found = cycles(signs, 0)
        if [len(cycle) for cycle in found] == [5]:
            x, y = flat(CENTRES[list(found[0])]).T
            area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
            best = max(best, (round(area, 6), signs, found[0]))
    return best[1], best[2]


def draw_five_cycle(ax) -> None:
    """Fig. 33d: a 5-cycle cut with its average point, and the normals of its five triangles."""
    _, cycle = five_cycle()
    places = CENTRES[list(cycle)] / 2
    middle = places.mean(axis=0)
    for k, (p, q) in enumerate(zip(places, np.roll(places, -1, axis=0), strict=True)):
        corners = np.array([p, q, middle])
        ax.fill(*flat(corners).T, fc=COLOURS[k], ec="w", lw=0.8, alpha=0.75, zorder=6)
        vector(ax, corners.mean(axis=0), corners.mean(axis=0) + np.cross(q - p, middle - p), "0.25")
    for place in places:
        spot(ax, place, INK)
    spot(ax, middle, GREY)
    finish(ax)


def paths_of_a_cell_face(r: Floats) -> set[tuple[tuple[float, ...], tuple[float, ...]]]:
    """(begin, end) of the four paths of one face, as `isoref.marching_vesta` has them.

    Each is that of another cell: the face's quarter in it. Places are relative to the centre.
    """
    axis = int(np.abs(r).argmax())
    signs = sum(1 << c for c, corner in enumerate(CORNERS) if (corner[axis] == 0) == (r[axis] > 0))
    return {
        (
            tuple((JUNCTURES[begin] - CENTRES[e]) / 2),
            tuple((JUNCTURES[end] - CENTRES[e]) / 2),
        )
        for e, (begin, _, end) in cell_paths(signs).items()
    }
