"""The claims on how a mesh hangs together, on right and on broken meshes of every kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from isograde.claims import topology
from isograde.declaration import Conventions, Declaration, End, declaration_from
from isograde.model import SURFACES, Case, Finding, Kind, Outcome, Status, Trial, Verdict
from isograde.oracles.lattice import Lattice
from isograde.report.headline import _fault
from isoref.fast.simplicial import extract as simplicial
from isoref.field import Field
from isoref.methods import METHODS

CLAIMS = {claim.id: claim for claim in topology.CLAIMS}
SHAPES = {2: (9, 8), 3: (6, 5, 6), 4: (4, 4, 3, 4), 5: (3, 2, 3, 2, 2)}
KINDS = [Kind(n, m) for n in range(2, 6) for m in range(1, n) if (n, m) != (5, 1)]
SPLIT = Declaration("", interpolant="tetrahedra")
NOTHING = Declaration("")


def trial(
    field: Field,
    vertices: Any,
    simplices: Any,
    declared: Declaration = NOTHING,
    isovalues: tuple[float, ...] = (0.0,),
) -> Trial:
    """A trial of these arrays."""
    kind = Kind(field.dimension, field.components)
    case = Case("test", lambda: field, isovalues, 1, kind=kind)
    outcome = Outcome(Status.OK, np.asarray(vertices), np.asarray(simplices))
    return Trial(case, field, declared, {"plain": outcome})


def judged(name: str, one: Trial) -> Finding:
    """What a claim says of it."""
    return CLAIMS[f"topology.{name}"].judge(one)


def noise(kind: Kind, seed: int = 0) -> tuple[Field, Any, Any]:
    """Noise of this kind, and Min's simplices in it."""
    values = np.random.default_rng([seed, *kind]).normal(size=(kind.m, *SHAPES[kind.n]))
    mesh = simplicial(Field.of(values, dimension=kind.n))
    field = Field.of(values if kind.m > 1 else values[0], dimension=kind.n)
    return field, mesh.vertices, mesh.simplices


def cubes(values: Any, isovalue: float = 0.0) -> tuple[Field, Any, Any]:
    """The asymptotic decider's surface."""
    field = Field.of(values)
    mesh = METHODS["asymptotic-decider"](field, isovalue)
    return field, mesh.vertices, mesh.simplices


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_simplices_of_every_kind_pass(kind: Kind) -> None:
    """Closed, oriented, manifold, on the right side, on evidence; Min 2003, section 5."""
    field, vertices, simplices = noise(kind)
    one = trial(field, vertices, simplices, SPLIT, (0.0,) * kind.m)
    for name in ("closed", "oriented", "manifold", "sides"):
        assert judged(name, one).verdict is Verdict.PASS, name


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_a_lost_simplex_is_a_hole(kind: Kind) -> None:
    """One simplex that touches no end of the domain."""
    field, vertices, simplices = noise(kind)
    last = np.subtract(field.shape, 1.0)
    inner = ((vertices > 0) & (vertices < last)).all(axis=1)[simplices].all(axis=1)
    which = int(np.flatnonzero(inner)[0]) if inner.any() else len(simplices) // 2
    fewer = np.delete(simplices, which, axis=0)
    found = judged("closed", trial(field, vertices, fewer, SPLIT, (0.0,) * kind.m))
    assert found.verdict is Verdict.FAIL
    assert found.numbers["boundary_facets"] >= 1


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_one_simplex_turned_over_is_not_oriented(kind: Kind) -> None:
    """And all turned over are on the wrong side."""
    field, vertices, simplices = noise(kind)
    turned = simplices.copy()
    turned[7, -2:] = turned[7, -2:][::-1]
    one = trial(field, vertices, turned, SPLIT, (0.0,) * kind.m)
    assert judged("oriented", one).verdict is Verdict.FAIL
    turned[:, -2:] = simplices[:, -2:][:, ::-1]
    every = trial(field, vertices, turned, SPLIT, (0.0,) * kind.m)
    assert judged("oriented", every).verdict is Verdict.PASS
    found = judged("sides", every)
    assert found.verdict is Verdict.FAIL
    assert found.numbers["reversed"] == found.numbers["faces"]


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_who_declares_no_orientation_is_not_asked_for_one(kind: Kind) -> None:
    """The mesh still passes where it must."""
    declared = Declaration("", interpolant="tetrahedra", conventions=Conventions(normals="none"))
    field, vertices, simplices = noise(kind)
    turned = simplices.copy()
    turned[:, -2:] = simplices[:, -2:][:, ::-1]
    one = trial(field, vertices, turned, declared, (0.0,) * kind.m)
    assert judged("oriented", one).verdict is Verdict.SKIP
    assert judged("sides", one).verdict is Verdict.PASS


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_a_mesh_drawn_twice_is_no_manifold_and_on_no_side(kind: Kind) -> None:
    """Every facet has four simplices, or two on the border."""
    field, vertices, simplices = noise(kind)
    twice = np.concatenate([simplices, simplices])
    one = trial(field, vertices, twice, SPLIT, (0.0,) * kind.m)
    assert judged("manifold", one).verdict is Verdict.FAIL
    assert judged("sides", one).verdict is Verdict.FAIL


@pytest.mark.parametrize("name", ["closed", "oriented", "manifold"])
def test_an_empty_mesh_is_no_evidence(name: str) -> None:
    """Nothing is a pass without evidence; what is missing is for `sides` to say."""
    field, _, _ = cubes(np.random.default_rng(0).normal(size=(4, 4, 4)))
    one = trial(field, np.empty((0, 3)), np.empty((0, 3), int))
    assert judged(name, one).verdict is Verdict.SKIP
    assert judged("sides", one).verdict is Verdict.FAIL


def test_points_are_as_many_as_the_degree_says() -> None:
    """Isolated points, n = m: at least the winding number round each square, and as odd."""
    values = np.random.default_rng(3).normal(size=(2, 7, 7))
    mesh = simplicial(Field.of(values, dimension=2))
    field = Field.of(values, dimension=2)
    right = trial(field, mesh.vertices, mesh.simplices, SPLIT, (0.0, 0.0))
    assert judged("sides", right).verdict is Verdict.PASS
    fewer = trial(field, mesh.vertices, mesh.simplices[1:], SPLIT, (0.0, 0.0))
    assert judged("sides", fewer).verdict is Verdict.FAIL
    assert not CLAIMS["topology.closed"].kinds(Kind(2, 2))


def test_a_soup_is_closed_within_its_tolerance_and_says_why() -> None:
    """Edges interpolated from either end: the last digits differ (issue: soups)."""
    field, vertices, faces = cubes(np.random.default_rng(1).normal(size=(5, 5, 5)))
    soup = vertices[faces].reshape(-1, 3)
    soup += np.random.default_rng(0).uniform(-1e-8, 1e-8, soup.shape)
    rows = np.arange(faces.size).reshape(-1, 3)
    assert judged("closed", trial(field, soup, rows, Declaration("", soup=1e-6))).verdict is (
        Verdict.PASS
    )
    found = judged("closed", trial(field, soup, rows))
    assert found.verdict is Verdict.FAIL
    assert "depends on the direction" in found.detail
    holed = judged("closed", trial(field, soup, rows[1:], Declaration("", soup=1e-6)))
    assert holed.verdict is Verdict.FAIL


def test_one_tied_sample_excuses_no_unwelded_vertex_elsewhere() -> None:
    """Slabs that are not welded, in a field with one tie far away (issue: false alarm 4)."""
    values = np.random.default_rng(2).normal(size=(8, 5, 5))
    values[1, 2, 2] = 0.0
    field, vertices, faces = cubes(values)
    upper = (vertices[faces][..., 0] >= 4).all(axis=1)
    apart = np.where(upper[:, None], faces + len(vertices), faces)
    doubled = np.concatenate([vertices, vertices])
    assert judged("closed", trial(field, vertices, faces)).verdict is Verdict.PASS
    assert judged("closed", trial(field, doubled, apart)).verdict is Verdict.FAIL


def test_vertices_at_a_tied_sample_may_be_one_or_several() -> None:
    """The convention of a tie is free: both meshes are closed."""
    values = np.random.default_rng(4).integers(-1, 2, (5, 5, 5)).astype(float)
    field, vertices, faces = cubes(values)
    at = np.abs(vertices - np.rint(vertices)).max(axis=1) < 1e-9
    key = np.where(at[:, None], np.rint(vertices), vertices)
    _, first, name = np.unique(key, axis=0, return_index=True, return_inverse=True)
    merged = first[name.reshape(-1)][faces]
    whole = merged[(merged != np.roll(merged, 1, axis=1)).all(axis=1)]
    for rows in (faces, whole):
        assert judged("ties", trial(field, vertices, rows)).verdict is Verdict.PASS
        assert judged("closed", trial(field, vertices, rows)).verdict is Verdict.PASS
    assert len(whole) < len(faces)


def test_a_closed_end_excuses_nothing_and_an_inset_moves_the_open_one() -> None:
    """The end of the domain is where it is declared (design, domain)."""
    values = np.random.default_rng(5).normal(size=(6, 6, 6))
    field, vertices, faces = cubes(values)
    assert judged("closed", trial(field, vertices, faces)).verdict is Verdict.PASS
    capped = Declaration("", domain=(End(0.0, "closed"),))
    assert judged("closed", trial(field, vertices, faces, capped)).verdict is Verdict.FAIL
    inner = METHODS["asymptotic-decider"](Field.of(values[1:-1, 1:-1, 1:-1]), 0.0)
    less = Declaration("", domain=(End(1.0, "open"),))
    shifted = inner.vertices + 1.0
    assert judged("closed", trial(field, shifted, inner.simplices, less)).verdict is Verdict.PASS
    assert judged("closed", trial(field, shifted, inner.simplices)).verdict is Verdict.FAIL


def test_a_periodic_mesh_closes_across_the_seam() -> None:
    """Its open facets in the two end planes are the same; one lost triangle there shows."""
    n = 6
    i, j, k = np.indices((n, n, n))
    wave = np.cos(2 * np.pi * (i + 0.3) / n) + np.cos(2 * np.pi * (j + 0.1) / n)
    values = wave + np.cos(2 * np.pi * (k + 0.7) / n) + 0.4
    mesh = METHODS["asymptotic-decider"](Field.of(np.pad(values, (0, 1), mode="wrap")), 0.0)
    field, declared = Field.of(values), Declaration("", domain=(End(0.0, "periodic"),))
    whole = trial(field, mesh.vertices, mesh.simplices, declared)
    assert judged("closed", whole).verdict is Verdict.PASS
    assert judged("sides", whole).verdict is Verdict.PASS
    on_seam = (mesh.vertices[mesh.simplices] == n).any(axis=(1, 2))
    torn = np.delete(mesh.simplices, np.flatnonzero(on_seam)[0], axis=0)
    assert judged("closed", trial(field, mesh.vertices, torn, declared)).verdict is Verdict.FAIL


def test_two_sheets_in_a_vertex_are_no_manifold_unless_the_sample_is_tied() -> None:
    """Two inside samples, diagonal in a cell, with a tie between them."""
    values = np.full((3, 3, 3), -1.0)
    values[0, 0, 0] = values[2, 2, 2] = 1.0
    field, vertices, faces = cubes(values)
    pinched = vertices.copy()
    corners = np.unique(faces)
    low = corners[vertices[corners].sum(axis=1) < 3][0]
    high = corners[vertices[corners].sum(axis=1) > 3][0]
    rows = np.where(faces == high, low, faces)
    assert judged("manifold", trial(field, pinched, faces)).verdict is Verdict.PASS
    found = judged("manifold", trial(field, pinched, rows))
    assert found.verdict is Verdict.FAIL
    assert "several sheets meet" in found.detail


@pytest.mark.parametrize("high", [False, True], ids=["low", "high"])
@pytest.mark.parametrize("counts", ["inside", "outside"])
def test_a_block_of_ties_is_on_the_declared_side(counts: str, high: bool) -> None:
    """A body among low samples if ties are inside, among high ones if outside."""
    values = np.full((4, 4, 4), 1.0 if high else -1.0)
    values[1:3, 1:3, 1:3] = 0
    nudged = np.where(values == 0, 1e-9 if counts == "inside" else -1e-9, values)
    mesh = METHODS["asymptotic-decider"](Field.of(nudged), 0.0)
    for said in ("inside", "outside"):
        declared = Declaration("", conventions=Conventions(tie=said))
        found = judged("tie_side", trial(Field.of(values), mesh.vertices, mesh.simplices, declared))
        assert found.verdict is (Verdict.PASS if said == counts else Verdict.FAIL)
        assert (f'"tie": "{counts}"' in found.detail) == (said != counts)


def test_one_tied_sample_does_not_tell_its_side() -> None:
    """Its surface has no area, and such triangles may be left out; nor do ties on both sides."""
    values = np.full((5, 5, 5), -1.0)
    values[2, 2, 2] = 0
    one = judged("tie_side", trial(*cubes(values)))
    values[1:3, 1:3, 1:3], values[4, 4, 4] = 0, 1
    both = judged("tie_side", trial(*cubes(values)))
    assert one.verdict is both.verdict is Verdict.SKIP


@pytest.mark.parametrize("seed", range(12))
def test_a_net_whose_quads_end_with_its_domain_is_oriented(seed: int) -> None:
    """Thin volumes: of four quads round an edge the two that turn alike may be all that are there.

    A naive net is right (its edges of four quads are what it does not promise), and one triangle
    turned over among its inner ones is still found.
    """
    half = {"inset": 0.5, "end": "open"}
    declared = declaration_from({"vertices": "cells", "domain": half}, "net")
    shape = [(4, 2, 3), (5, 6, 7)][seed % 2]
    field = Field.of(np.random.default_rng(seed).choice([-1.0, -0.7, 0.9, 1], shape))
    mesh = METHODS["surface-nets"](field, 0.0)
    one = trial(field, mesh.vertices, mesh.simplices, declared)
    assert judged("oriented", one).verdict is not Verdict.FAIL
    if min(shape) < 5:
        return
    inside = np.logical_and(mesh.vertices > 1, mesh.vertices < np.subtract(shape, 2)).all(axis=1)
    inner = np.flatnonzero(np.take(inside, mesh.simplices).all(axis=1))[0]
    turned = mesh.simplices.copy()
    turned[inner] = turned[inner, ::-1]
    found = judged("oriented", trial(field, mesh.vertices, turned, declared))
    assert found.verdict is Verdict.FAIL


def test_the_net_that_was_accused_of_its_end_is_right() -> None:
    """Found by ``make correct``: 13 of 666 fields, this the smallest of them."""
    values = np.full((4, 2, 3), -1.0)
    values[0, 0, 2] = values[1, 0, 2] = 1
    values[1, 0, 1], values[2, 1, 1] = 1, 0.9
    mesh = METHODS["surface-nets"](Field.of(values), 0.0)
    half = {"inset": 0.5, "end": "open"}
    declared = declaration_from({"vertices": "cells", "domain": half}, "net")
    one = trial(Field.of(values), mesh.vertices, mesh.simplices, declared)
    assert judged("oriented", one).verdict is Verdict.PASS
    on_edges = trial(Field.of(values), mesh.vertices, mesh.simplices, NOTHING)
    assert judged("oriented", on_edges).verdict is Verdict.FAIL


def test_sheets_that_meet_away_from_a_tie_are_seen_on_a_field_with_ties() -> None:
    """Of "manifold": only who samples on a lattice of its own is excused wherever a tie is."""
    values = np.full((5, 5, 9), -1.0)
    values[2, 2, 2] = values[2, 2, 4] = 1
    values[2, 2, 7] = 0
    field, vertices, simplices = cubes(values)
    assert judged("manifold", trial(field, vertices, simplices)).verdict is Verdict.PASS
    # Two sheets, round the two high samples, are made to share a vertex.
    one, other = np.argsort(np.abs(vertices - (2, 2, 3)).sum(axis=1))[:2]
    assert not np.array_equal(vertices[one], vertices[other])
    vertices[[one, other]] = (2, 2, 3)
    joined = np.where(simplices == other, one, simplices)
    assert judged("manifold", trial(field, vertices, joined)).verdict is Verdict.FAIL
    own = Declaration("", vertices="own", reach=1.0)
    assert judged("manifold", trial(field, vertices, joined, own)).verdict is Verdict.SKIP


def test_a_lattice_of_its_own_may_be_tied_between_booleans() -> None:
    """Found by ``make correct``: the mean of false and true is the isovalue, and no sample is."""
    sheets = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1]]
    crowded = [[0, 1, 2], [1, 0, 4], [0, 1, 3], [1, 0, 5]]
    soup = {"vertices": {"own": 1.0}, "mesh": {"soup": 0}}
    booleans = np.arange(27).reshape(3, 3, 3) % 2 == 0
    noise = np.random.default_rng(1).normal(size=(3, 3, 3))
    for values, verdict in [(booleans, Verdict.SKIP), (noise, Verdict.FAIL)]:
        field = Field.of(values)
        one = trial(field, np.add(sheets, 1), crowded, declaration_from(soup, "x"), (0.5,))
        assert judged("manifold", one).verdict is verdict


def test_a_surface_that_ends_too_late_has_no_hole_and_is_not_said_to() -> None:
    """Isosurface 0.1.0-alpha.0 goes on for a layer of cells: open, but nowhere inside."""
    field = Field.of(np.tile([-1.0, -1.0, 1.0], (3, 3, 1)).transpose(2, 0, 1))
    plain = declaration_from({}, "x")
    ends = [0.0, 3.0]
    corners = [[1.5, 0, z] for z in ends] + [[1.5, 2, z] for z in ends]
    finding = judged("closed", trial(field, corners, [[0, 1, 2], [1, 3, 2]], plain))
    assert finding.verdict is Verdict.FAIL
    assert "1 edges beyond the end of the domain" in finding.detail
    told: dict[str, object] = {"verdict": "fail", "numbers": finding.numbers}
    assert _fault("topology.closed", SURFACES, told) == "a surface that goes on beyond its domain"
    corners[1][2] = 1.0
    finding = judged("closed", trial(field, corners, [[0, 1, 2], [1, 3, 2]], plain))
    assert "edges inside the domain belong to one simplex only" in finding.detail
    fan = [[1.5, 1, 0.5], [1.5, 1, 1.5], [0, 1, 1], [2, 1, 1], [1.5, 0, 1]]
    three = trial(field, fan, [[0, 1, 2], [1, 0, 3], [0, 1, 4]], plain)
    assert "belong to an odd number of simplices" in judged("closed", three).detail


def test_a_domain_that_is_one_sample_thick_has_no_surface() -> None:
    """Found by ``make correct``: 18 of 647 fields, who leaves the outermost cells out."""
    inset = declaration_from({"domain": {"inset": 1, "end": "open"}}, "cropped")
    field = Field.of(np.random.default_rng(2).normal(size=(3, 4, 3)))
    empty = trial(field, np.empty((0, 3)), np.empty((0, 3), np.int64), inset)
    assert judged("sides", empty).verdict is Verdict.PASS
    one = trial(field, [[1, 1.2, 1], [1, 1.5, 1], [1, 1.5, 1.2]], [[0, 1, 2]], inset)
    assert judged("sides", one).verdict is Verdict.FAIL
    thick = Field.of(np.random.default_rng(2).normal(size=(4, 5, 4)))
    nothing = trial(thick, np.empty((0, 3)), np.empty((0, 3), np.int64), inset)
    assert judged("sides", nothing).verdict is Verdict.FAIL
    # Smoothed nets of VTK were accused on 1,017 fields: vertices of its own stand beyond the ends.
    own = {"interpolant": "labels", "vertices": {"own": 2.0}}
    smoothed = declaration_from({**own, "domain": {"inset": 1, "end": "open"}}, "smoothed")
    small = Field.of(np.random.default_rng(2).normal(size=(2, 2, 2)))
    drawn = trial(small, [[0.4, 0.5, 0.5], [1, 0.5, 0.5], [1, 0.7, 0.5]], [[0, 1, 2]], smoothed)
    assert judged("sides", drawn).verdict is Verdict.SKIP


def test_a_net_has_a_surface_in_a_single_layer_of_cells() -> None:
    """Its vertices are in the middles of the cells: 15 of 1,669 fields were accused for it."""
    half = {"inset": 0.5, "end": "open"}
    declared = declaration_from({"vertices": "cells", "domain": half}, "net")
    field = Field.of(np.random.default_rng(2).normal(size=(2, 5, 5)))
    mesh = METHODS["surface-nets"](field, 0.0)
    assert len(mesh.simplices)
    one = trial(field, mesh.vertices, mesh.simplices, declared)
    assert judged("sides", one).verdict is Verdict.SKIP  # No sample is between its ends.


@pytest.mark.parametrize(
    "samples",
    [[-1, 1, -1, -9e-6, -1, -1, -1, 1], [-1, -20000, -1, 1, -1, 1, 1, -0.007]],
    ids=["corners on two borders", "an inner vertex near three"],
)
def test_a_soup_is_judged_in_its_place_at_the_border(samples: list[float]) -> None:
    """Found by ``make correct``: corners that become one, and one that must not move."""
    values = np.reshape(samples, (2, 2, 2))
    field, vertices, simplices = cubes(values)
    corners = vertices[simplices].reshape(-1, 3)
    soup = np.arange(len(corners)).reshape(-1, 3)
    declared = declaration_from({"mesh": {"soup": 1e-4}}, "soup")
    assert judged("sides", trial(field, corners, soup, declared)).verdict is Verdict.PASS
    verdicts = {
        judged("sides", trial(field, corners, np.delete(soup, lost, axis=0), declared)).verdict
        for lost in range(len(soup))
    }
    assert Verdict.FAIL in verdicts


@pytest.mark.parametrize("end", ["closed", "periodic"])
def test_a_surface_that_goes_on_beyond_the_samples_is_not_judged_by_them(end: Any) -> None:
    """Neither in a domain one sample thick, nor by a block of tied samples."""
    declared = Declaration("", domain=(End(0.0, end), End(), End()))
    thin = Field.of(np.random.default_rng(2).normal(size=(1, 4, 3)))
    nothing = trial(thin, np.empty((0, 3)), np.empty((0, 3), np.int64), declared)
    assert judged("sides", nothing).verdict is Verdict.SKIP
    values = np.full((4, 4, 4), -1.0)
    values[1:3, 1:3, 1:3] = 0
    found = judged("tie_side", trial(*cubes(values), declared))
    assert found.verdict is Verdict.SKIP
    assert "goes on beyond" in found.detail


def test_a_facet_is_in_the_seam_at_a_tie_where_it_lies_in_it_and_touches_one() -> None:
    """In either plane of the seam; not across it, nor beside no tie."""
    values = np.random.default_rng(0).choice([-1.0, 1.0], (5, 5, 5))
    values[0, 1, 1] = 0.0
    declared = Declaration("", domain=(End(0.0, "periodic"), End(), End()))
    lattice = Lattice.of(Field.of(values), (0.0,), declared)
    seam = np.array([[0.0, 1.5, 1.0], [0.0, 2.5, 1.0]])
    away = np.array([[0.0, 3.5, 3.0], [0.0, 2.5, 3.0]])
    across = np.array([[0.5, 1.5, 1.0], [0.0, 2.5, 1.0]])
    behind, inside = (np.add(seam, [x, 0.0, 0.0]) for x in (5, 2))
    facets = np.array([seam, seam[::-1], away, behind, across, inside])
    found = topology._in_seam_at_tie(lattice, facets, 0)
    assert found.tolist() == [True, True, False, True, False, False]
