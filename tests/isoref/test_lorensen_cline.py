from collections import Counter

import numpy as np
import pytest
from isoref import cube, lorensen_cline
from isoref.cycles import ALL_JOINED, ALL_SEPARATED, cycles
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.methods import METHODS


def open_edges(mesh: Mesh) -> Counter[tuple[int, int]]:
    """Half-edges of a triangle mesh without a partner."""
    halves = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in mesh.simplices for i in range(3))
    return halves - Counter({(b, a): n for (a, b), n in halves.items()})


@pytest.mark.parametrize(
    ("configuration", "triangles"),
    list(enumerate((0, 1, 2, 2, 2, 3, 3, 3, 2, 4, 4, 4, 4, 4, 4))),
)
def test_each_drawing_has_the_published_number_of_triangles(
    configuration: int, triangles: int
) -> None:
    """Lorensen & Cline, Fig. 3: at most four triangles in any of the fifteen drawings."""
    counts = {
        len(lorensen_cline.tile(signs, 0).triangles)
        for signs in range(256)
        if cube.configuration(signs) == configuration
    }
    assert counts == {triangles}


def test_configuration_6_beside_the_complement_of_3_leaves_a_hole_of_four_edges() -> None:
    """Nielson & Hamann, Fig. 3: the flaw of the 1987 drawings, on two cells."""
    values = -np.ones((3, 2, 2))
    # The shared plane has two diagonally opposite inside corners; the left cell has one more,
    # next to one of them (configuration 6); the right cell is full but for two (3 exchanged).
    values[1, 0, 0] = values[1, 1, 1] = values[0, 0, 0] = 1
    values[2] = 1
    signs = [
        sum(1 << c for c, (i, j, k) in enumerate(cube.CORNERS) if values[i + x, j, k] > 0)
        for x in (0, 1)
    ]
    assert [cube.configuration(s) for s in signs] == [6, 3]
    assert [cube.is_exchanged(s) for s in signs] == [False, True]
    mesh = METHODS["lorensen-cline"](Field.of(values), 0.0)
    on_shared_face = [
        edge for edge in open_edges(mesh) if np.all(mesh.vertices[list(edge), 0] == 1)
    ]
    assert len(on_shared_face) == 4
    repaired = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    assert not [e for e in open_edges(repaired) if np.all(repaired.vertices[list(e), 0] == 1)]


def test_the_minority_is_cut_apart_and_the_inside_where_there_are_four_and_four() -> None:
    """Fig. 3: no diagonal of an ambiguous face joins its inside corners, up to four of them."""
    for signs in range(256):
        separate = cycles(signs, ALL_SEPARATED if signs.bit_count() <= 4 else ALL_JOINED)
        assert lorensen_cline.polygons(signs) == separate
