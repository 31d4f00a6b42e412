"""The correct extractors are what they say, and the cheats are right somewhere and wrong elsewhere.

Judged without the grader, by counts and by measures of bodies: these functions judge the grader.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from isograde.oracles.self_intersections import self_intersections
from isoref.field import Array, Floats, Integers
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tests.isograde.cheats import CHEATS, EMPTY_HANDED
from tests.isograde.families import CORRECT, Family
from tests.isoref.counting import edges, fans

EVERY = pytest.mark.parametrize("name", CORRECT)
SPACING = (1.0, 2.0, 0.5)
SHAPE = (18, 19, 20)
CENTRE = np.array([8.3, 8.8, 9.6])
RADIUS = 6.0


def asked(family: Family, values: Array, isovalue: float) -> tuple[Floats, Integers]:
    """The answer in the house's conventions and index coordinates, welded, polygons as they are."""
    says = family.says
    conventions = says.get("conventions", {})
    vertices, faces = family.function(values, isovalue, SPACING)
    points = np.array(vertices, np.float64).reshape(-1, 3)
    rows = np.array(faces, np.int64)
    turned = conventions.get("axes") == "reversed"
    if turned:
        points = points[:, ::-1]
    if turned != (conventions.get("normals") == "to_high"):
        rows = rows[:, ::-1]
    if conventions.get("units") != "index":
        points = points / SPACING
    if says.get("mesh"):
        points, rows = welded(points, rows, says["mesh"]["soup"])
    return points, rows


def welded(points: Floats, rows: Integers, tolerance: float) -> tuple[Floats, Integers]:
    """The mesh with vertices within the tolerance made one."""
    pairs = cKDTree(points).query_pairs(max(tolerance, 1e-12), output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    _, name = connected_components(graph, directed=False)
    _, first = np.unique(name, return_index=True)
    return points[first], name[rows].astype(np.int64)


def posed(family: Family, values: Floats) -> Array:
    """The samples as a type that the extractor takes."""
    types = family.says.get("limits", {}).get("types", ["float64"])
    return values.astype("float64" if "float64" in types else types[0])


def ball(shape: tuple[int, ...] = SHAPE) -> Floats:
    """The distance to a sphere, positive inside."""
    x = np.indices(shape) - CENTRE[:, None, None, None]
    return np.asarray(RADIUS - np.sqrt((x**2).sum(axis=0)))


def shape_for(family: Family, shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape, or the cube on its longest side where only cubes are taken."""
    cubes = family.says.get("limits", {}).get("cubes", False)
    return (max(shape),) * len(shape) if cubes else shape


def in_triangles(rows: Integers) -> Integers:
    """Polygons as fans of triangles."""
    return np.concatenate([rows[:, [0, i, i + 1]] for i in range(1, rows.shape[1] - 1)])


def test_there_are_enough_of_every_kind() -> None:
    """Issue: at least 20 correct extractors of different families, conventions and layouts."""
    said = [family.says for family in CORRECT.values()]
    assert len(said) >= 40
    placed = {str(one.get("vertices", "edges")).split("'")[-2:][0] for one in said}
    assert len(placed) >= 3
    drawn = {str(one.get("interpolant", "multilinear"))[:12] for one in said}
    assert drawn == {"multilinear", "kuhn", "{'tetrahedra", "labels"}
    assert sum("mesh" in one for one in said) >= 10
    ends = {str(one.get("domain", "open")) for one in said}
    assert len(ends) >= 6
    assert all(family.function.__doc__ for family in [*CORRECT.values(), *CHEATS.values()])


@EVERY
def test_a_ball_comes_out_closed_in_place_and_of_its_size(name: str) -> None:
    """One piece of Euler number 2; the mean offset and the centre within the design's bounds."""
    family = CORRECT[name]
    values = posed(family, ball(shape_for(family, SHAPE)))
    points, rows = asked(family, values, 0.0)
    found = edges(rows)
    assert len(found.one_sided) == 0
    assert len(np.unique(rows)) - len(found.ends) + len(rows) == 2
    corners = points[in_triangles(rows)]
    volume = np.linalg.det(corners).sum() / 6
    offset = (volume - 4 / 3 * np.pi * RADIUS**3) / (4 * np.pi * RADIUS**2)
    assert abs(offset) < bound(family)
    centre = (np.linalg.det(corners)[:, None] * corners.sum(axis=1)).sum(axis=0) / 24 / volume
    np.testing.assert_allclose(centre, CENTRE, atol=0.25)


def bound(family: Family) -> float:
    """The largest mean offset from a ball, in cells, that the declaration allows (design)."""
    reach = family.says.get("vertices", {"own": 1.0})
    scale = reach["own"] if isinstance(reach, dict) else 1.0
    chord = 0.385 if family.says.get("vertices") == "cells" else 3 / 8 * scale**2
    labels = 0.5 if family.says.get("interpolant") == "labels" else 0.0
    return chord / RADIUS + labels


@pytest.mark.parametrize(
    ("name", "kind"),
    [(name, "noise") for name in CORRECT]
    # In a soup with ties, what touches cannot be told from what is joined.
    + [(name, "integers") for name, family in CORRECT.items() if "mesh" not in family.says],
)
def test_any_field_comes_out_closed_behind_a_low_border(name: str, kind: str) -> None:
    """Exact counts of half-edges; manifold unless the declaration excepts that."""
    family = CORRECT[name]
    rng = np.random.default_rng(3)
    shape = shape_for(family, (7, 8, 9))
    inner = rng.normal(size=shape) if kind == "noise" else rng.integers(-2, 3, size=shape) + 0.0
    if "own" in str(family.says.get("vertices")):
        inner = np.repeat(np.repeat(np.repeat(inner, 2, 0), 2, 1), 2, 2)
    values = posed(family, np.pad(inner, 3, constant_values=-9.0))
    points, rows = asked(family, values, 0.0)
    found = edges(rows)
    assert len(rows) > 500
    assert len(found.one_sided) == 0
    if "not_promised" not in family.says:
        assert len(found.crowded) == 0
        assert set(fans(rows, len(points)).tolist()) == {1}


@pytest.mark.parametrize("name", sorted(CORRECT))
def test_no_triangles_cross_on_noise(name: str) -> None:
    """Level 2, and so it is of nets, which are not manifolds."""
    family = CORRECT[name]
    values = posed(family, np.random.default_rng(4).normal(size=(8, 8, 8)))
    points, rows = asked(family, values, 0.0)
    triangles = in_triangles(rows)
    assert len(triangles) > 200
    assert len(self_intersections(points, triangles)) == 0


@EVERY
def test_open_edges_are_at_the_declared_end(name: str) -> None:
    """In the end's plane, or for vertices in cells in the border layer; none where it is closed."""
    family = CORRECT[name]
    shape = (9, 9, 9)
    points, rows = asked(family, posed(family, np.random.default_rng(5).normal(size=shape)), 0.0)
    ends = edges(rows).one_sided
    domain = family.says.get("domain", "open")
    said: dict[str, Any] = {"inset": 0.0, "end": domain} if isinstance(domain, str) else domain
    if said["end"] == "closed":
        assert len(ends) == 0
        assert np.ptp(points, axis=0) == pytest.approx(np.subtract(shape, 1 + 2 * said["inset"]))
        return
    last = np.subtract(shape, 1) - said["inset"] + (said["end"] == "periodic")
    wide = 0.5 if family.says.get("vertices") == "cells" else 1e-4
    both = points[ends]
    at_low = (np.abs(both - said["inset"]) <= wide).all(axis=1)
    at_high = (np.abs(both - last) <= wide).all(axis=1)
    assert len(ends) > 50
    assert (at_low | at_high).any(axis=1).all()


def test_what_is_open_in_the_last_plane_of_a_periodic_one_is_open_in_the_first() -> None:
    """Moved by the period, with the same corners."""
    values = np.random.default_rng(6).normal(size=(5, 6, 7))
    points, rows = asked(CORRECT["periodic"], values, 0.0)
    both = points[edges(rows).one_sided]
    for axis in range(3):
        flat = np.ptp(both[..., axis], axis=1) == 0
        low, high = (both[flat & (both[:, 0, axis] == x)] for x in (0, values.shape[axis]))
        low = low[[(np.delete(b, axis, 1) % 1 != 0).any() for b in low]]
        assert len(low) > 10
        moved = low + np.eye(3)[axis] * values.shape[axis]
        assert {pair(b) for b in moved} <= {pair(b) for b in high}


def pair(ends: Floats) -> frozenset[tuple[float, ...]]:
    """The ends of an edge, in either order, to nine digits."""
    return frozenset(tuple(row) for row in np.round(ends, 9).tolist())


@pytest.mark.parametrize("name", ["ties_outside", "all_otherwise"])
def test_a_tied_sample_counts_as_outside_where_that_is_declared(name: str) -> None:
    """A sample on the isovalue in a field that is low elsewhere has no surface round it."""
    values = np.zeros((5, 5, 5))
    values[2, 2, 2] = 1
    assert len(asked(CORRECT["cubes"], values, 1.0)[1]) > 0
    if name == "all_otherwise":
        with pytest.raises(ValueError, match="out of range"):
            asked(CORRECT[name], values, 1.0)
    else:
        assert len(asked(CORRECT[name], values, 1.0)[1]) == 0


def test_a_soup_from_either_end_differs_in_its_last_digits_only() -> None:
    """Equal corners are farther apart than rounding, and nearer than 1e-6 of a cell."""
    family = CORRECT["cubes_in_soup_from_either_end"]
    values = np.random.default_rng(7).normal(size=(8, 8, 8))
    vertices, _ = family.function(values, 0.0, (1, 1, 1))
    near = cKDTree(vertices).query_pairs(1e-6, output_type="ndarray")
    apart = np.linalg.norm(vertices[near[:, 0]] - vertices[near[:, 1]], axis=1)
    assert (apart > 1e-10).sum() > 100
    assert apart.max() < 2e-7
    whole, _ = CORRECT["cubes"].function(values, 0.0, (1, 1, 1))
    assert len(welded(vertices, np.arange(len(vertices)).reshape(-1, 3), 1e-6)[0]) == len(whole)


def test_flat_triangles_lie_in_faces_and_draw_the_same_pieces() -> None:
    """The same Euler number as without them."""
    values = np.pad(np.random.default_rng(8).normal(size=(8, 8, 8)), 1, constant_values=-9)
    flat, plain = (
        asked(CORRECT[n], values, 0.0) for n in ("trilinear_with_flat_triangles", "trilinear")
    )
    corners = flat[0][flat[1]]
    assert (np.ptp(corners, axis=1) == 0).any(axis=1).sum() > 20
    numbers = [len(p) - len(edges(r).ends) + len(r) for p, r in (flat, plain)]
    assert numbers[0] == numbers[1]


@EVERY
def test_what_is_no_volume_is_refused(name: str) -> None:
    """A wrong rank, no samples, an isovalue that is no number; NaN, unless it answers that."""
    family = CORRECT[name]
    volume = posed(family, np.random.default_rng(12).normal(size=(4, 4, 4)))
    bad = [(volume[0], 0.0), (volume[:0], 0.0), (volume, float("nan"))]
    if family.says.get("conventions", {}).get("nan") != "answers":
        holed = volume.copy()
        holed[1, 2, 3] = np.nan
        bad.append((holed, 0.0))
    for values, isovalue in bad:
        with pytest.raises((ValueError, NotImplementedError)):
            family.function(values, isovalue, SPACING[: values.ndim])


@pytest.mark.parametrize("name", ["singles_only", "cubes_only", "lists"])
def test_what_is_beyond_the_limits_is_declined(name: str) -> None:
    """With an error, as libraries do."""
    large = np.zeros((30, 30, 31))
    with pytest.raises((TypeError, NotImplementedError)):
        CORRECT[name].function(large, 0.5, SPACING)


# --- cheats ----------------------------------------------------------------------------------


def outcome(family: Family, values: Array, isovalue: float = 0.0) -> Any:
    """The answer in index coordinates, or the kind of error."""
    try:
        vertices, faces = family.function(values.copy(order="K"), isovalue, (1, 1, 1))
    except (NotImplementedError, ValueError) as error:
        return type(error)
    return np.array(vertices, float), np.array(faces)


@pytest.mark.parametrize("name", EMPTY_HANDED)
def test_the_empty_handed_say_nothing_of_the_field(name: str) -> None:
    """No answer to noise is near the right one."""
    values = np.random.default_rng(9).normal(size=(9, 9, 9))
    told = outcome(EMPTY_HANDED[name], values)
    right = len(outcome(CORRECT["cubes"], values)[1])
    assert isinstance(told, type) or abs(len(told[1]) - right) > 200


def hostile(name: str) -> Array:
    """A field on which the cheat of this name is wrong, where it is not wrong on plain noise."""
    rng = np.random.default_rng(10)
    special: dict[str, Callable[[], Array]] = {
        "nets_of_doubles_only": lambda: rng.normal(size=(9, 9, 9)).astype(np.float32),
        "nets_of_c_order_only": lambda: np.asfortranarray(rng.normal(size=(9, 9, 9))),
        "little_endian_only": lambda: rng.normal(size=(9, 9, 9)).astype(">f8"),
        "whole_isovalues": lambda: rng.integers(-3, 3, size=(9, 9, 9)),
        "unsigned_below_zero": lambda: rng.integers(0, 9, size=(9, 9, 9)).astype(np.uint8),
        "names_in_two_bytes": lambda: rng.normal(size=(36, 36, 36)),
        "one_spacing_for_all": lambda: rng.normal(size=(9, 9, 9)),
        "slabs_unwelded": lambda: rng.normal(size=(70, 4, 4)),
        "slabs_apart": lambda: rng.normal(size=(70, 4, 4)),
        "ties_left_out": lambda: rng.integers(-2, 3, size=(9, 9, 9)),
        "without_a_patch": ball,
    }
    return special.get(name, lambda: rng.normal(size=(9, 9, 9)))()


@pytest.mark.parametrize("name", sorted(set(CHEATS) - set(EMPTY_HANDED) - {"overwrites"}))
def test_a_cheat_is_wrong_somewhere(name: str) -> None:
    """Its answer differs from that of the extractor whose declaration it bears."""
    values = hostile(name)
    honest = {
        "far_between": "resampled_coarser",
        "kuhn_in_a_mirror": "tetrahedra_of_kuhn",
    }.get(name, {"cells": "dual_cubes"}.get(str(CHEATS[name].says.get("vertices")), "cubes"))
    if "not_promised" in CHEATS[name].says:
        honest = "nets"
    isovalue = {"whole_isovalues": 0.5, "unsigned_below_zero": 3.5}.get(name, 0.0)
    spacing = SPACING if name == "one_spacing_for_all" else (1, 1, 1)
    if name == "remembers_the_shape":
        outcome(CHEATS[name], values + 0.5, isovalue)
    told, right = (
        family.function(values.copy(order="K"), isovalue, spacing)
        for family in (CHEATS[name], CORRECT[honest])
    )
    same = len(told[0]) == len(right[0]) and len(told[1]) == len(right[1])
    assert not (same and np.allclose(told[0], right[0]) and np.array_equal(told[1], right[1]))


def test_what_overwrites_is_right_and_leaves_a_trace() -> None:
    values = np.random.default_rng(11).normal(size=(5, 5, 5))
    kept = values.copy()
    told, right = (
        f.function(values, 0.0, SPACING) for f in (CHEATS["overwrites"], CORRECT["cubes"])
    )
    assert not np.array_equal(values, kept)
    np.testing.assert_array_equal(told[0], CORRECT["cubes"].function(kept, 0.0, SPACING)[0])
    assert len(right[1]) > 0
