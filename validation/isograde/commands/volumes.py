"""What the commands on one volume do: `extract` and `frequencies`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from isoref import distributed
from isoref.attributes import filled
from isoref.degenerate import without_degenerate
from isoref.fast.slabs import slabs
from isoref.field import Booleans, Field, FieldError
from isoref.label_cubes import one_label
from isoref.mesh import Mesh
from isoref.methods import METHODS, RULES, surface
from rich.markup import escape

from isograde.cases import volumes
from isograde.commands.console import Exit, close_to, console, say, stop
from isograde.formats.reading import Asked, Stored, VolumeError, library, native
from isograde.formats.writing import MESH_FILES, write, write_pieces
from isograde.frequencies import frequencies as count

Number = TypeVar("Number", int, float)


@dataclass(frozen=True)
class Wanted:
    """Which surfaces are to be made of a volume, and how.

    isovalues, labels : one surface each; of labels the samples that are that number are inside
    method : of `isoref.METHODS`, or None for the usual one
    cap : close them on the border of the volume, and beside absent samples
    absent : samples that are not finite are no error: no surface is drawn beside them, but
        for what closes it with `cap`
    clean : remove triangles without area, where that does no harm
    space : RAS, LPS, or None for what the file is in
    frames : which of several volumes in a row, each with surfaces of its own; None for the first
    """

    isovalues: tuple[float, ...]
    labels: tuple[float, ...] = ()
    method: str | None = None
    cap: bool = False
    absent: bool = False
    clean: bool = False
    space: str | None = None
    frames: slice | None = None

    @property
    def drawn_by(self) -> str:
        """The method: without another word, labels are drawn by the method that is for them."""
        return self.method or ("label-cubes" if self.labels else "asymptotic-decider")


def extract(volume: str, wanted: Wanted, out: Path, asked: Asked) -> None:
    """The reference's surfaces of a volume are in mesh files, where the volume stands."""
    _check(wanted, out)
    try:
        series = wanted.frames is not None
        stored = _opened(volume, wanted, replace(asked, absent=wanted.absent, series=series))
        for number, frame in _frames(stored, wanted):
            name = out if number is None else out.with_stem(f"{out.stem}-{number}")
            try:
                _extract(frame, wanted, name)
            except FieldError as error:
                told = str(error) if number is None else f"frame {int(number)}: {error}"
                raise FieldError(told) from error
    except (VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))


def _extract(stored: Stored, wanted: Wanted, out: Path) -> None:
    """The surfaces of one volume are in their files."""
    field, gone = present(stored) if wanted.absent else (stored.field, None)
    if gone is not None:
        say(f"[dim]{int(gone.sum()):,} samples of {gone.size:,} are absent[/]")
    for number, posed, level in _posed(field, wanted):
        name = _named(out, number, wanted)
        mesh = surface(posed, level, wanted.drawn_by, cap=wanted.cap, absent=gone)
        if wanted.clean:
            mesh = _cleaned(mesh)
        write(mesh, name, stored.space)
        if not len(mesh.simplices):
            say(_why_empty(field, number))
        _tell(len(mesh.vertices), len(mesh.simplices), stored, name)


def _frames(stored: Stored, wanted: Wanted) -> Iterator[tuple[str | None, Stored]]:
    """The volumes that are wanted; of a series each with its number, all of as many digits."""
    if wanted.frames is None:
        yield None, stored
        return
    count = len(stored.values)
    numbers = range(count)[wanted.frames]
    if not numbers:
        raise VolumeError(f"no frame of that number: there are {count}, counted from 0")
    digits = len(str(count - 1))
    for number in numbers:
        yield f"{number:0{digits}}", replace(stored, values=native(stored.values[number]))


def frames_named(said: str | None) -> slice | None:
    """Which frames are meant, as Python counts: all, one, or FIRST:STOP:STEP; else a wrong use.

    >>> frames_named("all"), frames_named("3"), frames_named("2:8:2"), frames_named("-1")
    (slice(None, None, None), slice(3, 4, None), slice(2, 8, 2), slice(-1, None, None))
    """
    if said is None or said == "all":
        return None if said is None else slice(None)
    try:
        parts = [int(part) if part else None for part in said.split(":")]
    except ValueError:
        parts = []
    if len(parts) == 1 and parts[0] is not None:
        return slice(parts[0], parts[0] + 1 or None)
    if len(parts) not in (2, 3) or parts[2:] == [0]:
        stop(Exit.WRONG_USE, f"--frames {said}: say all, a number, or FIRST:STOP:STEP, from 0 on")
    return slice(*parts)


def extract_by_planes(volume: str, wanted: Wanted, out: Path, asked: Asked) -> None:
    """The same of a volume and a mesh that may be larger than the memory, as a PLY file."""
    _check_rule(wanted, out, "--by-planes")
    if out.suffix.lower() != ".ply":
        stop(Exit.WRONG_USE, f"--by-planes writes PLY, and {out} ends otherwise")
    try:
        stored = _opened(volume, wanted, replace(asked, stays=True))
        place = Field.of_affine(np.zeros((1, 1, 1)), stored.affine)
        for number in wanted.isovalues:
            name = _named(out, number, wanted)
            found = slabs(
                stored.values,
                number,
                place.spacing,
                place.origin,
                directions=place.directions,
                rule=RULES[wanted.drawn_by],
            )
            vertices, triangles = write_pieces(((s.vertices, s.simplices) for s in found), name)
            if not triangles:
                say(f"no surface at {number:g}: all samples are on one side of it")
            _tell(vertices, triangles, stored, name)
    except (VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))


def extract_by_dask(volume: str, wanted: Wanted, out: Path, asked: Asked, address: str) -> None:
    """The same by the workers of a dask cluster, block by block; only the mesh has to fit here."""
    _check_rule(wanted, out, "--dask")
    try:
        arrays: Any = library("dask.array", "distributed")
        cluster: Any = library("distributed", "distributed")
        stored = _opened(volume, wanted, replace(asked, stays=True))
        place = Field.of_affine(np.zeros((1, 1, 1)), stored.affine)
        array = arrays.from_array(stored.values, chunks="auto")
        try:
            client = cluster.Client(address, timeout=10)
        except (OSError, ValueError, TimeoutError) as error:
            stop(Exit.WRONG_USE, f"no dask scheduler answers at {address}: {error}")
        with client:
            for number in wanted.isovalues:
                name = _named(out, number, wanted)
                mesh = distributed.extract(
                    array,
                    number,
                    place.spacing,
                    place.origin,
                    directions=place.directions,
                    method=wanted.drawn_by,
                )
                write(mesh, name, stored.space)
                _tell(len(mesh.vertices), len(mesh.simplices), stored, name)
    except (VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))


def _opened(volume: str, wanted: Wanted, asked: Asked) -> Stored:
    """What is in a file, in the coordinates that are wanted; how it was read is told."""
    stored = stored_named(volume, asked)
    if wanted.space:
        stored = stored.in_space(wanted.space)
    for note in stored.notes:
        say(f"[dim]{escape(note)}[/]")
    return stored


def _check_rule(wanted: Wanted, out: Path, option: str) -> None:
    """A surface in parts can be made of what is asked for, or the command stops."""
    _check(wanted, out)
    if wanted.frames is not None:
        stop(Exit.WRONG_USE, f"--frames reads the volumes one by one; leave {option} out")
    if wanted.labels or wanted.cap or wanted.absent or wanted.clean:
        stop(Exit.WRONG_USE, f"{option} takes isovalues, and no --label, --cap, --absent, --clean")
    if wanted.drawn_by not in RULES:
        stop(
            Exit.WRONG_USE,
            f"{wanted.drawn_by} does not go part by part; {', '.join(sorted(RULES))} do",
        )


def _named(out: Path, number: float, wanted: Wanted) -> Path:
    """The file of one surface: of several each has its number in its name."""
    several = len(wanted.isovalues) + len(wanted.labels) > 1
    return out.with_stem(f"{out.stem}-{number:g}") if several else out


def _check(wanted: Wanted, out: Path) -> None:
    """What is asked for can be made, or the command stops."""
    if wanted.method is not None and wanted.method not in METHODS:
        stop(Exit.WRONG_USE, f"no method {wanted.method!r}; {close_to(wanted.method, METHODS)}")
    if out.suffix.lower() not in MESH_FILES:
        stop(Exit.WRONG_USE, f"{out} ends in none of {' '.join(MESH_FILES)}")
    if bool(wanted.isovalues) == bool(wanted.labels):
        stop(Exit.WRONG_USE, "say which surface: --isovalue VALUE, or --label NUMBER for a label")


def present(stored: Stored) -> tuple[Field, Booleans]:
    """The field with numbers for samples that are not finite, and which these are."""
    samples, gone = filled(stored.values)
    return Field.of_affine(samples, stored.affine), gone


def _posed(field: Field, wanted: Wanted) -> Iterator[tuple[float, Field, float]]:
    """For each surface the number it was asked for by, its field and its isovalue."""
    for isovalue in wanted.isovalues:
        yield isovalue, field, isovalue
    for label in wanted.labels:
        yield label, one_label(field, label), 0.0


def _cleaned(mesh: Mesh) -> Mesh:
    """The mesh without degenerate triangles; what was done is said."""
    removal = without_degenerate(mesh)
    done = (
        f"{removal.before.degenerate:,} triangles without area: {removal.collapsed:,} edges "
        f"collapsed, {removal.flipped:,} flipped, {removal.vanished:,} pieces removed that were "
        "points"
    )
    if removal.after.degenerate:
        done += f"; {removal.after.degenerate:,} stay, for the surface to stay a manifold"
    say(f"[dim]{done}[/]")
    return removal.mesh


def _why_empty(field: Field, number: float) -> str:
    """Why there is no surface."""
    low, high = field.values.min(), field.values.max()
    return f"no surface at {number:g}: samples lie between {low:g} and {high:g}"


def _tell(vertices: int, triangles: int, stored: Stored, out: Path) -> None:
    """What was written, and in which coordinates."""
    say(
        f"{vertices:,} vertices, {triangles:,} triangles "
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
