"""Contours over their samples, and curves in the box of their lattice, drawn as SVG.

Contours have an arrow each, so that it is seen on which side the inside is. Ends that lie inside
the lattice are red, as is whatever place the judge named. Curves grow fainter away from the eye.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from isoref.field import Floats

from isograde.report.view import Part, View, box, dot, drawing, line

# Name the values of up to this many samples, and draw both sides of up to so many.
LABELLED, HOLLOW = 12, 400
NEAR = 10.0


def polylines(record: Mapping[str, Any], mesh: Mapping[str, Any]) -> list[Floats]:
    """The polylines of an answer, in index coordinates."""
    steps, origin = np.asarray(record["spacing"]), np.asarray(record["origin"])
    points = np.asarray(mesh.get("vertices", []), np.float64).reshape(-1, len(steps))
    owner = np.asarray(mesh.get("faces", []), np.int64).reshape(-1)
    cuts = np.flatnonzero(np.diff(owner)) + 1
    return [part for part in np.split((points - origin) / steps, cuts) if len(part)]


def contour_picture(record: Mapping[str, Any], mesh: Mapping[str, Any], label: str = "") -> str:
    """The SVG of a planar field with the contours that came."""
    shape = tuple(record["shape"])
    view, lines = View.of(shape), polylines(record, mesh)
    parts = [*_grid(view, shape), *_samples(view, record), *_sore(view, record)]
    for points in lines:
        parts += [*_run(view, points), *_arrow(view, points)]
    return drawing(view, [*parts, *_loose_ends(view, lines, shape)], label)


def curve_picture(record: Mapping[str, Any], mesh: Mapping[str, Any], label: str = "") -> str:
    """The SVG of a lattice in space with the curves that came."""
    shape = tuple(record["shape"])
    view, lines = View.of(shape), polylines(record, mesh)
    parts = [*box(view, shape), *_signs(view, record), *_sore(view, record, world=True)]
    near = float(np.ptp(view.place(np.array([shape, np.zeros(3)]))[1])) or 1.0
    for points in lines:
        parts += _run(view, points, fade=near)
    return drawing(view, [*parts, *_loose_ends(view, lines, shape)], label)


def _grid(view: View, shape: tuple[int, ...]) -> Iterator[Part]:
    """The lines of a planar lattice."""
    a, b = np.asarray(shape) - 1
    yield from (line(view, (i, 0), (i, b), "lat", nearer=-2) for i in range(a + 1))
    yield from (line(view, (0, j), (a, j), "lat", nearer=-2) for j in range(b + 1))


def _samples(view: View, record: Mapping[str, Any]) -> Iterator[Part]:
    """A disc for each sample, hollow outside; the value beside it where there are few."""
    values = np.asarray(record["values"], np.float64)
    if not values.size:
        return
    values = values.reshape(record["shape"])
    inside = values >= record["isovalue"]
    radius = 5.5 if values.size <= LABELLED else min(3.6, 0.22 * view.scale)
    for index in np.ndindex(*values.shape):
        if not inside[index] and values.size > HOLLOW:
            continue
        yield dot(view, index, "in" if inside[index] else "out", radius, nearer=-1)
        if values.size <= LABELLED:
            yield _text(view, index, f"{values[index]:.3g}")


def _signs(view: View, record: Mapping[str, Any]) -> Iterator[Part]:
    """Beside each sample of a few the sides on which it is of both fields: + inside, − outside."""
    values = np.asarray(record["values"], np.float64)
    if not values.size or np.prod(record["shape"]) > 3 * LABELLED:
        return
    fields = values.reshape(-1, *record["shape"])
    second = fields[2].flat[0] if len(fields) == 3 else record["isovalue"]
    for index in np.ndindex(*record["shape"]):
        sides = (fields[0][index] >= record["isovalue"], fields[1][index] >= second)
        yield dot(view, index, "in" if all(sides) else "out", 2.5)
        yield _text(view, index, "".join("+" if side else "−" for side in sides))


def _text(view: View, place: Any, words: str) -> Part:
    """Words beside a place."""
    (x, y), depth = view.place(place)
    drawn = f'<text class="val" x="{x + 8:.1f}" y="{y - 7:.1f}">{words}</text>'
    return Part(float(depth) + NEAR, drawn)


def _run(view: View, points: Floats, fade: float = 0.0) -> Iterator[Part]:
    """The segments of a polyline, fainter the farther away where `fade` is the depth of it all."""
    flat, depth = view.place(points)
    for (a, b), (p, q) in zip(pairwise(flat), pairwise(depth), strict=True):
        share = min(1.0, max(0.0, 0.5 + (p + q) / 2 / fade)) if fade else 1.0
        drawn = (
            f'<line class="run" x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}"'
            f' stroke-opacity="{0.35 + 0.65 * share:.2f}"/>'
        )
        yield Part(float(p + q) / 2 + (0 if fade else NEAR / 2), drawn)


def _arrow(view: View, points: Floats) -> Iterator[Part]:
    """An arrowhead on the longest segment, in the direction of the polyline."""
    if len(points) < 2:
        return
    flat, _ = view.place(points)
    steps = np.diff(flat, axis=0)
    length = np.linalg.norm(steps, axis=1)
    at = int(length.argmax())
    if not length[at] > 0:
        return
    ahead = steps[at] / length[at] * min(6.0, 0.3 * view.scale)
    aside, tip = ahead[::-1] * (-0.6, 0.6), flat[at : at + 2].mean(axis=0) + ahead
    corners = (tip, tip - 1.8 * ahead + aside, tip - 1.8 * ahead - aside)
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    yield Part(NEAR, f'<polygon class="head" points="{text}"/>')


def _loose_ends(view: View, lines: list[Floats], shape: tuple[int, ...]) -> Iterator[Part]:
    """A red disc at each end of an open polyline that is not on the border."""
    top = np.asarray(shape) - 1
    for points in lines:
        if len(points) > 1 and (points[0] == points[-1]).all():
            continue
        for end in points[[0, -1]]:
            if min(np.abs(end).min(), np.abs(end - top).min()) > 1e-6 * top.max():
                yield dot(view, end, "spot", 3.5, nearer=NEAR)


def _sore(view: View, record: Mapping[str, Any], *, world: bool = False) -> Iterator[Part]:
    """What the judge named: a place, a square, or the step from a sample along an axis."""
    numbers = record["finding"].get("numbers", {})
    if "at" in numbers:
        place = np.asarray(numbers["at"], np.float64)
        if world:
            place = (place - record["origin"]) / np.asarray(record["spacing"])
        yield dot(view, place, "ring", 9, nearer=NEAR)
    if "square" in numbers:
        i, j = numbers["square"]
        corners, _ = view.place([(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)])
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
        yield Part(-3.0, f'<polygon class="sore" points="{text}"/>')
    if "sample" in numbers:
        start = np.asarray(numbers["sample"])
        end = start + np.eye(len(start), dtype=int)[numbers["axis"]]
        yield line(view, start, end, "gap", nearer=-1.5)
