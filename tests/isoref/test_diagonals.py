"""Diagonals chosen by a criterion on the values."""

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.trilinear_distance import distance
from isoref import asymptotic_decider, trilinear_cubes
from isoref.diagonals import Criterion, extract, smallest_angle, smoothness
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.rule import Rule

CRITERIA: list[Criterion] = ["smooth", "angle", "near"]
RULES = [asymptotic_decider.RULE, trilinear_cubes.RULE]


def noise(seed: int, n: int = 9) -> Field:
    """Noise, smoothed once along each axis, in cells that are no cubes."""
    values = np.random.default_rng(seed).normal(size=(n + 1,) * 3)
    for axis in range(3):
        values = values.take(range(n), axis) + values.take(range(1, n + 1), axis)
    return Field.of(values, (1.0, 0.5, 0.75), (3.0, -1.0, 0.0))


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_topology_stays_and_triangles_turn(rule: Rule, criterion: Criterion) -> None:
    """Same vertices, as many triangles, the same Euler characteristic, borders and closedness."""
    before, after = sweep(rule, noise(0), 0.0), extract(rule, noise(0), 0.0, criterion)
    np.testing.assert_array_equal(before.vertices, after.vertices)
    assert before.simplices.shape == after.simplices.shape
    assert (before.simplices != after.simplices).any()
    old, new = (Complex.of(m.vertices, m.simplices) for m in (before, after))
    assert (old.euler, old.components) == (new.euler, new.components)
    assert len(new.crowded_facets) == len(new.misdirected_facets) == 0
    assert {tuple(e) for e in old.open_facets.tolist()} == {
        tuple(e) for e in new.open_facets.tolist()
    }


@pytest.mark.parametrize("criterion", CRITERIA)
def test_no_two_triangles_cross(criterion: Criterion) -> None:
    """In exact arithmetic, on noise."""
    mesh = extract(asymptotic_decider.RULE, noise(1), 0.0, criterion)
    assert len(mesh.simplices) > 500
    assert len(self_intersections(mesh.vertices, mesh.simplices)) == 0


def test_the_nearest_diagonals_cross_nothing_in_cells_with_tunnels() -> None:
    """On white noise, of which some cells have points inside: those are left alone."""
    field = Field.of(np.random.default_rng(0).normal(size=(12, 12, 12)))
    mesh = extract(trilinear_cubes.RULE, field, 0.0, "near")
    assert (mesh.simplices != sweep(trilinear_cubes.RULE, field, 0.0).simplices).any()
    assert len(self_intersections(mesh.vertices, mesh.simplices)) == 0


def test_edges_on_faces_between_cells_stay() -> None:
    """Only edges inside a cell come and go: each cell keeps its boundary."""
    field = noise(2)
    mesh = sweep(asymptotic_decider.RULE, field, 0.0, provenance=True)
    cells = mesh.traced().cells
    turned = extract(asymptotic_decider.RULE, field, 0.0)
    changed = 0
    for cell in np.unique(cells):
        sides = []
        for triangles in (mesh.simplices[cells == cell], turned.simplices[cells == cell]):
            pairs = np.concatenate([triangles, np.roll(triangles, -1, axis=1)]).reshape(2, -1).T
            own = {(int(a), int(b)) for a, b in pairs}
            sides.append({(a, b) for a, b in own if (b, a) not in own})
            changed += len(own)
        assert sides[0] == sides[1]
    assert changed > 0


def test_a_quadrilateral_is_cut_where_it_bends_least() -> None:
    """A cylinder's quadrilaterals: along the axis the two triangles share a plane nearly."""
    field = Field.of(9.0 - ((np.indices((4, 8, 8))[1:] - 3.6) ** 2).sum(axis=0))
    table = sweep(asymptotic_decider.RULE, field, 0.0)
    smooth = extract(asymptotic_decider.RULE, field, 0.0)
    sharp = extract(asymptotic_decider.RULE, field, 0.0, "angle")

    def mean_angle(mesh: object) -> float:
        """Mean angle between the normals of neighbours."""
        surface = Complex.of(mesh.vertices, mesh.simplices)  # type: ignore[attr-defined]
        n = surface.normals / np.linalg.norm(surface.normals, axis=1)[:, None]
        edges = surface.facets
        two = edges.uses == 2
        faces = [edges.sides[edges.start[two] + i] // 3 for i in (0, 1)]
        return float(np.arccos(np.clip((n[faces[0]] * n[faces[1]]).sum(axis=1), -1, 1)).mean())

    assert mean_angle(smooth) <= mean_angle(table)
    least = [
        min(smallest_angle(np.stack([m.vertices[t]] * 2)) for t in m.simplices)
        for m in (table, sharp)
    ]
    assert least[1] >= least[0]


def test_triangles_without_area_are_worth_nothing() -> None:
    """No criterion prefers them."""
    flat = np.zeros((2, 3, 3))
    assert smoothness(flat) == -1
    assert smallest_angle(flat) == 0


def test_a_criterion_that_is_none_is_refused() -> None:
    """The message names those there are."""
    with pytest.raises(ValueError, match="smooth, angle"):
        extract(asymptotic_decider.RULE, noise(0), 0.0, "short")  # type: ignore[arg-type]


def test_nothing_to_turn_is_an_empty_mesh() -> None:
    """An isovalue out of range."""
    assert len(extract(asymptotic_decider.RULE, noise(0), 1e9).simplices) == 0


def test_the_nearest_diagonals_draw_nearer_at_as_many_triangles() -> None:
    """The mean distance of middles of triangles from the level set falls by a tenth at least."""
    field = Field.of(noise(3).values)
    for rule in (asymptotic_decider.RULE, trilinear_cubes.RULE):
        plain, near = sweep(rule, field, 0.0), extract(rule, field, 0.0, "near")
        assert len(near.simplices) == len(plain.simplices)
        off = [
            np.nanmean(distance(field.values, 0.0, mesh.vertices[mesh.simplices].mean(axis=1)))
            for mesh in (plain, near)
        ]
        assert off[1] < 0.9 * off[0]
