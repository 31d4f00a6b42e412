"""Pictures of sections of cubes and simplices, and of walks from face to face."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from isoref import Field, Mesh
from isoref.face_tracing import all_of, every_face, exact, trace
from isoref.field import Floats
from isoref.hypercubes import hull_places, tile
from isoref.recursive_sections import pieces_of
from isoref.simplex_section import staircase
from scipy.spatial import ConvexHull

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, corners, flat, panels, surface, wire


@beside("isoref.hypercubes", "tile")
def hulls() -> Picture:
    """The hulls of three patterns of signs, and what they show inside the cube."""
    patterns = (0b00000111, 0b01001001, 0b01100000)
    figure, axes = panels(len(patterns), 2.6, 2.7)
    told = []
    for axis, signs in zip(axes, patterns, strict=True):
        places = np.array(hull_places(signs, 3)) / 2
        hull = ConvexHull(places)
        rows = tile(signs, 3)
        inner = np.array(rows, float) / 2
        told.append(len(rows))
        axis.computed_zorder = False
        wire(axis)
        surface(axis, Mesh.of(places, hull.simplices), SAND, alpha=0.25, edges="#c9b48c", width=0.3)
        loose = np.arange(3 * len(inner)).reshape(-1, 3)
        surface(axis, Mesh.of(inner.reshape(-1, 3), loose), BLUE, alpha=0.9, width=0.8)
        values = np.array([1.0 if signs >> c & 1 else -1.0 for c in range(8)])
        corners(axis, values.reshape(2, 2, 2).transpose(2, 1, 0), 20)
        count = signs.bit_count()
        bare(axis, (0, 0, 0), (1, 1, 1), f"{count} inside: {told[-1]} triangles", view=(20, -62))
    return Picture(
        figure,
        "Three cubes with the hull (sand) of their inside corners and crossed middles. What of its "
        f"boundary lies inside the cube (blue) is the surface: {', '.join(map(str, told[:-1]))} "
        f"and {told[-1]} triangles. Corners of a face that lie diagonally are joined.",
    )


@beside("isoref.recursive_sections", "pieces_of")
def by_recursion() -> Picture:
    """Two sections cut by recursion, beside the same cut by the staircase."""
    figure, axes = panels(4, 2.5, 2.6)
    told = []
    for first, (p, q) in enumerate(((2, 2), (3, 2))):
        nodes = _section(p, q)
        face = tuple(range(p + q))
        pieces = pieces_of(face, [v >= p for v in face], {})
        cut = np.array([[nodes[node] for node in piece] for piece in pieces])
        steps = np.array([[nodes[i, p + j] for i, j in row] for row in staircase(p, q).tolist()])
        for axis, rows, word in (
            (axes[2 * first], cut, "recursion"),
            (axes[2 * first + 1], steps, "staircase"),
        ):
            told.append(len(rows))
            _apart(axis, rows)
            kind = "triangles" if rows.shape[1] == 3 else "tetrahedra"
            bare(
                axis,
                (-0.05,) * 3,
                (1.05,) * 3,
                f"({p}, {q}) by {word}:\n{len(rows)} {kind}",
                view=(24, -50),
            )
    return Picture(
        figure,
        f"Sections of a tetrahedron and of a 4-simplex, moved apart: {told[0]} triangles by "
        f"recursion and {told[1]} by the staircase, {told[2]} tetrahedra and {told[3]}.",
    )


def _section(p: int, q: int) -> dict[tuple[int, ...], Floats]:
    """Places in space for the nodes of a section: a square, or a prism over a triangle."""
    low = np.array([[0.0, 0, 0], [1, 0, 0], [0.25, 0.95, 0]])[:p]
    high = np.array([[0.0, 0, 0], [0, 0, 1]])[:q]
    nodes: dict[tuple[int, ...], Floats] = {
        (i, p + j): low[i] + high[j] for i in range(p) for j in range(q)
    }
    for size in range(3, p + q + 1):
        for face in combinations(range(p + q), size):
            crossed = [nodes[i, j] for i in face if i < p for j in face if j >= p]
            # Where the section is no simplex, it has a node in its middle.
            if len(crossed) > size - 1:
                nodes[face] = np.mean(crossed, axis=0)
    return nodes


def _apart(axis: Any, rows: Floats) -> None:
    """Simplices, each moved away from the middle of all."""
    middle = rows.mean(axis=(0, 1))
    corner_rows = [list(c) for c in combinations(range(rows.shape[1]), 3)]
    for n, row in enumerate(rows):
        moved = row + 0.22 * (row.mean(axis=0) - middle)
        surface(axis, Mesh.of(moved, corner_rows), BLUE if n % 2 else SAND, alpha=0.85, width=0.6)


@beside("isoref.face_tracing", "trace")
def traced_from_a_seed() -> Picture:
    """One of two contours, traced from a seed, and the samples that were read for it."""
    count = 17
    i, j = np.meshgrid(*[np.arange(count, dtype=float)] * 2, indexing="ij")
    blobs = ((5.2, 5.4, 3.1), (12.3, 11.2, 2.6))
    values = sum(np.exp(-((i - a) ** 2 + (j - b) ** 2) / (2 * r * r)) for a, b, r in blobs)
    field, level = Field.of(values, dimension=2), 0.6
    whole = all_of(field, level)
    value, read = exact(field, level), set()

    def watched(vertex: tuple[int, ...]) -> tuple[Fraction, ...]:
        read.add(vertex)
        return value(vertex)

    seed = min(whole.points)
    one = trace(watched, 1, field.shape, [seed])
    figure, axes = panels(2, 3.2, 3.3, space=False)
    for axis, found, title in (
        (axes[0], whole, f"every edge: {len(list(every_face(field.shape, 1)))} asked"),
        (axes[1], one, f"from a seed: {len(read)} of {count * count} samples read"),
    ):
        _triangulation(axis, count)
        for face in found.cells()[1]:
            ends = np.array([found.points[f] for f in face.facets() if f in found.points])
            axis.plot(*ends.T, color=RED, linewidth=2)
        axis.plot(*np.array(list(found.points.values())).T, ".", color=INK, markersize=4)
        flat(axis, title)
    axes[1].plot(*np.array(sorted(read)).T, "o", color=BLUE, markersize=3.2, zorder=1)
    axes[1].plot(*whole.points[seed], "o", color=SAND, markeredgecolor=INK, markersize=9, zorder=5)
    return Picture(
        figure,
        f"Two contours with {len(whole.points)} points. From one seed (sand) the walk finds the "
        f"{len(one.points)} points of its own contour, and reads the samples beside it alone "
        f"(blue): {len(read)} of {count * count}.",
    )


def _triangulation(axis: Any, count: int) -> None:
    """The edges of the Kuhn triangulation, one Face after the other."""
    pieces = [np.array(face.vertices()) for face in every_face((count, count), 1)]
    for a, b in pieces:
        axis.plot(*np.array([a, b]).T, color="#d5dce2", linewidth=0.5, zorder=0)
