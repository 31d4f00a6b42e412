"""What the commands on one volume do: `extract` and `frequencies`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from isoref.field import Field, FieldError
from isoref.methods import METHODS
from rich.markup import escape

from isograde.cases import volumes
from isograde.commands.console import Exit, close_to, console, say, stop
from isograde.formats.reading import Asked, Stored, VolumeError
from isograde.formats.writing import MESH_FILES, write
from isograde.frequencies import frequencies as count

Number = TypeVar("Number", int, float)


def extract(volume: str, isovalue: float, method: str, out: Path, asked: Asked, space: str) -> None:
    """The reference's surface of a volume is in the mesh file `out`, where the volume stands."""
    if method not in METHODS:
        stop(Exit.WRONG_USE, f"no method {method!r}; {close_to(method, METHODS)}")
    if out.suffix.lower() not in MESH_FILES:
        stop(Exit.WRONG_USE, f"{out} ends in none of {' '.join(MESH_FILES)}")
    try:
        stored = stored_named(volume, asked)
        if space:
            stored = stored.in_space(space)
        mesh = METHODS[method](stored.field, isovalue)
        write(mesh, out, stored.space)
    except (VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    for note in stored.notes:
        say(f"[dim]{escape(note)}[/]")
    if not len(mesh.simplices):
        low, high = stored.field.values.min(), stored.field.values.max()
        say(f"no surface at {isovalue:g}: samples lie between {low:g} and {high:g}")
    say(
        f"{len(mesh.vertices):,} vertices, {len(mesh.simplices):,} triangles "
        f"{_where(stored)}: [bold]{escape(str(out))}[/]"
    )


def asked(dataset: str | None, shape: str | None, dtype: str | None, spacing: str | None) -> Asked:
    """What was said of a file on the command line, checked."""
    sides = _three("--shape", shape, int)
    steps = _three("--spacing", spacing, float)
    if dtype is not None:
        try:
            real = np.dtype(dtype).kind in "biuf"
        except TypeError:
            real = False
        if not real:
            stop(Exit.WRONG_USE, f"--type {dtype} is no type of real numbers; say uint8, >i2, ..")
    return Asked(dataset, sides, dtype, steps)


def _three(
    option: str, given: str | None, kind: Callable[[str], Number]
) -> tuple[Number, Number, Number] | None:
    """Three positive numbers with commas between them."""
    if given is None:
        return None
    try:
        x, y, z = (kind(part) for part in given.replace("x", ",").split(","))
    except ValueError:
        x = y = z = kind("0")
    if not min(x, y, z) > 0:
        stop(Exit.WRONG_USE, f"{option} {given!r} is not three positive numbers, as 256,256,128")
    return x, y, z


def _where(stored: Stored) -> str:
    """In which coordinates the vertices are."""
    unit = f" in {stored.unit}" if stored.unit else ""
    if stored.space:
        return f"in {stored.space} coordinates{unit}"
    return f"in the file's own coordinates{unit} (it names neither RAS nor LPS)"


def frequencies(volume: str, isovalue: float) -> None:
    """The table of configurations of a volume's cells is printed."""
    try:
        table = count(_volume(volume), isovalue).markdown()
    except (VolumeError, FieldError) as error:
        stop(Exit.WRONG_USE, str(error))
    console.print(table, end="", markup=False)


def _volume(name: str) -> Field:
    """The field in a file, or of a known data set, on a straight lattice."""
    return stored_named(name, Asked()).field.straight()


def stored_named(name: str, asked: Asked) -> Stored:
    """What is in a file, or in a known data set, which is downloaded where it is not here."""
    known = volumes.REGISTRY.get(name)
    if known is not None and not Path(name).exists():
        return volumes.stored(volumes.fetch(known), volume=known, asked=asked)
    return volumes.stored(Path(name), asked=asked)
