"""Claims on each cell by itself: what it is made of, and what was chosen where there is a choice.

Stated by family, each for what its cells are:

multilinear, labels; edges    on each face of a cell (in the plane: in each square) the mesh has one
                              of the legal systems of segments
a split; edges                in each simplex the mesh is the section of a linear function
cells                         the mesh is dual to the lattice: each part of it belongs to the
                              polygon round one crossed lattice edge
own                           not stated: its cells are not the field's

That the two cells at a face made the same choice is `topology.closed`. Cells with a tied corner are
not judged: vertices there stand on several edges at once. Cells are judged that are wholly inside
the declared domain.

Counts
------
A cell's surface of Euler characteristic X with B boundary segments and I inner vertices has

    F = B + 2 I - 2 X

triangles. So the count gives X away, and X can only be the number of polygons, P (discs), or P - 2
(a tunnel between two of them). A bubble, a missing or a doubled triangle gives another. The section
of a simplex of n + 1 corners, p of them inside, has (n-1 choose p-1) parts however it is cut.

Choices
-------
Where a face is ambiguous, its inside corners may be separated or joined. `cells.separate`,
`cells.join` and `cells.mean` say on each case whether every such face was decided in this way;
nobody need promise any of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.claims.evidence import (
    Domain,
    cells_of,
    complex_of,
    domain_of,
    failed,
    on_mesh,
    passed,
    place,
    remembered,
    skipped,
    undecided,
)
from isograde.claims.geometry import on_edges, whole_of
from isograde.declaration import Declaration
from isograde.model import CONTOURS, SURFACES, Claim, Finding, Judge, Kind, Trial
from isograde.oracles.bilinear import faces_of, saddles
from isograde.oracles.complexes import Complex
from isograde.oracles.dual import in_a_star
from isograde.oracles.split import Sections, sections
from isograde.oracles.squares import Squares, squares
from isograde.oracles.traces import FACES, Traces, segments_on

NOBODY = "no cell without a tied corner is met, or should be"
ELSEWHERE = "cells of the multilinear interpolant are judged in two and three dimensions"


# --- families and kinds -------------------------------------------------------------------------


def on_cell_edges(declared: Declaration) -> bool:
    """Vertices on lattice edges: the multilinear interpolant, or labels."""
    return declared.vertices == "edges" and declared.interpolant != "tetrahedra"


def follows_values(declared: Declaration) -> bool:
    """Vertices on lattice edges, and the multilinear interpolant."""
    return on_cell_edges(declared) and declared.interpolant == "multilinear"


def in_split(declared: Declaration) -> bool:
    """Vertices on the edges of a split."""
    return declared.vertices == "edges" and declared.interpolant == "tetrahedra"


def with_cells(declared: Declaration) -> bool:
    """Vertices on edges, or in cells of the lattice."""
    dual = declared.vertices == "cells" and declared.interpolant != "tetrahedra"
    return declared.vertices == "edges" or dual


def of_cells(kind: Kind) -> bool:
    """Hypersurfaces: the level set of one field."""
    return kind.m == 1 and kind.k >= 1


def with_faces(kind: Kind) -> bool:
    """Surfaces in space and contours in the plane, whose faces are squares."""
    return kind in (SURFACES, CONTOURS)


def squares_of(trial: Trial) -> Squares:
    """What the contours do in each square of the domain."""
    domain = domain_of(trial)
    mesh = domain.at_places
    return remembered(
        trial, "squares", lambda: squares(domain.lattice, mesh.points, mesh.simplices)
    )


def sections_of(trial: Trial) -> Sections:
    """What the mesh is in each simplex of the split."""
    domain = domain_of(trial)
    mesh = domain.at_places
    return remembered(
        trial,
        "sections",
        lambda: sections(domain.lattice, mesh.points, mesh.simplices, domain.corner),
    )


# --- legal --------------------------------------------------------------------------------------


def legal(trial: Trial) -> Finding:
    """Pass when every cell without a tied corner is legal for the family."""
    if trial.declaration.vertices == "cells":
        return _dual(trial)
    if in_split(trial.declaration):
        return _sections_legal(trial)
    if trial.kind == SURFACES:
        return _cells_legal(trial)
    if trial.kind == CONTOURS:
        return _squares_legal(trial)
    return skipped(ELSEWHERE)


def _cells_legal(trial: Trial) -> Finding:
    """The same, of the faces of cells in space."""
    traces, domain = cells_of(trial), domain_of(trial)
    spanning = _free(domain, domain.mesh, traces.spanning)
    if len(spanning):
        return _spanning(domain, spanning, "triangles span several cells")
    wrong = ~(traces.separated | traces.joined | traces.undecided)
    wrong[traces.tied] = False
    cells = np.flatnonzero(wrong.any(axis=1))
    if not len(cells):
        open_cells = np.asarray(traces.undecided.any(axis=1))
        judged = int((~traces.tied).sum())
        if not judged:
            return skipped(NOBODY)
        counts = {"cells": judged, "tied": int(traces.tied.sum())}
        return undecided(traces, open_cells) or passed(**counts)
    first = int(cells[0])
    face = int(np.argmax(wrong[first]))
    at = domain.of_field(traces.place[first])
    return failed(
        f"{len(cells)} cells; in the cell at {at} with corner signs {int(traces.signs[first]):08b} "
        f"the mesh meets the {'low' if face % 2 == 0 else 'high'} face of axis {face // 2} in "
        f"{describe(traces, first, face)}",
        cells=int((~traces.tied).sum()),
        wrong=len(cells),
        cell=at,
        signs=int(traces.signs[first]),
        face=face,
    )


def describe(traces: Traces, row: int, face: int) -> str:
    """The segments of a cell's trace on one face, by the halves its nodes stand on."""
    code = int(traces.faces[row, face])
    found = [f"{p}-{q}" for s, (p, q) in enumerate(segments_on(FACES[face])) if code >> s & 1]
    return ", ".join(found) if found else "no segment"


def _free(domain: Domain, mesh: Complex, parts: Integers) -> Floats:
    """(r, k + 1, n) those of the parts that are in the domain, without a vertex beside a tie."""
    corners = mesh.points[mesh.simplices[parts]]
    middle, last = corners.mean(axis=1), np.subtract(domain.lattice.shape, 1)
    here = ((middle >= 0) & (middle <= last)).all(axis=1)
    beside = domain.lattice.beside_tie(corners.reshape(-1, domain.lattice.n))
    kept: Floats = corners[here & ~beside.reshape(corners.shape[:2]).any(axis=1)]
    return kept


def _spanning(domain: Domain, corners: Floats, what: str) -> Finding:
    """The failure of parts, by their corners, that are in no one cell."""
    first = [place(point) for point in corners[0] + domain.corner]
    return failed(
        f"{len(corners)} {what}, the first has its vertices at {first}",
        spanning=len(corners),
        first=first,
    )


def _squares_legal(trial: Trial) -> Finding:
    """The same, of the squares of the plane."""
    found, domain = squares_of(trial), domain_of(trial)
    spanning = _free(domain, domain.at_places, found.spanning)
    if len(spanning):
        return _spanning(domain, spanning, "segments span several squares")
    judged = ~found.tied
    if not judged.any():
        return skipped(NOBODY)
    wrong = np.flatnonzero(judged & ~found.separated & ~found.joined)
    if not len(wrong):
        return passed(cells=int(judged.sum()), tied=int(found.tied.sum()))
    first = int(wrong[0])
    at = domain.of_field(found.place[first])
    return failed(
        f"{len(wrong)} squares; in the square at {at} with corner signs "
        f"{int(found.signs[first]):04b} the segments join no legal pairs of edges",
        cells=int(judged.sum()),
        wrong=len(wrong),
        cell=at,
        signs=int(found.signs[first]),
    )


def _sections_legal(trial: Trial) -> Finding:
    """The same, of the simplices of a split."""
    found, domain = sections_of(trial), domain_of(trial)
    astray = _free(domain, domain.at_places, found.astray)
    if len(astray):
        return _spanning(domain, astray, "simplices of the mesh are in no one simplex of the split")
    judged = np.asarray(~found.tied.any(axis=1))
    if not judged.any():
        return skipped(NOBODY)
    return _by_section(domain, found, judged, ~found.right, "is not the section that the signs say")


def _by_section(
    domain: Domain, found: Sections, judged: Booleans, wrong: Booleans, told: str
) -> Finding:
    """The finding on these simplices of the split."""
    bad = np.flatnonzero(judged & wrong)
    if not len(bad):
        return passed(cells=int(judged.sum()), tied=int((~judged).sum()))
    first = int(bad[0])
    corners = [domain.of_field(sample) for sample in found.corners[first]]
    return failed(
        f"{len(bad)} of {int(judged.sum())} simplices of the split; in that with corners {corners} "
        f"the mesh {told}",
        cells=int(judged.sum()),
        wrong=len(bad),
        corners=corners,
        inside=found.inside[first].tolist(),
    )


def _dual(trial: Trial) -> Finding:
    """The same, of meshes with vertices in cells: each part is round one crossed lattice edge."""
    domain = domain_of_dual(trial)
    lattice, mesh = domain.lattice, domain.mesh
    if not len(mesh.simplices):
        return skipped("there is no simplex")
    bad = _free(domain, mesh, np.flatnonzero(~in_a_star(lattice, mesh.points, mesh.simplices)))
    if not len(bad):
        return passed(simplices=len(mesh.simplices))
    return _spanning(domain, bad, "simplices are not in the cells round one crossed lattice edge")


def domain_of_dual(trial: Trial) -> Domain:
    """All samples: the mesh of a dual method ends in the border layer of cells."""
    corner = np.zeros(trial.kind.n, np.int64)
    return Domain(whole_of(trial), corner, complex_of(trial))


# --- counts -------------------------------------------------------------------------------------


def count(trial: Trial) -> Finding:
    """Pass when every cell has as many simplices as its boundary takes."""
    if in_split(trial.declaration):
        found = sections_of(trial)
        judged = ~found.tied.any(axis=1) & (found.wanted >= 0) & found.right
        if not judged.any():
            return skipped(NOBODY)
        wrong = found.parts != found.wanted
        return _by_section(domain_of(trial), found, judged, wrong, "has another number of parts")
    if trial.kind == SURFACES:
        return _triangles(trial)
    if trial.kind == CONTOURS:
        return _segments(trial)
    return skipped(ELSEWHERE)


def _segments(trial: Trial) -> Finding:
    """Pass when every square has a segment for two crossed edges, and one for an inner vertex."""
    found = squares_of(trial)
    judged = ~found.tied
    if not judged.any():
        return skipped(NOBODY)
    bad = np.flatnonzero(judged & (found.segments != found.wanted))
    if not len(bad):
        return passed(cells=int(judged.sum()), segments=int(found.segments[judged].sum()))
    first = int(bad[0])
    at = domain_of(trial).of_field(found.place[first])
    made, wanted = int(found.segments[first]), int(found.wanted[first])
    return failed(
        f"{len(bad)} squares; the one at {at} has {made} segments where it takes {wanted}",
        cells=int(judged.sum()),
        wrong=len(bad),
        cell=at,
        signs=int(found.signs[first]),
        found=made,
        wanted=wanted,
    )


def _triangles(trial: Trial) -> Finding:
    """Pass when every cell has as many triangles as discs or one tunnel on its polygons take."""
    found = cells_of(trial)
    traces = found.settled
    judged = ~traces.tied & ~traces.unjudged & (traces.separated | traces.joined).all(axis=1)
    if trial.declaration.interpolant == "multilinear":
        # Where a saddle is on the surface, an inner vertex may come to stand in the face.
        lattice = domain_of(trial).lattice
        row, _, sign, clarity = saddles(lattice, found)
        judged[row[(sign == 0) | (clarity <= lattice.reach)]] = False
    if not judged.any():
        return undecided(found, traces.unjudged) or skipped(NOBODY)
    more = traces.excess
    tunnel = (more == 4) & (traces.polygons >= 2)
    bad = np.flatnonzero(judged & (more != 0) & ~tunnel)
    if not len(bad):
        return undecided(found, traces.unjudged) or passed(
            cells=int(judged.sum()),
            tunnels=int((judged & tunnel).sum()),
            triangles=int(traces.triangles[judged].sum()),
        )
    first = int(bad[0])
    at, wanted = domain_of(trial).of_field(traces.place[first]), traces.triangles - more
    return failed(
        f"{len(bad)} cells; the one at {at} has {int(traces.triangles[first])} triangles where "
        f"{int(traces.polygons[first])} polygons of {int(traces.segments[first])} segments in all "
        f"and {int(traces.extra[first])} inner vertices take {int(wanted[first])}",
        cells=int(judged.sum()),
        wrong=len(bad),
        cell=at,
        signs=int(traces.signs[first]),
        found=int(traces.triangles[first]),
        wanted=int(wanted[first]),
    )


# --- choices ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Ambiguous:
    """The ambiguous faces that are judged: those of cells, or squares, without a tied corner.

    Attributes
    ----------
    place : (r, n) the cell, or the square, in the domain
    face : (r,) number of the face in its cell, as in `isograde.oracles.traces`; 0 in the plane
    separated, joined : (r,) what the mesh does there; both where it can be read both ways
    values : (r, 4) samples at its corners 00, 10, 01, 11
    open : a face with too many flat triangles is among those left out
    """

    place: Integers
    face: Integers
    separated: Booleans
    joined: Booleans
    values: Floats
    open: Finding | None


def ambiguous_of(trial: Trial) -> Ambiguous:
    """The ambiguous faces of the trial's cells, or squares; in space each as seen from a cell."""

    def compute() -> Ambiguous:
        if trial.kind == CONTOURS:
            found = squares_of(trial)
            on = np.flatnonzero(found.ambiguous & ~found.tied)
            return Ambiguous(
                found.place[on],
                np.zeros(len(on), np.int64),
                found.separated[on],
                found.joined[on],
                found.values[on],
                None,
            )
        traces = cells_of(trial)
        row, face, values = faces_of(domain_of(trial).lattice, traces)
        free = ~traces.tied[row] & ~traces.undecided[row, face]
        row, face, values = row[free], face[free], values[free]
        return Ambiguous(
            traces.place[row],
            face,
            traces.separated[row, face],
            traces.joined[row, face],
            values,
            undecided(traces, np.asarray(traces.undecided.any(axis=1))),
        )

    return remembered(trial, "ambiguous", compute)


Choice = Callable[[Ambiguous, float], Booleans]


def chosen(choice: Choice, told: str) -> Judge:
    """The judge that passes when every ambiguous face is decided in this way."""

    @on_mesh
    def judge(trial: Trial) -> Finding:
        """Pass when every ambiguous face is decided in this way."""
        faces = ambiguous_of(trial)
        if not len(faces.face):
            return faces.open or skipped("no face is ambiguous")
        held = choice(faces, trial.isovalues[0])
        numbers = {"faces": len(held), "held": int(held.sum())}
        bad = np.flatnonzero(~held)
        if not len(bad):
            return faces.open or passed(**numbers)
        at = domain_of(trial).of_field(faces.place[bad[0]])
        return failed(
            f"{len(bad)} of {len(held)} ambiguous faces, the first of the cell at {at}, are not "
            f"{told}",
            cell=at,
            face=int(faces.face[bad[0]]),
            **numbers,
        )

    return judge


def _separated(faces: Ambiguous, isovalue: float) -> Booleans:
    """(r,) the inside corners are separated."""
    del isovalue
    return faces.separated


def _joined(faces: Ambiguous, isovalue: float) -> Booleans:
    """(r,) the inside corners are joined."""
    del isovalue
    return faces.joined


def _by_mean(faces: Ambiguous, isovalue: float) -> Booleans:
    """(r,) joined where the mean of the samples is inside; a mean on the isovalue may be either."""
    mean = (faces.values.astype(np.float64) - isovalue).sum(axis=1)
    return np.asarray((faces.joined & (mean >= 0)) | (faces.separated & (mean <= 0)))


def _choice(
    name: str,
    rule: str,
    choice: Choice,
    told: str,
    families: Callable[[Declaration], bool] = on_cell_edges,
) -> Claim:
    """A claim of choice: beside the ladder, and promised by nobody who does not say so."""
    return Claim(
        id=f"cells.{name}",
        rule=rule,
        source="Schlei 2010, section II.C: the modes disconnect, connect and mixed",
        level=None,
        judge=chosen(choice, told),
        kinds=with_faces,
        families=families,
        promised=False,
    )


CLAIMS = (
    Claim(
        id="cells.legal",
        rule="Every cell is legal for its interpolant: on each face of a cell, or in each square, "
        "the segments separate the corners by sign, and where four edges are crossed they are one "
        "of the two pairs that do not cross; in each simplex of a split the mesh is the section "
        "that the signs say; with vertices in cells, each simplex lies in the cells round one "
        "crossed lattice edge.",
        source="Nielson & Hamann 1991, section 2 and Figure 4: both triangulations are correct; "
        "Min 2003, section 2 (sections of simplices); Gibson 1998, section 2 (surface nets)",
        level=2,
        judge=on_mesh(legal),
        kinds=of_cells,
        families=with_cells,
    ),
    Claim(
        id="cells.count",
        rule="A cell whose polygons have n nodes each has the sum of n - 2 triangles, two more for "
        "each inner vertex, and four more for a tunnel; a square has a segment for two crossed "
        "edges, and one for each inner vertex; a simplex with p of its n + 1 corners inside has "
        "(n-1 choose p-1) parts.",
        source="Euler's formula; Schlei 2010, Tables II to IV; De Loera, Rambau & Santos 2010, "
        "section 6.2 (products of simplices)",
        level=2,
        judge=on_mesh(count),
        kinds=of_cells,
        families=on_edges,
    ),
    _choice(
        "separate",
        "Every ambiguous face separates its inside corners.",
        _separated,
        "separated",
    ),
    _choice("join", "Every ambiguous face joins its inside corners.", _joined, "joined"),
    _choice(
        "mean",
        "Every ambiguous face joins its inside corners where the mean of its samples is inside, "
        "and separates them where it is outside.",
        _by_mean,
        "decided by the mean",
        follows_values,
    ),
)
