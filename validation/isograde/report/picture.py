"""A small field and its mesh, drawn as SVG, with the fault where the judge named it; for any kind.

Samples that are inside every component are filled, the others hollow; where there are several
components, signs beside a sample say on which side of each it is. Triangles in space are blue from
outside and orange from inside, segments in the plane have an arrow, inside on its left: a wrong
orientation is seen. In more dimensions than three the simplices near the fault are drawn by their
edges, with one direction of the picture for each axis.

Facets that only one simplex has are red inside the lattice and thin on its border; facets of more
than two simplices are violet. What a finding's numbers name is marked, in index coordinates::

    first         a point, or the corners of a facet or simplex       ring, or thick line
    at            a point                                             ring
    first         several simplices, such as two that cross           an outline of each
    vertex, simplex  its number in the mesh                           ring, or outline
    corners       the corners of a simplex of a split                 its edges
    cell          the lowest corner of a cell                         its edges
    cell, face    the same, and the number of one of its faces        the face's edges
    sample, axes  a sample and the axes of the face that begins there its edges

Triangles at a facet so named that lie flat in the face between two cells are tinted violet.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise, product
from typing import Any

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.report.view import MARGIN, SIZE, Part, View, box, dot, drawing, line

# Draw samples and lattice of fields up to this many samples, and only inside samples beyond HOLLOW.
DETAILED, HOLLOW = 400, 200
# Name values up to this many samples, and signs of several components up to so many.
LABELLED, SIGNED = 12, 36
# Draw so many simplices; in more than three dimensions so many, those nearest to the fault.
SHOWN, SHOWN_BEYOND = 6000, 4
# Give each segment an arrow up to this many.
ARROWED = 60
NEAR = 10.0


@dataclass(frozen=True)
class Scene:
    """What is drawn: a field with one of the meshes that belong to it, in index coordinates."""

    shape: tuple[int, ...]
    values: Floats
    inside: Booleans
    points: Floats
    simplices: Integers
    numbers: Mapping[str, Any]

    @classmethod
    def of(cls, record: Mapping[str, Any], mesh: Mapping[str, Any], tie: str) -> Scene:
        """The scene of an evidence record; `tie` is the side of a sample equal to its isovalue."""
        shape = tuple(record["shape"])
        n, m = len(shape), len(record["isovalues"])
        values = np.asarray(record["values"], np.float64)
        values = values.reshape(m, *shape) if values.size else np.empty((m, 0))
        level = np.asarray(record["isovalues"], np.float64).reshape(m, *[1] * (values.ndim - 1))
        points = np.asarray(mesh.get("vertices", []), np.float64).reshape(-1, n)
        points = (points - record["origin"]) / np.asarray(record["spacing"], np.float64)
        rows = np.asarray(mesh.get("simplices", []), np.int64).reshape(-1, n - m + 1)
        inside = values >= level if tie == "inside" else values > level
        return cls(shape, values, inside, points, rows, record["finding"].get("numbers", {}))

    @property
    def n(self) -> int:
        """Dimension of the lattice."""
        return len(self.shape)

    @property
    def k(self) -> int:
        """Dimension of the simplices."""
        return int(self.simplices.shape[1]) - 1

    @property
    def samples(self) -> int:
        """How many samples there are."""
        return int(np.prod(self.shape))

    @cached_property
    def shown(self) -> Integers:
        """The simplices that are drawn."""
        count = SHOWN if self.n <= 3 else SHOWN_BEYOND
        place = self.fault
        if len(self.simplices) <= count or place is None:
            return self.simplices[:count]
        away = np.abs(self.points[self.simplices].mean(axis=1) - place).max(axis=1)
        return self.simplices[np.argsort(away, kind="stable")[:count]]

    @cached_property
    def fault(self) -> Floats | None:
        """The middle of what the finding names, or None."""
        for name in ("first", "at", "cell", "sample"):
            marked = points_of(self.numbers.get(name), self.n)
            if marked is not None:
                middle: Floats = marked.mean(axis=0) + (0.5 if name == "cell" else 0.0)
                return middle
        return None

    def on_border(self, place: Floats) -> bool:
        """These points lie on one side of the lattice's box."""
        top = np.asarray(self.shape) - 1
        return bool(((place == place[0]).all(axis=0) & ((place[0] == 0) | (place[0] == top))).any())


def picture(
    record: Mapping[str, Any], mesh: Mapping[str, Any], label: str = "", tie: str = "inside"
) -> str:
    """The SVG of an evidence record's field, with one of the meshes that belong to it.

    `tie` is the side on which a sample equal to the isovalue counts. The fault is marked in what
    came, not in other answers.
    """
    scene = Scene.of(record, mesh, tie)
    view = View.of(scene.shape)
    parts = [*_lattice(view, scene), *_samples(view, scene), *_simplices(view, scene)]
    parts += _facets(view, scene)
    if mesh is record["came"]:
        parts += _fault(view, scene)
    return drawing(view, parts, label)


def points_of(value: Any, n: int) -> Floats | None:
    """(r, n) the points that a finding names: one, or several; None where it names none."""
    try:
        points = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        return None
    if points.ndim == 1 and points.shape == (n,):
        return points[None]
    return points if points.ndim == 2 and points.shape[1] == n and len(points) else None


def _lattice(view: View, scene: Scene) -> Iterator[Part]:
    """The lattice's edges, or of a large lattice or one of many axes the box round it."""
    if scene.samples > DETAILED or scene.n > 3:
        yield from box(view, scene.shape)
        return
    short = _radius(scene) if scene.n > 2 else 0.0
    for start in np.ndindex(*scene.shape):
        for axis in range(scene.n):
            if start[axis] + 1 < scene.shape[axis]:
                end = np.asarray(start) + np.eye(scene.n, dtype=int)[axis]
                yield line(view, start, end, "lat", short=short, nearer=0 if scene.n > 2 else -2)


def _radius(scene: Scene) -> float:
    """The radius of a sample's disc; 0 where samples are not shown."""
    if scene.samples > DETAILED or not scene.values.size:
        return 0.0
    return 5.5 if scene.samples <= LABELLED else 3.6


def _samples(view: View, scene: Scene) -> Iterator[Part]:
    """A disc for each sample, hollow outside; its value or its signs beside it where few are."""
    radius = _radius(scene)
    if not radius or scene.n > 3:
        return
    for index in np.ndindex(*scene.shape):
        sides, values = scene.inside[(slice(None), *index)], scene.values[(slice(None), *index)]
        if not sides.all() and scene.samples > HOLLOW:
            continue
        told = f"sample {index}: {', '.join(f'{value:g}' for value in values)}"
        (x, y), depth = view.place(index)
        svg = f'<circle class="{"in" if sides.all() else "out"}" cx="{x:.1f}" cy="{y:.1f}" '
        svg += f'r="{radius}"><title>{told}</title></circle>{_said(scene, x, y, values, sides)}'
        yield Part(float(depth) + (1e-3 if scene.n > 2 else -1), svg)


def _said(scene: Scene, x: float, y: float, values: Floats, sides: Booleans) -> str:
    """The sample's value or signs beside it, on the left where there is no room on the right."""
    if len(values) == 1 and scene.samples <= LABELLED:
        words = f"{values[0]:.3g}"
    elif len(values) > 1 and scene.samples <= SIGNED:
        words = "".join("+" if side else "−" for side in sides)
    else:
        return ""
    left = x > SIZE - 2 * MARGIN
    anchor = ' text-anchor="end"' if left else ""
    return (
        f'<text class="val" x="{x - 8 if left else x + 8:.1f}" y="{y - 7:.1f}"{anchor}>'
        f"{words}</text>"
    )


def _simplices(view: View, scene: Scene) -> Iterator[Part]:
    """Points as discs, segments as lines, triangles in space as triangles; of others the edges."""
    rows, points = scene.shown, scene.points
    if scene.k == 0:
        yield from (dot(view, points[row[0]], "spot", 4, nearer=NEAR / 2) for row in rows)
    elif scene.k == 2 and scene.n == 3:
        yield from _triangles(view, points, rows)
    elif scene.k == 1:
        yield from _segments(view, points, rows)
    elif len(rows):
        pairs = np.concatenate([rows[:, pair] for pair in combinations(range(scene.k + 1), 2)])
        for a, b in np.unique(np.sort(pairs, axis=1), axis=0):
            yield line(view, points[a], points[b], "run")


def _triangles(view: View, points: Floats, rows: Integers) -> Iterator[Part]:
    """The triangles, shaded by how they stand to the eye."""
    flat, depth = view.place(points)
    for row in rows:
        a, b, c = flat[row]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        sides = points[row[1:]] - points[row[0]]
        length = np.linalg.norm(np.cross(sides[0], sides[1]))
        square = abs(area) / (length * view.scale**2) if length else 0.0
        # The picture's second axis points down, so a front face turns clockwise.
        kind = "front" if area < 0 else "back"
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in (a, b, c))
        svg = (
            f'<polygon class="{kind}" points="{corners}" fill-opacity="{0.45 + 0.4 * square:.2f}"/>'
        )
        yield Part(float(depth[row].mean()), svg)


def _segments(view: View, points: Floats, rows: Integers) -> Iterator[Part]:
    """The segments, fainter away from the eye in space, with arrows where there are few."""
    flat, depth = view.place(points)
    span = float(np.ptp(depth)) if len(depth) else 0.0
    for a, b in rows:
        share = 0.5 + ((depth[a] + depth[b]) / 2 - depth.mean()) / (2 * span) if span else 1.0
        svg = (
            f'<line class="run" x1="{flat[a][0]:.1f}" y1="{flat[a][1]:.1f}" x2="{flat[b][0]:.1f}" '
            f'y2="{flat[b][1]:.1f}" stroke-opacity="{0.45 + 0.55 * np.clip(share, 0, 1):.2f}"/>'
        )
        yield Part(float(depth[a] + depth[b]) / 2 + (0 if span else NEAR / 2), svg)
        if len(rows) <= ARROWED:
            yield from _arrow(view, flat[a], flat[b])


def _arrow(view: View, start: Floats, end: Floats) -> Iterator[Part]:
    """An arrowhead in the middle of a segment."""
    length = float(np.linalg.norm(end - start))
    if length < 4:
        return
    ahead = (end - start) / length * min(6.0, 0.3 * length, 0.2 * view.scale)
    aside, tip = ahead[::-1] * (-0.6, 0.6), (start + end) / 2 + ahead
    corners = (tip, tip - 1.8 * ahead + aside, tip - 1.8 * ahead - aside)
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    yield Part(NEAR, f'<polygon class="head" points="{text}"/>')


def _facets(view: View, scene: Scene) -> Iterator[Part]:
    """Facets of one simplex: red, or thin on the border; of more than two: violet."""
    for kind, place in facet_marks(scene, scene.shown):
        near = NEAR if kind == "crowd" else 0.05
        if len(place) == 1:
            yield dot(view, place[0], "crowd" if kind == "crowd" else "spot", 4, nearer=NEAR)
        for a, b in combinations(place, 2):
            yield line(view, a, b, kind, nearer=near)


def facet_marks(scene: Scene, rows: Integers) -> Iterator[tuple[str, Floats]]:
    """The facets of these simplices that only one simplex has, or more than two: kind and place."""
    if scene.k < 1 or not len(rows):
        return
    shown = {facet for row in rows.tolist() for facet in combinations(sorted(row), scene.k)}
    for facet, uses in facets_of(scene.simplices).items():
        place = scene.points[list(facet)]
        if facet not in shown or uses == 2:
            continue
        border = scene.on_border(place)
        if scene.k > 1 or uses > 2 or not border:
            yield "crowd" if uses > 2 else "rim" if border else "gap", place


def facets_of(rows: Integers) -> dict[tuple[int, ...], int]:
    """Each facet, its vertices in order, with the number of simplices that have it."""
    width = rows.shape[1] - 1
    facets = np.concatenate([rows[:, list(kept)] for kept in combinations(range(width + 1), width)])
    ends, uses = np.unique(np.sort(facets, axis=1), axis=0, return_counts=True)
    return dict(zip(map(tuple, ends.tolist()), uses.tolist(), strict=True))


def _fault(view: View, scene: Scene) -> Iterator[Part]:
    """What the finding names: points, simplices, a cell, or a face of the lattice."""
    for kind, points, nearer in fault_marks(scene):
        if kind == "level":
            flat, depth = view.place(points)
            text = " ".join(f"{x:.1f},{y:.1f}" for x, y in flat)
            svg = f'<polygon class="level" points="{text}"><title>flat in a face</title></polygon>'
            yield Part(float(depth.max()) + nearer, svg)
        elif len(points) == 1:
            yield dot(view, points[0], kind, 9, nearer=nearer)
        else:
            yield line(view, points[0], points[1], kind, nearer=nearer)


def fault_marks(scene: Scene) -> Iterator[tuple[str, Floats, float]]:
    """What marks the fault: a kind, a point, two ends or a triangle, and how far it is lifted.

    Kinds are the classes of the style sheet: ring, sore-line, level.
    """
    for marked in _marked(scene):
        if len(marked) == 1:
            yield "ring", marked, NEAR
        for a, b in pairwise([*marked, marked[0]][: len(marked) + (len(marked) > 2)]):
            yield "sore-line", np.stack([a, b]), 2 * NEAR
    for triangle in level_triangles(scene):
        yield "level", triangle, NEAR / 4
    corners = points_of(scene.numbers.get("corners"), scene.n)
    for a, b in combinations(corners if corners is not None else (), 2):
        yield "sore-line", np.stack([a, b]), 0.02
    cell = points_of(scene.numbers.get("cell"), scene.n)
    if cell is not None:
        yield from _block(*spanned(scene, cell[0]))
    sample = points_of(scene.numbers.get("sample"), scene.n)
    if sample is not None:
        axes = scene.numbers.get("axes", scene.numbers.get("axis", []))
        yield from _block(sample[0], [axes] if isinstance(axes, int) else list(axes))


def _marked(scene: Scene) -> Iterator[Floats]:
    """The points, facets and simplices that the finding names, by their places or by number."""
    for name in ("first", "at"):
        value = scene.numbers.get(name)
        one = points_of(value, scene.n)
        several = value if one is None and isinstance(value, list) else []
        for part in (one, *(points_of(part, scene.n) for part in several)):
            if part is not None:
                yield part
    for name, rows in (("vertex", np.arange(len(scene.points))), ("simplex", scene.simplices)):
        number = scene.numbers.get(name)
        if isinstance(number, int) and number < len(rows):
            yield scene.points[rows[number]].reshape(-1, scene.n)


def level_triangles(scene: Scene) -> Iterator[Floats]:
    """Triangles (3, 3) at the facet that is named which lie flat in a face between two cells."""
    named = points_of(scene.numbers.get("first"), scene.n)
    if (scene.n, scene.k) != (3, 2) or named is None or len(named) != 2:
        return
    top = np.asarray(scene.shape) - 1
    for row in scene.shown:
        corners = scene.points[row]
        flat = (np.ptp(corners, axis=0) < 1e-6) & (corners[0] > 0.5) & (corners[0] < top - 0.5)
        flat &= np.abs(corners[0] - np.rint(corners[0])) < 1e-6
        if (flat & (np.abs(named - corners[0]).max(axis=0) < 1e-4)).any():
            yield corners


def spanned(scene: Scene, low: Floats) -> tuple[Floats, list[int]]:
    """Where the cell at `low`, or the one of its faces that the finding names, begins; its axes."""
    face = scene.numbers.get("face")
    if scene.n != 3 or not isinstance(face, int):
        return low, list(range(scene.n))
    axis = face // 2
    return low + np.eye(3)[axis] * (face % 2), [one for one in range(3) if one != axis]


def _block(low: Floats, axes: list[int]) -> Iterator[tuple[str, Floats, float]]:
    """The edges of the face of the lattice that begins at a sample and spans these axes."""
    unit = np.eye(len(low))
    if not axes:
        yield "ring", low[None], NEAR
    for ends in product((0, 1), repeat=len(axes)):
        start = low + sum((end * unit[axis] for end, axis in zip(ends, axes, strict=True)), 0 * low)
        for end, axis in zip(ends, axes, strict=True):
            if not end:
                yield "sore-line", np.stack([start, start + unit[axis]]), 0.02
