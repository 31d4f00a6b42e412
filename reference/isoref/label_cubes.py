"""Surfaces of labels: what a method draws that sees only inside and outside.

A segmentation has no values to interpolate: a voxel belongs to the object or it does not. The
surface between the two kinds crosses each lattice edge in its middle, for want of anything better
to go by, and consists of a few kinds of flat pieces, inclined by multiples of 45 degrees and the
angle of a cube's diagonal. Give a sample inside the value 1 and a sample outside -1, and every rule
of the cube draws such a surface. What the rule must not do is to compare values on an ambiguous
face: all of them are alike. VESTA's global modes compare none, and `disconnect` separates the
voxels that touch along an edge only, as the label filters in use do.

Glossary
--------
label       1 where value >= isovalue, else -1

Invariants
----------
A function of the labels alone: no monotonic change of the values changes the mesh. There are no
ties. Closed away from the border, oriented and a manifold, as the rule is. The mean distance from
the surface of a smooth body does not fall when the lattice is refined as it does with values: it
stays in proportion to the spacing.

References
----------
[1] G. T. Herman, H. K. Liu, "Three-dimensional display of human organs from computed tomograms",
    Computer Graphics and Image Processing 9, 1979: cuberilles, the boundary faces of voxels.
[2] B. R. Schlei, "Volume-enclosing surface extraction", 2010, section II.F: the rule.
"""

from __future__ import annotations

import numpy as np

from isoref import marching_vesta
from isoref.fast.sweep import sweep
from isoref.field import Field, FieldError, check_isovalue, inside_samples
from isoref.mesh import Mesh

RULE = marching_vesta.rule("disconnect", "L")


def labels(field: Field, isovalue: float) -> Field:
    """The field of labels: 1 inside, -1 outside, on the same lattice.

    >>> labels(Field.of([0.2, 7.0]), 0.5).values.tolist()
    [-1, 1]
    """
    inside = inside_samples(field, check_isovalue(isovalue))
    return field.with_values(np.where(inside, 1, -1).astype(np.int8))


def one_label(field: Field, number: float) -> Field:
    """The field of one of many labels: 1 where a sample is this number, -1 elsewhere.

    Raises
    ------
    FieldError
        where no sample is, with the numbers that there are.

    >>> one_label(Field.of([0, 3, 5]), 3).values.tolist()
    [-1, 1, -1]
    """
    there = field.values == number
    if not there.any():
        known = np.unique(field.values)
        listed = ", ".join(f"{label:g}" for label in known[:20]) + (
            ", .." if len(known) > 20 else ""
        )
        raise FieldError(f"no sample has the label {number:g}; there are {listed}")
    return field.with_values(np.where(there, 1, -1).astype(np.int8))


def surface(field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The surface of the labels, in triangles, its normals from inside to outside.

    Raises
    ------
    FieldError
        for a field that is not a scalar volume, or an isovalue that is no finite number.

    >>> surface(Field.of([[[9, 0], [0, 0]], [[0, 0], [0, 0]]]), 1).vertices.tolist()
    [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]
    """
    mesh = sweep(RULE, labels(field, isovalue), 0.0, provenance=provenance)
    return mesh.drawn_of(field)
