"""Cases of the peers' own suites, asked of isoref through adapters of a few lines.

The suites themselves run in `tests.peers`, where their source distributions can be had, with the
calls of the page "coming from". What they ask is asked again here, case by case, of more methods
and without a network; a test says from which suite a case is, and why an answer differs.
"""

from collections.abc import Sequence

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isoref.fast.diconex import diconex
from isoref.field import Array, Field, FieldError, Floats, Integers
from isoref.methods import METHODS, extract

SURFACES = ["asymptotic-decider", "trilinear-cubes", "marching-vesta-mixed-L", "vesta-mixed-L"]


def marching_cubes(
    volume: Floats, level: float, spacing: Sequence[float] = (1, 1, 1), method: str = SURFACES[0]
) -> tuple[Floats, Integers]:
    """Isoref as `skimage.measure.marching_cubes` or `mcubes.marching_cubes`."""
    mesh = extract(volume, level, spacing, method=method)
    return mesh.vertices, mesh.simplices


def find_contours(image: Array, level: float, mode: str = "disconnect") -> list[Floats]:
    """Isoref as `skimage.measure.find_contours`: closed polygons repeat their first point."""
    return diconex(Field.of(image), level, mode=mode, border="closed").polygons()  # type: ignore[arg-type]


def matrix_to_marching_cubes(matrix: Array, pitch: float) -> Complex:
    """Isoref as `trimesh.voxel.ops.matrix_to_marching_cubes`: inside or outside, padded."""
    field = Field.of(np.pad(np.asarray(matrix, float), 1), pitch, [-pitch] * 3)
    mesh = METHODS["asymptotic-decider"](field, 0.5)
    return Complex.of(mesh.vertices, mesh.simplices)


class TestScikitImage:
    """measure/tests/test_marching_cubes.py and test_find_contours.py."""

    @pytest.mark.parametrize("method", SURFACES)
    def test_marching_cubes_isotropic(self, method: str) -> None:
        """The area of an ellipsoid, a little below the exact one and within 1 %."""
        draw = pytest.importorskip("skimage.draw")
        volume = draw.ellipsoid(6, 10, 16, levelset=True)
        _, area = draw.ellipsoid_stats(6, 10, 16)
        found = Complex.of(*marching_cubes(volume, 0.0, method=method)).measure
        assert found < area < 1.01 * found

    @pytest.mark.parametrize("method", SURFACES)
    def test_marching_cubes_anisotropic(self, method: str) -> None:
        """The same with a spacing for each axis, within 1.5 %."""
        draw = pytest.importorskip("skimage.draw")
        spacing = (1.0, 10 / 6, 16 / 6)
        volume = draw.ellipsoid(6, 10, 16, spacing=spacing, levelset=True)
        _, area = draw.ellipsoid_stats(6, 10, 16)
        found = Complex.of(*marching_cubes(volume, 0.0, spacing, method)).measure
        assert found < area < 1.015 * found

    def test_invalid_input(self) -> None:
        """Wrong rank and wrong spacing are refused.

        A level outside the range, which scikit-image refuses, gives an empty mesh: the convention
        of this package (design, "One convention").
        """
        with pytest.raises(FieldError):
            marching_cubes(np.zeros((2, 2)), 0.0)
        with pytest.raises(FieldError):
            marching_cubes(np.zeros((2, 2, 2)), 0.0, (1, 2))
        assert len(marching_cubes(np.zeros((2, 2, 2)), 2.1)[1]) == 0

    def test_both_directions_of_gradient(self) -> None:
        """A volume and its negative have the same surface, faces the other way round."""
        volume = np.random.default_rng(0).normal(size=(7, 8, 6))
        up, down = marching_cubes(volume, 0.0), marching_cubes(-volume, 0.0)
        one, other = (Complex.of(*mesh) for mesh in (up, down))
        np.testing.assert_array_equal(np.sort(up[0], axis=0), np.sort(down[0], axis=0))
        assert one.measure == pytest.approx(other.measure, rel=0.02)

    def test_binary(self) -> None:
        """A contour round an L of zeros, to the last number.

        find_contours runs with high values on its left; ours runs with the inside on its left too.
        The ones that touch the border are open there and closed here ("closed" border): the inner
        contour is compared.
        """
        image = np.ones((8, 8))
        image[1:-1, 1] = image[1, 1:-1] = 0
        expected = [
            [6.0, 1.5], [5.0, 1.5], [4.0, 1.5], [3.0, 1.5], [2.0, 1.5], [1.5, 2.0], [1.5, 3.0],
            [1.5, 4.0], [1.5, 5.0], [1.5, 6.0], [1.0, 6.5], [0.5, 6.0], [0.5, 5.0], [0.5, 4.0],
            [0.5, 3.0], [0.5, 2.0], [0.5, 1.0], [1.0, 0.5], [2.0, 0.5], [3.0, 0.5], [4.0, 0.5],
            [5.0, 0.5], [6.0, 0.5], [6.5, 1.0],
        ]  # fmt: skip
        inner = [c for c in find_contours(image, 0.5) if (c > 0).all() and (c < 7).all()]
        assert len(inner) == 1
        assert sorted(map(tuple, inner[0][:-1].tolist())) == sorted(map(tuple, expected))

    def test_target_contour(self) -> None:
        """A square of side 5 in a field of 0: one closed contour round it."""
        image = np.zeros((9, 9))
        image[2:7, 2:7] = 1
        (contour,) = find_contours(image, 0.5)
        assert (contour[0] == contour[-1]).all()
        assert len(contour) == 21
        assert contour.min() == 1.5
        assert contour.max() == 6.5

    def test_float(self) -> None:
        """A slope: the contour of the level crosses where linear interpolation says."""
        x, y = np.mgrid[-1:1:5j, -1:1:5j]
        r = np.sqrt(x**2 + y**2)
        (contour,) = find_contours(1 - r, 0.5)
        assert {(2.0, 3.0), (1.0, 2.0), (2.0, 1.0), (3.0, 2.0)} <= set(map(tuple, contour.tolist()))

    def test_memory_order_and_input_types(self) -> None:
        """C or Fortran order, floats or integers: the same contours."""
        image = np.arange(16).reshape(4, 4) % 7
        plain = find_contours(image.astype(float), 3.5)
        for other in (np.asfortranarray(image, float), image.astype(np.int16)):
            for one, two in zip(plain, find_contours(other, 3.5), strict=True):
                np.testing.assert_array_equal(one, two)

    @pytest.mark.parametrize(("mode", "number"), [("disconnect", 2), ("connect", 1)])
    def test_fully_connected(self, mode: str, number: int) -> None:
        """Two pixels that share a corner: `fully_connected="low"` parts them, `"high"` does not."""
        image = np.zeros((4, 4))
        image[1, 1] = image[2, 2] = 1
        assert len(find_contours(image, 0.5, mode)) == number


class TestPyMCubes:
    """tests/test_marching_cubes.py."""

    def test_empty(self) -> None:
        """Nothing crosses the level: no vertices, no triangles."""
        vertices, triangles = marching_cubes(np.zeros((20, 20, 20)), 0.0)
        assert len(vertices) == len(triangles) == 0

    def test_sphere(self) -> None:
        """Vertices on a sphere of squared distances lie within the error of one cell's chord."""
        x, y, z = np.mgrid[:40, :40, :40]
        vertices, _ = marching_cubes((x - 20.0) ** 2 + (y - 20) ** 2 + (z - 20) ** 2 - 15**2, 0.0)
        distance = np.linalg.norm(vertices - 20, axis=1)
        np.testing.assert_allclose(distance, 15, atol=1 / (8 * 15))

    def test_no_duplicates_and_orientation(self) -> None:
        """No vertex twice. PyMCubes' normals point to lower values, as ours do."""
        x, y, z = np.mgrid[:20, :20, :20]
        ball = 36.1 - (x - 9.6) ** 2 - (y - 9.5) ** 2 - (z - 9.4) ** 2
        vertices, triangles = marching_cubes(ball, 0.0)
        assert len(np.unique(vertices, axis=0)) == len(vertices)
        assert Complex.of(vertices, triangles).enclosed == pytest.approx(
            4 / 3 * np.pi * 36.1**1.5, rel=0.03
        )


class TestTrimesh:
    """tests/test_voxel.py."""

    def test_marching(self) -> None:
        """A block of voxels is a closed surface; its box reaches half a voxel beyond centres."""
        matrix = np.ones((3, 4, 5))
        surface = matrix_to_marching_cubes(matrix, 1.0)
        assert len(surface.open_facets) == 0
        assert surface.enclosed > 0
        np.testing.assert_allclose(np.ptp(surface.points, axis=0), [3, 4, 5])

    def test_pitch_scales_and_places(self) -> None:
        """Twice the pitch: eight times the volume."""
        matrix = np.random.default_rng(1).random((4, 4, 4)) > 0.4
        one, two = (matrix_to_marching_cubes(matrix, pitch) for pitch in (0.5, 1.0))
        assert two.enclosed == pytest.approx(8 * one.enclosed)

    def test_empty_matrix(self) -> None:
        """No voxel is no surface."""
        assert len(matrix_to_marching_cubes(np.zeros((2, 2, 2)), 1.0).simplices) == 0


class TestContourpy:
    """tests/test_lines.py: what does not depend on its chunks and line types."""

    def test_lines_of_a_saddle_by_the_centre(self) -> None:
        """Saddle quads are decided by the mean of four, as in mixed mode: the same lines."""
        contourpy = pytest.importorskip("contourpy")
        values = np.random.default_rng(2).normal(size=(9, 11))
        padded = np.pad(values, 1, constant_values=-3.0)
        ours = find_contours(padded, 0.1, "mixed")
        theirs = contourpy.contour_generator(z=padded, name="serial").lines(0.1)
        sizes = [
            sorted((len(line), round(float(abs(line).sum()), 6)) for line in own)
            for own in (ours, theirs)
        ]
        assert len(sizes[0]) > 5
        assert [n for n, _ in sizes[0]] == [n for n, _ in sizes[1]]
