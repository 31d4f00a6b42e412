"""A failed case as a few lines of Python that show it without the grader.

The lines hold the samples, call the implementation as its own users do, and print what the claim is
about. For implementations that are no Python, and for cases too large to print, there is only the
command that grades the case again.
"""

from __future__ import annotations

from textwrap import dedent, indent
from typing import Any

import numpy as np

from isograde.report.record import Report, Summary

# Print samples up to this many.
PRINTED = 200

SKIMAGE = """
from skimage.measure import marching_cubes

vertices, faces, *_ = marching_cubes(values, isovalue, spacing=spacing, method="{method}")
"""
ISOREF = """
from isoref import extract

mesh = extract(values, isovalue, spacing, method="{method}")
vertices, faces = mesh.vertices, mesh.simplices
"""
MCUBES = """
import mcubes

vertices, faces = mcubes.marching_cubes(values, isovalue)
"""
TRIMESH = """
from trimesh.voxel.ops import matrix_to_marching_cubes

mesh = matrix_to_marching_cubes(values >= isovalue)
vertices, faces = mesh.vertices, mesh.faces
"""
LIBIGL = """
import igl

index = np.stack(np.meshgrid(*map(np.arange, values.shape), indexing="ij"), -1)
points = index.transpose(2, 1, 0, 3).reshape(-1, 3) * np.asarray(spacing)
samples = np.ascontiguousarray(values.T.ravel())
vertices, faces, *_ = igl.marching_cubes(samples, points, *values.shape, isovalue)
"""
PYTHON = """
from {module} import {function}

vertices, faces = {function}(values, isovalue, spacing)
"""

CALLS = {
    "skimage": SKIMAGE,
    "isoref": ISOREF,
    "pymcubes": MCUBES,
    "mcubes": MCUBES,
    "libigl": LIBIGL,
}

SHOW_OPEN = """
# Edges that one triangle has and no other: a closed surface has none inside the volume.
edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
ends, uses = np.unique(edges, axis=0, return_counts=True)
for edge in vertices[ends[uses == 1]]:
    print("open edge from", edge[0], "to", edge[1])
"""
SHOW_CROWDED = """
# Edges that more than two triangles share.
edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
ends, uses = np.unique(edges, axis=0, return_counts=True)
print(vertices[ends[uses > 2]])
"""
SHOW_TWICE = """
# Triangles that are there more than once.
triangles, count = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
print(triangles[count > 1])
"""
SHOW_UNUSED = """
# Vertices that no triangle uses.
print(np.setdiff1d(np.arange(len(vertices)), faces))
"""
SHOW_ALL = """
print(vertices)
print(faces)
"""
SHOWS = {
    "topology.closed": SHOW_OPEN,
    "topology.edge_manifold": SHOW_CROWDED,
    "structure.no_duplicate_face": SHOW_TWICE,
    "structure.all_used": SHOW_UNUSED,
}


def snippet(report: Report, summary: Summary) -> str | None:
    """The lines that show the claim's smallest failed case, or None where there are none."""
    record, failure = report.evidence.get(summary.id), summary.failure
    call = calling(report.spec)
    if record is None or failure is None or call is None or len(record["values"]) > PRINTED:
        return None
    show = SHOWS.get(summary.id, SHOW_ALL)
    return "\n".join([*_samples(record), call.strip(), "", show.strip()]) + "\n"


def calling(spec: str) -> str | None:
    """The lines that call an implementation as its users do; None where there is no such way."""
    kind, _, rest = spec.partition(":")
    if kind == "python":
        module, _, function = rest.rpartition(":")
        return PYTHON.format(module=module, function=function) if "/" not in module else None
    return CALLS[kind].format(method=rest) if kind in CALLS else None


def _samples(record: dict[str, Any]) -> list[str]:
    """The lines that make `values`, `isovalue` and `spacing`."""
    values = np.asarray(record["values"], record["dtype"]).reshape(record["shape"])
    printed = np.array2string(values, separator=", ", threshold=PRINTED + 1, floatmode="unique")
    dtype = f', dtype="{record["dtype"]}"' if record["dtype"] != "float64" else ""
    return [
        "import numpy as np",
        "",
        f"values = np.array({indent(dedent(printed), ' ' * 18).strip()}{dtype})",
        f"isovalue, spacing = {record['isovalue']}, {tuple(record['spacing'])}",
        "",
    ]
