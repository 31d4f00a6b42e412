"""Cubes in any dimension, by convex hulls (Bhaniramka, Wenger and Crawfis)."""

from itertools import product

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isoref.cube import CORNERS, EDGES
from isoref.fast.sweep import sweep
from isoref.field import Field, FieldError
from isoref.hypercubes import (
    classes,
    cycle_lengths,
    extract,
    hull_places,
    on_the_cube,
    pulled,
    rank,
    tile,
)
from isoref.marching_vesta import cycles, rule


def noise(shape: tuple[int, ...], seed: int) -> Field:
    """Noise amid low samples, in cells that are no cubes."""
    inner = np.random.default_rng(seed).normal(size=shape)
    values = np.pad(inner, 1, constant_values=-1.0)
    return Field.of(values, [1.0, 0.5, 2.0, 1.5][: len(shape)])


def signed_facets(simplices: np.ndarray) -> dict[tuple[int, ...], int]:
    """The boundary of the chain of oriented simplices: what does not cancel."""
    total: dict[tuple[int, ...], int] = {}
    for row in simplices.tolist():
        for k in range(len(row)):
            facet = row[:k] + row[k + 1 :]
            order = np.argsort(facet)
            inversions = sum(
                order[i] > order[j] for i in range(len(order)) for j in range(i + 1, len(order))
            )
            key = tuple(sorted(facet))
            total[key] = total.get(key, 0) + (-1) ** (k + int(inversions))
    return {key: n for key, n in total.items() if n}


@pytest.mark.parametrize(("shape", "seed"), [((7, 8), 0), ((5, 4, 5), 1), ((3, 2, 3, 2), 2)])
def test_the_surface_is_closed_and_oriented(shape: tuple[int, ...], seed: int) -> None:
    """In dimension 2, 3 and 4: every facet has two simplices, which cancel there."""
    mesh = extract(noise(shape, seed), 0.0)
    assert len(mesh.simplices) > 20
    assert signed_facets(mesh.simplices) == {}
    owners = Complex(mesh.vertices, mesh.simplices).facets.uses
    assert (owners == 2).all()


@pytest.mark.parametrize("shape", [(7, 8), (5, 4, 5), (2, 3, 2, 3)])
def test_right_hand_normals_point_from_high_to_low(shape: tuple[int, ...]) -> None:
    """The enclosed volume, by det(vertices) / n!, is positive and near that of the inside."""
    n = len(shape)
    index = np.indices([s + 6 for s in shape]).astype(float)
    middle = np.array([(s + 5) / 2 for s in shape]).reshape(-1, *[1] * n)
    field = Field.of(3.0 - np.sqrt(((index - middle) ** 2).sum(axis=0)))
    mesh = extract(field, 0.0)
    volume = np.linalg.det(mesh.vertices[mesh.simplices]).sum()
    volume *= 1 / np.prod(np.arange(1, n + 1))
    ball = {2: np.pi * 9, 3: 4 / 3 * np.pi * 27, 4: np.pi**2 / 2 * 81}[n]
    assert 0.85 * ball < volume < ball


def test_in_space_the_polygons_are_those_of_vesta_connect() -> None:
    """Inside corners are always joined: the same cycles round each of the 254 mixed cells."""
    places = [tuple(np.add(CORNERS[a], CORNERS[b])) for a, b in EDGES]
    for signs in range(1, 255):
        sides = [(row[i], row[(i + 1) % 3]) for row in tile(signs, 3) for i in range(3)]
        open_sides = {(a, b) for a, b in sides if (b, a) not in sides}
        wanted = {
            (places[a], places[b])
            for cycle in cycles(signs, 0)
            for a, b in zip(cycle, cycle[1:] + cycle[:1], strict=True)
        }
        assert open_sides == wanted


def test_fields_in_space_have_the_topology_of_vesta_connect() -> None:
    """Pieces and Euler characteristic of noise: the rule "connect" is the same surface."""
    field = noise((7, 6, 7), 3)
    ours, vesta = extract(field, 0.0), sweep(rule("connect", "L"), field, 0.0)
    one, other = (Complex.of(m.vertices, m.simplices) for m in (ours, vesta))
    assert (one.components, one.euler, len(ours.simplices)) == (
        other.components,
        other.euler,
        len(vesta.simplices),
    )


def test_facets_inside_have_middles_only() -> None:
    """Near an inside corner the hull fills the cube."""
    for n, step in ((2, 1), (3, 1), (4, 257)):
        for signs in range(1, (1 << (1 << n)) - 1, step):
            for row in tile(signs, n):
                assert all(sum(x % 2 for x in place) == 1 for place in row)


def test_classes_are_the_numbers_of_min_and_of_burnside() -> None:
    """Section 1 of Min: 14 and 222; each class counted by its members too, in dimension 3."""
    assert (classes(2), classes(3), classes(4)) == (4, 14, 222)
    corners = np.array(list(product((0, 1), repeat=3)))
    seen: set[int] = set()
    number = 0
    for signs in range(256):
        if signs in seen:
            continue
        number += 1
        for axes in ([0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
            for flips in product((0, 1), repeat=3):
                moved = (corners[:, axes] ^ np.array(flips)) @ [4, 2, 1]
                image = sum(1 << int(moved[c]) for c in range(8) if signs >> c & 1)
                seen |= {image, 255 - image}
    assert number == 14


def test_a_pulling_triangulation_fills_a_square_and_a_prism() -> None:
    """From the lowest vertex, over the faces that do not hold it."""
    prism: list[tuple[int, ...]] = [
        (0, 0, 0),
        (2, 0, 0),
        (0, 2, 0),
        (0, 0, 2),
        (2, 0, 2),
        (0, 2, 2),
    ]
    facets = [
        frozenset(prism[:3]),
        frozenset(prism[3:]),
        frozenset([prism[0], prism[1], prism[3], prism[4]]),
        frozenset([prism[0], prism[2], prism[3], prism[5]]),
        frozenset([prism[1], prism[2], prism[4], prism[5]]),
    ]
    rows = np.array(pulled(frozenset(prism), facets, 3), np.float64)
    assert len(rows) == 3
    volume = np.abs(np.linalg.det(rows[:, 1:] - rows[:, :1])).sum() / 6
    assert volume == pytest.approx(4.0)
    assert rank(frozenset(prism)) == 3
    assert rank(frozenset()) == -1
    assert not on_the_cube(frozenset(prism))
    assert on_the_cube(facets[0])


def test_hull_places_are_corners_inside_and_middles() -> None:
    """One corner of a square and its two middles."""
    assert hull_places(0b0001, 2) == [(0, 0), (0, 1), (1, 0)]
    assert cycle_lengths([0, 1, 2]) == [1, 1, 1]


def test_what_cubes_cannot_take_is_refused() -> None:
    """Several components, five axes, one sample thick."""
    with pytest.raises(FieldError, match="2 components"):
        extract(Field.of(np.zeros((2, 3, 3)), dimension=2))
    with pytest.raises(FieldError, match="dimension 5"):
        extract(Field.of(np.zeros((2,) * 5)))
    with pytest.raises(FieldError):
        extract(Field.of(np.zeros((1, 4))))
    assert len(extract(Field.of(np.zeros((3, 3))), 1.0).simplices) == 0
