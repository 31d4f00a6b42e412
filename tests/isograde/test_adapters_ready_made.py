"""Ready-made adapters say what they do, and do it."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.adapters.measure import ball, measure
from isograde.adapters.python import PythonAdapter
from isograde.adapters.ready_made import READY_MADE, _interpolant, _lookup
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.claims.cycles import MODES
from isograde.model import AdapterError, Case, Limits, Outcome, Request, Status, Verdict
from isograde.runner import Task, Worker
from isoref.field import Field
from scipy.interpolate import RegularGridInterpolator

# Volume of the ball of `isograde.adapters.measure`, radius sqrt(3), in samples of 1 x 2 x 3.
VOLUME = 6 * 4 / 3 * np.pi * 3**1.5
CLOSED = {"trimesh", "manifold3d"}
# Their surfaces end in the border layer of cells.
INSET = {"isoref:surface-nets", "isoref:dual-marching-cubes"}
SMALL_ONLY = {"pymeshlab"}
# Wrong answers known to us; one that has been mended fails the test, to be taken off the list.
MISREAD = {("pymcubes", ">i4")}


@pytest.fixture(params=sorted(READY_MADE), scope="module")
def adapter(request: pytest.FixtureRequest) -> Iterator[PythonAdapter]:
    """Each ready-made adapter whose library is here, opened."""
    name: str = request.param
    distribution = READY_MADE[name].distribution
    if distribution != "isograde":
        try:
            version(distribution)
        except PackageNotFoundError:
            pytest.skip(f"{distribution} is not installed")
    adapter = open_adapter(name)
    assert isinstance(adapter, PythonAdapter)
    try:
        adapter.open(Limits(seconds=30.0, megabytes=2048))
    except AdapterError as error:
        if "system library" not in str(error):
            raise
        pytest.skip(str(error))
    yield adapter
    adapter.close()


def ask(adapter: PythonAdapter, field: Field, isovalue: float) -> Outcome:
    """The outcome in the house's conventions."""
    return adapter.run(Request("test", "plain", field, isovalue))


def test_conventions_are_declared_as_measured(adapter: PythonAdapter) -> None:
    measured = measure(lambda f, level: adapter.answer(Request("test", "plain", f, level)))
    assert None not in vars(measured).values()
    assert measured.differences(adapter.declaration.conventions) == []


def test_whatever_is_not_promised_is_named_by_a_claim() -> None:
    """A misspelt word would excuse nothing."""
    named = {word for claim in CLAIMS.values() for word in claim.unless}
    assert {word for ready in READY_MADE.values() for word in ready.without} <= named


def judged_as(adapter: PythonAdapter, mode: str, cases: dict[str, Case]) -> Counter[Verdict]:
    """What `cases.cycles` says of the adapter's answers to these cases, were this mode declared."""
    worker = Worker(adapter, replace(adapter.declaration, connectivity=mode), cases, CLAIMS)
    tasks = (Task(name, ("cases.cycles",)) for name in cases)
    return Counter(worker.judge(task).findings["cases.cycles"].verdict for task in tasks)


@pytest.mark.slow
def test_a_library_s_connectivity_is_that_of_all_256_cells(adapter: PythonAdapter) -> None:
    """In a border outside; the two other modes fail in some of their 23 classes already."""
    declared = adapter.declaration.connectivity
    if not declared or adapter.declaration.name.startswith("isoref"):
        pytest.skip("declares none, or is judged in test_cycles_claim.py")
    cells = {n: case for n, case in all_cases().items() if n.startswith("cells/outside")}
    classes = {name: case for name, case in cells.items() if "posed" in case.tags}
    # The cell without a corner inside has no surface.
    assert judged_as(adapter, declared, cells) == {Verdict.PASS: 255, Verdict.SKIP: 1}
    for mode in {*MODES} - {declared}:
        assert judged_as(adapter, mode, classes)[Verdict.FAIL] > 0


def test_the_version_of_the_library_is_declared(adapter: PythonAdapter) -> None:
    assert adapter.declaration.version


def test_answers_arrive_closed_in_place_and_facing_outwards(adapter: PythonAdapter) -> None:
    """The inscribed mesh of a ball, or the blocks round its samples, off by its coarseness."""
    import trimesh

    field, origin = ball(), np.array([9.0, 8, 7])
    values = field.values
    if adapter.spec in INSET:
        values, origin = np.pad(values, 1, mode="edge"), origin - field.spacing
    outcome = ask(adapter, Field.of(values, field.spacing, origin.tolist()), 1.0)
    assert outcome.mesh is not None, outcome.detail
    solid = trimesh.Trimesh(outcome.mesh.vertices, outcome.mesh.simplices)
    assert solid.is_watertight
    # A dual surface lies up to 0.4 / R within (design): 1.2 / R^2 of the volume, and R^2 is 3 here.
    assert solid.volume == pytest.approx(VOLUME, rel=0.4 if adapter.spec in INSET else 0.3)
    centre = (np.array([2.1, 2.4, 3.2]) * field.spacing) + (9, 8, 7)
    assert solid.center_mass == pytest.approx(centre, abs=0.7)


@pytest.mark.parametrize("level", [99.0, -99.0])
def test_a_field_without_a_surface_gives_an_empty_mesh(
    adapter: PythonAdapter, level: float
) -> None:
    """Those that close the surface at the border close it round the whole lattice."""
    outcome = ask(adapter, ball(), level)
    assert outcome.mesh is not None, outcome.detail
    whole = level < 0 and adapter.spec in CLOSED
    assert (len(outcome.mesh.simplices) > 0) == whole


@pytest.mark.parametrize("kind", ["bool", "uint8", ">i4", "float16", "float32"])
def test_samples_of_any_type_are_taken_or_declined_or_refused(
    adapter: PythonAdapter, kind: str
) -> None:
    """The same as float64 gives, where it answers."""
    rng = np.random.default_rng(3)
    values = rng.integers(0, 2, (4, 4, 4)) * (1 if kind == "bool" else 100)
    exact = ask(adapter, Field.of(values.astype(float)), 0.5)
    outcome = ask(adapter, Field.of(values.astype(kind)), 0.5)
    if outcome.status is Status.RAISED:
        assert outcome.detail
        return
    assert outcome.mesh is not None, outcome.detail
    assert exact.mesh is not None, exact.detail
    same = np.array_equal(outcome.mesh.simplices, exact.mesh.simplices) and np.allclose(
        outcome.mesh.vertices, exact.mesh.vertices, atol=1e-4
    )
    assert same == ((adapter.spec, kind) not in MISREAD)


def test_where_vertices_stand_is_declared_as_measured(adapter: PythonAdapter) -> None:
    """On lattice edges, at the linear crossing, inside the volume: else declared without."""
    field = Field.of(np.random.default_rng(6).random((7, 7, 7)))
    values = np.asarray(field.values)
    mesh = ask(adapter, field, 0.5).mesh
    assert mesh is not None
    places = mesh.vertices
    whole = np.abs(places - places.round()) < 1e-4
    on_edge = places[whole.sum(axis=1) == 2]
    without = adapter.declaration.without
    assert ("on-edges" in without) == (len(on_edge) < 0.55 * len(places))
    beyond = (places < -1e-4).any() or (places > 6 + 1e-4).any()
    assert beyond <= ("border" in without)
    if "on-edges" not in without:
        inner = on_edge[((on_edge > -1e-4) & (on_edge < 6 + 1e-4)).all(axis=1)]
        interpolated = RegularGridInterpolator((np.arange(7),) * 3, values)(inner.clip(0, 6))
        error = np.abs(interpolated - 0.5).max()
        assert ("linear-crossing" in without) == (error > 1e-3)


def test_thousands_of_samples_are_taken_or_declined(adapter: PythonAdapter) -> None:
    outcome = ask(adapter, Field.of(np.random.default_rng(5).random((12, 13, 14))), 0.5)
    expected = Status.DECLINED if adapter.spec in SMALL_ONLY else Status.OK
    assert outcome.status is expected, outcome.detail


def test_the_lookup_formula_has_the_sample_s_value_at_every_sample() -> None:
    samples = np.random.default_rng(2).integers(-3, 3, (3, 4, 5)).astype(float)
    program = _lookup(samples)
    while "?" in program:
        head, _, tail = program.rpartition("(")
        inner, _, rest = tail.partition(")")
        condition, _, branches = inner.partition("?")
        high, _, low = branches.partition(":")
        program = f"{head}[{low},{high}][{condition}]{rest}"
    for place in np.ndindex(*samples.shape):
        names = dict(zip("xyz", place, strict=True))
        assert eval(program, {}, names) == samples[place]


def test_the_interpolant_is_scipy_s() -> None:
    values = np.random.default_rng(2).random((3, 4, 5))
    spacing = (1.0, 0.5, 2.0)
    at = _interpolant(values, spacing)
    axes = tuple(np.arange(n) * h for n, h in zip(values.shape, spacing, strict=True))
    points = np.random.default_rng(3).random((50, 3)) * [axis[-1] for axis in axes]
    ours = [at(*map(float, point)) for point in points]
    assert ours == pytest.approx(RegularGridInterpolator(axes, values)(points))
