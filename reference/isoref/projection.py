r"""Projections of isosurfaces, and the normals of what is seen.

An isosurface of dimension k = n - m is drawn by dropping coordinates until k + 1 are left. There
it is a hypersurface, a curve in the plane or a surface in space, and light needs its normals. The
projection of a tangent vector is tangent to the projection; a vector that is normal to the
isosurface *and* has no component along the dropped axes is therefore normal to both. Such a
vector is a combination of the m gradients, and the m - 1 conditions leave one up to a factor::

              | g_1   g_1 . e_a  ..  g_1 . e_z |
    n  =      |  :        :              :     |      a .. z the dropped axes          (6)
              | g_m   g_m . e_a  ..  g_m . e_z |

The first column holds vectors: the determinant is meant to be expanded along it. Dotted with a
dropped axis it has two equal columns and vanishes, as it should.

Glossary
--------
n, m, k     dimension of the lattice, number of components, k = n - m
g_i         gradient of component i of the simplicial interpolant (`isoref.simplicial.gradients`)
kept        the k + 1 axes that are left; dropped: the m - 1 others, in increasing order

Invariants
----------
n is linear in each gradient, so its length means nothing, but its zeros do: n = 0 exactly where a
direction tangent to the isosurface is dropped whole, that is on folds and silhouettes, and on
simplices that are seen edge-on. For m = 1 nothing is dropped and n is the gradient.

Sign: the right-hand normal of a projected simplex of an oriented mesh, w with
w . x = det(x, t_1, .., t_k) for its projected edges t, is `side(n, kept)` times a positive
multiple of n. For k = 2 and the first three axes kept that is (-1)^m. On either sheet of a fold
the normal keeps this side with respect to the orientation of the isosurface, so it may point away
from the eye or towards it: shade with its absolute cosine.

Misprints
---------
Section 5 projects to R^(n-m+2), but drops the axes n-m+2 .. n, so that R^(n-m+1) is left, as its
example from R^5 to R^3 has it. Its expansion gives the last term the sign (-1)^m; the cofactor
has (-1)^(m+1), and so has the example.

References
----------
1. C. Min, 2003: section 5, equations 5 and 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import FieldError, Floats
from isoref.mesh import Mesh


def project(mesh: Mesh, kept: Sequence[int]) -> Mesh:
    """The same simplices with the kept coordinates of their vertices only (equation 5).

    Raises
    ------
    FieldError
        for an axis that the mesh has not, or one that is named twice.

    >>> project(Mesh.of([[1, 2, 3], [4, 5, 6]], [[0, 1]]), (0, 2)).vertices.tolist()
    [[1.0, 3.0], [4.0, 6.0]]
    """
    check_axes(mesh.vertices.shape[1], kept)
    return Mesh(mesh.vertices[:, list(kept)], mesh.simplices)


def normals(gradients: ArrayLike, kept: Sequence[int]) -> Floats:
    """The normals of the projection to the kept axes, (.., k+1), by cofactors (equation 6).

    Parameters
    ----------
    gradients : (.., m, n) gradients of the m components
    kept : k + 1 = n - m + 1 axes

    Raises
    ------
    FieldError
        for a wrong number of axes.

    >>> normals([[1.0, 2.0, 3.0]], (0, 1, 2)).tolist()
    [1.0, 2.0, 3.0]
    """
    # Check that the projection is a hypersurface.
    g = np.asarray(gradients, np.float64)
    m, n = g.shape[-2:]
    check_axes(n, kept)
    if len(kept) != n - m + 1:
        raise FieldError(
            f"{len(kept)} axes kept of {n} with {m} components; {n - m + 1} make the projection "
            "a hypersurface"
        )

    # Expand by the cofactors of the dropped axes.
    dropped = g[..., dropped_axes(n, kept)]
    shown = g[..., list(kept)]
    total = np.zeros_like(shown[..., 0, :])
    for i in range(m):
        cofactor = (-1) ** i * np.linalg.det(np.delete(dropped, i, axis=-2))
        total += cofactor[..., None] * shown[..., i, :]
    return total


def side(n: int, kept: Sequence[int]) -> int:
    """+1 where `normals` points as the right-hand normals of the projected mesh do, else -1.

    >>> side(3, (0, 1, 2)), side(5, (0, 1, 2)), side(4, (0, 1, 2))
    (-1, -1, 1)
    """
    k = len(kept) - 1
    m = n - k
    order = [*kept, *dropped_axes(n, kept)]
    swaps = sum(a > b for a, b in combinations(order, 2))
    return int((-1) ** (m + k * (m - 1) + swaps))


def dropped_axes(n: int, kept: Sequence[int]) -> list[int]:
    """The axes that are not kept.

    >>> dropped_axes(5, (0, 1, 4))
    [2, 3]
    """
    return [axis for axis in range(n) if axis not in kept]


def check_axes(n: int, kept: Sequence[int]) -> None:
    """Raise FieldError unless `kept` are distinct axes of R^n."""
    if len(set(kept)) != len(kept) or not all(0 <= axis < n for axis in kept):
        raise FieldError(f"axes {tuple(kept)} are not distinct axes of R^{n}")
