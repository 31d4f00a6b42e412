"""`isograde extract --frames`: a time series, one mesh a frame, in numbered files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.command import app
from isograde.formats.reading import Asked, VolumeError, read
from isoref import extract
from typer.testing import CliRunner, Result

trimesh: Any = pytest.importorskip("trimesh")

SERIES = np.random.default_rng(9).normal(size=(11, 5, 6, 7)).astype(np.float32)


@pytest.fixture(scope="module")
def series(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eleven frames in a file of NumPy, time first."""
    file = tmp_path_factory.mktemp("series") / "series.npy"
    np.save(file, SERIES)
    return file


def run(*words: str | Path) -> Result:
    """The result of the command."""
    return CliRunner().invoke(app, ["extract", *map(str, words)])


def test_every_frame_has_its_mesh_in_a_numbered_file(series: Path, tmp_path: Path) -> None:
    """Numbers are of as many digits, so that names sort as frames do."""
    done = run(series, "--isovalue", "0.3", "--frames", "all", "-o", tmp_path / "mesh.ply")
    assert done.exit_code == 0, done.output
    files = sorted(tmp_path.iterdir())
    assert [file.name for file in files] == [f"mesh-{n:02}.ply" for n in range(11)]
    for frame, file in zip(SERIES, files, strict=True):
        right = extract(frame, 0.3)
        mesh = trimesh.load(file, process=False)
        assert np.allclose(mesh.vertices, right.vertices, atol=1e-6)
        assert np.array_equal(mesh.faces, right.simplices)


@pytest.mark.parametrize(
    ("which", "numbers"),
    [("3", [3]), ("-1", [10]), ("8:", [8, 9, 10]), ("1:6:2", [1, 3, 5]), ("9:99", [9, 10])],
)
def test_some_frames_keep_their_numbers(
    which: str, numbers: list[int], series: Path, tmp_path: Path
) -> None:
    """As Python counts, from 0 on; several isovalues have a file each."""
    values = ["--isovalue", "0.3", "--isovalue", "-0.5"]
    done = run(series, *values, "--frames", which, "-o", tmp_path / "m.off")
    assert done.exit_code == 0, done.output
    names = {file.name for file in tmp_path.iterdir()}
    assert names == {f"m-{n:02}-{value}.off" for n in numbers for value in ("0.3", "-0.5")}


def test_a_volume_alone_is_a_series_of_one(tmp_path: Path) -> None:
    np.save(tmp_path / "one.npy", SERIES[0])
    done = run(
        tmp_path / "one.npy", "--isovalue", "0.3", "--frames", "all", "-o", tmp_path / "m.off"
    )
    assert done.exit_code == 0, done.output
    assert (tmp_path / "m-0.off").exists()


def test_scans_count_time_last_and_are_read_once(tmp_path: Path) -> None:
    """NIfTI: the axes behind x, y, z; each frame stands where the scan does."""
    nibabel: Any = pytest.importorskip("nibabel")
    affine = np.diag([0.5, 2.0, 3.0, 1.0])
    image = nibabel.Nifti1Image(np.moveaxis(SERIES[:3], 0, -1), affine)
    nibabel.save(image, tmp_path / "scan.nii.gz")
    stored = read(tmp_path / "scan.nii.gz", Asked(series=True))
    assert np.array_equal(stored.values, SERIES[:3])
    assert (stored.space, stored.notes) == ("RAS", ())
    assert np.array_equal(stored.affine, affine)
    assert "the first of 3" in read(tmp_path / "scan.nii.gz").notes[0]


def test_formats_with_axes_of_time_and_channels_give_all_of_them(tmp_path: Path) -> None:
    """TIFF, NRRD, HDF5 and Zarr: whatever is no axis of space counts frames, in order."""
    tifffile: Any = pytest.importorskip("tifffile")
    nrrd: Any = pytest.importorskip("nrrd")
    h5py: Any = pytest.importorskip("h5py")
    zarr: Any = pytest.importorskip("zarr")
    few = SERIES[:4]
    tifffile.imwrite(tmp_path / "s.tif", few, metadata={"axes": "TZYX"}, ome=False)
    rows = np.vstack([[np.nan] * 3, np.diag([1.0, 1.0, 1.0])])
    nrrd.write(str(tmp_path / "s.nrrd"), few, {"space directions": rows, "space": "LPS"})
    with h5py.File(tmp_path / "s.h5", "w") as file:
        file["samples"] = few.reshape(2, 2, 5, 6, 7)
    array = zarr.create_array(tmp_path / "s.zarr", shape=few.shape, dtype=few.dtype)
    array[:] = few
    for name in ("s.tif", "s.nrrd", "s.h5", "s.zarr"):
        assert np.array_equal(read(tmp_path / name, Asked(series=True)).values, few), name


def test_wrong_use_is_told(series: Path, tmp_path: Path) -> None:
    """Status 2, and one sentence; what was written before a bad frame stays."""
    out: list[str | Path] = ["--isovalue", "0.3", "-o", tmp_path / "m.ply"]
    for which in ("first", "1:2:0", "1:2:3:4", "", "1.5"):
        done = run(series, *out, "--frames", which)
        assert (done.exit_code, "say all, a number" in done.output) == (2, True), done.output
    done = run(series, *out, "--frames", "11")
    assert (done.exit_code, "there are 11, counted from 0" in done.output) == (2, True)
    done = run(series, *out)
    assert (done.exit_code, "is no volume, which has three axes" in done.output) == (2, True)
    done = run(series, *out, "--frames", "all", "--by-planes")
    assert (done.exit_code, "leave --by-planes out" in done.output) == (2, True)
    broken = SERIES[:3].copy()
    broken[1, 2, 3, 4] = np.nan
    np.save(tmp_path / "broken.npy", broken)
    done = run(tmp_path / "broken.npy", *out, "--frames", "all")
    assert (done.exit_code, "frame 1: sample (2, 3, 4) is nan" in done.output) == (2, True)
    assert (tmp_path / "m-0.ply").exists()
    np.save(tmp_path / "flat.npy", SERIES[0, 0])
    with pytest.raises(VolumeError, match="no series of volumes"):
        read(tmp_path / "flat.npy", Asked(series=True))
