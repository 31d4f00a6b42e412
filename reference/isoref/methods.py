"""The catalogue: every extractor of surfaces from volumes, by name.

A method is a function of a scalar `Field` on a 3-D lattice and an isovalue, and returns a `Mesh`
of triangles. `extract` is the same for whoever has an array and a name.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import ArrayLike

from isoref import (
    asymptotic_decider,
    dual_marching_cubes,
    label_cubes,
    lorensen_cline,
    marching_tetrahedra,
    marching_vesta,
    surface_nets,
    trilinear_cubes,
)
from isoref.attributes import cells_of_samples, filled, without_cells
from isoref.capping import capped
from isoref.dual import DualRule
from isoref.fast import dual
from isoref.fast import marching_tetrahedra as tetrahedra
from isoref.fast.sweep import sweep
from isoref.fast.vesta import vesta
from isoref.field import Array, Booleans, Field, FieldError, check_isovalue
from isoref.marching_tetrahedra import Split
from isoref.mesh import Mesh, Precision, Provenance, in_space, number_types
from isoref.rule import Rule
from isoref.sweep import check_volume
from isoref.ties import separated
from isoref.vesta import SIX_SURFACES


class Method(Protocol):
    """A function of a scalar field on a 3-D lattice and an isovalue.

    With `provenance` its mesh says where vertices and triangles come from.
    """

    def __call__(self, field: Field, isovalue: float, *, provenance: bool = False) -> Mesh:
        """The isosurface in triangles."""
        ...


RULES: dict[str, Rule] = {
    rule.name: rule
    for rule in (
        lorensen_cline.RULE,
        asymptotic_decider.RULE,
        *marching_vesta.RULES,
        trilinear_cubes.RULE,
    )
}

METHODS: dict[str, Method] = {name: partial(sweep, rule) for name, rule in RULES.items()}
METHODS |= {
    f"vesta-{mode}-{resolution}": partial(vesta, mode=mode, resolution=resolution)
    for mode, resolution in SIX_SURFACES
}

DUAL_RULES: dict[str, DualRule] = {
    rule.name: rule for rule in (surface_nets.RULE, dual_marching_cubes.RULE)
}
METHODS |= {name: partial(dual.surface, rule) for name, rule in DUAL_RULES.items()}
METHODS |= {"label-cubes": label_cubes.surface}

SPLITS: dict[str, Split] = {
    f"marching-tetrahedra-{split.name}": split
    for split in (marching_tetrahedra.KUHN, marching_tetrahedra.FIVE)
}
METHODS |= {name: partial(tetrahedra.surface, split) for name, split in SPLITS.items()}


@in_space
def _simplicial(field: Field, isovalue: float, *, provenance: bool = False) -> Mesh:
    """Min's surface of a volume, empty where the lattice has no cells."""
    from isoref.fast import simplicial  # Here, since SciPy takes a second to import.

    check_volume(field)
    if min(field.shape) < 2:
        check_isovalue(isovalue)
        none = Provenance.empty(field) if provenance else None
        return replace(Mesh.empty(3, 2), provenance=none)
    return simplicial.extract(field, isovalue, provenance=provenance)


METHODS |= {"simplicial": _simplicial}


def surface(
    field: Field,
    isovalue: float,
    method: str = "asymptotic-decider",
    *,
    precision: Precision = "double",
    cap: bool = False,
    absent: Booleans | None = None,
    nearness: float = 0,
    provenance: bool = False,
) -> Mesh:
    """The isosurface of a field, by the method of this name; parameters are those of `extract`.

    `absent` marks samples (N1, N2, N3) whose numbers do not count, as `attributes.filled` gives it.
    """
    if method not in METHODS:
        raise ValueError(f"no method {method!r}; there are {', '.join(sorted(METHODS))}")
    number_types(precision)
    traced = provenance or (absent is not None and not cap) or nearness != 0
    if cap:
        mesh = capped(METHODS[method], field, isovalue, traced, absent)
    elif method in RULES:
        mesh = sweep(RULES[method], field, isovalue, precision, traced)
    else:
        mesh = METHODS[method](field, isovalue, provenance=traced)
    if absent is not None and not cap:
        mesh = without_cells(mesh, cells_of_samples(absent))
    if nearness != 0:
        mesh = separated(mesh, nearness).mesh
    if traced and not provenance:
        mesh = Mesh(mesh.vertices, mesh.simplices)
    return mesh.in_precision(precision)


@overload
def extract(
    values: ArrayLike,
    isovalue: float,
    spacing: float | Sequence[float] | None = ...,
    origin: Sequence[float] | None = ...,
    method: str = ...,
    precision: Precision = ...,
    *,
    directions: ArrayLike | None = ...,
    cap: bool = ...,
    absent: bool | ArrayLike = ...,
    nearness: float = ...,
    provenance: bool = ...,
) -> Mesh: ...


@overload
def extract(
    values: ArrayLike,
    isovalue: Sequence[float],
    spacing: float | Sequence[float] | None = ...,
    origin: Sequence[float] | None = ...,
    method: str = ...,
    precision: Precision = ...,
    *,
    directions: ArrayLike | None = ...,
    cap: bool = ...,
    absent: bool | ArrayLike = ...,
    nearness: float = ...,
    provenance: bool = ...,
) -> list[Mesh]: ...


def extract(
    values: ArrayLike,
    isovalue: float | Sequence[float],
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    method: str = "asymptotic-decider",
    precision: Precision = "double",
    *,
    directions: ArrayLike | None = None,
    cap: bool = False,
    absent: bool | ArrayLike = False,
    nearness: float = 0,
    provenance: bool = False,
) -> Mesh | list[Mesh]:
    """The isosurface of an array, by the method of this name; one for each of several isovalues.

    Parameters
    ----------
    values : (N1, N2, N3) real numbers; a `numpy.memmap` is read plane by plane by cube rules
    isovalue : in the unit of the values; several give a list of meshes
    spacing, origin, directions : of the lattice, as of `Field.of`
    method : a name of `METHODS`
    precision : of the mesh; "double" is float64 and int64, "single" float32 and int32, as most
        libraries give, in half the memory
    cap : close the surface on the border of the volume and beside absent samples, where it may
        leave triangles without area to stay a manifold (`isoref.capping`)
    absent : samples that do not count: True for those that are not finite, or masked in a masked
        array; or (N1, N2, N3) booleans, True where a sample is absent. No surface is drawn in a
        cell with an absent corner, and it has a boundary there, or with `cap` what closes it. By
        default such samples are an error
    nearness : of crossings to samples, in parts of a lattice edge, at most 1/4. Nearer ones become
        one vertex at the sample where the surface stays a manifold by it, and elsewhere move off
        it, so that no triangle between them is without area (`isoref.ties`). By default, 0,
        everything stays where it is, ties too
    provenance : also say of each vertex on which edge it lies, and of each triangle in which cell
        (`isoref.mesh.Provenance`); what can be made of it is in `isoref.attributes`

    Raises
    ------
    ValueError
        for a method that is not in the catalogue
    FieldError
        for an array that is no field, an isovalue that is no number, or an unknown precision

    >>> extract([[[1, 0], [0, 0]], [[0, 0], [0, 0]]], 0.5)
    Mesh(3 vertices in R^3, 1 simplices of dimension 2)
    >>> extract([[[1, 0], [0, 0]], [[0, 0], [0, 0]]], [0.5, 2])
    [Mesh(3 vertices in R^3, 1 simplices of dimension 2), Mesh(0 vertices in R^3, 0 simplices of \
dimension 2)]
    """
    samples, gone = (values, None) if absent is False else filled(values, absent)
    field = Field.of(samples, spacing, origin, directions=directions)

    def at(level: Any) -> Mesh:
        return surface(
            field,
            level,
            method,
            precision=precision,
            cap=cap,
            absent=gone,
            nearness=nearness,
            provenance=provenance,
        )

    if isinstance(isovalue, Sequence | np.ndarray) and np.ndim(isovalue) > 0:
        return [at(level) for level in isovalue]
    return at(isovalue)


def extract_frames(
    values: ArrayLike,
    isovalue: float | Sequence[float],
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    method: str = "asymptotic-decider",
    precision: Precision = "double",
    *,
    directions: ArrayLike | None = None,
    cap: bool = False,
    absent: bool = False,
    nearness: float = 0,
    provenance: bool = False,
) -> Iterator[Mesh | list[Mesh]]:
    """The isosurfaces of a time series, one after the other: what `extract` gives of each frame.

    A frame is read when its mesh is asked for, so a series in a file (`numpy.memmap`) may be larger
    than the memory, and no mesh is kept.

    Parameters
    ----------
    values : (T, N1, N2, N3), T frames on one lattice
    spacing, origin, directions : of the lattice in space; time has none
    isovalue, and all others : as of `extract`

    Raises
    ------
    ValueError, FieldError
        as `extract`; of samples when their frame is asked for, with its number.

    >>> ball = 9 - ((np.indices((9, 9, 9)) - 4.0) ** 2).sum(axis=0)
    >>> [len(mesh.simplices) for mesh in extract_frames(np.stack([ball, ball + 5, -ball]), 0.0)]
    [344, 536, 296]
    """
    if not isinstance(values, np.ndarray):
        values = np.asarray(values)
    if values.ndim != 4:
        raise FieldError(
            f"an array of shape {values.shape} is no time series, which has four axes, time first"
        )
    if method not in METHODS:
        raise ValueError(f"no method {method!r}; there are {', '.join(sorted(METHODS))}")
    options: dict[str, Any] = {"directions": directions, "cap": cap, "absent": absent}
    options |= {"nearness": nearness, "provenance": provenance}

    def meshes(frames: Array) -> Iterator[Mesh | list[Mesh]]:
        for number, frame in enumerate(frames):
            try:
                yield extract(frame, isovalue, spacing, origin, method, precision, **options)
            except FieldError as error:
                raise FieldError(f"frame {number}: {error}") from error

    return meshes(values)
