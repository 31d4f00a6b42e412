"""Marching faces, as the article has it: tables from their definition, decisions of faces."""

import numpy as np
import pytest
from isoref.curves import Curve
from isoref.field import Field, FieldError
from isoref.marching_faces import (
    FACE_TABLE,
    FaceRule,
    Isosurface,
    edge_across,
    face_check,
    gradient,
    intersection_curves,
    is_separated,
    marching_faces,
    voxel_config,
)
from isoref.sweep import lattice_edge

RULES: tuple[FaceRule, ...] = ("gradient", "middle", "asymptotic", "separated", "joined")


def test_a_face_is_in_the_face_table_where_its_corners_differ() -> None:
    """Section 6: a mixed face has the surface intersecting it. Checked on explicit cells."""
    for b in range(256):
        cell = np.array([b >> c & 1 for c in range(8)]).reshape(2, 2, 2).transpose(2, 1, 0)
        for f in range(6):
            face = cell.take(f % 2, axis=f // 2)
            assert (FACE_TABLE[b] >> f & 1) == (face.min() != face.max())


def test_a_face_has_six_configurations_up_to_rotation() -> None:
    """Fig. 3: by rotation all 16 combinations can be obtained."""
    turned = {
        min(tuple((c >> (k + turn) % 4) & 1 for k in range(4)) for turn in range(4))
        for c in range(16)
    }
    assert len(turned) == 6


def test_face_check_visits_every_face_once() -> None:
    """FACECHECK: faces 1, 3 and 5 only where there is no next voxel."""
    cells = (2, 3, 1)
    visits = sum(bin(face_check(index, cells)).count("1") for index in np.ndindex(cells))
    assert visits == 3 * 3 * 1 + 2 * 4 * 1 + 2 * 3 * 2


def test_the_gradient_is_central_and_one_sided_at_the_border() -> None:
    """Eq. 4, against numpy.gradient."""
    field = Field.of(np.random.default_rng(1).normal(size=(4, 3, 2)), (0.5, 1, 2))
    expected = np.moveaxis(np.asarray(np.gradient(field.values, 0.5, 1, 2)), 0, -1)
    for index in np.ndindex(4, 3, 2):
        np.testing.assert_allclose(gradient(field, index), expected[index], atol=1e-14)


@pytest.mark.parametrize("rule", RULES)
def test_both_voxels_at_a_face_decide_alike(rule: FaceRule) -> None:
    """The invariant on which whole curves rest, with ties too."""
    chance = np.random.default_rng(3)
    asked = 0
    for values in (chance.normal(size=(5, 5, 5)), chance.integers(-1, 2, (6, 6, 6))):
        surface = Isosurface(Field.of(values), 0.0, rule)
        for voxel in np.ndindex(*(n - 2 for n in values.shape)):
            for axis in range(3):
                beside = tuple(i + (a == axis) for a, i in enumerate(voxel))
                here = is_separated(surface, voxel, 2 * axis + 1)
                there = is_separated(surface, beside, 2 * axis)
                assert here == there
                asked += here
    assert (asked > 10) == (rule != "joined")


def test_an_edge_keeps_its_place_across_a_face() -> None:
    """The same lattice edge, named from the voxel below and from the one above."""
    for axis in range(3):
        for e in (e for e in range(12) if e // 4 != axis):
            low = lattice_edge((3, 3, 3), e)
            beside = tuple(3 + (low[axis] * 2 - 7) * (a == axis) for a in range(3))
            assert lattice_edge(beside, edge_across(e, axis)) == low


def test_the_configuration_compares_whole_numbers_exactly() -> None:
    """2^53 + 3 is below 2^53 + 4, though as a float it is not."""
    values = np.full((2, 2, 2), 2**53 + 3)
    values[1, 1, 1] = 2**53 + 4
    assert voxel_config(Isosurface(Field.of(values), float(2**53 + 4), "joined"), (0, 0, 0)) == 128


def test_two_planes_meet_in_a_straight_line() -> None:
    """The line runs along ``grad psi_1 x grad psi_2``, from border to border."""
    x, y, _ = np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij")
    a, b = Field.of(x - 1.25), Field.of(y - 1.5)
    points = marching_faces(a, b)
    np.testing.assert_allclose(points.tangents, [[0, 0, 1]] * 4)
    np.testing.assert_allclose(points.confidence, 1)
    (curve,) = intersection_curves(a, b)
    assert isinstance(curve, Curve)
    np.testing.assert_allclose(curve.points, [[1.25, 1.5, z] for z in range(4)])


def test_fields_must_share_a_lattice() -> None:
    """An error names what was wrong."""
    a = Field.of(np.zeros((3, 3, 3)))
    with pytest.raises(FieldError, match=r"\(3, 3, 3\) and \(3, 3, 4\)"):
        marching_faces(a, Field.of(np.zeros((3, 3, 4))))
    with pytest.raises(FieldError, match="rule"):
        marching_faces(a, a, rule="guess")  # type: ignore[arg-type]
