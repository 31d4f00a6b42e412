"""Two algorithms laid side by side: where they differ, counted and drawn by the build."""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from isosite.evidence import PACKAGES
from isosite.modules import label_of
from isosite.prose import heading
from isosite.writing import Pages

SAMPLES = 20_000
FOLDER = "articles/pictures"


def cells(count: int, seed: int = 17) -> Any:
    """(8, count) corner values of random cells, uniform in (-1, 1)."""
    return np.random.default_rng(seed).uniform(-1, 1, (8, count))


def decided() -> dict[str, Any]:
    """How often the decider and the trilinear rule differ on random cells, and in which way.

    Both ask the faces alike, by design; what is counted is what the inside of the cell adds.
    """
    from isoref.cube import configuration
    from isoref.methods import RULES

    g = cells(SAMPLES)
    signs = (1 << np.arange(8)) @ (g >= 0)
    two = {name: RULES[name] for name in ("asymptotic-decider", "trilinear-cubes")}
    decisions = {}
    for name, rule in two.items():
        asks = np.array([rule.asks(s) for s in range(256)])[signs]
        decisions[name] = np.where(asks, rule.decisions(g), 0)
    faces = int(np.sum((decisions["trilinear-cubes"] & 63) != decisions["asymptotic-decider"] & 63))
    tunnels = decisions["trilinear-cubes"] >> 6
    active = (signs > 0) & (signs < 255)
    by_configuration: dict[int, int] = {}
    for s in signs[tunnels > 0].tolist():
        by_configuration[configuration(s)] = by_configuration.get(configuration(s), 0) + 1
    chosen = np.flatnonzero(tunnels > 0)
    # The plainest cell: fewest inside corners, then the largest least magnitude.
    best = min(
        chosen.tolist(),
        key=lambda n: (int(bin(int(signs[n])).count("1")), -float(np.abs(g[:, n]).min())),
    )
    return {
        "cells": SAMPLES,
        "active": int(active.sum()),
        "faces": faces,
        "tunnels": len(chosen),
        "configurations": sorted(by_configuration.items()),
        "cell": np.round(g[:, best], 3).tolist(),
    }


def mean_and_saddle() -> dict[str, int]:
    """How many ambiguous faces of the random cells the mean and the saddle decide differently."""
    from isoref.cube import ambiguous_faces
    from isoref.methods import RULES

    g = cells(SAMPLES)
    signs = (1 << np.arange(8)) @ (g >= 0)
    asked = np.array([sum(1 << f for f in ambiguous_faces(s)) for s in range(256)])[signs]
    saddle, mean = (
        RULES[name].decisions(g) & asked
        for name in ("asymptotic-decider", "marching-vesta-mixed-L")
    )
    count = np.array([bin(n).count("1") for n in range(64)])
    return {"faces": int(count[asked].sum()), "differ": int(count[saddle ^ mean].sum())}


def vestas() -> list[dict[str, Any]]:
    """How the two ways to the six surfaces compare on noise, triangle by triangle."""
    from isoref import METHODS, Field

    values = np.random.default_rng(8).uniform(0, 1, (12, 12, 12))
    rows = []
    for mode in ("disconnect", "connect", "mixed"):
        for resolution in "LH":
            meshes = [
                METHODS[f"{name}-{mode}-{resolution}"](Field.of(values), 0.5)
                for name in ("vesta", "marching-vesta")
            ]
            sets = [_triangles(mesh) for mesh in meshes]
            rows.append(
                {
                    "surface": f"{resolution}, {mode}",
                    "triangles": [len(mesh.simplices) for mesh in meshes],
                    "vertices": [len(mesh.vertices) for mesh in meshes],
                    "common": len(sets[0] & sets[1]),
                }
            )
    return rows


def _triangles(mesh: Any) -> set[tuple[tuple[float, ...], ...]]:
    """The triangles by their corners' places, each begun at its least corner."""
    places = [tuple(row) for row in np.round(mesh.vertices, 9).tolist()]
    found = set()
    for triangle in mesh.simplices.tolist():
        corners = [places[v] for v in triangle]
        least = corners.index(min(corners))
        found.add(tuple(corners[least:] + corners[:least]))
    return found


def numbers(pages: Pages) -> dict[str, Any]:
    """What is counted, counted again only when a module that it hangs on has changed."""
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(PACKAGES["isoref"].rglob("*.py")):
        digest.update(path.read_bytes())
    name = f"{FOLDER}/differences.json"
    known = Path(pages.folder, name)
    if known.is_file():
        kept: dict[str, Any] = json.loads(known.read_text(encoding="utf-8"))
        if kept.get("of") == digest.hexdigest():
            pages.has(name)
            return kept
    found = {
        "decided": decided(),
        "mean": mean_and_saddle(),
        "vesta": vestas(),
        "of": digest.hexdigest(),
    }
    pages.put(name, json.dumps(found))
    return found


def pair(cell: list[float]) -> bytes:
    """One cell by the decider and by the trilinear rule, as a picture."""
    from isoref import METHODS, Field
    from isoref.cube import CORNERS
    from pictures.drawing import bare, corners, panels, surface, wire

    values = np.zeros((2, 2, 2))
    for value, place in zip(cell, CORNERS, strict=True):
        values[tuple(place)] = value
    figure, axes = panels(2, 3, 3)
    for axis, name in zip(axes, ("asymptotic-decider", "trilinear-cubes"), strict=True):
        surface(axis, METHODS[name](Field.of(values), 0.0), alpha=0.9)
        wire(axis)
        corners(axis, values)
        bare(axis, (0, 0, 0), (1, 1, 1), name, view=(18, -32))
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=150, bbox_inches="tight", pad_inches=0.06)
    return data.getvalue()


def page(found: dict[str, Any]) -> str:
    """The page."""
    one, rows = found["decided"], found["vesta"]
    share = 100 * one["tunnels"] / one["active"]
    kinds = ", ".join(f"{n} of configuration {c}" for c, n in one["configurations"])
    cell = ", ".join(f"{v:g}" for v in one["cell"])
    text = heading("Where two algorithms differ", "=", "differences")
    text += (
        "Counted and drawn while this page was built, from the same rules that the articles "
        "tell.\n\n"
        + heading("The asymptotic decider and trilinear cubes", "-")
        + f":ref:`isoref.asymptotic_decider <{label_of('isoref.asymptotic_decider')}>` asks the "
        "faces of a cell, "
        f":ref:`isoref.trilinear_cubes <{label_of('isoref.trilinear_cubes')}>` asks its inside "
        "as well. On "
        f"{one['cells']:,} random cells, {one['active']:,} of them crossed, they decided "
        f"{one['faces']} faces "
        f"differently; {one['tunnels']} cells ({share:.2f} % of the crossed) have a tunnel, "
        "which the decider cannot "
        f"see: {kinds}. A random cell is far wilder than one of a scan.\n\n"
        f".. figure:: /{FOLDER}/differences.png\n   :alt: One cell by both rules\n   :class: "
        "drawn\n\n"
        f"   The plainest of these cells. Its samples, corners 0 to 7 of "
        f":ref:`isoref.cube <{label_of('isoref.cube')}>`: {cell}.\n\n"
        "The claim that tells them apart is :ref:`topology.trilinear "
        "<claim.topology.trilinear>`.\n\n"
        + heading("VESTA and marching VESTA", "-")
        + f":ref:`isoref.vesta <{label_of('isoref.vesta')}>` grows the surface from boundary "
        "faces of voxels and looks at no "
        f"cell; :ref:`isoref.marching_vesta <{label_of('isoref.marching_vesta')}>` goes from "
        "cell to cell. On one field of "
        "noise of 12 x 12 x 12 samples:\n\n"
        ".. list-table::\n   :header-rows: 1\n\n   * - surface\n     - triangles, original\n    "
        " - triangles, marching\n"
        "     - vertices, original\n     - vertices, marching\n     - triangles in common\n"
    )
    for row in rows:
        items = [row["surface"], *row["triangles"], *row["vertices"], row["common"]]
        text += "   * - " + "\n     - ".join(str(i) for i in items) + "\n"
    same = [r["surface"] for r in rows if r["common"] == max(r["triangles"]) == min(r["triangles"])]
    other = [r["surface"] for r in rows if r["surface"] not in same]
    text += "\n"
    if same:
        text += f"The same surface, triangle for triangle: {'; '.join(same)}. "
    if other:
        text += f"Not the same triangles: {'; '.join(other)}. "
    if not other:
        text += (
            "So what sets the two apart is the way, not the surface: the one needs the volume's "
            "boundary faces "
            "at once, the other two layers of samples and a table."
        )
    mean = found["mean"]
    share = 100 * mean["differ"] / mean["faces"]
    text += (
        "\n\n"
        + heading("The mean and the saddle", "-")
        + "VESTA's mixed mode joins the inside corners of an ambiguous face where the mean of "
        "its four values is "
        f"inside, the decider where the saddle is. Of {mean['faces']:,} ambiguous faces of the "
        "random cells "
        f"above, {mean['differ']:,} ({share:.1f} %) are decided differently. The claims are "
        ":ref:`cells.mean <claim.cells.mean>` and :ref:`topology.bilinear "
        "<claim.topology.bilinear>`.\n"
    )
    return text + "\n"


def write(pages: Pages) -> None:
    """Write the page and its picture."""
    found = numbers(pages)
    png = f"{FOLDER}/differences.png"
    mark = f"{FOLDER}/differences.of"
    same = Path(pages.folder, mark)
    if not (same.is_file() and same.read_text(encoding="utf-8") == found["of"] and pages.has(png)):
        pages.put(png, pair(found["decided"]["cell"]))
    pages.put(mark, found["of"])
    pages.put("articles/differences.rst", page(found))
