"""Volumes stand where SimpleITK and VTK say that the same file stands; meshes come back whole."""

from __future__ import annotations

import gc
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.formats.reading import READERS, Asked, Stored, VolumeError, other_format, read
from isograde.formats.writing import MESH_FILES, write
from isoref import METHODS, Field, Mesh, extract
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

itk: Any = pytest.importorskip("SimpleITK")
nibabel: Any = pytest.importorskip("nibabel")

SHAPE = (11, 13, 17)  # x, y, z
LPS = np.diag([-1.0, -1, 1, 1])


def samples() -> NDArray[np.float32]:
    """An egg, (x, y, z), with no symmetry that could hide an exchange of axes."""
    x, y, z = np.indices(SHAPE)
    egg = 20 - (x - 4.6) ** 2 - 0.7 * (y - 6.3) ** 2 - 0.4 * (z - 8.2) ** 2 + 0.3 * x * z / 9
    return np.asarray(egg, np.float32)


def rotation() -> Floats:
    """A rotation that leaves no axis alone."""
    return np.asarray(Rotation.from_euler("xyz", [21, -34, 50], degrees=True).as_matrix())


def oblique(mirrored: bool = False, shear: float = 0.0) -> Floats:
    """An affine in RAS: turned, with three different steps; mirrored or sheared if asked."""
    affine = np.eye(4)
    affine[:3, :3] = rotation() * [-1.25 if mirrored else 1.25, 0.75, 2.0]
    affine[:3, 2] += shear * affine[:3, 0]
    affine[:3, 3] = [12, -40, 77]
    return affine


def itk_image(affine: Floats) -> Any:
    """The samples as an image of ITK that stands where this affine, in LPS, says."""
    image = itk.GetImageFromArray(np.ascontiguousarray(samples().T))
    steps = np.linalg.norm(affine[:3, :3], axis=0)
    image.SetSpacing(steps.tolist())
    image.SetOrigin(affine[:3, 3].tolist())
    image.SetDirection((affine[:3, :3] / steps).ravel().tolist())
    return image


def signed_volume(mesh: Mesh) -> float:
    """Positive where right-hand normals point out of what the mesh encloses."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6)


def farthest(points: Floats, others: Floats) -> float:
    """How far the others are from the nearest of the points, at most."""
    return float(np.max(cKDTree(points).query(others)[0]))


def xyz(field: Field) -> Callable[[tuple[int, int, int]], Floats]:
    """From an index (x, y, z) to where the field puts the sample with that number."""
    given = samples()

    def place(index: tuple[int, int, int]) -> Floats:
        where = np.argwhere(field.values == given[index])
        assert len(where) == 1, "samples of the test are not all different"
        return field.position(where[0])

    return place


INDICES = [(0, 0, 0), (10, 0, 0), (0, 12, 0), (0, 0, 16), (3, 5, 7)]


def check_places(stored: Stored, expected: Callable[[tuple[int, int, int]], Any]) -> None:
    """Samples stand where another library says."""
    place = xyz(stored.field)
    for index in INDICES:
        assert place(index) == pytest.approx(np.array(expected(index)), abs=1e-4)


def test_the_samples_tell_the_indices_apart() -> None:
    """Otherwise `xyz` could not find them again."""
    given = samples()
    assert all((given == given[index]).sum() == 1 for index in INDICES)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("ending", [".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".gipl"])
def test_a_file_that_itk_wrote_stands_where_itk_says(
    ending: str, mirrored: bool, tmp_path: Path
) -> None:
    """Oblique and mirrored; NIfTI in RAS, all others in LPS. GIPL keeps no directions."""
    path = tmp_path / f"egg{ending}"
    affine = LPS @ oblique(mirrored)
    itk.WriteImage(itk_image(np.diag(np.diag(affine)) if ending == ".gipl" else affine), str(path))
    stored = read(path)
    again = itk.ReadImage(str(path))
    assert stored.space == ("RAS" if ending.startswith(".nii") else "LPS")
    check_places(stored.in_space("LPS"), again.TransformIndexToPhysicalPoint)
    check_places(
        stored.in_space("RAS"),
        lambda index: np.array(again.TransformIndexToPhysicalPoint(index)) * [-1, -1, 1],
    )


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("shear", [0.0, 0.4])
def test_a_nifti_affine_is_honoured_as_nibabel_gives_it(
    shear: float, mirrored: bool, tmp_path: Path
) -> None:
    """A sheared one too, which ITK refuses; outward normals point out in either handedness."""
    image = nibabel.Nifti1Image(samples(), None)
    image.set_sform(oblique(mirrored, shear), code=1)
    nibabel.save(image, tmp_path / "egg.nii.gz")
    stored = read(tmp_path / "egg.nii.gz")
    assert stored.space == "RAS"
    assert stored.field.handedness == (-1 if mirrored else 1)
    affine = nibabel.load(tmp_path / "egg.nii.gz").affine
    check_places(stored, lambda index: (affine @ [*index, 1])[:3])

    mesh = METHODS["asymptotic-decider"](stored.field, 5.0)
    straight = extract(samples(), 5.0)
    assert len(straight.simplices) > 100
    assert sorted(np.linalg.norm(mesh.vertices, axis=1)) == pytest.approx(
        sorted(np.linalg.norm(straight.vertices @ affine[:3, :3].T + affine[:3, 3], axis=1))
    )
    volume = signed_volume(straight) * abs(np.linalg.det(affine[:3, :3]))
    assert signed_volume(mesh) == pytest.approx(volume)


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_surface_of_an_oblique_scan_is_vtks(mirrored: bool, tmp_path: Path) -> None:
    """VTK contours what SimpleITK read, with ITK's direction matrix, as 3-D Slicer does."""
    vtk: Any = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

    nibabel.save(nibabel.Nifti1Image(samples(), oblique(mirrored)), tmp_path / "egg.nii")
    mesh = METHODS["asymptotic-decider"](read(tmp_path / "egg.nii").in_space("LPS").field, 5.0)

    image = itk.ReadImage(str(tmp_path / "egg.nii"))
    theirs = vtk.vtkImageData()
    theirs.SetDimensions(image.GetSize())
    theirs.SetSpacing(image.GetSpacing())
    theirs.SetOrigin(image.GetOrigin())
    theirs.SetDirectionMatrix(image.GetDirection())
    flat = itk.GetArrayFromImage(image).ravel()
    theirs.GetPointData().SetScalars(numpy_to_vtk(flat, deep=True))
    filter_ = vtk.vtkMarchingCubes()
    filter_.SetInputData(theirs)
    filter_.SetValue(0, 5.0)
    filter_.Update()
    points = vtk_to_numpy(filter_.GetOutput().GetPoints().GetData()).astype(np.float64)
    assert len(points) == len(mesh.vertices) > 100
    assert farthest(points, mesh.vertices) < 1e-4
    assert farthest(mesh.vertices, points) < 1e-4
    assert signed_volume(mesh) > 0


@pytest.mark.parametrize("ending", [".vti", ".vtk"])
def test_a_vtk_image_stands_where_vtk_says(ending: str, tmp_path: Path) -> None:
    """With directions, and with an extent that does not begin at 0; legacy files keep no turn."""
    pyvista: Any = pytest.importorskip("pyvista")
    grid = pyvista.ImageData(dimensions=SHAPE, spacing=(1.25, 0.75, 2.0), origin=(12, -40, 77))
    if ending == ".vti":
        grid.extent = (4, 14, -3, 9, 5, 21)
        grid.direction_matrix = rotation()
    grid.point_data["egg"] = samples().ravel(order="F")
    grid.save(tmp_path / f"egg{ending}")
    again = pyvista.read(tmp_path / f"egg{ending}")
    first = np.array(again.extent[::2])
    stored = read(tmp_path / f"egg{ending}")
    assert stored.space == ""
    check_places(stored, lambda index: _physical(again, first + index))


def _physical(grid: Any, index: Floats) -> Floats:
    """Where VTK says that an index stands."""
    place = [0.0, 0.0, 0.0]
    grid.TransformContinuousIndexToPhysicalPoint(*(float(i) for i in index), place)
    return np.array(place)


def write_series(folder: Path, affine: Floats, skip: int | None = None, uid: str = "1.2.3") -> None:
    """A DICOM series of the samples; each slice stands where the affine (LPS) says."""
    folder.mkdir(exist_ok=True)
    flat = np.ascontiguousarray(np.rint(samples().T * 10)).astype(np.int16)
    row, column = (affine[:3, a] / np.linalg.norm(affine[:3, a]) for a in (0, 1))
    for k, plane in enumerate(flat):
        if k == skip:
            continue
        image = itk.GetImageFromArray(plane)
        image.SetSpacing([float(np.linalg.norm(affine[:3, a])) for a in (0, 1)])
        place = affine[:3, 3] + k * affine[:3, 2]
        for tag, value in {
            "0008|0060": "CT",
            "0020|000d": "1.2",
            "0020|000e": uid,
            "0020|0032": "\\".join(f"{x:.9g}" for x in place),
            "0020|0037": "\\".join(f"{x:.9f}" for x in (*row, *column)),
            "0020|0013": str(k + 1),
        }.items():
            image.SetMetaData(tag, value)
        writer = itk.ImageFileWriter()
        writer.KeepOriginalImageUIDOn()
        writer.SetFileName(str(folder / f"{uid}-{(7 * k) % 17:02}.dcm"))
        writer.Execute(image)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_a_dicom_series_stands_where_its_slices_say(tilt: float, tmp_path: Path) -> None:
    """A tilted gantry makes the steps from slice to slice oblique to the slices."""
    affine = LPS @ oblique()
    affine[:3, 2] += tilt * affine[:3, 1]
    write_series(tmp_path / "series", affine)
    stored = read(tmp_path / "series")
    assert (stored.space, stored.unit) == ("LPS", "mm")
    field = stored.field
    assert np.array_equal(field.values, np.rint(samples().T * 10))
    for x, y, z in INDICES:
        assert field.position([z, y, x]) == pytest.approx((affine @ [x, y, z, 1])[:3], abs=1e-4)
    assert signed_volume(METHODS["surface-nets"](field, 50.0)) > 0


def test_a_missing_slice_and_a_second_series_are_told(tmp_path: Path) -> None:
    """In one sentence, with what to do."""
    write_series(tmp_path / "gap", LPS @ oblique(), skip=8)
    with pytest.raises(VolumeError, match=r"slices 7 and 8 .* not as far apart as the others"):
        read(tmp_path / "gap")
    write_series(tmp_path / "two", LPS @ oblique())
    write_series(tmp_path / "two", LPS @ oblique(), uid="1.2.4")
    with pytest.raises(VolumeError, match=r"1\.2\.3.*, 1\.2\.4.*; name one with --dataset"):
        read(tmp_path / "two")
    for file in (tmp_path / "two").glob("1.2.4-*"):
        file.unlink()
    shutil.copy(tmp_path / "two" / "1.2.3-07.dcm", tmp_path / "two" / "again.dcm")
    with pytest.raises(VolumeError, match=r"stand at one place: there are copies"):
        read(tmp_path / "two")
    (tmp_path / "none").mkdir()
    with pytest.raises(VolumeError, match="no DICOM series"):
        read(tmp_path / "none")


def test_arrays_with_names_are_asked_for(tmp_path: Path) -> None:
    """HDF5 and Zarr; ImageJ's and ilastik's size of an element is honoured."""
    h5py: Any = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "egg.h5", "w") as file:
        file["scan/egg"] = samples().T
        file["scan/egg"].attrs["element_size_um"] = [2.0, 0.75, 1.25]
        file["flat"] = np.zeros(4)
    check_places(read(tmp_path / "egg.h5"), lambda index: np.multiply(index, [1.25, 0.75, 2]))
    with h5py.File(tmp_path / "egg.h5", "a") as file:
        file["other"] = np.zeros((2, 2, 2))
    with pytest.raises(VolumeError, match="there are other, scan/egg; name one with --dataset"):
        read(tmp_path / "egg.h5")
    with pytest.raises(VolumeError, match="no dataset of three axes 'egg'; there are other, scan"):
        read(tmp_path / "egg.h5", Asked(dataset="egg"))
    assert read(tmp_path / "egg.h5", Asked(dataset="/scan/egg")).unit == "µm"


@pytest.mark.parametrize("version", [2, 3])
def test_a_level_of_ome_zarr_stands_where_its_transformations_say(
    version: int, tmp_path: Path
) -> None:
    """NGFF 0.4 (Zarr 2) and 0.5 (Zarr 3): scale, then translation, of the level and of all."""
    zarr: Any = pytest.importorskip("zarr")
    root = zarr.open_group(str(tmp_path / "egg.zarr"), mode="w", zarr_format=version)
    for name in ("0", "1"):
        step = 1 + int(name)
        root[name] = np.stack([samples().T, samples().T + 1])[None, :, ::step, ::step, ::step]
    axes = [{"name": "t"}, {"name": "c"}]
    axes += [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
    levels = [
        {
            "path": str(n),
            "coordinateTransformations": [
                {"type": "scale", "scale": [1, 1, 4 << n, 2 << n, 1 << n]},
                {"type": "translation", "translation": [0, 0, 30, 20, 10]},
            ],
        }
        for n in (0, 1)
    ]
    whole = [{"type": "scale", "scale": [1, 1, 0.5, 0.5, 0.5]}]
    scales = [{"axes": axes, "datasets": levels, "coordinateTransformations": whole}]
    root.attrs.update({"multiscales": scales} if version == 2 else {"ome": {"multiscales": scales}})
    stored = read(tmp_path / "egg.zarr")
    assert (stored.unit, stored.notes) == (
        "micrometer",
        ("the first of 2 volumes or channels is taken",),
    )
    check_places(stored, lambda index: np.add(np.multiply(index, [0.5, 1, 2]), [5, 10, 15]))
    coarse = read(tmp_path / "egg.zarr", Asked(dataset="1")).field
    assert coarse.position([1, 1, 1]).tolist() == [6.0, 12.0, 19.0]
    with pytest.raises(VolumeError, match="no level '2'; there are 0, 1"):
        read(tmp_path / "egg.zarr", Asked(dataset="2"))


def test_a_stack_of_tiff_pages_has_the_size_that_imagej_or_ome_wrote(tmp_path: Path) -> None:
    """Pages are z, rows y, columns x."""
    tifffile: Any = pytest.importorskip("tifffile")
    pages = np.ascontiguousarray(samples().T)
    tifffile.imwrite(tmp_path / "plain.tif", pages, photometric="minisblack")
    check_places(read(tmp_path / "plain.tif"), lambda index: index)
    tifffile.imwrite(tmp_path / "dots.tif", pages, imagej=True, resolution=(72, 72))
    check_places(read(tmp_path / "dots.tif"), lambda index: index)
    size = {"spacing": 2.0, "unit": "um", "axes": "ZYX"}
    tifffile.imwrite(
        tmp_path / "j.tif", pages, imagej=True, resolution=(1 / 1.25, 1 / 0.75), metadata=size
    )
    ome = {f"PhysicalSize{a}": s for a, s in zip("XYZ", (1.25, 0.75, 2.0), strict=True)}
    tifffile.imwrite(tmp_path / "o.ome.tif", pages, ome=True, metadata={"axes": "ZYX", **ome})
    for name in ("j.tif", "o.ome.tif"):
        check_places(read(tmp_path / name), lambda index: np.multiply(index, [1.25, 0.75, 2]))


def test_a_raw_file_needs_a_shape_and_a_type(tmp_path: Path) -> None:
    """X is fastest; a wrong size is told with both numbers."""
    path = tmp_path / "egg.raw"
    samples().T.astype(">f4").tofile(path)
    asked = Asked(shape=SHAPE, dtype=">f4", spacing=(1.25, 0.75, 2.0))
    check_places(read(path, asked), lambda index: np.multiply(index, [1.25, 0.75, 2]))
    with pytest.raises(VolumeError, match="--shape 256,256,128 --type uint8"):
        read(path)
    with pytest.raises(VolumeError, match=r"holds 2431 samples .*11 x 13 x 18 .* 10,296 bytes"):
        read(path, Asked(shape=(11, 13, 18), dtype=">f4"))


def test_an_npz_may_hold_directions_or_an_affine(tmp_path: Path) -> None:
    """Its array is (x, y, z), as everything of NumPy's here."""
    np.savez(tmp_path / "a.npz", values=samples(), affine=oblique(mirrored=True))
    np.savez(tmp_path / "d.npz", values=samples(), directions=rotation().T, origin=[1, 2, 3])
    check_places(read(tmp_path / "a.npz"), lambda i: (oblique(mirrored=True) @ [*i, 1])[:3])
    check_places(read(tmp_path / "d.npz"), lambda i: rotation() @ i + [1, 2, 3])


def test_nrrd_axes_without_a_direction_are_volumes(tmp_path: Path) -> None:
    """The first is taken, and said to be; LAS is turned into RAS."""
    nrrd: Any = pytest.importorskip("nrrd")
    rows = np.vstack([[np.nan] * 3, np.diag([1.25, 0.75, 2.0])])
    header = {"space": "left-anterior-superior", "space directions": rows}
    nrrd.write(str(tmp_path / "egg.nrrd"), np.stack([samples(), samples() + 1]), header)
    stored = read(tmp_path / "egg.nrrd")
    assert stored.space == "RAS"
    assert stored.notes == ("the first of 2 volumes or channels is taken",)
    check_places(stored, lambda index: np.multiply(index, [-1.25, 0.75, 2]))


def test_a_nifti_without_codes_names_no_space(tmp_path: Path) -> None:
    """Its header gives steps and no place; LPS cannot be made of it."""
    image = nibabel.Nifti1Image(samples(), None)
    image.header.set_zooms((1.25, 0.75, 2.0))
    nibabel.save(image, tmp_path / "egg.nii")
    stored = read(tmp_path / "egg.nii")
    assert stored.space == ""
    check_places(stored, lambda index: np.multiply(index, [1.25, 0.75, 2]))
    with pytest.raises(VolumeError, match="names no coordinate system, so LPS cannot be made"):
        stored.in_space("LPS")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("ending", sorted(READERS))
def test_rubbish_is_refused_in_one_sentence(ending: str, tmp_path: Path) -> None:
    """Whatever the library of the format raises; nibabel leaves its file open."""
    path = tmp_path / f"rubbish{ending}"
    path.write_bytes(b"rubbish" * 40)
    asked = Asked(shape=(9, 9, 9), dtype="uint8")
    with pytest.raises(VolumeError) as told:
        read(path, asked)
    assert len(str(told.value).splitlines()) == 1
    assert path.name in str(told.value)
    # What is left open is found out here, and not laid at another test.
    del told
    gc.collect()


def test_colours_and_pictures_are_no_volumes(tmp_path: Path) -> None:
    """They are told from a volume of numbers."""
    itk.WriteImage(
        itk.GetImageFromArray(np.zeros((4, 4, 4, 3), np.uint8), isVector=True),
        str(tmp_path / "c.mha"),
    )
    itk.WriteImage(itk.GetImageFromArray(np.zeros((4, 4), np.uint8)), str(tmp_path / "p.mha"))
    with pytest.raises(VolumeError, match="a voxel has 3 numbers, and an isosurface needs one"):
        read(tmp_path / "c.mha")
    with pytest.raises(VolumeError, match="2 dimensions is no volume"):
        read(tmp_path / "p.mha")


@pytest.mark.parametrize("ending", MESH_FILES)
def test_a_mesh_comes_back_from_every_format(ending: str, tmp_path: Path) -> None:
    """Read by the library of the format: the same triangles at the same places, turned alike."""
    mesh = extract(samples(), 5.0)
    path = tmp_path / f"egg{ending}"
    write(mesh, path, "LPS")
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    if ending == ".npz":
        with np.load(path) as arrays:
            again = Mesh.of(arrays["vertices"], arrays["faces"])
            assert str(arrays["space"]) == "LPS"
    elif ending == ".vtp":
        import pyvista

        surface: Any = pyvista.read(path)
        again = Mesh.of(surface.points, surface.faces.reshape(-1, 4)[:, 1:])
        assert list(surface.field_data["SPACE"]) == ["LPS"]
    elif ending in {".ply", ".obj", ".off", ".stl", ".glb", ".3mf"}:
        import trimesh

        loaded: Any = trimesh.load_mesh(path)
        again = Mesh.of(loaded.vertices, loaded.faces)
    else:
        import meshio

        read_back = meshio.read(path)
        again = Mesh.of(read_back.points, read_back.cells_dict["triangle"])
    assert len(again.simplices) == len(mesh.simplices) > 100
    assert signed_volume(again) == pytest.approx(signed_volume(mesh), rel=1e-5)
    assert farthest(again.vertices, mesh.vertices) < 1e-5


def test_real_scans_stand_where_simpleitk_puts_them(data: Path) -> None:
    """The corners of a brain and of a phase image of several echoes, in LPS."""
    for name in ("stroke_T1.nii.gz", "romeo_Mag.nii"):
        stored, image = read(data / name), itk.ReadImage(str(data / name))
        field = stored.in_space("LPS").field
        for far in np.ndindex(2, 2, 2):
            index = np.multiply(far, np.array(field.shape) - 1)
            padded = [int(i) for i in index] + [0] * (image.GetDimension() - 3)
            place = image.TransformIndexToPhysicalPoint(padded)[:3]
            assert field.position(index) == pytest.approx(np.array(place), abs=1e-3)
        values = itk.GetArrayFromImage(image)
        first = values.reshape(-1, *values.shape[-3:])[0].T
        assert np.allclose(stored.values, first, rtol=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: np.savez(path, a=np.zeros(3)), "no array named values"),
        (lambda path: np.savez(path, values=np.zeros((2, 2))), "no volume, which has three axes"),
        (lambda path: np.savez(path, values=np.zeros((0, 2, 2))), "no samples"),
        (
            lambda path: np.savez(path, values=np.zeros((2, 2, 2)), spacing=-1),
            "must be positive",
        ),
        (
            lambda path: np.savez(path, values=np.zeros((2, 2, 2)), directions=np.ones((3, 3))),
            "lie in a plane",
        ),
        (
            lambda path: np.savez(path, values=np.zeros((2, 2, 2)), affine=np.diag([1, 1, 0, 1])),
            "moves nothing along axis 2",
        ),
        (lambda path: np.savez(path, values=np.zeros((2, 2, 2), complex)), "not real numbers"),
        (lambda path: np.savez(path, values=np.full((2, 2, 2), np.nan)), "--absent leaves them"),
    ],
)
def test_a_file_that_is_no_volume_is_told_why(
    make: Callable[[Path], None], message: str, tmp_path: Path
) -> None:
    """Each in one sentence that begins with the file."""
    make(tmp_path / "bad.npz")
    with pytest.raises(VolumeError, match=message) as told:
        read(tmp_path / "bad.npz")
    assert str(told.value).startswith(str(tmp_path / "bad.npz"))
    assert len(str(told.value).splitlines()) == 1


def in_format(ending: str, path: Path) -> Path:
    """A file with this ending, of the format that it says."""
    file = path.with_name(f"{path.name}{ending}")
    if ending in (".nii", ".nii.gz"):
        nibabel.save(nibabel.Nifti1Image(samples().astype(np.float32), np.eye(4)), file)
    elif ending == ".npz":
        np.savez(file, values=samples())
    elif ending == ".npy":
        np.save(file, samples())
    else:
        itk.WriteImage(itk.GetImageFromArray(samples().astype(np.float32)), str(file))
    return file


@pytest.mark.parametrize("of", [".nii", ".nii.gz", ".npy", ".npz", ".nrrd", ".mha", ".tif"])
def test_a_wrong_ending_is_told_by_how_the_file_begins(of: str, tmp_path: Path) -> None:
    """Attack: scans that were renamed; a right name gets no such hint."""
    right = in_format(of, tmp_path / "köpf")
    assert other_format(right) == ""
    assert read(right).values.shape in (samples().shape, samples().T.shape)
    for ending in {".nii", ".nii.gz", ".nrrd", ".npz", ".npy", ".weird", ""} - {of}:
        wrong = tmp_path / f"wrong{ending}"
        shutil.copy(right, wrong)
        with pytest.raises(VolumeError, match=r"it begins as .* does: rename it"):
            read(wrong)


@pytest.mark.parametrize("ending", [".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd"])
def test_names_in_any_script_are_read(ending: str, tmp_path: Path) -> None:
    """Detached headers name their data in UTF-8."""
    path = tmp_path / f"Schädel 頭 ☠{ending}"
    given = samples().T.astype(np.float32)
    itk.WriteImage(itk.GetImageFromArray(given), str(path))
    assert sorted(read(path).values.ravel().tolist()) == sorted(given.ravel().tolist())


@pytest.mark.parametrize(
    ("affine", "told"),
    [
        (np.diag([1.0, 1, 0, 1]), "moves nothing along axis 2"),
        ([[1, 2, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]], "directions lie in a plane"),
        (np.diag([1, np.nan, 1, 1]), "finite numbers"),
    ],
)
def test_an_affine_that_flattens_space_is_refused(affine: Any, told: str, tmp_path: Path) -> None:
    header = nibabel.Nifti1Image(samples().astype(np.float32), np.eye(4)).header
    header.set_sform(np.array(affine), 1)
    header["qform_code"] = 0
    image = nibabel.Nifti1Image(samples().astype(np.float32), None, header)
    nibabel.save(image, tmp_path / "flat.nii")
    with pytest.raises(VolumeError, match=told):
        read(tmp_path / "flat.nii")
