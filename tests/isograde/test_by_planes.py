"""`isograde extract --by-planes`: volumes that stay in their files, meshes written as they come."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.command import app
from isograde.formats.reading import VolumeError
from isograde.formats.writing import write_pieces
from isoref import extract
from isoref.fast.slabs import slabs
from typer.testing import CliRunner

trimesh: Any = pytest.importorskip("trimesh")

VALUES = np.random.default_rng(8).normal(size=(12, 10, 11)).astype(np.float32)


def stored(folder: Path, kind: str) -> list[str]:
    """The words by which the command finds the samples in a file of this kind."""
    path = folder / f"volume.{kind}"
    if kind == "npy":
        np.save(path, VALUES)
    elif kind == "raw":
        VALUES.tofile(path)
        return [str(path), "--shape", "11,10,12", "--type", "float32"]
    elif kind == "h5":
        h5py: Any = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            file["samples"] = VALUES
    else:
        zarr: Any = pytest.importorskip("zarr")
        array = zarr.create_array(path, shape=VALUES.shape, chunks=(5, 4, 4), dtype=VALUES.dtype)
        array[:] = VALUES
    return [str(path)]


def pieces(values: Any, isovalue: float, precision: Any = "double") -> Iterator[tuple[Any, Any]]:
    """The surface as `write_pieces` takes it."""
    for slab in slabs(values, isovalue, precision=precision):
        yield slab.vertices, slab.simplices


@pytest.mark.parametrize("method", ["asymptotic-decider", "trilinear-cubes"])
@pytest.mark.parametrize("kind", ["npy", "raw", "h5", "zarr"])
def test_what_is_written_is_the_mesh_of_the_whole(kind: str, method: str, tmp_path: Path) -> None:
    """Number for number, once x is counted last as those files count it."""
    out = tmp_path / "mesh.ply"
    words = ["extract", *stored(tmp_path, kind), "--isovalue", "0.25", "--method", method]
    done = CliRunner().invoke(app, [*words, "--by-planes", "-o", str(out)])
    assert done.exit_code == 0, done.output
    came = trimesh.load(out, process=False)
    whole = extract(VALUES, 0.25, method=method)
    order = slice(None) if kind == "npy" else slice(None, None, -1)
    assert np.array_equal(came.vertices, whole.vertices[:, order])
    # A mirror image in space is turned over, so that normals point out again.
    turned = np.sort(came.faces) == np.sort(whole.simplices)
    assert turned.all()
    plain = tmp_path / "plain.ply"
    CliRunner().invoke(app, [*words, "-o", str(plain)])
    assert np.array_equal(came.faces, trimesh.load(plain, process=False).faces)
    assert sorted(path.name for path in tmp_path.glob("*.ply")) == ["mesh.ply", "plain.ply"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["-o", "mesh.obj"], "writes PLY"),
        (["--cap"], "no --label, --cap"),
        (["--label", "3"], "no --label, --cap"),
        (["--method", "surface-nets"], "surface-nets does not go part by part; asymptotic-decider"),
        (["--isovalue", "nan"], "isovalue nan is not finite"),
    ],
)
def test_what_does_not_go_by_planes_is_refused(
    more: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    isovalue = [] if {"--label", "--isovalue"} & set(more) else ["--isovalue", "0"]
    words = ["extract", *stored(tmp_path, "npy"), "--by-planes", *isovalue, *more]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2
    assert said in " ".join(done.output.split())
    assert not list(tmp_path.glob("mesh*"))


def test_other_files_and_more_axes_are_told_what_can_be_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "volume.npz", values=VALUES)
    np.save(tmp_path / "four.npy", VALUES[None])
    for name, said in [("volume.npz", "cannot be read by planes; .npy"), ("four.npy", "no volume")]:
        words = ["extract", str(tmp_path / name), "--isovalue", "0", "--by-planes"]
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 2
        assert said in " ".join(done.output.split())


def test_nothing_half_written_stays(tmp_path: Path) -> None:
    """What was there before a failure is there after it, and nothing else."""
    out = tmp_path / "mesh.ply"
    out.write_text("the last one", encoding="utf-8")
    values = VALUES.copy()
    values[9, 0, 0] = np.nan
    with pytest.raises(ValueError, match=r"sample \(9, 0, 0\) is nan"):
        write_pieces(pieces(values, 0.0), out)
    assert out.read_text(encoding="utf-8") == "the last one"
    assert list(tmp_path.iterdir()) == [out]


def test_more_vertices_than_ply_can_number_are_refused(tmp_path: Path) -> None:
    class Long(np.ndarray[Any, Any]):
        """Claims to have more rows than memory has."""

        def __len__(self) -> int:
            return (1 << 32) + 1

    many = np.empty((0, 3)).view(Long), np.empty((0, 3), np.int64)
    with pytest.raises(VolumeError, match="4,294,967,297 vertices are more"):
        write_pieces([many], tmp_path / "mesh.ply")


@pytest.mark.parametrize("precision", ["double", "single"])
def test_ply_has_the_numbers_that_it_is_given(precision: Any, tmp_path: Path) -> None:
    """No piece at all is an empty mesh, which every reader takes."""
    counts = write_pieces(pieces(VALUES, 0.1, precision), tmp_path / "mesh.ply")
    came = trimesh.load(tmp_path / "mesh.ply", process=False)
    whole = extract(VALUES, 0.1, precision=precision)
    assert (
        counts
        == (len(came.vertices), len(came.faces))
        == (
            len(whole.vertices),
            len(whole.simplices),
        )
    )
    assert np.array_equal(came.vertices.astype(whole.vertices.dtype), whole.vertices)
    assert write_pieces([], tmp_path / "none.ply") == (0, 0)
    assert (tmp_path / "none.ply").read_bytes().endswith(b"end_header\n")
