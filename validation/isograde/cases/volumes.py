"""Real volumes, found on this machine and cut into cases.

Measured data are what extractors meet: integers full of ties, noise, thin walls, surfaces that run
into the border. One small MRI comes with nibabel and is always there; others are used where they
are found, and a run never downloads anything.

Glossary
--------
volume    an entry of `REGISTRY`: what it is, where it is published, under which licence
present   its file lies in the folder that the environment variable ISOGRADE_DATA names, in the
          download cache, or in an installed package
crop      a block from the middle, small enough for the default run

Axes are those of the array as its library gives it: x first for NIfTI and NRRD, and (z, y, x) for
raw, TIFF and VTK files. A checksum is stated only where the file was at hand to compute it; None
means that nobody here has seen the bytes.
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from isoref.field import Field

from isograde import places
from isograde.formats import reading
from isograde.formats.reading import Asked, Stored, VolumeError, library
from isograde.model import Case

OPEN_SCIVIS = "https://klacansky.com/open-scivis-datasets"


@dataclass(frozen=True)
class Volume:
    """A published data set.

    name, title : how it is called here, and what it shows
    file : its file's name
    shape, dtype : of the array, in the order of its axes
    isovalues : worth a surface
    licence, source : as the source states them; where it is described
    url : direct address of the file, or None
    sha256 : of the file, or None where it was never at hand
    spacing : where the file does not say
    package : the installed package that ships it, or None
    focus : where blocks are cut, as a fraction of each axis
    """

    name: str
    title: str
    file: str
    shape: tuple[int, int, int]
    dtype: str
    isovalues: tuple[float, ...]
    licence: str
    source: str
    url: str | None = None
    sha256: str | None = None
    spacing: tuple[float, float, float] | None = None
    package: str | None = None
    focus: tuple[float, float, float] = (0.5, 0.5, 0.5)

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(np.prod(self.shape))


def find(volume: Volume) -> Path | None:
    """Where the volume's file is on this machine, or None."""
    return places.find(volume.file, volume.package)


def fetch(volume: Volume) -> Path:
    """The file of a volume, downloaded from its public address where it is not present.

    No address here has been tried, and none has a checksum that was computed from its file: a
    warning says so, with the checksum of what came. What comes is refused where its size is not
    that of the samples.

    Raises
    ------
    VolumeError
        where it has no address, pooch is not installed, the download fails, or what came is not
        as large as the volume.
    """
    place = find(volume)
    if place is not None:
        return place
    if volume.url is None:
        raise VolumeError(f"{volume.name} has no direct address; get it from {volume.source}")
    pooch = library("pooch", "data")
    known = f"sha256:{volume.sha256}" if volume.sha256 else None
    try:
        got = Path(pooch.retrieve(volume.url, known, fname=volume.file, path=places.cache_folder()))
    except (OSError, ValueError) as error:
        raise VolumeError(
            f"{volume.url} could not be downloaded ({type(error).__name__}). Without a network, "
            f"get the file elsewhere (see {volume.source}) and put it, as {volume.file}, into "
            f"{places.cache_folder()} or into the folder that ISOGRADE_DATA names"
        ) from error
    _check_size(volume, got)
    if known is None:
        print(unverified(volume, got), file=sys.stderr)
    return got


def _check_size(volume: Volume, path: Path) -> None:
    """Nothing, where a raw file has the bytes of its samples; else it is gone, and an error."""
    expected, found = volume.samples * np.dtype(volume.dtype).itemsize, path.stat().st_size
    if path.suffix == ".raw" and found != expected:
        path.unlink()
        raise VolumeError(
            f"{volume.url} gave {found:,} bytes, where {volume.name} has {expected:,}: it was not "
            "kept. Perhaps the address has changed"
        )


def unverified(volume: Volume, path: Path) -> str:
    """What is to be known of a download that nothing vouches for."""
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return (
        f"{volume.name} is unverified: nobody here has seen the file, so there is no checksum to "
        f"compare with. What came has sha256 {digest}, and is kept as {path}"
    )


def read(path: Path, *, volume: Volume | None = None) -> Field:
    """The scalar field in a file (`isograde.formats.reading`), on a straight lattice.

    Papers and grades look at samples and their distances, and not at where a patient lay: axes are
    those of the array, as its library gives it. A .raw needs a registered `volume`.

    Raises
    ------
    VolumeError
        for a missing file, an unknown ending, a missing library, or a file that is no volume.
    """
    field = stored(path, volume=volume).field.straight()
    if volume is not None and volume.spacing is not None:
        return Field.of(field.values, volume.spacing)
    if path.name.endswith((".nii", ".nii.gz")):
        # Cases are frozen, and began with the steps of the header, which the affine rounds.
        steps = library("nibabel").load(path).header.get_zooms()[:3]
        return Field.of(field.values, [float(step) for step in steps])
    return field


def stored(path: Path, *, volume: Volume | None = None, asked: Asked | None = None) -> Stored:
    """The field in a file where it stands; what the registry knows of it need not be asked."""
    if volume is not None and path.suffix == ".raw":
        nz, ny, nx = volume.shape
        asked = replace(asked or Asked(), shape=(nx, ny, nz), dtype=volume.dtype)
    return reading.read(path, asked)


@lru_cache(maxsize=2)
def load(name: str) -> Field:
    """The field of a registered volume that is present."""
    volume = REGISTRY[name]
    path = find(volume)
    if path is None:
        raise VolumeError(f"{name} is not on this machine; see {volume.source}")
    return read(path, volume=volume)


def block(name: str, sides: tuple[int, int, int]) -> Field:
    """A block of at most this many samples a side round the focus of a volume."""
    whole, focus = load(name), REGISTRY[name].focus
    cut = tuple(
        slice(start := min(max(int(n * share) - side // 2, 0), max(n - side, 0)), start + side)
        for n, share, side in zip(whole.shape, focus, sides, strict=True)
    )
    return Field.of(np.ascontiguousarray(whole.values[cut]), whole.spacing)


SMALL, LARGE = 32, 128
# Read a volume of more samples than this only where ``--full`` allows the time.
QUICK = 20_000_000


def cases(seed: int = 0) -> list[Case]:
    """A small and a large ("full") block of every present volume at each of its isovalues."""
    del seed
    present = [volume for volume in REGISTRY.values() if find(volume) is not None]
    return [case for volume in present for case in cases_of(volume)]


def cases_of(volume: Volume) -> list[Case]:
    """The cases of one volume, whether or not it is present."""
    return [
        _case(volume, isovalue, side) for side in (SMALL, LARGE) for isovalue in volume.isovalues
    ]


def _case(volume: Volume, isovalue: float, side: int) -> Case:
    """The case of one volume, isovalue and largest side of a block."""
    cut = [min(side, n) for n in volume.shape]
    name = f"real/{volume.name}-{isovalue:g}-{'x'.join(map(str, cut))}"
    full = side > SMALL or volume.samples > QUICK
    tags = frozenset({"real", "full"} if full else {"real"})
    build = partial(block, volume.name, (side, side, side))
    return Case(name, build, (isovalue,), int(np.prod(cut)), tags)


def _scivis(
    name: str, title: str, xyz: tuple[int, int, int], dtype: str, isovalue: float
) -> Volume:
    """An entry of the Open Scientific Visualization Datasets; dims are given x, y, z."""
    file = f"{name}_{xyz[0]}x{xyz[1]}x{xyz[2]}_{dtype}.raw"
    address = f"{OPEN_SCIVIS}/{name}/{file}"
    shape = (xyz[2], xyz[1], xyz[0])
    return Volume(name, title, file, shape, dtype, (isovalue,), "none stated", OPEN_SCIVIS, address)


_NIBABEL = "https://nipy.org/nibabel"
_VTK_DATA = "https://github.com/pyvista/vtk-data"

_ENTRIES = [
    Volume(
        "nibabel-anatomical", "MRI T1 of a head, downsampled; shipped with nibabel",
        "anatomical.nii", (33, 41, 25), "int16", (5000.5, 9000.0), "MIT", _NIBABEL,
        package="nibabel",
    ),
    Volume(
        "nibabel-example4d", "MRI, first of two volumes; shipped with nibabel",
        "example4d.nii.gz", (128, 96, 24), "int16", (250.0,), "MIT", _NIBABEL,
        package="nibabel",
    ),
    Volume(
        "bunny", "Stanford terra-cotta bunny, CT", "bunny_ct.npz", (361, 512, 512), "int16",
        (1807.0, 1500.0), "none stated", "https://graphics.stanford.edu/data/voldata",
        sha256="a690827663f8c857074604a65a658c0a17868cc33a1e7807a8a4223dc68d2da7",
    ),
    Volume(
        "headsq", "CT head of VTK, quarter resolution", "headsq.npz", (93, 64, 64), "uint16",
        (1150.0, 500.0), "BSD-3-Clause", _VTK_DATA,
        sha256="5dfb5d0b76122b374d767ea2a8962f4765539a4330783578edbb9bea4e5b723c",
    ),
    Volume(
        "tooth", "CT tooth, Seg3D test data", "tooth.npz", (161, 94, 103), "uint16", (640.0,),
        "MIT", "https://github.com/SCIInstitute/Seg3D",
        sha256="d8d1096f9241e8b50de6d3218ae4f63d80ef5da4f636636f538a25ba270e911a",
    ),
    Volume(
        "stroke", "MRI T1, brain with a lesion, very folded", "stroke_T1.nii.gz",
        (124, 160, 140), "uint8", (80.0,), "MIT", "none given",
        sha256="8e28e653578a2cd21d15064da5b089db16a205887c76baed8a65d01e8f2ab79e",
    ),
    Volume(
        "carotid", "MR angiography of the carotid artery", "carotid.vtk", (45, 49, 76),
        "float32", (200.0,), "BSD-3-Clause", _VTK_DATA,
        sha256="3f5dac7baa8ed60fa094f67b918d55add4d55f1d498fad587d1850915f60032d",
    ),
    Volume(
        "aneurism", "rotational angiography of an aneurysm", "aneurism.vti", (256, 256, 256),
        "uint8", (100.0,), "none stated", OPEN_SCIVIS, focus=(0.6, 0.4, 0.5),
        sha256="469de79bbc82771432de6bb8634a69749c2210b024c43abf499dfa38a9a5a9b1",
    ),
    Volume(
        "fiberform", "x-ray micro-CT of carbon-fibre insulation", "fiberform.tif",
        (100, 100, 100), "uint8", (90.0,), "NASA Open Source Agreement 1.3",
        "https://github.com/nasa/puma",
        sha256="1386f825c71272f2cac7a7dbf8c82a25387b70c379655c02a843f6150edbe861",
    ),
    _scivis("fuel", "simulated fuel injection", (64, 64, 64), "uint8", 50),
    _scivis("neghip", "electron density of a protein", (64, 64, 64), "uint8", 100),
    _scivis("nucleon", "two-body distribution of a nucleon", (41, 41, 41), "uint8", 140),
    _scivis("silicium", "silicium grid", (98, 34, 34), "uint8", 120),
    _scivis("hydrogen_atom", "electron of a hydrogen atom", (128, 128, 128), "uint8", 30),
    _scivis("engine", "CT of two cylinders of an engine block", (256, 256, 128), "uint8", 100),
    _scivis("lobster", "CT of a lobster in resin", (301, 324, 56), "uint8", 60),
    _scivis("bonsai", "CT of a bonsai tree", (256, 256, 256), "uint8", 40),
    _scivis("skull", "rotational x-ray of a skull phantom", (256, 256, 256), "uint8", 80),
    _scivis("foot", "rotational x-ray of a foot", (256, 256, 256), "uint8", 90),
]  # fmt: skip
REGISTRY: dict[str, Volume] = {volume.name: volume for volume in _ENTRIES}
