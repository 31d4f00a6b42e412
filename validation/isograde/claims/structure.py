"""Claims on the arrays as they came, before anything is made of them (level 0, *runs*)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.claims.evidence import VERDICT_OF, answered, failed, first_row, lattice_of, passed
from isograde.model import Claim, Finding, Status, Trial, Verdict


def answers(trial: Trial) -> Finding:
    """Pass when the call came back with two arrays; else what became of it."""
    outcome = trial.plain
    if outcome.status is Status.OK and answered(outcome):
        return passed()
    return Finding(VERDICT_OF.get(outcome.status, Verdict.FAIL), outcome.detail)


def shapes(trial: Trial) -> Finding:
    """Pass when vertices are (V, 3) numbers and faces are (F, 3) whole numbers."""
    vertices, faces = _arrays(trial)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or vertices.dtype.kind not in "fiu":
        return failed(f"vertices are {vertices.dtype} of shape {vertices.shape}, not (V, 3) reals")
    if faces.ndim != 2 or faces.shape[1] != 3 or faces.dtype.kind not in "iu":
        return failed(f"faces are {faces.dtype} of shape {faces.shape}, not (F, 3) integers")
    return passed(vertices=len(vertices), faces=len(faces))


def finite(trial: Trial) -> Finding:
    """Pass when no coordinate is NaN or infinite."""
    vertices, _ = _arrays(trial)
    if vertices.dtype.kind not in "fiub":
        return failed(f"vertices are {vertices.dtype}")
    bad = ~np.isfinite(vertices)
    if not bad.any():
        return passed()
    first = int(np.argwhere(bad)[0][0])
    return failed(f"vertex {first} has a coordinate that is not finite", count=int(bad.sum()))


def in_range(trial: Trial) -> Finding:
    """Pass when every face names vertices that exist."""
    vertices, faces = _arrays(trial)
    bad = (faces < 0) | (faces >= len(vertices))
    if not bad.any():
        return passed()
    first = int(np.argwhere(bad)[0][0])
    return failed(
        f"face {first} names a vertex that does not exist; there are {len(vertices)}",
        face=first,
        count=int(bad.sum()),
    )


def no_repeated_index(trial: Trial) -> Finding:
    """Pass when no face names a vertex twice."""
    _, faces = _arrays(trial)
    if faces.ndim != 2 or faces.shape[1] != 3:
        return Finding(Verdict.NOT_RUN, "faces are no triples")
    a, b, c = faces.T
    bad = np.flatnonzero((a == b) | (b == c) | (c == a))
    if not len(bad):
        return passed()
    return failed(
        f"face {int(bad[0])} is {first_row(faces[bad])}: it names a vertex twice", count=len(bad)
    )


def no_duplicate_face(trial: Trial) -> Finding:
    """Pass when no two faces name the same three vertices, but where sheets touch at a tie."""
    _, faces = _arrays(trial)
    if faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
        return passed()
    order, same = _repeats(np.sort(faces.astype(np.int64), axis=1))
    pairs = np.stack([order[:-1][same], order[1:][same]], axis=1)
    mesh = trial.plain.mesh
    if len(pairs) and mesh is not None and mesh.vertices.shape[1] == 3:
        lattice = lattice_of(trial)
        corners = lattice.index(mesh.vertices)[faces[pairs[:, 0]]]
        pairs = pairs[~lattice.at_tie(corners.reshape(-1, 3)).reshape(-1, 3).any(axis=1)]
    if not len(pairs):
        return passed()
    one, other = sorted(int(f) for f in pairs[0])
    return failed(f"faces {one} and {other} are the same triangle", count=len(pairs))


def _repeats(rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """An order that sorts the rows, and where a sorted row equals the one before it."""
    bits = int(rows.max()).bit_length()
    if 3 * bits <= 62 and rows.min() >= 0:
        key = (rows[:, 0] << 2 * bits) | (rows[:, 1] << bits) | rows[:, 2]
        ordered = np.sort(key)
        same = ordered[1:] == ordered[:-1]
        return (np.argsort(key, kind="stable") if same.any() else key), same
    order = np.lexsort(rows.T)
    return order, (rows[order][1:] == rows[order][:-1]).all(axis=1)


def all_used(trial: Trial) -> Finding:
    """Pass when every vertex belongs to a face."""
    vertices, faces = _arrays(trial)
    used = np.zeros(len(vertices), bool)
    index = faces.reshape(-1)
    if index.dtype.kind not in "iu":
        return Finding(Verdict.NOT_RUN, "faces are no integers")
    used[index[(index >= 0) & (index < len(vertices))]] = True
    if used.all():
        return passed()
    return failed(f"vertex {int(np.argmin(used))} belongs to no face", count=int((~used).sum()))


def _arrays(trial: Trial) -> tuple[NDArray[Any], NDArray[Any]]:
    """The arrays as they came; empty ones where nothing came."""
    outcome = trial.plain
    if outcome.vertices is None or outcome.faces is None:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return outcome.vertices, outcome.faces


def _claim(name: str, rule: str, judge: Any, needs_mesh: bool = False) -> Claim:
    """A claim of this family: level 0, on the raw arrays."""
    return Claim(
        id=f"structure.{name}",
        rule=rule,
        source="isograde design: vertices (V, 3), simplices (S, 3), indices from 0",
        level=0,
        judge=judge,
        needs_mesh=needs_mesh,
    )


CLAIMS = (
    _claim("answers", "Every field gets an answer: two arrays, no error, no crash.", answers),
    _claim("shapes", "Vertices are (V, 3) reals, faces are (F, 3) integers.", shapes),
    _claim("finite", "No coordinate is NaN or infinite.", finite),
    _claim("in_range", "Every face names vertices that exist.", in_range),
    _claim("no_repeated_index", "No face names a vertex twice.", no_repeated_index),
    _claim("no_duplicate_face", "No two faces name the same three vertices.", no_duplicate_face),
    _claim("all_used", "Every vertex belongs to a face.", all_used),
)
