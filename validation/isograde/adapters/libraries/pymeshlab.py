"""MeshLab's filter "create implicit surface", which takes a function as a formula of x, y, z."""

import numpy as np

# The longest formula that the parser under MeshLab (muParser) takes.
LONGEST = 20_000


def surface(values, isovalue, spacing, more=2, undefined="(0/0)"):
    """The surface in samples; the lattice is said to have so many samples more along each axis."""
    import pymeshlab

    formula = lookup(values.astype(np.float64) - isovalue, undefined)
    if len(formula) > LONGEST:
        raise NotImplementedError(
            f"MeshLab takes samples only as a formula of up to {LONGEST:,} characters; "
            f"these {values.size:,} samples need {len(formula):,}"
        )
    ends = {f"max{axis}": float(n - 1 + more) for axis, n in zip("xyz", values.shape, strict=True)}
    starts = {f"min{axis}": 0.0 for axis in "xyz"}
    meshes = pymeshlab.MeshSet()
    meshes.create_implicit_surface(voxelsize=1.0, expr=formula, **starts, **ends)
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def lookup(samples, undefined, axis=0):
    """A formula of x, y, z with these values at the lattice's samples: nested bisections."""
    first = samples.flat[0]
    if samples.ndim == 0 or (samples == first).all():
        return f"{first:.9g}" if first == first else undefined
    parts = [lookup(np.asarray(part), undefined, axis + 1) for part in samples]

    def bisected(low, high):
        if high - low == 1 or len(set(parts[low:high])) == 1:
            return parts[low]
        middle = (low + high) // 2
        left, right = bisected(low, middle), bisected(middle, high)
        return f"({'xyz'[axis]}<{middle - 0.5:g}?{left}:{right})"

    return bisected(0, len(parts))


LIBRARY = {"distribution": "pymeshlab", "imports": ["pymeshlab"]}
_NOTES = "takes a formula, so small fields only; computes in float32"
METHODS = {
    "pymeshlab": {
        "function": "surface",
        "declaration": {
            "conventions": {
                "tie": "outside", "normals": "to_high", "units": "index", "nan": "answers",
            },
            "notes": _NOTES,
        },
        "does": [
            "writes the samples as a formula",
            "asks for two samples more along each axis, without which the filter leaves out the "
            "last cells",
            "writes a sample that is not a number as 0/0",
        ],
    },
    "pymeshlab:raw": {
        "function": "surface",
        "options": {"more": 0, "undefined": "nan"},
        "declaration": {
            "conventions": {"tie": "outside", "normals": "to_high", "units": "index"},
            "notes": _NOTES,
        },
        "does": ["writes the samples as a formula"],
    },
}  # fmt: skip
