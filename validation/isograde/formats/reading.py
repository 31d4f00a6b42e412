"""Volumes read from files, with their place and directions in space.

A file of a scan says more than numbers: how far apart the samples are, where the first one stands,
and along which direction of the patient, or of the microscope's stage, each axis of the array
runs. All of it is one affine map, and it is kept as it stands: oblique, mirrored or sheared.

Glossary
--------
space     what the three coordinates count. RAS: to the patient's right, to the front (anterior),
          up to the head (superior), as NIfTI has it; LPS: left, posterior, superior, as DICOM and
          ITK have it. Empty where the file says nothing
dataset   the name of one array in a file of several: an HDF5 dataset, an array of a Zarr group or
          of an .npz, a point array of a VTK image, a DICOM series

Axes of the array are those that its library gives: x first from nibabel and pynrrd, x last from all
others. Directions make up for it: positions are always (x, y, z).
"""

from __future__ import annotations

import re
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Field, FieldError, Floats
from numpy.typing import NDArray

from isograde.formats.guard import (
    check_gzip,
    check_meta_image,
    check_vtk_image,
    free,
    in_words,
    within_memory,
)

#: What a library's spelling of a space is here; LAS is turned into RAS.
SPACES = {
    "left-posterior-superior": "LPS",
    "right-anterior-superior": "RAS",
    "left-anterior-superior": "LAS",
    "lps": "LPS",
    "ras": "RAS",
    "las": "LAS",
}
# The columns of an affine for (x, y, z), in the order of an array that counts x last.
LAST_IS_X = [2, 1, 0, 3]


class VolumeError(RuntimeError):
    """A volume cannot be read; the message says why and what to do."""


@dataclass(frozen=True)
class Asked:
    """What a user says of a file beside its name.

    dataset : the name of one array of several, or None
    shape : of a raw file, (NX, NY, NZ) with x fastest
    dtype : of a raw file, as NumPy spells it
    spacing : in place of the file's, along x, y, z
    absent : samples that are not finite are let in, for `isoref.attributes.filled`
    stays : the samples stay in the file, to be read by planes (`isoref.fast.slabs`)
    series : of several volumes in a row all are wanted, as (T, N1, N2, N3)
    """

    dataset: str | None = None
    shape: tuple[int, int, int] | None = None
    dtype: str | None = None
    spacing: tuple[float, float, float] | None = None
    absent: bool = False
    stays: bool = False
    series: bool = False


@dataclass(frozen=True, eq=False)
class Stored:
    """A volume as a file has it.

    values : (N1, N2, N3) samples, in the order of the library's axes; or what they are read from;
        of a series (T, N1, N2, N3)
    affine : (4, 4) from (index, 1) to (position, 1)
    space : "RAS", "LPS", or "" where the file does not say
    unit : of positions, or "" where the file does not say
    notes : what a user should know of how it was read
    """

    values: NDArray[Any]
    affine: Floats
    space: str = ""
    unit: str = ""
    notes: tuple[str, ...] = ()

    @cached_property
    def field(self) -> Field:
        """The field of it; a FieldError where samples are no finite real numbers."""
        return Field.of_affine(self.values, self.affine)

    def in_space(self, space: str) -> Stored:
        """The same field with positions in the other of RAS and LPS: x and y are negated.

        Raises
        ------
        VolumeError
            where the file does not say which of them it is in.
        """
        if space == self.space:
            return self
        if not self.space:
            raise VolumeError(f"the file names no coordinate system, so {space} cannot be made")
        turned = np.diag([-1.0, -1, 1, 1]) @ self.affine
        return replace(self, affine=turned, space=space)


def read(path: Path, asked: Asked | None = None) -> Stored:
    """The scalar field in a file, or in a folder of DICOM slices or of Zarr, by its ending.

    Of several volumes in a row (time, echoes) the first is taken, and a note says so; or all are,
    where a series is asked for, which may be of one.

    Raises
    ------
    VolumeError
        for a missing file, an unknown ending, a missing library, a file that is no volume, or one
        that holds several and nothing says which.
    """
    asked = asked or Asked()
    reader = _reader_of(path, asked)
    try:
        if told := _unsafe(path):
            raise FieldError(told)
        with within_memory():
            stored = _as_asked(reader(path, asked), asked)
        if asked.spacing is not None:
            stored = replace(stored, affine=_respaced(stored.affine, asked.spacing))
        if not (asked.absent or asked.stays or asked.series):
            _ = stored.field
    except VolumeError:
        raise
    except MemoryError as error:
        wanted = f" ({_in_one_line(error)})" if str(error) else ""
        told = f"it needs more memory than the {in_words(free())} that are free{wanted}"
        raise VolumeError(f"{path} cannot be read: {told}") from error
    except Exception as error:
        said = _in_one_line(error)
        hint = " (--absent leaves them out)" if said.endswith("that are not finite") else ""
        if other := other_format(path):
            said = f"it begins as {other} does: rename it"
        raise VolumeError(f"{path} cannot be read: {said}{hint}") from error
    return stored


def _as_asked(stored: Stored, asked: Asked) -> Stored:
    """The volume, or the series; else a FieldError."""
    shape = stored.values.shape
    if not asked.series and len(shape) != 3:
        raise FieldError(f"an array of shape {shape} is no volume, which has three axes")
    if asked.series and len(shape) == 3:
        return replace(stored, values=stored.values[None])
    if asked.series and len(shape) != 4:
        raise FieldError(f"an array of shape {shape} is no series of volumes, which has four axes")
    return stored


# How files of a format begin, at which byte, and the endings they have.
BEGINNINGS = (
    (0, b"\x93NUMPY", "a .npy file", (".npy",)),
    (0, b"PK\x03\x04", "an .npz file", (".npz",)),
    (0, b"NRRD", "an .nrrd file", (".nrrd", ".nhdr")),
    (344, b"n+1\0", "a .nii file", (".nii",)),
    (344, b"n+2\0", "a .nii file", (".nii",)),
    (4, b"n+2\0", "a .nii file", (".nii",)),
    (0, b"\x1f\x8b", "a compressed file, .nii.gz or .mgz,", (".nii.gz", ".mgz")),
    (0, b"\x89HDF\r\n\x1a\n", "an HDF5 file (.h5)", (".h5", ".hdf5")),
    (0, b"II*\0", "a .tif file", (".tif", ".tiff")),
    (0, b"MM\0*", "a .tif file", (".tif", ".tiff")),
    (0, b"ObjectType", "a MetaImage (.mha, .mhd)", (".mha", ".mhd")),
    (0, b"# vtk DataFile", "a .vtk file", (".vtk",)),
    (0, b"<VTKFile", "a .vti file", (".vti",)),
    (128, b"DICM", "a DICOM file (.dcm)", (".dcm",)),
)


def other_format(path: Path) -> str:
    """The format that a file's first bytes are of, where its name says another; else nothing."""
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        first = file.read(512)
    known = (
        (told, endings) for at, word, told, endings in BEGINNINGS if first[at:].startswith(word)
    )
    told, endings = next(known, ("", ()))
    return "" if ending_of(path) in endings else told


def _unsafe(path: Path) -> str:
    """Why a file is not even given to its reader, or nothing."""
    if path.is_dir():
        return ""
    if ending_of(path) in (".nii.gz", ".mgz"):
        return check_gzip(path)
    if ending_of(path) in (".mha", ".mhd"):
        return check_meta_image(path)
    return check_vtk_image(path) if ending_of(path) == ".vti" else ""


def _reader_of(path: Path, asked: Asked) -> Reader:
    """What reads this file or folder."""
    ending = ending_of(path)
    if path.is_dir() and ending != ".zarr" and not asked.stays:
        return _dicom_series
    if not path.exists():
        raise VolumeError(f"{path} is not a file")
    if asked.stays and ending not in STAYS:
        raise VolumeError(f"{path.name} cannot be read by planes; {', '.join(STAYS)} can")
    if ending not in READERS:
        other = other_format(path)
        raise VolumeError(
            f"{path.name} ends in none of {', '.join(sorted(READERS))}, and is no folder of DICOM"
            + f"; it begins as {other} does: rename it" * bool(other)
        )
    return READERS[ending]


def ending_of(path: Path) -> str:
    """The ending of a file's name in small letters, with what is before ``.gz``.

    >>> ending_of(Path("scan.v2.nii.GZ")), ending_of(Path("a.b.vti"))
    ('.nii.gz', '.vti')
    """
    suffixes = [suffix.lower() for suffix in path.suffixes]
    return "".join(suffixes[-2:] if suffixes[-1:] == [".gz"] else suffixes[-1:])


def library(name: str, extra: str = "volumes") -> Any:
    """The module of this name, or an error that names the extra to install."""
    try:
        return import_module(name)
    except ImportError as error:
        advice = f'pip install "isograde[{extra}]"'
        raise VolumeError(f"{name} is needed and does not load ({error}); {advice}") from error


def _in_one_line(error: BaseException) -> str:
    """What a library's exception says, without its lines of context."""
    if isinstance(error, KeyError):
        return f"it has no {error}"
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    # What ITK has to say stands behind the name and address of what says it.
    said = [re.sub(r".*ERROR: (\w+\(0x\w+\): )?", "", line) for line in lines if "ERROR: " in line]
    return next(iter([*said, *lines[-1:]]), type(error).__name__)


def native(values: Any) -> NDArray[Any]:
    """The samples in this machine's byte order."""
    samples = np.asarray(values)
    return samples.astype(samples.dtype.newbyteorder("="), copy=False)


def _stored(
    values: Any,
    affine: Floats,
    space: str = "",
    unit: str = "",
    notes: tuple[str, ...] = (),
    *,
    stays: bool = False,
) -> Stored:
    """The volume of these samples, in this machine's byte order.

    Those that stay in their file are left as they are.
    """
    samples = values if stays else native(values)
    return Stored(samples, np.asarray(affine, np.float64), space, unit, notes)


def _counting_x_first(spacing: Sequence[float] | None, origin: Sequence[float] | None) -> Floats:
    """The affine of an array (x, y, z)."""
    steps = np.broadcast_to(1.0 if spacing is None else spacing, 3)
    if not (steps > 0).all():
        raise FieldError(f"spacing {steps.tolist()} must be positive on every axis")
    affine = np.diag([*steps, 1.0])
    affine[:3, 3] = 0.0 if origin is None else origin
    return affine


def _counting_x_last(spacing: Sequence[float] = (1.0, 1.0, 1.0)) -> Floats:
    """The affine of an array (z, y, x), with spacing along x, y, z."""
    return _counting_x_first(spacing, None)[:, LAST_IS_X]


def _respaced(affine: Floats, spacing: tuple[float, float, float]) -> Floats:
    """Other spacings along x, y, z, each given to the axis of the array that runs along it."""
    steps = np.linalg.norm(affine[:3, :3], axis=0)
    order = np.abs(affine[:3, :3] / steps).argmax(axis=0)
    if sorted(order.tolist()) != [0, 1, 2]:
        raise FieldError("axes run askew, so that no spacing along x, y, z can be given to them")
    respaced = affine.copy()
    respaced[:3, :3] *= np.array(spacing)[order] / steps
    return respaced


def _one_of(names: Sequence[str], asked: str | None, what: str, option: str = "--dataset") -> str:
    """The name that was asked for, or the only one there is."""
    if asked is not None:
        if asked not in names:
            listed = ", ".join(names) or "none"
            raise FieldError(f"there is no {what} {asked!r}; there are {listed}")
        return asked
    if not names:
        raise FieldError(f"it holds no {what}")
    if len(names) > 1:
        listed = ", ".join(names)
        raise FieldError(f"it takes one {what}, and there are {listed}; name one with {option}")
    return names[0]


def _volumes(values: Any, along: Sequence[int], asked: Asked) -> tuple[Any, tuple[str, ...]]:
    """The first entry along these axes, and a note where that leaves something out.

    Of a series all entries, one after the other along a first axis.
    """
    if asked.series:
        first = np.moveaxis(np.asarray(values), along, range(len(along)))
        return first.reshape(-1, *first.shape[len(along) :]), ()
    index: list[Any] = [slice(None)] * values.ndim
    for axis in along:
        index[axis] = 0
    volumes = int(np.prod([values.shape[axis] for axis in along], dtype=np.int64))
    notes = (f"the first of {volumes} volumes or channels is taken",) if volumes > 1 else ()
    return values[tuple(index)], notes


def _volume_of(values: Any, along: Sequence[int], asked: Asked) -> tuple[Any, tuple[str, ...]]:
    """As `_volumes`; the whole, unread, where the samples stay in the file."""
    if not asked.stays:
        return _volumes(values, along, asked)
    if len(along):
        raise FieldError(f"an array of shape {values.shape} is read by planes only with three axes")
    return values, ()


# --- NumPy ---------------------------------------------------------------------------------------


def _npy(path: Path, asked: Asked) -> Stored:
    """A NumPy array; its axes are x, y, z."""
    apart = asked.stays or asked.series
    values = np.load(path, mmap_mode="r" if apart else None, allow_pickle=False)
    return _stored(values, np.eye(4), stays=asked.stays)


def _npz(path: Path, asked: Asked) -> Stored:
    """The array `values` of a NumPy archive, with `spacing`, `origin`, `directions` or `affine`."""
    # NumPy leaves its file open where the archive is broken; ours is closed.
    with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        name = asked.dataset or "values"
        if name not in archive:
            raise FieldError(f"it holds {sorted(archive)}, and no array named {name}")
        if "affine" in archive:
            return _stored(archive[name], archive["affine"])
        affine = _counting_x_first(archive.get("spacing"), archive.get("origin"))
        if "directions" in archive:
            affine[:3, :3] = np.asarray(archive["directions"]).T @ affine[:3, :3]
        return _stored(archive[name], affine)


def _raw(path: Path, asked: Asked) -> Stored:
    """Bare samples, x fastest, of a shape and type that the user says."""
    if asked.shape is None or asked.dtype is None:
        raise VolumeError(
            f"{path.name} says neither its shape nor its type: "
            "give both, as --shape 256,256,128 --type uint8 (x fastest)"
        )
    dtype = np.dtype(asked.dtype)
    expected, found = int(np.prod(asked.shape)) * dtype.itemsize, path.stat().st_size
    if expected != found:
        shape = " x ".join(map(str, asked.shape))
        raise FieldError(
            f"it holds {found // dtype.itemsize} samples ({found:,} bytes), where {shape} of type "
            f"{dtype} are {expected:,} bytes"
        )
    if asked.stays:
        values: NDArray[Any] = np.memmap(path, dtype, "r", shape=asked.shape[::-1])
    else:
        values = np.fromfile(path, dtype).reshape(asked.shape[::-1])
    return _stored(values, _counting_x_last(), stays=asked.stays)


# --- Scans ---------------------------------------------------------------------------------------


def _nifti(path: Path, asked: Asked) -> Stored:
    """A NIfTI or MGH file, as stored (scaling applied only where the header scales)."""
    nibabel = library("nibabel")
    image: Any = nibabel.load(path)
    data = image.dataobj
    scales = hasattr(data, "get_unscaled")
    scaled = not scales or (data.slope, data.inter) != (1.0, 0.0)
    values = np.asarray(data) if scaled else data.get_unscaled()
    values, notes = _volumes(values, range(3, values.ndim), asked)
    unit = (
        str(image.header.get_xyzt_units()[0]) if hasattr(image.header, "get_xyzt_units") else "mm"
    )
    unit = "" if unit == "unknown" else unit

    # Without a code the header gives steps and no place.
    if "qform_code" in image.header and not (
        int(image.header["qform_code"]) or int(image.header["sform_code"])
    ):
        zooms = [float(zoom) for zoom in image.header.get_zooms()[:3]]
        return _stored(values, _counting_x_first(zooms, None), "", unit, notes)
    return _stored(values, image.affine, "RAS", unit, notes)


def _nrrd(path: Path, asked: Asked) -> Stored:
    """An NRRD file: a direction for each axis that has one, else spacings."""
    nrrd = library("nrrd")
    header = nrrd.read_header(str(path))
    for name in {"data file", "datafile"} & header.keys():
        header[name] = _data_file(path)  # pynrrd leaves out what is not ASCII.
    with path.open("rb") as file:
        nrrd.read_header(file)
        values = nrrd.read_data(header, file, str(path))
    rows, spacings = header.get("space directions"), header.get("spacings")
    notes: tuple[str, ...] = ()
    if rows is None:
        if values.ndim > 3:
            kinds = header.get("kinds") or ["domain"] * values.ndim
            others = [a for a, kind in enumerate(kinds) if kind not in ("domain", "space")]
            others = others or list(range(3, values.ndim))
            values, notes = _volumes(values, others, asked)
            if spacings is not None:
                spacings = np.delete(spacings, others)
        return _stored(values, _counting_x_first(spacings, None), notes=notes)

    # Axes without a direction count components or volumes.
    vectors = np.array([[np.nan] * 3 if row is None else row for row in rows], np.float64)
    placed = np.isfinite(vectors).all(axis=1)
    values, notes = _volumes(values, np.flatnonzero(~placed).tolist(), asked)
    affine = np.eye(4)
    affine[:3, :3] = vectors[placed].T
    affine[:3, 3] = header.get("space origin", np.zeros(3))
    space = SPACES.get(str(header.get("space", "")).lower().removesuffix("-time"), "")
    if space == "LAS":
        affine, space = np.diag([-1.0, 1, 1, 1]) @ affine, "RAS"
    unit = str((header.get("space units") or [""])[0])
    return _stored(values, affine, space, unit, notes)


def _data_file(path: Path) -> str:
    """The file that a detached NRRD header names."""
    lines = path.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    names = (re.fullmatch(r"data ?file: *(.*?) *", line, re.I) for line in lines)
    return next(found[1] for found in names if found is not None)


def _itk(path: Path, asked: Asked) -> Stored:
    """What SimpleITK reads from one file."""
    itk = _itk_library()
    return _from_itk(itk, itk.ReadImage(str(path)), asked)


def _itk_library() -> Any:
    """SimpleITK, told not to print what it also raises."""
    itk = library("SimpleITK")
    itk.ProcessObject.SetGlobalWarningDisplay(False)
    return itk


def _from_itk(itk: Any, image: Any, asked: Asked, affine: Floats | None = None) -> Stored:
    """An image of SimpleITK; an affine in (x, y, z) where it is known better than by ITK."""
    if image.GetNumberOfComponentsPerPixel() != 1:
        count = image.GetNumberOfComponentsPerPixel()
        raise FieldError(f"a voxel has {count} numbers, and an isosurface needs one")
    n = image.GetDimension()
    if n < 3:
        raise FieldError(f"an image of {n} dimensions is no volume")
    values, notes = _volumes(itk.GetArrayFromImage(image), range(n - 3), asked)
    if affine is None:
        affine = np.eye(4)
        directions = np.array(image.GetDirection()).reshape(n, n)[:3, :3]
        affine[:3, :3] = directions * np.array(image.GetSpacing())[:3]
        affine[:3, 3] = image.GetOrigin()[:3]
    return _stored(values, affine[:, LAST_IS_X], "LPS", "mm", notes)


def _dicom_series(folder: Path, asked: Asked) -> Stored:
    """The slices of a DICOM series in a folder, each where its header puts it.

    The step from slice to slice is taken from the slices' positions: a tilted gantry makes it
    oblique to them, which an image of ITK cannot say.
    """
    itk = _itk_library()
    series = list(itk.ImageSeriesReader.GetGDCMSeriesIDs(str(folder)))
    if not series:
        raise VolumeError(f"{folder} is a folder in which there is no DICOM series")
    chosen = _one_of(series, asked.dataset, "DICOM series")
    reader = itk.ImageSeriesReader()
    reader.SetFileNames(itk.ImageSeriesReader.GetGDCMSeriesFileNames(str(folder), chosen))
    reader.MetaDataDictionaryArrayUpdateOn()
    image = reader.Execute()
    slices = image.GetSize()[2]
    if slices < 2 or not all(reader.HasMetaDataKey(k, "0020|0032") for k in range(slices)):
        return _from_itk(itk, image, asked)

    # Ask that slices stand at equal steps.
    tags = [reader.GetMetaData(k, "0020|0032") for k in range(slices)]
    places = np.array([[float(x) for x in tag.split("\\")] for tag in tags])
    step = (places[-1] - places[0]) / (slices - 1)
    gaps = np.linalg.norm(np.diff(places, axis=0) - step, axis=1)
    apart = np.linalg.norm(np.diff(places[np.lexsort(places.T)], axis=0), axis=1)
    if not apart.all():
        raise VolumeError(
            f"slices of {folder} stand at one place: there are copies, or the series holds several "
            "volumes"
        )
    if gaps.max() > 0.01 * np.linalg.norm(step):
        k = int(gaps.argmax())
        raise VolumeError(
            f"slices {k} and {k + 1} of {folder} are not as far apart as the others: one is "
            "missing, or the series holds several volumes"
        )
    affine = np.eye(4)
    plane = np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())
    affine[:3, :3] = np.column_stack([plane[:, :2], step])
    affine[:3, 3] = places[0]
    return _from_itk(itk, image, asked, affine)


def _vtk(path: Path, asked: Asked) -> Stored:
    """A scalar point array of a VTK image."""
    pyvista = library("pyvista")
    library("vtk").vtkObject.GlobalWarningDisplayOff()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        grid: Any = pyvista.read(path)
    if not hasattr(grid, "direction_matrix"):
        raise FieldError(f"it holds a {type(grid).__name__} and no image")
    names = [name for name in grid.point_data if grid.point_data[name].ndim == 1]
    if not names:
        raise FieldError("it holds no image with a scalar at each point")
    name = names[0] if asked.dataset is None else _one_of(names, asked.dataset, "point array")
    values = np.asarray(grid.point_data[name]).reshape(grid.dimensions[::-1])
    affine = np.eye(4)
    affine[:3, :3] = np.asarray(grid.direction_matrix) * np.array(grid.spacing)
    first = list(grid.extent[::2])
    affine[:3, 3] = np.array(grid.origin) + affine[:3, :3] @ first
    notes = (f"the first of {len(names)} arrays, {name}, is taken",) if len(names) > 1 else ()
    return _stored(values, affine[:, LAST_IS_X], notes=() if asked.dataset else notes)


# --- Microscopes ---------------------------------------------------------------------------------


def _tiff(path: Path, asked: Asked) -> Stored:
    """A stack of TIFF pages, with the size of a voxel where ImageJ or OME wrote it."""
    tifffile = library("tifffile")
    with tifffile.TiffFile(path) as file:
        series = file.series[0]
        values, axes = series.asarray(), series.axes
        spacing, unit = _size_of_voxel(file)
    if values.ndim > 3:
        others = [a for a, name in enumerate(axes) if name not in "ZYXQI"]
        values, notes = _volumes(values, others[: values.ndim - 3], asked)
    else:
        notes = ()
    return _stored(values, _counting_x_last(spacing), "", unit, notes)


def _size_of_voxel(file: Any) -> tuple[list[float], str]:
    """The size of a voxel along x, y, z, and its unit; 1 where the file does not say."""
    if file.ome_metadata:
        pixels = ET.fromstring(file.ome_metadata).find(".//{*}Pixels")
        given: Mapping[str, str] = {} if pixels is None else pixels.attrib
        sizes = [float(given.get(f"PhysicalSize{axis}", 1)) for axis in "XYZ"]
        return sizes, given.get("PhysicalSizeXUnit", "µm" if "PhysicalSizeX" in given else "")
    # ImageJ writes a resolution everywhere, and the step from page to page where it was calibrated.
    if file.imagej_metadata and "spacing" in file.imagej_metadata:
        tags = file.pages[0].tags
        sizes = []
        for name in ("XResolution", "YResolution"):
            count, length = tags[name].value if name in tags else (1, 1)
            sizes.append(length / count if count else 1.0)
        given = file.imagej_metadata
        return [*sizes, float(given["spacing"])], str(given.get("unit", ""))
    return [1.0, 1.0, 1.0], ""


def _hdf5(path: Path, asked: Asked) -> Stored:
    """A dataset of an HDF5 file, with ImageJ's and ilastik's `element_size_um` where it has it."""
    h5py = library("h5py")
    with ExitStack() as stack:
        # A file whose samples stay in it stays open as long as they are used.
        file = h5py.File(path, "r")
        if not asked.stays:
            stack.enter_context(file)
        found: list[str] = []

        def note(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.ndim >= 3:
                found.append(name)

        file.visititems(note)
        name = _one_of(found, asked.dataset and asked.dataset.strip("/"), "dataset of three axes")
        data = file[name]
        values, notes = _volume_of(data, range(data.ndim - 3), asked)
        size = data.attrs.get("element_size_um")
    if size is None:
        return _stored(values, _counting_x_last(), notes=notes, stays=asked.stays)
    steps = [float(s) for s in np.ravel(size)][::-1]
    return _stored(values, _counting_x_last(steps), "", "µm", notes, stays=asked.stays)


def _zarr(path: Path, asked: Asked) -> Stored:
    """An array of Zarr, or a level of an OME-Zarr image with its scale and translation."""
    zarr = library("zarr")
    root = zarr.open(str(path), mode="r")
    if not hasattr(root, "attrs") or hasattr(root, "shape"):
        values, notes = _volume_of(root, range(root.ndim - 3), asked)
        return _stored(values, _counting_x_last(), notes=notes, stays=asked.stays)
    metadata = dict(root.attrs)
    scales = metadata.get("ome", metadata).get("multiscales")
    if not scales:
        names = [name for name, array in root.arrays() if array.ndim >= 3]
        name = _one_of(names, asked.dataset, "array of three axes")
        values, notes = _volume_of(root[name], range(root[name].ndim - 3), asked)
        return _stored(values, _counting_x_last(), notes=notes, stays=asked.stays)
    return _ome(root, scales[0], asked)


def _ome(root: Any, image: Mapping[str, Any], asked: Asked) -> Stored:
    """A level of an OME-Zarr image, the finest unless another is named."""
    levels = {str(level["path"]): level for level in image["datasets"]}
    name = _one_of(list(levels), asked.dataset, "level") if asked.dataset else next(iter(levels))
    data = root[name]
    axes = [axis if isinstance(axis, Mapping) else {"name": axis} for axis in image["axes"]]
    names = [str(axis["name"]).lower() for axis in axes]
    spatial = [a for a, one in enumerate(names) if one in "xyz"]
    if len(spatial) != 3:
        raise FieldError(f"its axes are {', '.join(names)}, where x, y and z make a volume")

    # Apply the level's transformations, then those of all levels.
    scale, shift = np.ones(data.ndim), np.zeros(data.ndim)
    for step in [
        *levels[name].get("coordinateTransformations", ()),
        *image.get("coordinateTransformations", ()),
    ]:
        if step["type"] not in ("scale", "translation", "identity"):
            raise FieldError(f"its transformation {step['type']!r} is none of scale, translation")
        if step["type"] == "scale":
            scale, shift = scale * step["scale"], shift * step["scale"]
        elif step["type"] == "translation":
            shift = shift + step["translation"]
    values, notes = _volume_of(data, [a for a in range(data.ndim) if a not in spatial], asked)
    affine = np.eye(4)
    affine[:3] = 0.0
    for a, axis in enumerate(spatial):
        along = "xyz".index(names[axis])
        affine[along, a], affine[along, 3] = scale[axis], shift[axis]
    unit = str(axes[spatial[0]].get("unit", ""))
    return _stored(values, affine, "", unit, notes, stays=asked.stays)


Reader = Callable[[Path, Asked], Stored]

#: Files whose samples can stay where they are.
STAYS = (".npy", ".raw", ".h5", ".hdf5", ".zarr")

READERS: dict[str, Reader] = {
    ".npy": _npy,
    ".npz": _npz,
    ".raw": _raw,
    ".nrrd": _nrrd,
    ".nhdr": _nrrd,
    ".nii": _nifti,
    ".nii.gz": _nifti,
    ".mgh": _nifti,
    ".mgz": _nifti,
    ".mha": _itk,
    ".mhd": _itk,
    ".gipl": _itk,
    ".dcm": _itk,
    ".tif": _tiff,
    ".tiff": _tiff,
    ".vti": _vtk,
    ".vtk": _vtk,
    ".h5": _hdf5,
    ".hdf5": _hdf5,
    ".zarr": _zarr,
}
