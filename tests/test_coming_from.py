"""The page "coming from": each library's call, made of isoref, beside the library itself."""

from __future__ import annotations

import inspect
import textwrap
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from isoref.degenerate import state
from isoref.mesh import Mesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tests.loading import module_at

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "coming_from"
Array = NDArray[Any]


def ours(name: str) -> ModuleType:
    """The module of the page for one library."""
    return module_at(FOLDER / f"{name}.py", f"coming_from_{name}")


def volumes() -> dict[str, tuple[Array, float]]:
    """A smooth body, noise in general position, and whole numbers full of ties."""
    random = np.random.default_rng(0)
    x, y, z = np.indices((20, 21, 22)) - 9.3
    return {
        "smooth": (50 - x * x - y * y - 0.7 * z * z, 5.0),
        "noise": (random.normal(size=(8, 9, 10)), 0.1),
        "ties": (random.integers(-1, 2, size=(8, 9, 10)).astype(np.float64), 0.0),
    }


def enclosed(vertices: Array, faces: Array) -> float:
    """The signed volume: its sign tells the orientation."""
    a, b, c = np.moveaxis(np.asarray(vertices, np.float64)[faces.astype(np.int64)], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6)


def same_places(points: Array, others: Array, limit: float) -> NDArray[np.int64]:
    """Both are one set of places; for each point the number of the other."""
    distance, which = cKDTree(others).query(points)
    assert len(points) == len(others) > 100
    assert np.max(distance) < limit
    assert np.max(cKDTree(points).query(others)[0]) < limit
    return np.asarray(which)


@pytest.mark.parametrize(
    "name", ["scikit_image", "scikit_image_contours", "pymcubes", "contourpy", "vtk"]
)
def test_the_page_shows_each_module(name: str) -> None:
    """A few dozen lines of code each, and none that the page does not show."""
    page = (ROOT / "docs" / "coming_from.rst").read_text(encoding="utf-8")
    assert f".. literalinclude:: coming_from/{name}.py" in page
    lines = (FOLDER / f"{name}.py").read_text(encoding="utf-8").splitlines()
    code = [line for line in lines if line.strip() and '"""' not in line and "#" not in line[:5]]
    assert len(code) <= 42


def test_scikit_images_call_has_its_parameters_and_defaults() -> None:
    """Whoever calls theirs calls ours."""
    measure: Any = pytest.importorskip("skimage.measure")
    theirs, mine = (
        {name: one.default for name, one in inspect.signature(call).parameters.items()}
        for call in (measure.marching_cubes, ours("scikit_image").marching_cubes)
    )
    assert mine == theirs


@pytest.mark.parametrize("posed", ["smooth", "noise", "ties"])
@pytest.mark.parametrize("direction", ["descent", "ascent"])
def test_scikit_images_arrays_come_out(posed: str, direction: str) -> None:
    """Vertices, types, orientation and normals; with "lorensen" all of the topology too.

    On noise its lewiner places points of its own inside cells, and has other tunnels.
    """
    measure: Any = pytest.importorskip("skimage.measure")
    mine = ours("scikit_image").marching_cubes
    values, level = volumes()[posed]
    given = {"spacing": (1.0, 0.5, 2.0), "gradient_direction": direction}
    theirs = measure.marching_cubes(values, level, method="lorensen", **given)
    found = mine(values, level, method="lorensen", **given)
    which = same_places(found[0], theirs[0], np.finfo(np.float32).eps * theirs[0].max())
    assert [a.dtype for a in found] == [a.dtype for a in theirs]
    plain = mine(values, level), measure.marching_cubes(values, level)
    assert [a.dtype for a in plain[0]] == [a.dtype for a in plain[1]]
    assert found[1].shape == theirs[1].shape
    if posed == "smooth":
        assert enclosed(*found[:2]) == pytest.approx(enclosed(*theirs[:2]), rel=1e-5)
        normals = mine(values, level, gradient_direction=direction)[2]
        assert (normals * theirs[2][which]).sum(axis=1).min() > 0.99
        right = mine(values, **given)[:2], measure.marching_cubes(values, **given)[:2]
        assert enclosed(*right[0]) == pytest.approx(enclosed(*right[1]), rel=1e-5)
    whole = mine(values, level, **given)
    assert state(Mesh.of(*whole[:2])).crowded == 0


@pytest.mark.parametrize("step", [1, 2, 3])
def test_scikit_images_steps_and_masks(step: int) -> None:
    """Every other sample; cells whose highest corner is marked."""
    measure: Any = pytest.importorskip("skimage.measure")
    values, level = volumes()["smooth"]
    mask = np.random.default_rng(1).random(values.shape) < 0.8
    given: dict[str, Any] = {"step_size": step, "mask": mask if step == 1 else None}
    theirs = measure.marching_cubes(values, level, **given)
    found = ours("scikit_image").marching_cubes(values, level, **given)
    same_places(found[0], theirs[0], 1e-5)
    assert len(found[1]) == len(theirs[1])


@pytest.mark.parametrize("fully", ["low", "high"])
@pytest.mark.parametrize("posed", ["smooth", "noise", "ties"])
def test_scikit_images_contours_come_out(posed: str, fully: str) -> None:
    """Every directed segment: saddles both ways, samples left out, both directions.

    Where ties make several lines meet in a point, which go on into which is either's choice.
    """
    measure: Any = pytest.importorskip("skimage.measure")
    values, level = volumes()[posed]
    image = values[4]
    random = np.random.default_rng(5)
    total = 0
    for share, direction in ((0.0, "low"), (0.1, "low"), (0.1, "high")):
        holes = np.where(random.random(image.shape) < share / 2, np.nan, image)
        mask = random.random(image.shape) >= share / 2
        given = {"fully_connected": fully, "positive_orientation": direction, "mask": mask}
        theirs = measure.find_contours(holes, level, **given)
        mine = ours("scikit_image_contours").find_contours(holes, level, **given)
        a, b = segments(mine), segments(theirs)
        assert (len(mine) == len(theirs)) | (posed == "ties")
        assert len(a) == len(b) > 0
        for one, other in ((a, b), (b, a)):
            assert np.max(cKDTree(one).query(other)[0]) < 1e-12
        if posed != "ties":
            assert sorted(map(len, mine)) == sorted(map(len, theirs))
        total += len(mine)
    assert total > 3


@pytest.mark.parametrize("posed", ["smooth", "noise", "ties"])
def test_pymcubes_arrays_come_out(posed: str) -> None:
    """The same vertices, as many triangles, types and orientation."""
    mcubes: Any = pytest.importorskip("mcubes")
    values, level = volumes()[posed]
    theirs = mcubes.marching_cubes(values, level)
    found = ours("pymcubes").marching_cubes(values, level)
    same_places(found[0], theirs[0], 1e-6)
    assert found[1].shape == theirs[1].shape
    assert [a.dtype for a in found] == [a.dtype for a in theirs]
    if posed == "smooth":
        assert enclosed(*found) == pytest.approx(enclosed(*theirs))


def test_pymcubes_functions_are_sampled_where_it_samples_them() -> None:
    """The corners are samples; vertices come in the coordinates of the function."""
    mcubes: Any = pytest.importorskip("mcubes")

    def ball(x: float, y: float, z: float) -> float:
        return 1.3 - x * x - y * y - z * z

    given = (-1.5, -2.0, -1.5), (1.5, 2.0, 1.7), 20, 30, 25, ball, 0.0
    theirs, found = mcubes.marching_cubes_func(*given), ours("pymcubes").marching_cubes_func(*given)
    same_places(found[0], theirs[0], 1e-9)
    assert enclosed(*found) == pytest.approx(enclosed(*theirs))
    assert len(ours("pymcubes").marching_cubes(np.zeros((5, 5, 5)), 0.5)[0]) == 0


def segments(lines: list[Array]) -> Array:
    """(S, 4) the directed segments of polylines: from where to where."""
    pairs = [np.hstack([line[:-1], line[1:]]) for line in lines]
    return np.concatenate([np.empty((0, 4)), *pairs])


@pytest.mark.parametrize("posed", ["smooth", "noise", "ties"])
def test_contourpys_lines_come_out(posed: str) -> None:
    """Every directed segment, saddles and ties too, on plain, rectangular and bent grids."""
    contourpy: Any = pytest.importorskip("contourpy")
    values, level = volumes()[posed]
    total = 0
    for z in values:
        rows, columns = z.shape
        x, y = np.linspace(0, 3, columns) ** 2, np.linspace(-1, 1, rows)
        bent = np.meshgrid(x, y)
        for grid in ((None, None), (x, y), (bent[0] + bent[1], bent[1] - 0.1 * bent[0])):
            theirs = contourpy.contour_generator(*grid, z).lines(level)
            mine = ours("contourpy").contour_generator(*grid, z).lines(level)
            a, b = segments(mine), segments(theirs)
            assert len(a) == len(b)
            for one, other in ((a, b), (b, a)) if len(a) else ():
                assert np.max(cKDTree(one).query(other)[0]) < 1e-9
            assert len(mine) == len(theirs)
            assert sorted(map(len, mine)) == sorted(map(len, theirs))
            total += len(mine)
    assert total > 30


def test_contourpys_levels_that_meet_nothing() -> None:
    """Beyond the range, or no number: no lines, as from contourpy."""
    contourpy: Any = pytest.importorskip("contourpy")
    z = [[0.0, 1.0], [0.0, 1.0]]
    for level in (-1e-10, 1e10, np.nan, np.inf, -np.inf):
        assert contourpy.contour_generator(z=z).lines(level) == []
        assert ours("contourpy").contour_generator(z=z).lines(level) == []
    several = ours("contourpy").contour_generator(z=z).multi_lines([0.25, 0.5])
    assert [lines[0][:, 0].tolist() for lines in several] == [[0.25, 0.25], [0.5, 0.5]]
    with pytest.raises(ValueError, match="masked array"):
        ours("contourpy").contour_generator(z=np.ma.masked_equal(z, 1.0)).lines(0.5)


@pytest.mark.parametrize("posed", ["smooth", "noise", "ties"])
def test_vtks_surface_comes_out(posed: str) -> None:
    """The same points and normals, as many triangles, of a turned image with its own extent."""
    vtk: Any = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

    values, level = volumes()[posed]
    image = vtk.vtkImageData()
    nx, ny, nz = values.shape
    image.SetExtent(3, 2 + nx, -4, ny - 5, 0, nz - 1)
    image.SetSpacing(1, 0.5, 2)
    image.SetOrigin(10, 20, 30)
    image.SetDirectionMatrix(0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    meshes = []
    for filter_ in (vtk.vtkFlyingEdges3D(), ours("vtk").FlyingEdges3D()):
        filter_.SetInputData(image)
        filter_.SetValue(0, level)
        filter_.SetValue(1, level + 0.25)
        filter_.SetComputeNormals(True)
        filter_.Update()
        output = filter_.GetOutput()
        triangles = vtk_to_numpy(output.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        points = vtk_to_numpy(output.GetPoints().GetData())
        meshes.append((points, triangles, vtk_to_numpy(output.GetPointData().GetNormals())))
    (points, faces, normals), (mine, rows, own) = meshes
    if posed != "ties":  # of vertices at one place, any may be the nearest
        which = same_places(mine, points, 1e-5)
        assert (np.abs(own - normals[which]).max(axis=1) < 1e-2).mean() > 0.999
    assert len(mine) == len(points)
    assert rows.shape == faces.shape
    if posed == "smooth":
        assert enclosed(mine, rows) == pytest.approx(enclosed(points, faces), rel=1e-4)


def test_what_the_page_shows_at_its_end_runs() -> None:
    """Caps, several isovalues, absent samples, directions, provenance and the clean-up."""
    page = (ROOT / "docs" / "coming_from.rst").read_text(encoding="utf-8")
    shown = page.partition(".. code-block:: python\n")[2]
    program = textwrap.dedent(shown)
    assert program.count("extract(") == 5
    values = 1 - (((np.indices((9, 9, 9)) - 4) / 4.0) ** 2).sum(axis=0)
    names: dict[str, Any] = {
        "values": values,
        "frame": [[0, 1, 0], [1, 0, 0], [0, 0, 1]],
        "rgb": np.indices((9, 9, 9)) / 8.0,
    }
    exec(program, names)
    assert len(names["outer"].vertices) > len(names["inner"].vertices) > 0
