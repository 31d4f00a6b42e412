"""Isosurfaces in any dimension and codimension are manifolds where they should be."""

import re
import sys
import tracemalloc
from collections.abc import Callable
from itertools import product
from math import factorial, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isograde.oracles import complexes as oracle
from isograde.oracles.covering import covered, inner_open_facets
from isoref import Field, FieldError, Mesh
from isoref import simplicial as article
from isoref.fast.marching_faces import intersection_curves
from isoref.fast.simplicial import (
    allowed_memory,
    extract,
    most_pieces,
    section_of_field,
    weld,
)
from isoref.kuhn import interpolate, lattice_simplices
from isoref.simplex_section import RULES
from isoref.simplicial import Complex, gradients, jacobian_signs
from scipy.spatial import cKDTree

KINDS = [(1, 1), (2, 1), (3, 1), (3, 2), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 3), (3, 3)]


def noise(n: int, m: int, seed: int, ties: bool = False) -> Field:
    """Random samples on a small lattice; integers from -1 to 1 where ties are wanted."""
    rng = np.random.default_rng(seed)
    sizes = {1: [9], 2: [7, 4], 3: [5, 3, 4], 4: [4, 2, 3, 2], 5: [3, 2, 2, 2, 2]}[n]
    shape = (m, *rng.permutation(sizes))
    values = rng.integers(-1, 2, shape) if ties else rng.normal(size=shape)
    return Field.of(values, list(rng.uniform(0.5, 2, n)), list(rng.normal(size=n)), dimension=n)


def box(field: Field) -> list[list[float]]:
    """Lowest and highest corner of the lattice."""
    corners = np.array([[0] * field.dimension, np.array(field.shape) - 1])
    ends: list[list[float]] = field.position(corners).tolist()
    return ends


def sampled(n: int, N: int, half: float, *functions: Callable[..., Any]) -> Field:
    """The functions of n coordinates on N samples a side of [-half, half]^n."""
    axes = np.meshgrid(*[np.linspace(-half, half, N)] * n, indexing="ij")
    values = np.stack([f(*axes) for f in functions])
    return Field.of(values, 2 * half / (N - 1), [-half] * n, dimension=n)


def counted(mesh: Mesh) -> oracle.Complex:
    """The mesh with what is true of it."""
    return oracle.Complex.of(mesh.vertices, mesh.simplices)


def assert_manifold(mesh: Mesh, where: list[list[float]]) -> None:
    """Closed away from the border, at most two simplices on a facet, oriented alike."""
    found = counted(mesh).facets
    assert found.uses.max(initial=0) <= 2
    assert (found.balance[found.uses == 2] == 0).all()
    assert len(inner_open_facets(counted(mesh), where)) == 0


def in_order(complex_: Complex) -> dict[str, Any]:
    """The arrays of a complex, its simplices sorted with their signs and parents."""
    rows = np.column_stack([complex_.parents, complex_.simplices, complex_.signs])
    return {
        "names": complex_.names,
        "points": complex_.points,
        "values": complex_.values,
        "rows": rows[np.lexsort(rows.T[::-1])],
    }


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("n", "m"), KINDS)
def test_the_twin_has_the_complex_of_the_article(n: int, m: int, rule: str) -> None:
    """Section 4, vectorised and a simplex at a time; with ties and without, to the last bit."""
    for seed, ties in product(range(2), (False, True)):
        field = noise(n, m, seed, ties)
        for epsilon in (None, 1e-3) if ties else (None,):
            fast, plain = (
                in_order(make(field, 0.1 * (not ties), rule, epsilon))
                for make in (section_of_field, article.section_of_field)
            )
            assert len(fast["rows"]) > 0 or n - m < 1 or ties
            for name in fast:
                np.testing.assert_array_equal(fast[name], plain[name])


def test_the_twin_has_the_mesh_of_the_article() -> None:
    """In space, with spacing and origin; simplices up to their order."""
    fast, plain = (make(noise(4, 2, 3), 0.1) for make in (extract, article.extract))
    assert len(fast.simplices) > 50
    np.testing.assert_array_equal(fast.vertices, plain.vertices)
    np.testing.assert_array_equal(fast.canonical().simplices, plain.canonical().simplices)


@settings(max_examples=60)
@given(kind=st.sampled_from([k for k in KINDS if k[0] > k[1]]), seed=st.integers(0, 10**6))
def test_every_isosurface_is_a_manifold_closed_away_from_the_border(
    kind: tuple[int, int], seed: int
) -> None:
    """Section 4: a union of simplices, here a complex, on any samples, ties included."""
    for ties in (False, True):
        field = noise(*kind, seed, ties)
        assert_manifold(extract(field), box(field))


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_printed_tables_make_a_complex_up_to_dimension_four_but_not_in_five(n: int) -> None:
    """Table 4: in dimension 5 facets are met by two different cuts; no gap, but no complex."""
    field = Field.of(np.random.default_rng(5).normal(size=(3, 3, 2, 2, 2)[:n]))
    mesh, good = extract(field, rule="printed"), extract(field)
    rows = inner_open_facets(counted(mesh), box(field))
    assert (len(rows) > 0) == (n == 5)
    assert covered(mesh.vertices, rows).all()
    assert len(mesh.simplices) == len(good.simplices)
    total, same = (oracle.Complex.of(x.vertices, x.simplices).measure for x in (mesh, good))
    assert total == pytest.approx(same, rel=1e-12)


@pytest.mark.parametrize(("n", "m"), KINDS)
def test_every_vertex_is_where_the_interpolant_has_the_isovalue(n: int, m: int) -> None:
    """Section 2.2 and equation 4; the simplices lie in the Kuhn simplices they come from."""
    field = noise(n, m, seed=3)
    mesh = extract(field, 0.25)
    inside = field.origin + (mesh.vertices - field.origin) * (1 - 1e-14)
    np.testing.assert_allclose(interpolate(field, inside), 0.25, atol=1e-9)
    complex_ = section_of_field(field, 0.25)
    cell = complex_.parents // factorial(n)
    lowest = np.stack(np.unravel_index(cell, field.shape), axis=1)
    corner = complex_.points[complex_.simplices] - lowest[:, None]
    assert corner.min() > -1e-12
    assert corner.max() < 1 + 1e-12


@pytest.mark.parametrize(("n", "m"), [kind for kind in KINDS if kind[0] > kind[1]])
def test_orientation_puts_the_gradients_before_the_edges(n: int, m: int) -> None:
    """det(-g_1, .., -g_m, t_1, .., t_(n-m)) > 0 with gradients by equation 1."""
    field = noise(n, m, seed=4)
    complex_, mesh = section_of_field(field), extract(field)
    flat = field.values.reshape(m, -1)
    slopes = gradients(complex_.parents, lambda i: flat[:, i].T, field.shape, field.spacing)
    edges = np.diff(mesh.vertices[mesh.simplices], axis=1)
    frame = np.linalg.det(np.concatenate([-slopes, edges], axis=1))
    big = counted(mesh).measures > 1e-9
    assert big.any()
    assert (frame[big] > 0).all()


@pytest.mark.parametrize(("n", "m"), [(2, 1), (3, 1), (3, 2), (4, 2), (5, 3)])
def test_affine_fields_give_the_flat_set_itself(n: int, m: int) -> None:
    """phi^ is phi where phi is affine: every vertex solves the equations."""
    rng = np.random.default_rng(n * m)
    A, b = rng.normal(size=(m, n)), rng.normal(size=m) * 0.2
    field = sampled(n, 5, 1.0, *(lambda *x, r=r, s=s: s + np.tensordot(r, x, 1)
                                 for r, s in zip(A, b, strict=True)))  # fmt: skip
    mesh = extract(field)
    assert len(mesh.simplices) > 0
    np.testing.assert_allclose(mesh.vertices @ A.T + b, 0, atol=1e-12)


def test_it_is_marching_tetrahedra_for_a_scalar_field_in_space() -> None:
    """N = 3, m = 1, against VTK's contour of the same tetrahedra."""
    pyvista = pytest.importorskip("pyvista")
    field = noise(3, 1, seed=8)
    tetrahedra, _ = lattice_simplices(field.shape)
    points = field.position(np.indices(field.shape).reshape(3, -1).T)
    cells = np.hstack([np.full((len(tetrahedra), 1), 4), tetrahedra]).ravel()
    grid = pyvista.UnstructuredGrid(cells, np.full(len(tetrahedra), 10), points)
    grid["phi"] = field.values.ravel()
    peer = grid.contour([0.0], scalars="phi").triangulate()
    faces = peer.faces.reshape(-1, 4)[:, 1:].astype(np.int64)
    mesh = extract(field)
    assert len(faces) == len(mesh.simplices)
    assert len(peer.points) == len(mesh.vertices)
    near, _ = cKDTree(mesh.vertices).query(np.asarray(peer.points, float))
    np.testing.assert_allclose(near, 0, atol=1e-5)
    theirs = oracle.Complex.of(np.asarray(peer.points, float), faces)
    assert counted(mesh).measure == pytest.approx(theirs.measure, rel=1e-5)
    assert counted(mesh).euler == theirs.euler


def test_it_follows_the_curves_of_marching_faces_for_two_fields_in_space() -> None:
    """N = 3, m = 2, against Ljung and Ynnerman's curves: one length, one place, to O(h^2)."""
    pair = (sphere, lambda x, y, z: z - 0.4 * x - 0.2 * y + 0.1)
    apart, differences = [], []
    for N in (12, 23):
        field = sampled(3, N, 1.4, *pair)
        mesh = extract(field)
        fields = [Field.of(v, field.spacing, field.origin) for v in field.values]
        curves = intersection_curves(fields[0], fields[1], (0.0, 0.0))
        assert len(curves) == counted(mesh).components == 1
        assert curves[0].closed
        points = curves[0].polyline
        fine = np.concatenate([points[:-1] + t * np.diff(points, axis=0) for t in (0, 0.25, 0.5)])
        near, _ = cKDTree(fine).query(mesh.vertices)
        apart.append(np.max(near) / (2.8 / (N - 1)))
        length = counted(mesh).measure
        differences.append(abs(length - curves[0].length))
    assert max(apart) < 0.35
    assert differences[1] < 0.5 * differences[0]


def sphere(*x: Any) -> Any:
    """1 - |x|^2: inside the unit sphere is high."""
    return 1 - np.square(x).sum(axis=0)


@pytest.mark.parametrize(("n", "N", "euler"), [(2, 12, 0), (3, 11, 2), (4, 9, 0), (5, 5, 2)])
def test_spheres_have_the_euler_characteristic_of_spheres(n: int, N: int, euler: int) -> None:
    """S^(n-1) in R^n has 1 + (-1)^(n-1); it is one piece and encloses a positive volume."""
    field = sampled(n, N, 1.3, sphere)
    mesh = extract(field)
    assert_manifold(mesh, box(field))
    assert counted(mesh).euler == euler
    assert counted(mesh).components == 1
    assert counted(mesh).enclosed > 0
    assert len(counted(mesh).facets.uses) == len(mesh.simplices) * n // 2


MANIFOLDS: dict[str, tuple[int, int, float, tuple[Callable[..., Any], ...], int, int]] = {
    "circle in R^3": (3, 13, 1.4, (sphere, lambda x, y, z: z - 0.3 * x), 0, 1),
    "two-sphere in R^4": (4, 9, 1.4, (sphere, lambda x, y, z, w: w - 0.2 * x), 2, 1),
    "torus in R^3": (
        3, 21, 1.4, (lambda x, y, z: 0.09 - (np.hypot(x, y) - 0.9) ** 2 - z**2,), 0, 1,
    ),
    "Clifford torus in R^4": (
        4, 12, 1.4, (lambda x, y, z, w: 1 - x**2 - y**2, lambda x, y, z, w: 1 - z**2 - w**2), 0, 1,
    ),
    "torus in R^5": (
        5, 7, 1.5, (lambda x, y, z, w, v: 1 - x**2 - y**2,
                    lambda x, y, z, w, v: 1 - z**2 - w**2,
                    lambda x, y, z, w, v: v - 0.1 * x), 0, 1,
    ),
    "S^2 x S^1 in R^4": (
        4, 11, 1.6,
        (lambda x, y, z, w: 0.16 - (np.sqrt(x**2 + y**2 + z**2) - 1) ** 2 - w**2,), 0, 1,
    ),
    "two circles in R^3": (3, 12, 1.4, (sphere, lambda x, y, z: z**2 - 0.3), 0, 2),
}  # fmt: skip


@pytest.mark.parametrize("name", MANIFOLDS)
def test_known_closed_manifolds_have_their_euler_characteristic(name: str) -> None:
    """Any dimension and codimension; all are closed, none touches the border."""
    n, N, half, functions, euler, pieces = MANIFOLDS[name]
    field = sampled(n, N, half, *functions)
    mesh = extract(field)
    assert mesh.dimension == n - len(functions)
    assert_manifold(mesh, box(field))
    assert (counted(mesh).facets.uses == 2).all()
    assert counted(mesh).euler == euler
    assert counted(mesh).components == pieces


@pytest.mark.parametrize(("degree", "half", "N", "euler"), [(2, 1.5, 12, 0), (3, 1.5, 22, -3)])
def test_complex_curves_have_the_genus_of_their_degree(
    degree: int, half: float, N: int, euler: int
) -> None:
    """z1^d + z2^d = 1 in C^2 is a surface of genus (d-1)(d-2)/2 with d ends: 2 - 2g - d."""

    def f(x: Any, y: Any, p: Any, q: Any) -> Any:
        return (x + 1j * y) ** degree + (p + 1j * q) ** degree - 1

    field = sampled(4, N, half, lambda *x: f(*x).real, lambda *x: f(*x).imag)
    mesh = extract(field)
    assert_manifold(mesh, box(field))
    assert counted(mesh).euler == euler


@pytest.mark.parametrize(
    ("n", "functions", "exact", "sizes"),
    [
        (2, (sphere,), 2 * pi, (11, 21, 41)),
        (3, (sphere,), 4 * pi, (9, 17, 33)),
        (4, (sphere,), 2 * pi**2, (7, 13, 25)),
        (4, (lambda x, y, z, w: 1 - x**2 - y**2, lambda x, y, z, w: 1 - z**2 - w**2),
         4 * pi**2, (7, 13, 25)),
        (3, (sphere, lambda x, y, z: z - 0.5), pi * 3**0.5, (9, 17, 33)),
    ],
)  # fmt: skip
def test_volumes_of_known_manifolds_converge_in_second_order(
    n: int, functions: tuple[Callable[..., Any], ...], exact: float, sizes: tuple[int, ...]
) -> None:
    """The interpolant is linear: halving the spacing divides the error by four."""
    errors = []
    for N in sizes:
        mesh = extract(sampled(n, N, 1.33, *functions))
        errors.append(abs(counted(mesh).measure - exact))
    order = np.log2(errors[0] / errors[-1]) / (len(sizes) - 1)
    assert order > 1.7


@pytest.mark.parametrize("shift", [0, 61])
def test_welding_is_the_same_with_keys_that_can_be_packed_and_with_keys_that_cannot(
    shift: int,
) -> None:
    """The fast sort of packed keys and its plain twin, against NumPy's unique."""
    keys = np.random.default_rng(0).integers(0, 2, 50) << shift
    keys[:3] = [0, 1 << shift, 1]
    distinct, places = weld(keys)
    expected, where = np.unique(keys, return_inverse=True)
    np.testing.assert_array_equal(distinct, expected)
    np.testing.assert_array_equal(places, where)


def test_blocks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells cut in blocks of seven give the mesh of all cells cut at once."""
    field = noise(4, 2, 6)
    whole = extract(field)
    monkeypatch.setattr("isoref.fast.simplicial.BLOCK", 7 * 24)
    parts = extract(field)
    np.testing.assert_array_equal(whole.vertices, parts.vertices)
    np.testing.assert_array_equal(whole.simplices, parts.simplices)


def test_as_many_components_as_axes_give_the_roots() -> None:
    """N = m: isolated points, here where sin(3 pi x - y / 9) and cos(pi y) vanish together."""
    field = sampled(
        2, 61, 1.0, lambda x, y: np.sin(3 * pi * x - y / 9), lambda x, y: np.cos(pi * y)
    )
    mesh = extract(field)
    assert mesh.simplices.shape[1] == 1
    roots = [((k + y / 9 / pi) / 3, y) for k in range(-3, 4) for y in (-0.5, 0.5)]
    roots = [root for root in roots if abs(root[0]) <= 1]
    assert len(mesh.vertices) == len(mesh.simplices) == len(roots)
    np.testing.assert_allclose(mesh.vertices[np.lexsort(mesh.vertices.T[::-1])], roots, atol=0.01)


def degree_on_the_border(field: Field) -> float:
    """How often phi on the border goes round 0, by the angles of its simplices seen from there."""
    n = field.dimension
    rows, signs = lattice_simplices(field.shape)
    rows[signs < 0, :2] = rows[signs < 0, 1::-1]
    found = oracle.Complex.of(np.zeros((field.values[0].size, 0)), rows).facets
    border = found.uses == 1
    ends = field.values.reshape(n, -1).T[found.rows[border]]
    lengths = np.linalg.norm(ends, axis=2)
    volume = np.linalg.det(ends)
    if n == 1:
        angle = np.sign(volume)
    elif n == 2:
        angle = np.arctan2(volume, (ends[:, 0] * ends[:, 1]).sum(axis=1))
    else:
        # Van Oosterom and Strackee, "The solid angle of a plane triangle", 1983.
        pairs = [(0, 1, 2), (0, 2, 1), (1, 2, 0)]
        dots = [(ends[:, i] * ends[:, j]).sum(axis=1) * lengths[:, k] for i, j, k in pairs]
        angle = 2 * np.arctan2(volume, lengths.prod(axis=1) + np.sum(dots, axis=0))
    return float(angle @ found.balance[border] / (2, 2 * pi, 4 * pi)[n - 1])


@settings(max_examples=40)
@given(n=st.integers(1, 3), seed=st.integers(0, 10**6), ties=st.booleans())
def test_signs_of_points_sum_to_the_degree_on_the_border(n: int, seed: int, ties: bool) -> None:
    """N = m: whatever the samples inside are, tied ones too; the border has none."""
    rng = np.random.default_rng(seed)
    shape = (n, *rng.integers(3, 6, n))
    values = rng.normal(size=shape)
    if ties:
        inside = (slice(None), *[slice(1, -1)] * n)
        values[inside] = rng.integers(-1, 2, values[inside].shape)
    field = Field.of(values, dimension=n)
    total = jacobian_signs(section_of_field(field)).sum()
    assert total == pytest.approx(degree_on_the_border(field), abs=1e-9)


@pytest.mark.parametrize("power", [-3, -2, -1, 1, 2, 3])
def test_points_of_a_complex_power_have_the_sign_of_their_jacobian(power: int) -> None:
    """Z^d = c has d roots of index 1; with the conjugate of z, d of index -1."""

    def f(x: Any, y: Any) -> Any:
        return (x + 1j * y * np.sign(power)) ** abs(power) - 0.3 - 0.2j

    field = sampled(2, 41, 1.2, lambda *x: f(*x).real, lambda *x: f(*x).imag)
    complex_ = section_of_field(field)
    signs = jacobian_signs(complex_)
    assert signs.tolist() == [np.sign(power)] * abs(power)
    flat = field.values.reshape(2, -1)
    slopes = gradients(complex_.parents, lambda i: flat[:, i].T, field.shape, field.spacing)
    assert (np.sign(np.linalg.det(slopes)) == signs).all()


def test_only_points_have_jacobian_signs() -> None:
    """All else is oriented by its rows."""
    with pytest.raises(FieldError, match="simplices of dimension 1 are oriented by their rows"):
        jacobian_signs(section_of_field(noise(3, 2, 0)))


def test_zeros_change_no_coordinate_by_default_and_epsilon_moves_them() -> None:
    """Section 3, end: psi(v_i) = epsilon there, an infinitesimal here."""
    values = np.array([[0.0, 1.0], [-1.0, -1.0]])
    exact = extract(Field.of(values)).vertices
    moved = extract(Field.of(values), epsilon=1e-3).vertices
    assert [0.0, 0.0] in exact.tolist()
    assert [0.0, 0.0] not in moved.tolist()
    assert abs(exact - moved).max() < 2e-3


def test_a_level_outside_the_range_gives_an_empty_mesh_of_the_right_kind() -> None:
    """No surface is no error."""
    mesh = extract(noise(4, 2, 0), 99.0)
    assert (mesh.vertices.shape, mesh.simplices.shape) == ((0, 4), (0, 3))
    plain = article.extract(noise(4, 2, 0), 99.0)
    assert (plain.vertices.shape, plain.simplices.shape) == ((0, 4), (0, 3))


def test_components_may_have_isovalues_of_their_own() -> None:
    """The zero isosurface of phi minus the isovalues."""
    field = noise(3, 2, 1)
    shifted = Field.of(
        field.values - np.array([0.5, -0.25])[:, None, None, None],
        field.spacing, field.origin, dimension=3,
    )  # fmt: skip
    a, b = extract(field, [0.5, -0.25]), extract(shifted)
    np.testing.assert_array_equal(a.simplices, b.simplices)
    np.testing.assert_array_equal(a.vertices, b.vertices)


@pytest.mark.parametrize("dtype", ["uint8", "int16", "float32", "bool"])
def test_any_real_type_is_read_as_its_numbers(dtype: str) -> None:
    """The mesh of a narrow type is that of the same numbers as float64."""
    values = (np.random.default_rng(2).random((5, 5, 5)) * 2).astype(dtype)
    a, b = extract(Field.of(values), 0.4), extract(Field.of(values.astype(float)), 0.4)
    np.testing.assert_array_equal(a.vertices, b.vertices)
    np.testing.assert_array_equal(a.simplices, b.simplices)


def test_bad_input_is_refused_with_a_reason() -> None:
    """More components than axes, a thin lattice, huge numbers, too many isovalues, no memory."""
    with pytest.raises(FieldError, match="3 components on a lattice of dimension 2"):
        extract(Field.of(np.zeros((3, 4, 4)), dimension=2))
    with pytest.raises(FieldError, match="1 sample thick along axis 2"):
        extract(Field.of(np.zeros((4, 4, 1))))
    with pytest.raises(FieldError, match="rescale the field"):
        extract(Field.of(np.array([[1e308, -1e308], [0, 0]])))
    with pytest.raises(FieldError, match="3 isovalues for 1 components"):
        extract(Field.of(np.zeros((4, 4))), [1, 2, 3])
    with pytest.raises(FieldError, match="not finite"):
        extract(Field.of(np.zeros((4, 4))), float("nan"))


def test_memory_that_would_not_suffice_is_refused_before_anything_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the numbers: of the pass over the samples, and of the isosurface after a trial."""
    monkeypatch.delattr("isoref.fast.simplicial.united")
    with pytest.raises(
        FieldError, match=r"one pass over 48 samples needs about 240 bytes, but 200"
    ):
        extract(noise(4, 1, 0), memory=200)
    with pytest.raises(FieldError, match=r"the 24 simplices of a cell needs .* 1,000 are allowed"):
        extract(noise(4, 1, 0), memory=1000)
    with pytest.raises(FieldError, match=r"cells needs about .* but 60,000 are allowed; take a"):
        extract(Field.of(np.random.default_rng(0).normal(size=(6,) * 4)), memory=60_000)


@pytest.mark.parametrize(("n", "m"), [(7, 3), (8, 1), (9, 8), (12, 1)])
def test_what_cannot_be_cut_is_bounded_before_anything_is_listed(n: int, m: int) -> None:
    """Ten million bytes allowed: refused in less, though n! simplices would take far more."""
    field = Field.of(np.random.default_rng(n).normal(size=(m, *(2,) * n)), dimension=n)
    tracemalloc.start()
    try:
        with pytest.raises(FieldError, match="but 10,000,000 are allowed"):
            extract(field, memory=10_000_000)
        used = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert used < 10_000_000


@pytest.mark.parametrize(("n", "m", "N"), [(5, 3, 3), (6, 1, 2), (6, 4, 2), (5, 2, 3)])
def test_what_is_cut_stays_within_the_memory_allowed(n: int, m: int, N: int) -> None:
    """As Python traces it, for noise, which leaves most: in small portions, and the same mesh."""
    field = Field.of(np.random.default_rng(n).normal(size=(m, *(N,) * n)), dimension=n)
    whole = extract(field)
    allowed = 3_000_000
    while True:
        tracemalloc.start()
        try:
            mesh = extract(field, memory=allowed)
        except FieldError:
            allowed *= 2
            continue
        finally:
            used = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
        break
    assert used < allowed
    np.testing.assert_array_equal(mesh.vertices, whole.vertices)
    np.testing.assert_array_equal(mesh.simplices, whole.simplices)


def test_the_bound_of_pieces_is_that_of_the_paper() -> None:
    """Section 4: n_1 <= 6, n_2 <= 6 x 3, n_3 <= 6 x 3 x 2."""
    assert most_pieces(5, 3) == [6, 18, 36]


@pytest.mark.parametrize(
    ("n", "m", "N"), [(2, 1, 200), (3, 1, 24), (3, 2, 24), (3, 3, 24), (4, 2, 8), (5, 3, 4)]
)
def test_the_memory_estimated_is_about_the_memory_used(n: int, m: int, N: int) -> None:
    """A trial on a share of the cells tells the highest use, as Python traces it, to a factor."""
    field = Field.of(np.random.default_rng(n).normal(size=(m, *(N,) * n)), dimension=n)
    tracemalloc.start()
    extract(field)
    used = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # With less memory smaller portions are cut: take so little that the result does not fit.
    estimated, allowed = 0, used
    while not estimated:
        allowed //= 2
        try:
            extract(field, memory=allowed)
        except FieldError as error:
            estimated = int(re.findall(r"about ([\d,]+) bytes", str(error))[0].replace(",", ""))
    assert allowed < estimated < 2 * used


def test_without_a_word_the_machine_says_how_much_memory_there_is() -> None:
    """A number of bytes between a megabyte and as many as there can be."""
    assert allowed_memory(12) == 12
    assert 1 << 20 < allowed_memory(None) <= sys.maxsize
