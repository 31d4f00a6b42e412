"""Projected isosurfaces have the normals that equation 6 gives them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref import Field, FieldError, Mesh
from isoref.fast.simplicial import extract, section_of_field
from isoref.projection import dropped_axes, normals, project, side
from isoref.simplicial import gradients

PROJECTIONS = [
    (2, 1, (0, 1)),
    (3, 1, (0, 1, 2)),
    (3, 2, (0, 1)),
    (3, 2, (2, 0)),
    (4, 2, (0, 1, 2)),
    (4, 2, (0, 1, 3)),
    (4, 2, (3, 1, 0)),
    (5, 3, (0, 1, 2)),
    (5, 3, (4, 0, 2)),
    (4, 3, (0, 1)),
    (4, 1, (0, 1, 2, 3)),
]


@pytest.mark.parametrize(("n", "m", "kept"), PROJECTIONS)
def test_cofactor_normals_are_the_right_hand_normals_of_the_projected_mesh(
    n: int, m: int, kept: tuple[int, ...]
) -> None:
    """Equation 6 and its sign, against the edges of each projected simplex."""
    rng = np.random.default_rng(n * 10 + m)
    field = Field.of(
        rng.normal(size=(m,) + ({2: 8}.get(n, 3),) * n), list(rng.uniform(0.5, 2, n)), dimension=n
    )
    complex_, mesh = section_of_field(field), extract(field)
    flat = field.values.reshape(m, -1)
    g = gradients(complex_.parents, lambda i: flat[:, i].T, field.shape, field.spacing)
    edges = np.diff(project(mesh, kept).vertices[mesh.simplices], axis=1)
    right_hand = np.stack(
        [
            np.linalg.det(np.concatenate([np.broadcast_to(x, edges[:, :1].shape), edges], axis=1))
            for x in np.eye(n - m + 1)
        ],
        axis=1,
    )
    found = side(n, kept) * normals(g, kept)
    scale = np.linalg.norm(right_hand, axis=1) * np.linalg.norm(found, axis=1)
    clear = np.linalg.norm(right_hand, axis=1) > 1e-6
    cosine = (right_hand * found).sum(axis=1)[clear] / scale[clear]
    assert clear.sum() > 10
    np.testing.assert_allclose(cosine, 1, atol=1e-6)


@given(seed=st.integers(0, 10**6), kept=st.permutations(range(5)))
def test_the_example_of_section_5_is_the_general_formula(seed: int, kept: list[int]) -> None:
    """Section 5: phi in Z^5 -> R^3, written out; and n has no part along dropped axes."""
    g = np.random.default_rng(seed).normal(size=(3, 5))
    a, b = g[:, 3], g[:, 4]
    printed = (
        g[0] * (a[1] * b[2] - a[2] * b[1])
        - g[1] * (a[0] * b[2] - a[2] * b[0])
        + g[2] * (a[0] * b[1] - a[1] * b[0])
    )
    np.testing.assert_allclose(normals(g, (0, 1, 2)), printed[:3], atol=1e-12)
    np.testing.assert_allclose(printed[3:], 0, atol=1e-12)
    basis = np.linalg.svd(g)[2][3:]
    projected = basis[:, kept[:3]]
    np.testing.assert_allclose(projected @ normals(g, kept[:3]), 0, atol=1e-9)


def test_normals_vanish_at_the_silhouette_and_only_there() -> None:
    """The circle x^2 + y^2 = 1, z = 0 of R^3, seen in (x, z): edge-on at the ends y = 0."""
    angle = np.linspace(0, 2 * np.pi, 9)
    x, y = np.cos(angle), np.sin(angle)
    zero, one = np.zeros(9), np.ones(9)
    g = np.stack(
        [np.stack([2 * x, 2 * y, zero], axis=1), np.stack([zero, zero, one], axis=1)], axis=1
    )
    length = np.linalg.norm(normals(g, (0, 2)), axis=1)
    np.testing.assert_array_equal(length < 1e-9, abs(y) < 1e-9)


def test_the_projection_of_two_spheres_is_the_exact_sphere() -> None:
    """Section 7.5: x^2 + y^2 + z^2 = 3/4, with normals along the radius."""
    axis = np.linspace(-1.3, 1.3, 14)
    x = np.stack(np.meshgrid(*[axis] * 4, indexing="ij"))
    r = (x[:3] ** 2).sum(axis=0)
    values = np.stack([r + (x[3] - 0.5) ** 2 - 1, r + (x[3] + 0.5) ** 2 - 1])
    field = Field.of(values, 2.6 / 13, [-1.3] * 4, dimension=4)
    sphere = project(extract(field), (0, 1, 2))
    radius = np.linalg.norm(sphere.vertices, axis=1)
    np.testing.assert_allclose(radius, 0.75**0.5, atol=0.03)
    complex_ = section_of_field(field)
    flat = field.values.reshape(2, -1)
    g = gradients(complex_.parents, lambda i: flat[:, i].T, field.shape, field.spacing)
    n = normals(g, (0, 1, 2))
    centre = sphere.vertices[sphere.simplices].mean(axis=1)
    cosine = (n * centre).sum(axis=1) / np.linalg.norm(n, axis=1) / np.linalg.norm(centre, axis=1)
    assert abs(cosine).min() > 0.9
    assert len(set(np.sign(cosine))) == 1


def test_bad_axes_are_refused_with_a_reason() -> None:
    """Axes that are not there, twice the same, too many."""
    with pytest.raises(FieldError, match="not distinct axes of R"):
        project(Mesh.empty(4, 2), (0, 1, 4))
    with pytest.raises(FieldError, match="not distinct axes of R"):
        project(Mesh.empty(4, 2), (0, 1, 1))
    with pytest.raises(FieldError, match="not distinct axes of R"):
        normals(np.zeros((2, 4)), (0, 1, 4))
    with pytest.raises(FieldError, match="2 axes kept of 4 with 2 components; 3 make"):
        normals(np.zeros((2, 4)), (0, 1))
    assert dropped_axes(4, (1, 2)) == [0, 3]
