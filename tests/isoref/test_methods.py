"""The catalogue: one call for every method, in either precision."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from isoref import (
    METHODS,
    Field,
    FieldError,
    Mesh,
    extract,
    marching_faces,
    marching_tetrahedra,
    simplicial,
    surface_nets,
    vesta,
)
from isoref import dual as plain_dual
from isoref import sweep as plain_sweep
from isoref.fast import vesta as fast_vesta
from isoref.methods import RULES, extract_frames


@pytest.mark.parametrize("method", METHODS)
def test_every_method_gives_its_mesh_in_either_precision(method: str) -> None:
    """Single precision is the same mesh, rounded."""
    values = np.random.default_rng(3).normal(size=(5, 6, 7))
    double, single = (
        extract(values, 0.1, (0.5, 1, 3), (9, 0, 1), method, precision=precision)
        for precision in ("double", "single")
    )
    assert len(double.simplices) > 20
    assert [str(a.dtype) for a in (double.vertices, double.simplices)] == ["float64", "int64"]
    assert [str(a.dtype) for a in (single.vertices, single.simplices)] == ["float32", "int32"]
    assert np.array_equal(single.vertices, double.vertices.astype(np.float32))
    assert np.array_equal(single.simplices, double.simplices)


def test_an_unknown_method_or_precision_is_named() -> None:
    """With what there is."""
    with pytest.raises(ValueError, match="no method 'cubes'; there are asymptotic-decider"):
        extract(np.zeros((2, 2, 2)), 0, method="cubes")
    for method in ("asymptotic-decider", "simplicial"):
        with pytest.raises(FieldError, match="precision 'half'"):
            extract(np.zeros((2, 2, 2)), 0, method=method, precision="half")  # type: ignore[call-overload]


def test_rules_are_in_the_catalogue_under_their_names() -> None:
    """Each of them, carried by the sweep."""
    assert len(RULES) == 9
    assert set(RULES) <= set(METHODS)


AFFINE = np.array([[0, 0.3, -2, 5], [1.5, 0.1, 0, -6], [0, 0.8, 0.4, 70], [0, 0, 0, 1]])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("mirrored", [False, True])
def test_every_method_draws_where_the_field_stands(method: str, mirrored: bool) -> None:
    """Vertices are those of the lattice, moved; right-hand normals point to low values still."""
    values = np.random.default_rng(3).normal(size=(5, 6, 7))
    affine = AFFINE @ np.diag([-1 if mirrored else 1, 1, 1, 1])
    field = Field.of_affine(values, affine)
    mesh, plain = METHODS[method](field, 0.1), METHODS[method](Field.of(values), 0.1)
    assert np.allclose(mesh.vertices, plain.vertices @ affine[:3, :3].T + affine[:3, 3])
    assert len(mesh.simplices) > 20
    turned = plain.simplices if field.handedness > 0 else plain.simplices[:, [0, 2, 1]]
    assert np.array_equal(mesh.simplices, turned)
    given: dict[str, Any] = {
        "spacing": field.spacing,
        "origin": field.origin,
        "directions": field.directions,
    }
    same = extract(values, 0.1, method=method, **given)
    assert np.array_equal(same.vertices, mesh.vertices)
    single = extract(values, 0.1, method=method, precision="single", **given)
    assert single.vertices.dtype == np.float32
    assert np.allclose(single.vertices, mesh.vertices, rtol=0, atol=1e-5)
    assert np.array_equal(single.simplices, mesh.simplices)


def test_plain_articles_draw_where_the_field_stands() -> None:
    """As their twins do."""
    field = Field.of_affine(np.random.default_rng(3).normal(size=(3, 4, 4)), AFFINE)
    articles: list[tuple[Mesh, Mesh]] = [
        (
            plain_sweep.sweep(RULES["asymptotic-decider"], field, 0.1),
            METHODS["asymptotic-decider"](field, 0.1),
        ),
        (plain_dual.surface(surface_nets.RULE, field, 0.1), METHODS["surface-nets"](field, 0.1)),
        (
            marching_tetrahedra.surface(marching_tetrahedra.KUHN, field, 0.1),
            METHODS["marching-tetrahedra-kuhn"](field, 0.1),
        ),
        (vesta.vesta(field, 0.1), METHODS["vesta-mixed-L"](field, 0.1)),
        (simplicial.extract(field, 0.1), METHODS["simplicial"](field, 0.1)),
    ]
    for plain, fast in articles:
        a, b = plain.canonical(), fast.canonical()
        assert np.allclose(a.vertices, b.vertices)
        assert len(a.simplices) == len(b.simplices) > 10


def test_a_curve_in_a_mirrored_field_runs_backwards() -> None:
    """det(-g_1, .., -g_m, t_1, .., t_k) > 0 is asked in space."""
    values = np.random.default_rng(1).normal(size=(5, 5))
    turned = Field.of(values, directions=[[-1, 0], [0, 1]])
    mirrored, plain = simplicial.extract(turned, 0.0), simplicial.extract(Field.of(values), 0.0)
    assert np.array_equal(mirrored.vertices, plain.vertices * [-1, 1])
    assert len(plain.simplices) > 5
    assert np.array_equal(mirrored.simplices, plain.simplices[:, ::-1])


def test_what_works_on_straight_lattices_alone_says_so() -> None:
    """Nothing draws in a wrong place in silence."""
    field = Field.of_affine(np.random.default_rng(3).normal(size=(4, 4, 4)), AFFINE)
    for refuses in (
        lambda: plain_dual.quads(surface_nets.RULE, field, 0.1),
        lambda: vesta.extract(field, 0.1),
        lambda: fast_vesta.extract(field, 0.1),
        lambda: marching_faces.marching_faces(field, field, (0.1, 0.2)),
    ):
        with pytest.raises(FieldError, match="straight lattices alone"):
            refuses()


def test_several_isovalues_give_a_mesh_each() -> None:
    """In their order, as one by one."""
    values = np.random.default_rng(3).normal(size=(5, 6, 7))
    levels: Sequence[float]
    for levels in ([0.1, -0.5, 9.0], (0.1,), tuple(np.array([0.1, 0.2]))):
        meshes = extract(values, levels)
        assert len(meshes) == len(levels)
        for mesh, level in zip(meshes, levels, strict=True):
            assert np.array_equal(mesh.vertices, extract(values, float(level)).vertices)


@pytest.mark.parametrize("method", METHODS)
def test_absent_samples_are_absent_cells(method: str) -> None:
    """Not a number, masked, or named: the surface is that of the cells that have all their samples.

    Whatever stands in for them: another number gives the same mesh.
    """
    values = np.random.default_rng(3).normal(size=(6, 7, 8))
    gone = np.random.default_rng(4).random(values.shape) < 0.03
    gone[2, 3, 4] = True
    holed = np.where(gone, np.nan, values)
    with pytest.raises(FieldError, match="is nan"):
        extract(holed, 0.1, method=method)
    mesh = extract(holed, 0.1, method=method, absent=True)
    assert 50 < len(mesh.simplices) < len(extract(values, 0.1, method=method).simplices)
    assert mesh.provenance is None
    for same in (
        extract(np.ma.masked_array(values, gone), 0.1, method=method, absent=True),
        extract(np.where(gone, np.inf, values), 0.1, method=method, absent=gone),
        extract(values, 0.1, method=method, absent=gone),
    ):
        a, b = mesh.canonical(), same.canonical()
        if "dual" not in method:  # a pair of cells that turn may have one absent
            assert np.array_equal(a.vertices, b.vertices)
            assert np.array_equal(a.simplices, b.simplices)
    kept = extract(holed, 0.1, method=method, absent=True, provenance=True)
    index = kept.traced().field.index(kept.vertices)[kept.simplices].mean(axis=1)
    cells = np.floor(index).astype(int)
    corners = cells[:, None] + np.moveaxis(np.indices((2, 2, 2)), 0, -1).reshape(-1, 3)
    if (kept.traced().cells >= 0).all():
        flat = np.abs(index - np.round(index)).min(axis=1) < 1e-9
        assert not gone[tuple(np.moveaxis(corners[~flat], -1, 0))].any()


def test_nothing_present_is_nothing_drawn() -> None:
    """And a mask of another shape is refused."""
    holes = np.full((3, 3, 3), np.nan)
    assert len(extract(holes, 0.0, absent=True).simplices) == 0
    with pytest.raises(FieldError, match=r"absent has shape \(2, 2, 2\)"):
        extract(np.zeros((3, 3, 3)), 0.0, absent=np.zeros((2, 2, 2), bool))


def test_a_cap_closes_beside_an_absent_corner_too() -> None:
    """The corner of a block is cut off through its three neighbours."""
    values = np.ones((5, 5, 5))
    values[4, 4, 4] = np.nan
    mesh = extract(values, 0.5, cap=True, absent=True)
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    assert (a * np.cross(b, c)).sum() / 6 == pytest.approx(4**3 - 1 / 6)
    assert len(extract(values, 0.5, absent=True).simplices) == 0


def test_an_isovalue_may_be_an_array_of_no_axes() -> None:
    """As NumPy gives one; of an axis there are several."""
    values = np.indices((3, 3, 3))[0]
    none: Any = np.array(0.5)
    one: Any = np.array([0.5])
    first, (same,) = extract(values, none), extract(values, one)
    assert np.array_equal(first.vertices, same.vertices)
    wrong: Any
    for wrong in (None, "high", [[0.5]]):
        with pytest.raises(FieldError, match="is not a number"):
            extract(values, wrong)


def test_frames_of_a_time_series_are_extracted_one_by_one() -> None:
    """Each is the surface of its frame alone, for one isovalue and for several, and its options."""
    series = np.random.default_rng(12).normal(size=(3, 4, 5, 6))
    place: dict[str, Any] = {"spacing": (1, 2, 0.5), "origin": (3, 0, -1), "cap": True}
    isovalue: Any
    for isovalue in (0.1, [0.1, 0.7]):
        found = list(extract_frames(series, isovalue, method="trilinear-cubes", **place))
        assert len(found) == 3
        for frame, meshes in zip(series, found, strict=True):
            right = extract(frame, isovalue, method="trilinear-cubes", **place)
            several = (meshes, right) if isinstance(meshes, list) else ([meshes], [right])
            assert isinstance(meshes, list) == isinstance(isovalue, list)
            for one, other in zip(*several, strict=True):
                assert np.array_equal(one.vertices, other.vertices)
                assert np.array_equal(one.simplices, other.simplices)


def test_a_frame_that_is_no_field_is_told_when_it_is_reached() -> None:
    """With its number; those before it come, and wrong use is told at once."""
    series = np.zeros((3, 2, 2, 2))
    series[2, 1, 0, 1] = np.nan
    frames = extract_frames(series, 0.5)
    assert len([next(frames), next(frames)]) == 2
    with pytest.raises(FieldError, match=r"frame 2: sample \(1, 0, 1\) is nan"):
        next(frames)
    with pytest.raises(FieldError, match=r"shape \(2, 2, 2\) is no time series"):
        extract_frames(series[0], 0.5)
    with pytest.raises(ValueError, match="no method 'nothing'"):
        extract_frames(series, 0.5, method="nothing")
