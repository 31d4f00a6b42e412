"""Files that are no volumes: one sentence, status 2, and the memory that is free (issue 13)."""

import gzip
import io
import json
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from isograde.command import app
from isograde.formats import guard
from isograde.formats.reading import VolumeError, read
from typer.testing import CliRunner

GOOD = np.random.default_rng(0).random((5, 6, 7)).astype(np.float32)


def npy(shape: tuple[int, ...], descr: str = "<f8", data: bytes = bytes(64)) -> bytes:
    """A .npy file that says it has this shape and type."""
    head = f"{{'descr': {descr!r}, 'fortran_order': False, 'shape': {shape!r}, }}"
    head += " " * (63 - (10 + len(head)) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data


def nii(
    *shape: int, code: int = 16, rank: int = 3, offset: float = 352.0, data: bytes | None = None
) -> bytes:
    """A NIfTI file that says so."""
    head = bytearray(348)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, rank, *shape, 1, 1, 1, 1)
    struct.pack_into("<hh", head, 70, code, 32)
    struct.pack_into("<8f", head, 76, *[1.0] * 8)
    struct.pack_into("<f", head, 108, offset)
    head[344:348] = b"n+1\0"
    return bytes(head) + bytes(4) + (GOOD.tobytes() if data is None else data)


def nrrd(sizes: str, encoding: str = "raw") -> bytes:
    """An NRRD file that says so."""
    head = f"NRRD0004\ntype: float\ndimension: 3\nsizes: {sizes}\nencoding: {encoding}\n"
    return f"{head}endian: little\n\n".encode() + GOOD.tobytes()


def mha(size: str) -> bytes:
    """A MetaImage that says so."""
    head = f"ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = {size}\n"
    return f"{head}ElementType = MET_FLOAT\nElementDataFile = LOCAL\n".encode() + GOOD.tobytes()


def vti(extent: str) -> bytes:
    """An XML image of VTK that says so."""
    array = '<DataArray type="Float32" Name="a" format="ascii">1 2 3</DataArray>'
    piece = f'<Piece Extent="{extent}"><PointData Scalars="a">{array}</PointData></Piece>'
    image = f'<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">{piece}</ImageData>'
    return f'<VTKFile type="ImageData" version="1.0">{image}</VTKFile>'.encode()


def vtk(size: str) -> bytes:
    """A legacy image of VTK that says so."""
    head = f"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {size}\n"
    return f"{head}POINT_DATA 210\nSCALARS a float 1\nLOOKUP_TABLE default\n1 2 3\n".encode()


def npz(**arrays: np.ndarray) -> bytes:
    """A NumPy archive."""
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def bomb() -> bytes:
    """A small archive of a large array of zeros, cut short so that tests are quick."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("values.npy", npy((4000, 1000, 1000), data=bytes(1 << 20)))
    return file.getvalue()


HUGE = "20000 20000 20000"
FILES: dict[str, bytes] = {
    "huge.npy": npy((10_000, 10_000, 10_000)),
    "negative.npy": npy((-2, 3, 4)),
    "empty-axis.npy": npy((0, 3, 4)),
    "overflow.npy": npy((2**62, 4, 4)),
    "objects.npy": npy((2, 2, 2), "|O"),
    "texts.npy": npy((2, 2, 2), "<U4", bytes(128)),
    "complex.npy": npy((2, 2, 2), "<c16", bytes(128)),
    "truncated.npy": npy((5, 6, 7)),
    "flat.npy": npy((2, 4)),
    "magic.npy": b"\x93NUMPY",
    "code.npy": b"\x93NUMPY\x01\x00\x10\x00{'descr': __imp}",
    "nested.npy": b"\x93NUMPY\x02\x00" + struct.pack("<I", 60_000) + b"(" * 60_000,
    "nothing.npy": b"",
    "huge.nii": nii(20_000, 20_000, 20_000),
    "negative.nii": nii(-5, 6, 7),
    "empty-axis.nii": nii(0, 6, 7),
    "type.nii": nii(5, 6, 7, code=9999),
    "truncated.nii": nii(5, 6, 7, data=b"abc"),
    "offset.nii": nii(5, 6, 7, offset=1e18),
    "no-offset.nii": nii(5, 6, 7, offset=float("nan")),
    "rank.nii": nii(5, 6, 7, rank=9),
    "truncated.nii.gz": gzip.compress(nii(5, 6, 7))[:200],
    "rubbish.nii.gz": b"\x1f\x8b\x08\0" + bytes(50),
    "plain.nii.gz": nii(5, 6, 7),
    "checksum.nii.gz": gzip.compress(nii(5, 6, 7))[:-8] + bytes(8),
    "huge.nrrd": nrrd(HUGE),
    "negative.nrrd": nrrd("-5 6 7"),
    "empty-axis.nrrd": nrrd("0 6 7"),
    "words.nrrd": nrrd("a b c"),
    "few.nrrd": nrrd("5 6"),
    "truncated.nrrd": nrrd("50 60 70"),
    "encoding.nrrd": nrrd("5 6 7", "zip"),
    "gzip.nrrd": nrrd("5 6 7", "gzip"),
    "huge.mha": mha(HUGE),
    "negative.mha": mha("-5 6 7"),
    "empty-axis.mha": mha("0 6 7"),
    "truncated.mha": mha("50 60 70"),
    "missing.mhd": mha("5 6 7").replace(b"LOCAL", b"no.raw"),
    "huge.vti": vti("0 20000 0 20000 0 20000"),
    "negative.vti": vti("0 -5 0 6 0 7"),
    "words.vti": vti("a b c"),
    "truncated.vti": vti("0 40 0 50 0 60"),
    "huge.vtk": vtk(HUGE),
    "negative.vtk": vtk("-5 6 7"),
    "truncated.vtk": vtk("5 6 7"),
    "truncated.npz": npz(values=GOOD)[:100],
    "rubbish.npz": b"PK\3\4" + bytes(50),
    "other.npz": npz(samples=GOOD),
    "bomb.npz": bomb(),
    "rubbish.tif": b"II*\0" + bytes(range(200)),
    "loop.tif": b"II*\0\x08\0\0\0\x01\0" + struct.pack("<HHIII", 256, 4, 1, 5, 8),
    "rubbish.h5": b"\x89HDF\r\n\x1a\n" + bytes(100),
    "rubbish.gipl": bytes(300),
    "rubbish.dcm": bytes(128) + b"DICM" + bytes(range(256)),
    "huge.mgz": gzip.compress(struct.pack(">7i", 1, 20_000, 20_000, 20_000, 1, 3, 0) + bytes(300)),
    "negative.mgh": struct.pack(">7i", 1, -5, 6, 7, 1, 3, 0) + bytes(300),
    "no-ending": b"x",
}
# NumPy leaves a file open that is no archive.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
NEEDS = {
    ".nii": "nibabel", ".gz": "nibabel", ".mgz": "nibabel", ".mgh": "nibabel", ".nrrd": "nrrd",
    ".mha": "SimpleITK", ".mhd": "SimpleITK", ".gipl": "SimpleITK", ".dcm": "SimpleITK",
    ".vti": "pyvista", ".vtk": "pyvista", ".tif": "tifffile", ".h5": "h5py",
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(FILES))
def test_a_file_that_is_no_volume_gets_a_sentence(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if path.suffix in NEEDS:
        pytest.importorskip(NEEDS[path.suffix])
    path.write_bytes(FILES[name])
    with pytest.raises(VolumeError) as told:
        read(path)
    said = str(told.value)
    assert name in said
    assert "\n" not in said
    assert len(said) < 600


@pytest.mark.parametrize("name", ["huge.npy", "truncated.nii.gz", "negative.nrrd", "bomb.npz"])
def test_the_command_says_it_with_status_2(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(FILES[name])
    for command in (["frequencies"], ["extract", "--out", str(tmp_path / "mesh.npz")]):
        asked = [command[0], str(tmp_path / name), "0.5", *command[1:]]
        found = CliRunner().invoke(app, asked if command[0] == "extract" else asked[:3])
        assert found.exit_code == 2, found.output


def test_a_header_that_asks_for_more_than_is_free_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """8 TB in a header, and an archive that unfolds to more than there is."""
    (tmp_path / "huge.npy").write_bytes(FILES["huge.npy"])
    with pytest.raises(VolumeError, match=r"more memory than the .* GB that are free"):
        read(tmp_path / "huge.npy")
    large = gzip.compress(nii(300, 300, 300, data=bytes(4 * 300**3)))
    (tmp_path / "bomb.nii.gz").write_bytes(large)
    assert len(large) < 200_000
    monkeypatch.setattr(guard, "free", lambda: 1 << 24)
    with pytest.raises(VolumeError, match="unfolds to more than"):
        read(tmp_path / "bomb.nii.gz")


def test_memory_is_given_back() -> None:
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_AS)
    with guard.within_memory():
        assert resource.getrlimit(resource.RLIMIT_AS) != before
    assert resource.getrlimit(resource.RLIMIT_AS) == before


@pytest.mark.parametrize(
    "metadata",
    [
        {"shape": [20_000] * 3, "chunks": [64] * 3},
        {"shape": [-5, 6, 7]},
        {"shape": [0, 6, 7]},
        {"dtype": "no"},
    ],
)
def test_a_zarr_that_is_no_volume_gets_a_sentence(
    metadata: dict[str, object], tmp_path: Path
) -> None:
    pytest.importorskip("zarr")
    said = {
        "zarr_format": 2, "shape": [5, 6, 7], "chunks": [5, 6, 7], "dtype": "<f4",
        "compressor": None, "fill_value": 0, "order": "C", "filters": None, **metadata,
    }  # fmt: skip
    folder = tmp_path / "v.zarr"
    folder.mkdir()
    (folder / ".zarray").write_text(json.dumps(said))
    with pytest.raises(VolumeError):
        read(folder)


SEEDS = {
    ".npy": npy((5, 6, 7), "<f4", GOOD.tobytes()),
    ".npz": npz(values=GOOD),
    ".nii": nii(5, 6, 7),
    ".nii.gz": gzip.compress(nii(5, 6, 7)),
    ".nrrd": nrrd("5 6 7"),
}


@pytest.mark.parametrize("ending", sorted(SEEDS))
@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    cut=st.integers(0, 2000),
    changes=st.lists(st.tuples(st.integers(0, 1200), st.integers(0, 255)), max_size=4),
    extra=st.binary(max_size=20),
)
def test_a_damaged_file_is_read_or_refused(
    ending: str,
    cut: int,
    changes: list[tuple[int, int]],
    extra: bytes,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    """Fuzz: bytes changed, cut off and added; nothing but a volume or a sentence comes of it."""
    if ending not in (".npy", ".npz"):
        pytest.importorskip("nibabel" if "nii" in ending else "nrrd")
    data = bytearray(SEEDS[ending])
    for place, byte in changes:
        data[place % len(data)] = byte
    path = tmp_path_factory.mktemp("fuzz") / f"x{ending}"
    path.write_bytes(bytes(data[: len(data) - cut % len(data)] if cut % 3 else data) + extra)
    try:
        found = read(path)
    except VolumeError as error:
        told = str(error)
        found = None
    else:
        told = ""
    assert (found is None) == bool(told)
    assert "\n" not in told


def test_the_gzip_of_a_scan_is_checked_to_its_end(tmp_path: Path) -> None:
    """Readers stop at the last sample; a bit that flipped on the way is seen by the checksum."""
    whole = gzip.compress(nii(5, 6, 7))
    (tmp_path / "a.nii.gz").write_bytes(whole)
    assert guard.check_gzip(tmp_path / "a.nii.gz") == ""
    (tmp_path / "a.nii.gz").write_bytes(whole[:-8] + struct.pack("<I", 1) + whole[-4:])
    assert "damaged" in guard.check_gzip(tmp_path / "a.nii.gz")
