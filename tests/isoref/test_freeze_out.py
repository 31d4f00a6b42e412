"""Freeze-out: eq. 1 of Schlei, and the theorem of Gauss on closed surfaces."""

import numpy as np
import pytest
from isoref.fast.vesta import extract
from isoref.field import Field, Floats
from isoref.freeze_out import (
    contour_stack,
    correspondence_problems,
    cycle_elements,
    hypersurface,
    physical,
    physical_triangles,
    triangle_elements,
)
from isoref.vesta import SIX_SURFACES


def ball(n: int) -> Field:
    """One minus the distance from the middle of a cube of side 3, n samples a side."""
    x = np.linspace(-1.5, 1.5, n)
    distance = np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None] ** 2)
    return Field.of(1 - distance, x[1] - x[0], [-1.5] * 3)


def noise() -> Field:
    """A field with every ambiguity."""
    return Field.of(np.random.default_rng(7).normal(size=(8, 9, 10)), (1, 0.5, 2))


def position(x: Floats) -> Floats:
    """The linear field whose divergence is one."""
    return x / 3


def test_both_normals_sum_to_zero_over_a_closed_surface() -> None:
    """Section III.C: a closed surface has no net normal, cycle by cycle as well (eq. 1)."""
    surface = hypersurface(noise(), 0.3)
    assert np.allclose(cycle_elements(surface).normals.sum(axis=0), 0)
    for resolution in ("L", "H"):
        elements = triangle_elements(surface.mesh(resolution))
        assert np.allclose(elements.normals.sum(axis=0), 0)


@pytest.mark.parametrize(("mode", "resolution"), SIX_SURFACES)
def test_the_flux_of_a_linear_field_is_the_volume(mode: str, resolution: str) -> None:
    """Gauss: with dsigma at the middles it is the sum of the tetrahedra from the origin."""
    mesh = extract(noise(), 0.3, mode=mode, border="closed").mesh(resolution)  # type: ignore[arg-type]
    volume = float(np.linalg.det(mesh.vertices[mesh.simplices]).sum()) / 6
    assert triangle_elements(mesh).flux(position) == pytest.approx(volume)
    skew = np.array([[1.0, 2, 0], [0, -3, 1], [5, 0, 7]])
    assert triangle_elements(mesh).flux(lambda x: x @ skew) == pytest.approx(5 * volume)


def test_a_normal_a_cycle_is_accurate_to_second_order() -> None:
    """Section III.C: fewer normals; the flux through a ball tends to its volume fourfold."""
    errors = [
        abs(cycle_elements(hypersurface(ball(n), 0)).flux(position) - 4 / 3 * np.pi)
        for n in (13, 25, 49)
    ]
    assert errors[0] / errors[1] > 3
    assert errors[1] / errors[2] > 3


def test_unphysical_pieces_are_discarded() -> None:
    """Section III.C: no triangle keeps a corner with a negative radius or time."""
    field = Field.of(np.ones((3, 3, 3)))
    surface = hypersurface(field, 0.5)
    mesh = physical_triangles(surface.mesh("H"), axes=(0, 1))
    used = mesh.vertices[mesh.simplices.ravel()]
    assert len(used)
    assert (used[:, :2] >= 0).all()
    assert (used[:, 2] < 0).any()
    whole = physical(surface, axes=(0, 1))
    assert 0 < sum(whole.lengths.values()) < sum(surface.lengths.values())
    for rows in whole.cycles.values():
        assert (whole.points[rows][..., :2] >= 0).all()


def test_stacked_contours_have_a_correspondence_problem_where_their_number_changes() -> None:
    """Section III.C, Fig. 30, frames 20 and 21: one contour has to become two."""
    grey = np.zeros((4, 3, 5))
    grey[1, 1, 1:4] = grey[2, 1, 1] = grey[2, 1, 3] = 1
    stack = contour_stack(Field.of(grey), 0.5, axis=0)
    assert [len(contours) for contours in stack] == [0, 1, 2, 0]
    assert correspondence_problems(stack) == [1]
    assert correspondence_problems(contour_stack(Field.of(grey), 0.5, axis=2)) == []
