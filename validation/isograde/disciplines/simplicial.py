"""The discipline ``simplices``: isosurfaces of any dimension and codimension.

An implementation is a function::

    extract_simplices(values, spacing) -> (vertices, simplices)

values      (m, N1, .., Nn) samples of m components, m < n
spacing     n floats; a vertex is ``index * spacing``, in the order of the array's axes
vertices    (V, n) numbers
simplices   (S, n - m + 1) rows of indices into `vertices`, of the set where all components are 0

It goes through the doors like any other: declare ``{"discipline": "simplices"}`` and name it
``python:my.module:extract_simplices``. Inside, `through_door` drops the isovalue, which is always
0. Programs behind ``exec:`` and folders behind ``dir:`` see `LAYOUT`. To decline a dimension or a
codimension, raise `NotImplementedError`, or answer "unsupported".

Glossary
--------
k           n - m, the dimension of the simplices
facet       a (k-1)-face of a simplex; open where it has one simplex and is not on the border
covered     an open facet that lies on other open facets: two cuts of one face
h           edge of a cell

Judges are pure functions of a mesh and of what is known; each claim names its judge. How a cell is
cut is the implementation's choice, so nothing is said of counts. What is said of vertices holds
for every interpolation that stays between its samples: Kuhn's, cubes', and others.

References
----------
[1] C. Min, Simplicial isosurfacing in arbitrary dimension and codimension, 2003.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.mesh import Mesh
from numpy.typing import NDArray

from isograde.disciplines.polylines import declare
from isograde.model import (
    Case,
    Claim,
    Finding,
    Outcome,
    Status,
    Trial,
    Verdict,
)
from isograde.truths import simplices as truth
from isograde.truths.known_manifolds import MANIFOLDS, Manifold

Extract = Callable[[Any, tuple[float, ...]], Any]

# Samples along each axis of a known case, by n; "finer" has cells of half the size.
COARSE = {2: 25, 3: 17, 4: 12, 5: 8}
# Samples along each axis of a case of noise, by n.
ROUGH = {2: (9, 8), 3: (6, 5, 6), 4: (4, 4, 3, 4), 5: (3, 2, 3, 2, 2)}
# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6
# The error of linear interpolation falls as h^2; two sizes do not show the order exactly.
LEAST_ORDER = 1.4


# --- through the doors ---------------------------------------------------------------------------

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (m, N1, .., Nn): the surface is where all m components are 0",
    "vertices": "origin + index * spacing (V, n), coordinates in the order of the array's axes",
    "faces": "rows of n - m + 1 0-based indices; with the negated gradients before them, the "
    "simplex's edges have a positive determinant",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no simplex": "arrays without rows; a missing file counts as unsupported",
}


def through_door(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the doors call it, with an isovalue, which is 0 in every case."""

    def extract(values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]) -> Any:
        return function(values - isovalue if isovalue else values, tuple(spacing))

    return declare(extract, function, "simplices")


# --- judges --------------------------------------------------------------------------------------


def well_formed(outcome: Outcome, n: int, m: int) -> Finding:
    """Vertices are finite (V, n) numbers, simplices (S, n - m + 1) indices in range."""
    vertices, simplices = outcome.vertices, outcome.faces
    if vertices is None or simplices is None:
        return _fail("no arrays came back")
    if vertices.ndim != 2 or vertices.shape[1] != n or vertices.dtype.kind not in "fiu":
        return _fail(f"vertices are {vertices.dtype} {vertices.shape}, not numbers (V, {n})")
    if simplices.ndim != 2 or simplices.shape[1] != n - m + 1 or simplices.dtype.kind not in "iu":
        return _fail(
            f"simplices are {simplices.dtype} {simplices.shape}, not integers (S, {n - m + 1})"
        )
    if not np.isfinite(vertices).all():
        return _fail("a vertex is not finite")
    if simplices.size and not (0 <= simplices.min() and simplices.max() < len(vertices)):
        return _fail(f"indices reach from {simplices.min()} to {simplices.max()}")
    return _pass(vertices=len(vertices), simplices=len(simplices))


def nothing(mesh: Mesh) -> Finding:
    """There is no simplex."""
    count = len(mesh.simplices)
    return _fail(f"{count} simplices where there are no zeros") if count else _pass()


def closed(mesh: Mesh, box: Any) -> Finding:
    """No open facet is left over when those of two cuts of one face are set aside."""
    rows = truth.open_facets(mesh.vertices, mesh.simplices, box)
    holes = rows[~truth.covered(mesh.vertices, rows)]
    if len(holes):
        place = mesh.vertices[holes[0]].mean(axis=0).round(6).tolist()
        return _fail(f"{len(holes)} facets have a simplex on one side only", at=place)
    return _pass()


def conforming(mesh: Mesh, box: Any) -> Finding:
    """No face is cut one way by one simplex and another way by its neighbour."""
    rows = truth.open_facets(mesh.vertices, mesh.simplices, box)
    doubled = rows[truth.covered(mesh.vertices, rows)]
    if len(doubled):
        place = mesh.vertices[doubled[0]].mean(axis=0).round(6).tolist()
        return _fail(f"{len(doubled)} facets lie on facets of another cut", at=place)
    return _pass()


def manifold(mesh: Mesh) -> Finding:
    """No facet belongs to more than two simplices."""
    worst = int(truth.facets(mesh.simplices).owners.max(initial=0))
    return _fail(f"a facet belongs to {worst} simplices") if worst > 2 else _pass()


def oriented(mesh: Mesh) -> Finding:
    """The two simplices on a facet give it opposite orientations."""
    found = truth.facets(mesh.simplices)
    wrong = int(((found.owners == 2) & (found.balance != 0)).sum())
    return _fail(f"{wrong} facets between simplices that disagree") if wrong else _pass()


def side(mesh: Mesh, known: Manifold) -> Finding:
    """det(-g_1, .., -g_m, t_1, .., t_k) > 0 on every simplex that is not nearly flat."""
    if not len(mesh.simplices):
        return Finding(Verdict.NOT_RUN, "there is no simplex to look at")
    place = mesh.vertices[mesh.simplices]
    frame = np.concatenate([-known.gradients(place.mean(axis=1)), np.diff(place, axis=1)], axis=1)
    determinants = np.linalg.det(frame)
    size = truth.measures(mesh.vertices, mesh.simplices)
    clear = size > 1e-3 * size.mean()
    wrong = int((determinants[clear] < 0).sum())
    return (
        _fail(f"{wrong} of {int(clear.sum())} simplices face the other way") if wrong else _pass()
    )


def euler(mesh: Mesh, known: Manifold) -> Finding:
    """The Euler characteristic and the number of pieces are the known ones."""
    found = (truth.euler_characteristic(mesh.simplices), truth.components(mesh.simplices))
    right = (known.euler, known.pieces)
    if found != right:
        return _fail(
            f"Euler characteristic {found[0]} in {found[1]} pieces; "
            f"{right[0]} in {right[1]} are known"
        )
    return _pass(euler=found[0], pieces=found[1])


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
        return _fail(
            f"{len(bad)} vertices in cells without a zero", at=mesh.vertices[bad[0]].tolist()
        )
    return _pass(vertices=len(place))


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
        return _fail("no simplices where there are zeros")
    scale = abs(known.gradients(np.zeros((1, known.n)))).sum() * known.half
    worst = float(abs(known.phi(mesh.vertices)).max())
    if worst > ROUNDING * scale:
        return _fail(f"a vertex has a value of {worst:.3g}, not 0", worst=worst)
    return _pass(worst=worst)


def converges(coarse: Mesh, fine: Mesh | None, known: Manifold) -> Finding:
    """With cells of half the size the error of the volume falls by 2^1.4 at least."""
    if fine is None:
        return Finding(Verdict.NOT_RUN, "the finer lattice gave no mesh")
    volumes = [float(truth.measures(x.vertices, x.simplices).sum()) for x in (coarse, fine)]
    errors = [abs(volume - (known.volume or 0.0)) for volume in volumes]
    order = float(np.log2(errors[0] / max(errors[1], 1e-300)))
    numbers = {"volumes": volumes, "known": known.volume, "order": order}
    if order < LEAST_ORDER:
        return Finding(Verdict.FAIL, f"the error of the volume falls as h^{order:.2f}", numbers)
    return Finding(Verdict.PASS, "", numbers)


def _pass(**numbers: Any) -> Finding:
    """The claim holds."""
    return Finding(Verdict.PASS, "", numbers)


def _fail(detail: str, **numbers: Any) -> Finding:
    """The claim does not hold, and why."""
    return Finding(Verdict.FAIL, detail, numbers)


# --- cases ---------------------------------------------------------------------------------------


def cases(seed: int = 0) -> list[Case]:
    """Every case of the discipline, deterministic for a seed."""
    listed = [_known_case(known) for known in MANIFOLDS.values()]
    for n, m in ((2, 1), (3, 1), (3, 2), (4, 1), (4, 2), (5, 1), (5, 3)):
        for kind, tags in (("noise", {"generic"}), ("integers", {"ties"})):
            build = partial(_noise, n, m, kind, seed)
            tagged = frozenset({"simplices", *tags})
            size = int(np.prod(ROUGH[n]))
            listed.append(Case(f"simplices/{kind}-{n}-{m}", build, 0.0, size, tagged))
    empty = frozenset({"simplices", "empty"})
    return [*listed, Case("simplices/apart", _apart, 0.0, 5**3, empty)]


def _known_case(known: Manifold) -> Case:
    """The case that samples a known manifold."""
    tags = {"simplices", "generic", "known", "flat" if known.flat else "curved"}
    tags |= {"volume"} if known.volume is not None else set()
    size = COARSE[known.n]
    facts = {"euler": known.euler, "components": known.pieces}
    return Case(
        f"simplices/{known.name}",
        lambda: _sampled(known, size),
        0.0,
        size**known.n,
        frozenset(tags),
        facts,
    )


def _sampled(known: Manifold, N: int) -> Field:
    """A known manifold's functions on N samples a side."""
    values, spacing = known.sample(N)
    return Field.of(values, spacing, [-known.half] * known.n, dimension=known.n)


def _noise(n: int, m: int, kind: str, seed: int) -> Field:
    """Random samples: generic ones, or whole numbers from -1 to 1."""
    rng = np.random.default_rng([seed, n, m])
    shape = (m, *ROUGH[n])
    values = rng.normal(size=shape) if kind == "noise" else rng.integers(-1, 2, shape) * 1.0
    return Field.of(values, dimension=n)


def _apart() -> Field:
    """Two components with zeros, but none in common."""
    x = np.indices((5, 5, 5))[0].astype(float)
    return Field.of(np.stack([x - 0.5, x - 3.5]), dimension=3)


# --- claims --------------------------------------------------------------------------------------


def _known(trial: Trial) -> Manifold:
    """The known manifold of a trial's case."""
    return MANIFOLDS[trial.case.id.removeprefix("simplices/")]


def _joined(mesh: Mesh, trial: Trial) -> Mesh:
    """The mesh; with ties, where vertices fall together up to rounding, they count as one."""
    if "ties" not in trial.case.tags or not len(mesh.vertices):
        return mesh
    slack = ROUNDING * float(np.ptp(_box(trial), axis=0).max())
    return Mesh(*truth.joined(mesh.vertices, mesh.simplices, slack))


def _box(trial: Trial) -> Any:
    """Lowest and highest corner of the lattice."""
    field = trial.field
    top = np.array(field.shape) - 1
    return field.position(np.stack([0 * top, top]))


def _claim(
    name: str,
    rule: str,
    level: int | None,
    judge: Callable[[Mesh, Trial], Finding],
    tags: set[str],
    source: str,
    variants: tuple[str, ...] = (),
) -> Claim:
    """A claim about a well-formed mesh; not run where there is none."""

    def of_trial(trial: Trial) -> Finding:
        if trial.plain.status is not Status.OK:
            return Finding(_failed(trial.plain.status), trial.plain.detail)
        form = well_formed(trial.plain, trial.field.dimension, trial.field.components)
        if name == "well-formed":
            return form
        if form.verdict is not Verdict.PASS or trial.plain.mesh is None:
            return Finding(Verdict.NOT_RUN, form.detail)
        return judge(trial.plain.mesh, trial)

    return Claim(
        f"simplices.{name}", rule, source, level, of_trial, tags=frozenset(tags),
        variants=variants, needs_mesh=False, discipline="simplices",
    )  # fmt: skip


def _failed(status: Status) -> Verdict:
    """The verdict for a call that gave no mesh."""
    if status is Status.CRASH:
        return Verdict.CRASH
    if status in (Status.TIMEOUT, Status.MEMORY):
        return Verdict.TIMEOUT
    return Verdict.UNSUPPORTED if status is Status.DECLINED else Verdict.ERROR


ALL, SOLID = {"simplices"}, {"generic", "ties"}
CLAIMS: tuple[Claim, ...] = (
    _claim(
        "well-formed", "vertices are (V, n) finite numbers, simplices (S, n-m+1) indices", 0,
        lambda _, trial: well_formed(trial.plain, trial.field.dimension, trial.field.components),
        ALL, "the signature of extract_simplices",
    ),
    _claim(
        "nothing", "components without a common zero give no simplex", 0,
        lambda mesh, _: nothing(mesh), {"empty"}, "[1] section 2.2, definition of the isosurface",
    ),
    _claim(
        "closed", "away from the border every facet has something on both sides", 1,
        lambda mesh, trial: closed(_joined(mesh, trial), _box(trial)), SOLID,
        "[1] theorem 2.1: phi^ is continuous",
    ),
    _claim(
        "conforming", "simplices meet in common faces: no face is cut in two ways", 1,
        lambda mesh, trial: conforming(_joined(mesh, trial), _box(trial)), SOLID,
        "[1] section 2, definition of a triangulation",
    ),
    _claim(
        "manifold", "a facet belongs to two simplices at most", 1,
        lambda mesh, _: manifold(mesh), {"generic"}, "[1] section 5: a manifold of dimension n - m",
    ),
    _claim(
        "oriented", "neighbours are oriented alike", 1,
        lambda mesh, _: oriented(mesh), {"generic"}, "orientability of regular level sets",
    ),
    _claim(
        "side", "det(-g_1, .., -g_m, t_1, .., t_k) > 0: normals point from high to low", 2,
        lambda mesh, trial: side(mesh, _known(trial)), {"known"}, "the convention of the house",
    ),
    _claim(
        "euler", "Euler characteristic and number of pieces are those of the known manifold", 2,
        lambda mesh, trial: euler(mesh, _known(trial)), {"known"}, "the manifold's description",
    ),
    _claim(
        "at-crossing", "every vertex lies in a cell where each component has both signs", None,
        lambda mesh, trial: at_crossing(mesh, trial.field), {"generic"},
        "interpolation stays between its samples",
    ),
    _claim(
        "flat", "where the components are affine, every vertex solves them", None,
        lambda mesh, trial: flat(mesh, _known(trial)), {"flat"},
        "[1] section 2.2: linear on each simplex",
    ),
    _claim(
        "converges", "the error of the volume falls with the square of the cell's edge", None,
        lambda mesh, trial: converges(mesh, trial.outcomes["finer"].mesh, _known(trial)),
        {"volume"}, "the error of linear interpolation", ("finer",),
    ),
)  # fmt: skip


# --- grading -------------------------------------------------------------------------------------


def pose(variant: str, case: Case, field: Field) -> Field:
    """The field of a variant of a case: ``plain`` or ``finer``."""
    if variant == "finer":
        known = MANIFOLDS[case.id.removeprefix("simplices/")]
        return _sampled(known, 2 * COARSE[known.n] - 1)
    return field


# Ready-made implementations, by short name.
_METHODS = ("reference", "printed", "skimage", "contourpy", "pymcubes", "libigl", "vtk")
READY_MADE: Mapping[str, str] = {
    f"simplices:{name}": f"python:isograde.doors.simplex_methods:{name.replace('-', '_')}"
    for name in (*_METHODS, "vtk-tetrahedra")
}
