"""Places in a split, and sections of its simplices, beside enumeration."""

from itertools import combinations

import numpy as np
import pytest
from isograde.declaration import Declaration, declaration_from
from isograde.oracles.lattice import Lattice
from isograde.oracles.split import _bounded, corners_of, locate, sections
from isoref import marching_tetrahedra
from isoref.fast.simplicial import extract as simplicial
from isoref.field import Booleans, Field, Integers

from tests.isograde.families import lattice_simplices

FIVE = declaration_from(
    {"interpolant": {"tetrahedra": lattice_simplices(marching_tetrahedra.FIVE)}}, "five"
)
KUHN = Declaration("", interpolant="tetrahedra")


@pytest.mark.parametrize(("declared", "n"), [(KUHN, 2), (KUHN, 3), (KUHN, 4), (FIVE, 3)])
@pytest.mark.parametrize("begin", [0, 1])
def test_weights_put_the_corners_at_the_place(declared: Declaration, n: int, begin: int) -> None:
    """Barycentric coordinates, none below 0, of corners that are one simplex of the split."""
    values = np.zeros((5,) * n)
    lattice = Lattice.of(Field.of(values), (0.5,), declared)
    places = np.random.default_rng(n).uniform(0, 4, (50, n))
    corner = np.full(n, begin)
    found = locate(lattice, places, corner)
    corners = corners_of(lattice, found)
    np.testing.assert_allclose((corners * found.weights[..., None]).sum(axis=1), places)
    assert found.weights.min() >= 0
    known = {frozenset(map(tuple, simplex)) for simplex in declared.split.over(n)}
    period = declared.split.period(n)
    for simplex in corners + corner:
        block = np.floor(simplex.mean(axis=0) / period).astype(int) * period
        assert frozenset(map(tuple, (simplex - block).tolist())) in known


def chains(sides: tuple[int, int], size: int) -> tuple[list[tuple[int, ...]], Booleans]:
    """Every set of so many simplices on the crossings of a simplex, and which are its section."""
    p, q = sides
    n = p + q - 1
    crossings = [(a, p + b) for a in range(p) for b in range(q)]
    simplices = list(combinations(range(len(crossings)), n))
    sets = list(combinations(range(len(simplices)), size))
    parts = np.array([simplices[s] for chosen in sets for s in chosen])
    mask = np.array([1 << a | 1 << b for a, b in crossings])
    inside = np.tile(np.arange(n + 1) < p, (len(sets), 1))
    row = np.repeat(np.arange(len(sets)), size)
    return sets, _bounded(parts, row, mask[parts], inside)


@pytest.mark.parametrize(
    ("sides", "size", "triangulations"),
    [
        ((1, 1), 1, 1),
        ((1, 2), 1, 1),
        ((1, 3), 1, 1),
        ((2, 2), 2, 2),
        ((2, 3), 3, 6),
        ((1, 4), 1, 1),
    ],
)
def test_the_right_chains_are_the_triangulations(
    sides: tuple[int, int], size: int, triangulations: int
) -> None:
    """Of a point, a segment, a triangle, a quad (2) and a prism (6): De Loera and others, 6.2."""
    _, right = chains(sides, size)
    assert right.sum() == triangulations


@pytest.mark.parametrize("sides", [(2, 2), (2, 3)])
def test_one_simplex_less_or_more_is_no_section(sides: tuple[int, int]) -> None:
    """Whatever the simplices are; four in a prism may bound as three do, and are counted."""
    size = {(2, 2): 2, (2, 3): 3}[sides]
    wrong = {(2, 2): (1, 3), (2, 3): (1, 2)}[sides]
    assert size not in wrong
    for other in wrong:
        assert not chains(sides, other)[1].any()


@pytest.mark.parametrize("n", [2, 3, 4])
def test_every_simplex_with_both_sides_is_listed_and_right(n: int) -> None:
    """As many as a count over all simplices says; their parts are Haiman's count."""
    values = np.random.default_rng(n).normal(size=(4,) * n)
    field = Field.of(values)
    mesh = simplicial(field)
    lattice = Lattice.of(field, (0.0,), KUHN)
    found = sections(lattice, mesh.vertices, mesh.simplices, np.zeros(n, np.int64))
    count = 0
    for cell in np.ndindex((3,) * n):
        for simplex in KUHN.split.over(n):
            sides = {bool(values[tuple(np.add(cell, c))] >= 0) for c in simplex}
            count += len(sides) == 2
    assert len(found.right) == count > 9
    assert found.right.all()
    assert not len(found.astray)
    assert np.array_equal(found.parts, found.wanted)
    assert found.parts.sum() == len(mesh.simplices)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("high", [[0], [0, -1]], ids=["one", "two"])
def test_an_inner_vertex_takes_n_parts_less_one_more(n: int, high: list[int]) -> None:
    """One part of each simplex in turn cut at its middle: still the section, and so counted."""
    values = np.full(2**n, -1.0)
    values[high] = 1
    field = Field.of(values.reshape((2,) * n))
    mesh = simplicial(field)
    lattice = Lattice.of(field, (0.0,), KUHN)
    top = len(mesh.vertices)
    for part, row in enumerate(mesh.simplices):
        more: Integers = np.array([[*np.delete(row, i), top] for i in range(n)])
        points = np.concatenate([mesh.vertices, mesh.vertices[row].mean(axis=0)[None]])
        rows = np.concatenate([np.delete(mesh.simplices, part, axis=0), more])
        found = sections(lattice, points, rows, np.zeros(n, np.int64))
        assert found.right.all()
        assert found.inner.sum() == 1
        assert np.array_equal(found.parts, found.wanted)
