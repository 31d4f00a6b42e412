"""A failed case as the small data from which a page's viewer turns it; `viewer.js` draws them.

A page holds one static picture for each answer (`picture`), and beside them, once a failure, a JSON
object: the samples as they are, so that they can be copied, and the answers in index coordinates,
rounded to what a picture shows. Of a large mesh the simplices nearest to the fault are kept, so
that a page of reports stays small::

    name, reason             the case's id, and the finding in words
    shape, values, dtype     the samples in the array's order; no values of a large field
    inside                   for each sample, 1 where it is inside every component
    isovalues, spacing, origin
    answers                  caption, points, rows (simplices), left_out, marks
    explorer                 the link that opens the case in the explorer, without the values,
                             or nothing where the explorer cannot show it

A mark is a kind with one point, the two ends of a segment or a triangle. Kinds are the classes of
the static picture (gap, spot, crowd, rim, ring, sore-line, level), and three more: `twice` a
simplex that is there more than once, `flat` one without area, `unused` a vertex of no simplex.
"""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Floats, Integers

from isograde.report.lines import JSON
from isograde.report.picture import Scene, facet_marks, fault_marks

# Keep so many simplices of an answer, and mark so many things of one kind.
KEPT, MARKED = 300, 60
# Write out the samples of fields up to so many, as pictures draw them.
SAMPLES = 400
# A picture is 360 units wide: in a lattice of up to 36 samples a side this is below a tenth of one.
DECIMALS = 3
# The explorer stands beside the pages, under this name, and shows so many samples at most.
EXPLORER, OPENED = "explorer.html", 1331
LEADS = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Explorer</title></head>
<body><p>The explorer is <a href="{away}">kept once</a> in this repository.</p>
<script>location.replace("{away}" + location.search + location.hash);</script></body></html>
"""
# JSON's readers keep integers up to here.
EXACT = 2**53

Mark = list[Any]


def turned_case(record: JSON | None, answers: list[tuple[str, JSON]], tie: str) -> JSON | None:
    """What the viewer needs of an evidence record; None where there is nothing to see or copy.

    `answers` are the meshes that the static pictures show, with their captions, what came first.
    """
    if record is None or not (record["values"] or answers):
        return None
    values = record["values"] if len(record["values"]) <= 11 * SAMPLES else []
    scenes = [Scene.of(record, mesh, tie) for _, mesh in answers]
    space = len(record["shape"]) == 3
    inside = scenes[0].inside.all(axis=0) if scenes and values else np.empty(0)
    return {
        "name": record["case"],
        "reason": record["finding"]["detail"],
        "shape": record["shape"],
        "values": [_plain(value) for value in values],
        "inside": inside.ravel().astype(int).tolist() if space else [],
        "isovalues": [_plain(value) for value in record["isovalues"]],
        "spacing": record["spacing"],
        "origin": record["origin"],
        "dtype": record["dtype"],
        "answers": [
            _answer(caption, scene, n == 0)
            for n, ((caption, _), scene) in enumerate(zip(answers, scenes, strict=True))
            if space
        ],
        "explorer": _opened(record, values),
    }


def explorer() -> Path | None:
    """The explorer's page: with the package where that is installed, else where it is built."""
    package = Path(str(resources.files("isograde")))
    places = (package / "report" / EXPLORER, package.parents[1] / "docs" / "explorer" / EXPLORER)
    return next((place for place in places if place.is_file()), None)


def beside(folder: Path) -> str:
    """What stands as the explorer beside the pages of a folder.

    Within the repository that the explorer is kept in, a page that leads to it, with the case that
    was asked for; anywhere else the explorer itself.
    """
    shown = explorer()
    assert shown is not None
    root = Path(str(resources.files("isograde"))).parents[1]
    place = folder.resolve()
    if not (shown.is_relative_to(root / "docs") and place.is_relative_to(root)):
        return shown.read_text(encoding="utf-8")
    away = os.path.relpath(shown, place).replace(os.sep, "/")
    return LEADS.format(away=away)


def _opened(record: JSON, values: list[Any]) -> str:
    """The link to the case in the explorer, to which a page adds the values; or nothing.

    It shows one component of finite numbers, in a plane, in space, or on a cell of four dimensions.

    >>> record = {"shape": [2, 2, 2], "isovalues": [0.5]}
    >>> _opened(record, [0.0] * 8) if explorer() else "explorer.html#tab=cell&n=2,2,2&i=0.5"
    'explorer.html#tab=cell&n=2,2,2&i=0.5'
    >>> _opened(record, [math.nan] * 8)
    ''
    """
    shape = tuple(record["shape"])
    finite = all(map(math.isfinite, [*values, *record["isovalues"]]))
    known = {(2, 2, 2): "cell", (3, 2, 2): "pair", (2, 2, 2, 2): "four"}
    tab = known.get(shape) or {2: "plane", 3: "field"}.get(len(shape))
    shown = values and finite and tab and len(record["isovalues"]) == 1 and min(shape) > 1
    if not shown or len(values) > OPENED or explorer() is None:
        return ""
    return f"{EXPLORER}#tab={tab}&n={','.join(map(str, shape))}&i={record['isovalues'][0]}"


def _plain(value: Any) -> Any:
    """A number as JSON and its readers in browsers hold it; as text where they would not.

    >>> _plain(0.5), _plain(float("nan")), _plain(-math.inf), _plain(2**64 - 1)
    (0.5, 'NaN', '-Infinity', '18446744073709551615')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        return value if abs(value) <= EXACT else str(value)
    if math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else f"{'-' if value < 0 else ''}Infinity"


def _answer(caption: str, scene: Scene, accused: bool) -> JSON:
    """One answer, with its marks; what a finding names is marked in what the accused made."""
    rows = _nearest(scene)
    used, renumbered = np.unique(rows, return_inverse=True)
    points = scene.points[used] if len(rows) else np.empty((0, scene.n))
    return {
        "caption": caption,
        "points": [round(x, DECIMALS) for x in points.ravel().tolist()],
        "rows": renumbered.reshape(rows.shape).tolist(),
        "left_out": len(scene.simplices) - len(rows),
        "marks": _few(_marks(scene, rows, accused)),
    }


def _nearest(scene: Scene) -> Integers:
    """The simplices that are kept: all of a few, else those nearest to the fault."""
    rows = scene.simplices[np.isfinite(scene.points[scene.simplices]).all(axis=(1, 2))]
    if len(rows) <= KEPT:
        return rows
    marks = [points for _, points, _ in fault_marks(scene)]
    middle = (np.asarray(scene.shape) - 1) / 2
    place = np.concatenate(marks).mean(axis=0) if marks else middle
    away = np.abs(scene.points[rows].mean(axis=1) - place).max(axis=1)
    return rows[np.sort(np.argsort(away, kind="stable")[:KEPT])]


def _few(marks: Iterable[Mark]) -> list[Mark]:
    """The marks, at most `MARKED` of a kind, all numbers finite."""
    kept: list[Mark] = []
    count: Counter[str] = Counter()
    for kind, *where in marks:
        if count[kind] < MARKED and np.isfinite(where).all():
            count[kind] += 1
            kept.append([kind, *(round(float(x), DECIMALS) for x in where)])
    return kept


def _marks(scene: Scene, rows: Integers, accused: bool) -> Iterator[Mark]:
    """What the static picture marks; in what came also what is never right."""
    for kind, place in facet_marks(scene, rows):
        yield ["spot" if kind == "gap" and len(place) == 1 else kind, *place.ravel()]
    if accused:
        for kind, points, _ in fault_marks(scene):
            yield [kind, *points.ravel()]
        yield from _never_right(scene, rows)


def _never_right(scene: Scene, rows: Integers) -> Iterator[Mark]:
    """Of these triangles those that are there twice or without area; vertices of no simplex."""
    if scene.k == 2 and len(rows):
        corners = scene.points[rows]
        _, first, uses = np.unique(
            np.sort(rows, axis=1), axis=0, return_index=True, return_counts=True
        )
        for n in first[uses > 1]:
            yield from _outline("twice", corners[n])
        area = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        for n in np.flatnonzero(area == 0):
            yield from _outline("flat", corners[n])
    for n in np.setdiff1d(np.arange(len(scene.points)), scene.simplices):
        yield ["unused", *scene.points[n]]


def _outline(kind: str, points: Floats) -> Iterator[Mark]:
    """A point as a ring, two as a segment, more as a closed line."""
    if len(points) == 1:
        yield ["ring", *points[0]]
    for a, b in pairwise([*points, points[0]][: len(points) + (len(points) > 2)]):
        yield [kind, *a, *b]
