"""The verification set in its own files, and as cases of the grader.

The set is published as two archives of small files, and public programs that check themselves by it
(CGAL's tests, MCPro's) read it so::

    MarchingCubes_cases/Grids/7-scalar_field.iso                a cell of 2^3 samples
    MarchingCubes_cases/Grid_invariants/7-euler_number.txt      its Euler characteristic
    Closed_Surfaces/Grids/7-scalar_field.iso                    a grid of 5^3 samples
    Closed_Surfaces/InvariantsGrid/7-invariant_grid.txt         b0 and b1 of its surface

A field is three 32-bit integers, the samples along x, y and z; six 32-bit floats, the box from xmin
to zmax; and the samples, 32-bit floats, x fastest. All of it is little-endian, the isovalue is 0.

The verification program of Etiene and others itself is in no public repository that we know of: the
set and its invariants are what it left, and its two methods are oracles here
(`isograde.oracles.trilinear_by_refinement`, `stratified_morse`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from isograde.cases.own import Entry, add, entry_of
from isoref.field import Field
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
CELLS = ("MarchingCubes_cases", "Grid_invariants", "euler_number")
GRIDS = ("Closed_Surfaces", "InvariantsGrid", "invariant_grid")
HEADER = 3 * 4 + 6 * 4
NAME = re.compile(r"(\d+)-scalar_field\.iso")


class SetError(ValueError):
    """Files that are not those of the set; the message says which, and what is wrong."""


def read_field(path: Path) -> Floats:
    """The samples (nx, ny, nz) of a file of the set. Raises `SetError`."""
    data = path.read_bytes()
    if len(data) < HEADER:
        raise SetError(f"{path}: {len(data)} bytes, and the header alone has {HEADER}")
    shape = tuple(int(n) for n in np.frombuffer(data, "<i4", 3))
    if not all(0 < n <= 1 << 10 for n in shape) or len(data) != HEADER + 4 * int(np.prod(shape)):
        raise SetError(f"{path}: {len(data)} bytes are not those of {shape} samples")
    values = np.frombuffer(data, "<f4", offset=HEADER).astype(np.float64)
    if not np.isfinite(values).all():
        raise SetError(f"{path}: a sample is not finite")
    return np.ascontiguousarray(values.reshape(shape[::-1]).transpose())


def written(values: Floats) -> bytes:
    """The bytes of a file of the set with these samples (nx, ny, nz), one apart.

    >>> field = np.arange(24.0).reshape(2, 3, 4)
    >>> len(written(field)) == HEADER + 4 * 24
    True
    """
    box = [x for n in values.shape for x in (0.0, n - 1.0)]
    parts = np.array(values.shape, "<i4"), np.array(box, "<f4"), values.transpose().astype("<f4")
    return b"".join(part.tobytes() for part in parts)


def is_set(folder: Path) -> bool:
    """The folder holds the set in its own files."""
    return all((folder / kind[0] / "Grids").is_dir() for kind in (CELLS, GRIDS))


def read_set(folder: Path) -> tuple[Floats, Ints, Floats, Ints]:
    """The cells, their Euler characteristics, the grids, and their (b0, b1). Raises `SetError`."""
    cells, euler = _of_kind(folder, CELLS, (2,) * 3, 1)
    grids, betti = _of_kind(folder, GRIDS, (5,) * 3, 2)
    return cells, euler[:, 0], grids, betti


def _of_kind(
    folder: Path, kind: tuple[str, str, str], shape: tuple[int, ...], count: int
) -> tuple[Floats, Ints]:
    """The fields of one kind in the order of their numbers, and so many invariants of each."""
    name, beside, what = kind
    paths = {
        int(m[1]): p for p in (folder / name / "Grids").iterdir() if (m := NAME.fullmatch(p.name))
    }
    if not paths:
        raise SetError(f"{folder / name / 'Grids'} holds no file 0-scalar_field.iso")
    fields, invariants = [], []
    for number, path in sorted(paths.items()):
        field = read_field(path)
        if field.shape != shape:
            raise SetError(f"{path}: {field.shape} samples, where the set has {shape}")
        told = folder / name / beside / f"{number}-{what}.txt"
        try:
            numbers = [int(word) for word in told.read_text(encoding="utf-8").split()]
        except (OSError, ValueError) as error:
            raise SetError(f"{told}: {error}") from None
        if len(numbers) < count:
            raise SetError(f"{told}: {len(numbers)} whole numbers, and {count} are needed")
        fields.append(field)
        invariants.append(numbers[:count])
    return np.array(fields), np.array(invariants, np.int64)


def as_cases(cells: Floats, grids: Floats) -> Iterator[Entry]:
    """Each field as a case of the grader's own format, isovalue 0."""
    for kind, values in (("cell", cells), ("grid", grids)):
        for number, field in enumerate(values):
            says = f"{kind} {number} of the verification set"
            made = entry_of(Field.of(field), [0.0], "topology.trilinear", "", says)
            yield {**made, "id": f"own/custodio-{kind}-{number}"}


def write_cases(path: Path, cells: Floats, grids: Floats) -> int:
    """How many cases the file has more than before."""
    return len(add(path, as_cases(cells, grids)))
