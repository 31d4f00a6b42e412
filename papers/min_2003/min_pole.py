"""Figure 9: why the projected lift of the spindle is speckled at its poles.

Run it from anywhere: ``python papers/min_2003/min_pole.py``. It writes
reports/papers/min_2003/pole.md and a picture. At a pole all angles theta have one place: the
surface runs along theta there, and its projection is a point. Most triangles beside it are seen
from the side and have no area in space; eq. 6, a determinant of slopes that go to zero there, gives
them normals of any direction. A renderer that draws them, as dots, shades them by these. Left out,
they leave no speckle and no gap.
"""

from __future__ import annotations

from pathlib import Path

import min_examples as examples
import min_pictures as pictures
import numpy as np
from isograde.reproduction import write_report
from isoref.field import Booleans, Floats
from isoref.mesh import Mesh
from isoref.projection import normals, project
from isoref.simplicial import gradients, to_mesh
from reproduce import from_tree

FOLDER = Path(__file__).parents[2] / "reports" / "papers" / "min_2003"
ABOVE = (1.0, -0.55, 1.6)
SIZES = (16, 32)
# Bands of the angle from the axis, in steps of the lattice from the nearer pole.
BANDS = ((0.0, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 8.0))
FLAT, TURNED = 1e-9, 30.0


def true_normals(theta: Floats, polar: Floats) -> Floats:
    """(F, 3) unit normals of the spindle, outwards; r = 2 cos^2 phi."""
    r, slope = 2 * np.cos(polar) ** 2, -2 * np.sin(2 * polar)
    # Along phi the surface goes (r' sin + r cos) across and (r' cos - r sin) along the axis.
    across = slope * np.sin(polar) + r * np.cos(polar)
    along = slope * np.cos(polar) - r * np.sin(polar)
    normals = np.stack([-along * np.cos(theta), -along * np.sin(theta), across], axis=1)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def band_rows(N: int) -> list[str]:
    """A row a band; the picture of the largest N."""
    example = examples.lifted_spindle()
    complex_, samples = from_tree(example, N)[1], example.samples(N)
    mesh = to_mesh(complex_, tuple(example.spacing(N)), tuple(example.low))
    corners = mesh.vertices[mesh.simplices]
    middle = corners.mean(axis=1)
    a, b, c = np.moveaxis(corners[:, :, :3], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    g = gradients(complex_.parents, samples.at, samples.shape, samples.spacing)
    by_slopes = normals(g, (0, 1, 2))
    right = true_normals(middle[:, 3], middle[:, 4])
    away = np.minimum(middle[:, 4], np.pi - middle[:, 4]) / example.spacing(N)[4]
    if max(SIZES) == N:
        picture(project(mesh, (0, 1, 2)), by_slopes, area >= FLAT)
    # Most normals point one way; which way that is does not matter.
    way = np.sign(np.median((by_slopes * right).sum(axis=1)))
    rows = []
    for low, high in BANDS:
        here = (away >= low) & (away < high)
        told = [
            f"{len(own):,} | {turned(way * by_slopes[own], right[own])}"
            for own in (np.flatnonzero(here & side) for side in (area >= FLAT, area < FLAT))
        ]
        rows.append(f"| {N} | {low:g} to {high:g} | {' | '.join(told)} |")
    return rows


def turned(vectors: Floats, right: Floats) -> str:
    """The share of vectors that are more than `TURNED` degrees from the right ones."""
    if not len(vectors):
        return ""
    size = np.linalg.norm(vectors, axis=1)
    cosine = (vectors * right).sum(axis=1) / np.maximum(size, 1e-300)
    return f"{np.mean(cosine < np.cos(np.radians(TURNED))):.1%}"


def picture(mesh: Mesh, by_slopes: Floats, seen: Booleans) -> None:
    """The surface from above with every triangle, and with those that have an area."""
    less = Mesh(mesh.vertices, mesh.simplices[seen])
    images = [
        ("every triangle", pictures.render(mesh, by_slopes, ABOVE)),
        ("those with an area in space", pictures.render(less, by_slopes[seen], ABOVE)),
    ]
    pictures.gallery(FOLDER / "pole.png", images)


def report() -> str:
    """The table."""
    lines = [
        "Triangles of the lifted spindle (section 7.3) on N^5 cells, projected into space, by the "
        "steps of the angle from the axis between them and the nearer pole: those with an area in "
        f"space, and those below {FLAT:g}, which are seen from the side. Of both, how many have a "
        f"normal by eq. 6, which shades the figure, more than {TURNED:g} degrees from that of the "
        "exact surface.",
        "",
        "| N | steps from the pole | with an area | turned | without | turned |",
        "| ---: | --- | ---: | ---: | ---: | ---: |",
    ]
    for N in SIZES:
        lines += band_rows(N)
    return "\n".join([*lines, "", "![The pole from above](pole.png)"]) + "\n"


def main() -> None:
    """The page, in reports/papers of this repository."""
    path = FOLDER / "pole.md"
    opening = "Made by `papers/min_2003/min_pole.py`."
    write_report(path, "Min 2003, Figure 9: the speckle at the poles", [opening, report()])
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
