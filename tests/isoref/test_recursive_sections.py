"""Sections by recursion over faces (Weigle and Banks), beside Min's tables."""

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isograde.oracles.covering import inner_open_facets
from isoref.fast.simplicial import extract as by_tables
from isoref.field import Field
from isoref.recursive_sections import asked, extract, piece_count, pieces_of
from isoref.simplex_section import haiman_count, section_types

CASES = [((5, 6), 1), ((4, 4, 3), 1), ((4, 3, 3), 2), ((3, 3, 3, 2), 1), ((3, 2, 3, 2), 2)]


@pytest.mark.parametrize(("shape", "m"), CASES)
def test_it_is_the_set_of_the_tables_cut_finer(shape: tuple[int, ...], m: int) -> None:
    """The same measure and Euler characteristic; closed away from the border; more simplices."""
    values = np.random.default_rng(len(shape)).normal(size=(m, *shape))
    field = Field.of(values, dimension=len(shape))
    ours, tables = extract(field), by_tables(field)
    measures = [Complex(mesh.vertices, mesh.simplices).measure for mesh in (ours, tables)]
    assert measures[0] == pytest.approx(measures[1], rel=1e-9)
    eulers = [Complex(mesh.vertices, mesh.simplices).euler for mesh in (ours, tables)]
    assert eulers[0] == eulers[1]
    box = [[0.0] * len(shape), [N - 1.0 for N in shape]]
    assert len(inner_open_facets(Complex(ours.vertices, ours.simplices), box)) == 0
    assert len(ours.simplices) >= len(tables.simplices) > 0


@pytest.mark.parametrize("n", range(2, 7))
def test_pieces_are_as_many_as_counted_and_no_fewer_than_the_least(n: int) -> None:
    """Corollary 3.2 gives the least; the recursion gives it only where the section is a simplex."""
    for p, q in section_types(n):
        made = pieces_of(tuple(range(p + q)), [False] * p + [True] * q, {})
        assert len(made) == piece_count(p, q)
        assert len(set(made)) == len(made)
        assert (piece_count(p, q) == haiman_count(p, q)) == (q == 1)
        assert asked(p, q) >= len({face for piece in made for face in piece if len(face) > 2})


def test_neighbours_find_the_same_pieces_on_the_face_they_share() -> None:
    """Two simplices with a common facet, in whatever order their vertices come."""
    positive = [False, True, False, True, True]
    facet = (1, 2, 3)
    for row in ((0, 1, 2, 3), (1, 2, 3, 4)):
        known: dict[tuple[int, ...], list[tuple[tuple[int, ...], ...]]] = {}
        pieces_of(row, positive, known)
        alone = pieces_of(facet, positive, {})
        assert known.get(facet, alone) == alone
