"""Evidence lines: the smallest failed case of a claim, whole, so that it can be drawn and repeated.

They hold the samples and isovalues, what came back, what an implementation of which the claim holds
made of it, and, where the failure is between two ways to pose the case, the other way with its
answer brought back over the plain one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from isoref.field import Field, Floats, Integers

from isograde import variants
from isograde.model import Kind, Outcome
from isograde.report.lines import JSON
from isograde.report.record import finding_record

if TYPE_CHECKING:
    from isograde.runner import Evidence, Judged

# Write out the samples of a failed case up to so many numbers: two components of a shown case.
SHOWN_NUMBERS = 4400
# Write out a mesh up to so many simplices.
SHOWN_SIMPLICES = 6000


def evidence_record(
    claim: str,
    judged: Judged,
    of: str = "",
    legal: Outcome | None = None,
    variants: Sequence[str] = (),
) -> JSON:
    """The smallest failed case of a claim.

    `of` is the case it is a block of, and `legal` what an implementation that passes made of it. Of
    the claim's `variants` the one that the judge named is kept, or the only one.
    """
    evidence, finding = judged.evidence, judged.findings[claim]
    assert evidence is not None, "only a case that was kept whole can be shown"
    record: JSON = {
        "record": "evidence",
        "claim": claim,
        "case": judged.case,
        "kind": list(judged.kind),
        "of": of,
        "finding": finding_record(claim, finding),
        **_field_record(evidence.field, evidence.isovalues),
        "came": _mesh_record(evidence.outcomes["plain"], judged.kind),
    }
    if legal is not None:
        record["legal"] = _mesh_record(legal, judged.kind)
    only = variants[0] if len(variants) == 1 else ""
    posed = _posed_record(evidence, str(finding.numbers.get("variant", only)), judged.kind)
    if posed is not None:
        record["posed"] = posed
    return record


def _field_record(field: Field, isovalues: Sequence[float]) -> JSON:
    """The samples, in the array's order, and their place; of a large field only the place."""
    values = np.asarray(field.values)
    numbers = values.astype(np.uint8) if values.dtype == np.bool_ else values
    return {
        "shape": list(field.shape),
        "spacing": list(field.spacing),
        "origin": list(field.origin),
        "dtype": str(field.values.dtype),
        "isovalues": list(isovalues),
        "values": numbers.ravel().tolist() if values.size <= SHOWN_NUMBERS else [],
    }


def _posed_record(evidence: Evidence, name: str, kind: Kind) -> JSON | None:
    """A variant of the case: how it was posed, and its answer brought back to the plain field."""
    outcome = evidence.outcomes.get(name)
    if outcome is None or name == "plain":
        return None
    variant = variants.variant(name, kind)
    posed = variant.pose(evidence.field, evidence.isovalues)
    if posed is None:
        return None
    field, isovalues = posed
    record: JSON = {"variant": name, "meaning": variant.meaning, **_field_record(field, isovalues)}
    mesh = outcome.mesh_of(kind)
    if mesh is None or field.dimension != evidence.field.dimension or field.values.size == 0:
        return {**record, "came": _ended(outcome)}
    places = (mesh.vertices - np.asarray(field.origin)) / np.asarray(field.spacing)
    vertices = evidence.field.position(variant.back(places, evidence.field))
    return {**record, "came": _arrays_record(vertices, _turned(mesh.simplices, variant))}


def _turned(simplices: Integers, variant: variants.Variant) -> Integers:
    """The simplices, turned over where the variant exchanges left and right."""
    if not variant.reflects or simplices.shape[1] < 2:
        return simplices
    turned: Integers = simplices[:, [*range(simplices.shape[1] - 2), -1, -2]]
    return turned


def _mesh_record(outcome: Outcome, kind: Kind) -> JSON:
    """Vertices and simplices of an outcome, or what became of it."""
    mesh = outcome.mesh_of(kind)
    if mesh is None or len(mesh.simplices) > SHOWN_SIMPLICES:
        return _ended(outcome)
    return _arrays_record(mesh.vertices, mesh.simplices)


def _ended(outcome: Outcome) -> JSON:
    """How a call ended."""
    return {"status": outcome.status.value, "detail": outcome.detail}


def _arrays_record(vertices: Floats, simplices: Integers) -> JSON:
    """Vertices to nine digits, which is what a picture needs, and simplices."""
    return {
        "status": "ok",
        "vertices": [[float(f"{x:.9g}") for x in row] for row in vertices.tolist()],
        "simplices": simplices.tolist(),
    }
