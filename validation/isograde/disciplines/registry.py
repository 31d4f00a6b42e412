"""The disciplines by name: what is asked, what is claimed, and how a case is posed otherwise.

An implementation says in its declaration which discipline it belongs to; "surfaces" is the default.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache

from isoref.field import Field

from isograde import variants
from isograde.cases import Catalogue, all_cases
from isograde.claims import CLAIMS
from isograde.disciplines import contours, curves, simplices
from isograde.model import AdapterError, Case, Claim

Pose = Callable[[str, Case, Field], tuple[Field, float] | None]


@dataclass(frozen=True)
class Discipline:
    """A kind of thing that implementations make.

    cases : every case by id, for a seed
    claims : every claim by id
    pose : the field and the isovalue of a variant of a case; None where the values do not allow it
    layout : how samples and answers stand in files, for the manifest of an exported folder
    """

    cases: Callable[[int], Mapping[str, Case]]
    claims: Mapping[str, Claim]
    pose: Pose
    layout: Mapping[str, str]


def pose_surfaces(variant: str, case: Case, field: Field) -> tuple[Field, float] | None:
    """The variant of a case as `isograde.variants` poses it."""
    return variants.pose(variant, field, case.isovalue)


def _with_isovalue(pose: Callable[[str, Case, Field], Field]) -> Pose:
    """`pose`, where a variant changes the field and never the isovalue."""
    return lambda variant, case, field: (pose(variant, case, field), case.isovalue)


def _discipline(
    cases: Callable[[int], list[Case]],
    claims: Iterable[Claim],
    pose: Callable[[str, Case, Field], Field],
    layout: Mapping[str, str],
) -> Discipline:
    """The discipline of these, its cases listed once for each seed."""

    @cache
    def by_id(seed: int) -> Catalogue:
        return Catalogue({case.id: case for case in cases(seed)})

    return Discipline(by_id, {claim.id: claim for claim in claims}, _with_isovalue(pose), layout)


SURFACES = {
    "inside": "value >= isovalue",
    "vertices": "origin + index * spacing, coordinates in the order of the array's axes",
    "faces": "rows of three 0-based indices; right-hand normals point to lower values",
    "values": "npy in C order, last axis fastest; the nrrd's first axis is the array's first",
    "answer": "beside the values, same name: .ply .obj .off .stl, or .vertices.npy and .faces.npy",
    "no surface": "a mesh without vertices and faces; a missing file counts as unsupported",
}
DISCIPLINES: dict[str, Discipline] = {
    "surfaces": Discipline(all_cases, CLAIMS, pose_surfaces, SURFACES),
    **{
        name: _discipline(module.cases, module.CLAIMS, module.pose, module.LAYOUT)
        for name, module in (("contours", contours), ("curves", curves), ("simplices", simplices))
    },
}
ALL_CLAIMS: dict[str, Claim] = {
    name: claim for one in DISCIPLINES.values() for name, claim in one.claims.items()
}
READY_MADE: dict[str, str] = {
    **contours.READY_MADE,
    **curves.READY_MADE,
    **simplices.READY_MADE,
}


def discipline(name: str) -> Discipline:
    """The discipline of this name. Raises `AdapterError` for an unknown one."""
    if name not in DISCIPLINES:
        known = ", ".join(DISCIPLINES)
        raise AdapterError(f"no discipline {name!r}; there are {known}")
    return DISCIPLINES[name]
