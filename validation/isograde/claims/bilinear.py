"""The claim of level 3: faces are connected as the bilinear interpolant connects them.

In space it is asked of the faces of cells, in the plane of the squares. A face whose saddle is
exactly on the surface may be either way, and cells with a tied corner are not judged.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.cells import ambiguous_of, follows_values, with_faces
from isograde.claims.evidence import domain_of, failed, on_mesh, passed, skipped
from isograde.model import CONTOURS, Claim, Finding, Trial
from isograde.oracles.bilinear import saddle_sign
from isograde.oracles.rows import distinct


def bilinear(trial: Trial) -> Finding:
    """Pass when every ambiguous face is connected as the bilinear interpolant connects it."""
    faces = ambiguous_of(trial)
    if not len(faces.face):
        return faces.open or skipped("no face is ambiguous")
    sign, _ = saddle_sign(faces.values, trial.isovalues[0])
    wrong = np.where(sign > 0, ~faces.joined, np.where(sign < 0, ~faces.separated, False))
    judged, bad = sign != 0, np.flatnonzero(wrong)
    counts = {
        "cells": len(distinct(faces.place[judged])[0]),
        "wrong": len(distinct(faces.place[bad])[0]),
        "faces": int(judged.sum()),
        "wrong_faces": len(bad),
        "joined": int(faces.joined.sum()),
        "separated": int(faces.separated.sum()),
        "degenerate": int((~judged).sum()),
    }
    if not judged.any():
        return skipped("the saddle of every ambiguous face is on the surface")
    if not len(bad):
        return faces.open or passed(**counts)
    first = int(bad[0])
    at, face = domain_of(trial).of_field(faces.place[first]), int(faces.face[first])
    where = f"the {'low' if face % 2 == 0 else 'high'} face of axis {face // 2} of the cell at {at}"
    return failed(
        f"{len(bad)} of {int(judged.sum())} ambiguous faces; on "
        f"{f'the square at {at}' if trial.kind == CONTOURS else where} the bilinear interpolant "
        f"{'joins' if sign[first] > 0 else 'separates'} the inside corners",
        cell=at,
        face=face,
        **counts,
    )


CLAIMS = (
    Claim(
        id="topology.bilinear",
        rule="On every ambiguous face the mesh connects what the bilinear interpolant connects.",
        source="Nielson & Hamann 1991, section 2: the asymptotic decider",
        level=3,
        judge=on_mesh(bilinear),
        kinds=with_faces,
        families=follows_values,
    ),
)
