"""What is right for simplices of any dimension; pure functions of a mesh and of what is known."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.mesh import Mesh
from numpy.typing import NDArray

from isograde.claims.evidence import failed, passed
from isograde.model import Finding, Outcome, Verdict
from isograde.oracles import simplices as oracle
from isograde.oracles.known_manifolds import Manifold

# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6
# The error of linear interpolation falls as h^2; two sizes do not show the order exactly.
LEAST_ORDER = 1.4


def well_formed(outcome: Outcome, n: int, m: int) -> Finding:
    """Vertices are finite (V, n) numbers, simplices (S, n - m + 1) indices in range."""
    vertices, simplices = outcome.vertices, outcome.faces
    if vertices is None or simplices is None:
        return failed("no arrays came back")
    if vertices.ndim != 2 or vertices.shape[1] != n or vertices.dtype.kind not in "fiu":
        return failed(f"vertices are {vertices.dtype} {vertices.shape}, not numbers (V, {n})")
    if simplices.ndim != 2 or simplices.shape[1] != n - m + 1 or simplices.dtype.kind not in "iu":
        return failed(
            f"simplices are {simplices.dtype} {simplices.shape}, not integers (S, {n - m + 1})"
        )
    if not np.isfinite(vertices).all():
        return failed("a vertex is not finite")
    if simplices.size and not (0 <= simplices.min() and simplices.max() < len(vertices)):
        return failed(f"indices reach from {simplices.min()} to {simplices.max()}")
    return passed(vertices=len(vertices), simplices=len(simplices))


def nothing(mesh: Mesh) -> Finding:
    """There is no simplex."""
    count = len(mesh.simplices)
    return failed(f"{count} simplices where there are no zeros") if count else passed()


def closed(mesh: Mesh, box: Any) -> Finding:
    """No open facet is left over when those of two cuts of one face are set aside."""
    rows = oracle.open_facets(mesh.vertices, mesh.simplices, box)
    holes = rows[~oracle.covered(mesh.vertices, rows)]
    if len(holes):
        place = mesh.vertices[holes[0]].mean(axis=0).round(6).tolist()
        return failed(f"{len(holes)} facets have a simplex on one side only", at=place)
    return passed()


def conforming(mesh: Mesh, box: Any) -> Finding:
    """No face is cut one way by one simplex and another way by its neighbour."""
    rows = oracle.open_facets(mesh.vertices, mesh.simplices, box)
    doubled = rows[oracle.covered(mesh.vertices, rows)]
    if len(doubled):
        place = mesh.vertices[doubled[0]].mean(axis=0).round(6).tolist()
        return failed(f"{len(doubled)} facets lie on facets of another cut", at=place)
    return passed()


def manifold(mesh: Mesh) -> Finding:
    """No facet belongs to more than two simplices."""
    worst = int(oracle.facets(mesh.simplices).owners.max(initial=0))
    return failed(f"a facet belongs to {worst} simplices") if worst > 2 else passed()


def oriented(mesh: Mesh) -> Finding:
    """The two simplices on a facet give it opposite orientations."""
    found = oracle.facets(mesh.simplices)
    wrong = int(((found.owners == 2) & (found.balance != 0)).sum())
    return failed(f"{wrong} facets between simplices that disagree") if wrong else passed()


def side(mesh: Mesh, known: Manifold) -> Finding:
    """det(-g_1, .., -g_m, t_1, .., t_k) > 0 on every simplex that is not nearly flat."""
    if not len(mesh.simplices):
        return Finding(Verdict.NOT_RUN, "there is no simplex to look at")
    place = mesh.vertices[mesh.simplices]
    frame = np.concatenate([-known.gradients(place.mean(axis=1)), np.diff(place, axis=1)], axis=1)
    determinants = np.linalg.det(frame)
    size = oracle.measures(mesh.vertices, mesh.simplices)
    clear = size > 1e-3 * size.mean()
    wrong = int((determinants[clear] < 0).sum())
    return (
        failed(f"{wrong} of {int(clear.sum())} simplices face the other way") if wrong else passed()
    )


def euler(mesh: Mesh, known: Manifold) -> Finding:
    """The Euler characteristic and the number of pieces are the known ones."""
    found = (oracle.euler_characteristic(mesh.simplices), oracle.components(mesh.simplices))
    right = (known.euler, known.pieces)
    if found != right:
        return failed(
            f"Euler characteristic {found[0]} in {found[1]} pieces; "
            f"{right[0]} in {right[1]} are known"
        )
    return passed(euler=found[0], pieces=found[1])


def at_crossing(mesh: Mesh, field: Field) -> Finding:
    """Every vertex lies in a cell on whose corners no component has one strict sign."""
    place = (mesh.vertices - field.origin) / field.spacing
    slack = ROUNDING * max(field.shape)
    good = np.zeros(len(place), bool)
    # A vertex on the face of a cell may belong to any cell around it.
    for nudge in product((-slack, slack), repeat=field.dimension):
        cell = np.floor(place + nudge).astype(int)
        inside = ((cell >= 0) & (cell <= np.array(field.shape) - 2)).all(axis=1)
        cell = np.clip(cell, 0, np.array(field.shape) - 2)
        good |= inside & _crosses(field, cell)
    bad = np.flatnonzero(~good)
    if len(bad):
        return failed(
            f"{len(bad)} vertices in cells without a zero", at=mesh.vertices[bad[0]].tolist()
        )
    return passed(vertices=len(place))


def _crosses(field: Field, cell: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether every component is somewhere <= 0 and somewhere >= 0 on the corners of each cell."""
    components = field.values.reshape(field.components, *field.shape)
    low = np.full((field.components, len(cell)), np.inf)
    high = np.full_like(low, -np.inf)
    for corner in product((0, 1), repeat=field.dimension):
        values = components[:, *(cell + corner).T]
        low, high = np.minimum(low, values), np.maximum(high, values)
    return np.asarray(((low <= 0) & (high >= 0)).all(axis=0))


def flat(mesh: Mesh, known: Manifold) -> Finding:
    """Where the components are affine, every vertex is on their common zero set."""
    if not len(mesh.simplices):
        return failed("no simplices where there are zeros")
    scale = abs(known.gradients(np.zeros((1, known.n)))).sum() * known.half
    worst = float(abs(known.phi(mesh.vertices)).max())
    if worst > ROUNDING * scale:
        return failed(f"a vertex has a value of {worst:.3g}, not 0", worst=worst)
    return passed(worst=worst)


def converges(coarse: Mesh, fine: Mesh | None, known: Manifold) -> Finding:
    """With cells of half the size the error of the volume falls by 2^1.4 at least."""
    if fine is None:
        return Finding(Verdict.NOT_RUN, "the finer lattice gave no mesh")
    volumes = [float(oracle.measures(x.vertices, x.simplices).sum()) for x in (coarse, fine)]
    errors = [abs(volume - (known.volume or 0.0)) for volume in volumes]
    order = float(np.log2(errors[0] / max(errors[1], 1e-300)))
    numbers = {"volumes": volumes, "known": known.volume, "order": order}
    if order < LEAST_ORDER:
        return Finding(Verdict.FAIL, f"the error of the volume falls as h^{order:.2f}", numbers)
    return Finding(Verdict.PASS, "", numbers)
