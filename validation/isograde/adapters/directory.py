"""The adapter to meshes computed elsewhere: ``dir:path``.

`export` writes fields into a folder; whoever runs the implementation, anywhere, puts a mesh beside
each field; the adapter reads them. No program of ours is needed in between::

    folder/manifest.json              every field: its kind, isovalues, place and files
    folder/cells/outside/137.npy      the samples, C order (last axis fastest)
    folder/cells/outside/137.nrrd     the same: NRRD's first axis is the array's first
    folder/cells/outside/137.ply      the answer: .ply, .obj, .off, .stl,
    folder/cells/outside/137.vertices.npy and 137.simplices.npy (or 137.faces.npy)
    folder/cells/outside/137.json     or an object as programs answer it (`isograde.adapters.exec`)
    folder/declaration.json           optional: what the implementation says of itself

The manifest says of each field its kind (n, m), and how samples and answers are laid out. Vertices
are ``origin + index * spacing`` in the order of the array's axes, indices are 0-based, and
right-hand normals point to lower values, unless the declaration says otherwise. A field without an
answer counts as declined: no answer is not an empty mesh.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from isoref.field import Field

from isograde.adapters.answers import MESH_FILES, json_in, load, mesh_in
from isograde.adapters.child import MEGABYTE
from isograde.adapters.conventions import refusal, to_house
from isograde.adapters.forms import AnswerError, Arrays, from_pair
from isograde.adapters.process import samples
from isograde.adapters.protocol import check_json, declared
from isograde.adapters.strict import isovalue, parse, written
from isograde.declaration import Declaration, Scope
from isograde.model import (
    AdapterError,
    Case,
    Kind,
    Limits,
    Outcome,
    Request,
    Status,
    UnknownName,
)
from isograde.variants import is_bad_input

FORMAT = 2
VERTICES, SIMPLICES = ".vertices.npy", (".simplices.npy", ".faces.npy")
MANIFEST = "manifest.json"
# What a path below the manifest may have, in characters, and a kind in axes.
LONGEST_PATH, LONGEST_NAME, MOST_AXES = 1000, 200, 16
DECLARATION = "declaration.json"
ANSWER = (
    "beside the values, same name: .ply .obj .off .stl, .json, or .vertices.npy and .simplices.npy"
)
# What the manifest tells whoever answers it.
LAYOUT: Mapping[str, str] = {
    "kind": "[n, m]: m fields on an n-dimensional lattice; the answer has simplices of dimension "
    "n - m on which each field has its isovalue",
    "values": "npy in C order, last axis fastest, (N1, .., Nn) or (m, N1, .., Nn); the nrrd's "
    "first axis is the array's first",
    "inside": "value >= isovalue",
    "vertices": "origin + index * spacing (V, n), coordinates in the order of the array's axes",
    "simplices": "rows of n - m + 1 0-based indices; with g the gradients of the fields and t the "
    "edges of a simplex, det(-g_1, .., -g_m, t_1, ..) > 0: right-hand normals of triangles point "
    "to lower values, contours have the inside on their left; quads and other "
    "polygons are taken for triangles, rows with fewer corners filled up with -1",
    "answer": ANSWER,
    "json": 'an object of "vertices" and "simplices", or of "polylines": lists of points, the '
    "first repeated where one is closed",
    "nothing there": "a mesh without simplices; a missing file counts as unsupported",
}


class DirectoryAdapter:
    """Meshes in a folder that `export` made; `spec` is ``dir:path``."""

    def __init__(self, spec: str):
        self.spec = spec
        self.declaration = Declaration(spec)
        self._folder = Path(spec.removeprefix("dir:"))
        self._entries: dict[tuple[str, str], dict[str, Any]] = {}
        self._limits = Limits()

    def open(self, limits: Limits) -> Declaration:
        """Read the manifest and the declaration. Raises `AdapterError`."""
        self._limits = limits
        manifest = self._json(MANIFEST, "write one with `isograde export`")
        check_json(manifest, "manifest", str(self._folder / MANIFEST))
        for entry in manifest["fields"]:
            _check_entry(entry, self._folder / MANIFEST)
        self._entries = {(entry["id"], entry["variant"]): entry for entry in manifest["fields"]}
        self.declaration = self._declared()
        if self._needs_trimesh() and find_spec("trimesh") is None:
            raise AdapterError(
                f"{self._folder}: mesh files are read by trimesh, which is not installed: "
                'pip install "isograde[meshes]"'
            )
        if self.answered() == 0:
            raise AdapterError(
                f"{self._folder}: no mesh beside any of the {len(self._entries)} fields; "
                f"put each {ANSWER}"
            )
        return self.declaration

    def _needs_trimesh(self) -> bool:
        """Whether some answer is a mesh file."""
        every = (self._folder / entry["values"] for entry in self._entries.values())
        return any(one.suffix.lower() in MESH_FILES for path in every for one in _answers(path))

    def answered(self) -> int:
        """The number of fields that have a mesh."""
        return sum(bool(_answers(self._folder / e["values"])) for e in self._entries.values())

    def exported(self) -> int:
        """The number of fields."""
        return len(self._entries)

    def unreadable(self) -> list[tuple[str, str]]:
        """(file, reason) for each answer that cannot be read."""
        reasons = []
        for entry in self._entries.values():
            for path in _answers(self._folder / entry["values"]):
                try:
                    self._read(path, Kind(*entry["kind"]))
                except AnswerError as error:
                    reasons.append((str(path.relative_to(self._folder)), str(error)))
        return reasons

    def run(self, request: Request) -> Outcome:
        """The mesh that was found for the request, in the house's conventions."""
        conventions = self.declaration.conventions
        return to_house(self.answer(request), request, conventions, placed=True)

    def answer(self, request: Request) -> Outcome:
        """The mesh that was found for the request, as it stands in the file."""
        if reason := refusal(request, self.declaration):
            return Outcome(Status.DECLINED, detail=reason)
        if request.calls != "once":
            return Outcome(Status.DECLINED, detail="files hold one answer a field")
        entry = self._entries.get((request.case, request.variant))
        if entry is None:
            return Outcome(Status.DECLINED, detail=f"not exported: variant {request.variant}")
        if entry["sha256"] != fingerprint(request.field, request.isovalues):
            return Outcome(Status.DECLINED, detail="exported with other numbers: export again")
        found = _answers(self._folder / entry["values"])
        if len(found) != 1:
            detail = f"more than one answer: {', '.join(p.name for p in found)}"
            status = Status.GARBAGE if found else Status.DECLINED
            return Outcome(status, detail=detail if found else "no mesh was handed in")
        try:
            vertices, simplices = self._read(found[0], request.kind)
        except AnswerError as error:
            return Outcome(error.status, detail=str(error))
        return Outcome(Status.OK, vertices, simplices)

    def close(self) -> None:
        """Nothing runs, so there is nothing to stop."""

    def _read(self, path: Path, kind: Kind) -> Arrays:
        """The arrays of an answer; raises `AnswerError`."""
        limit = self._limits.megabytes * MEGABYTE
        if not path.resolve().is_relative_to(self._folder.resolve()):
            raise AnswerError(f"{path.name} is a link that leads outside the folder")
        if path.suffix == ".json":
            return json_in(path, limit, kind)
        if path.suffix != ".npy":
            return mesh_in(path, limit, kind)
        stem = path.name.removesuffix(VERTICES)
        beside = [path.with_name(stem + suffix) for suffix in SIMPLICES]
        there = [one for one in beside if one.exists()]
        if len(there) > 1:
            raise AnswerError(f"{there[0].name} and {there[1].name} are the same thing twice")
        rows = load(there[0] if there else beside[0], limit)
        return from_pair(load(path, limit), rows, kind)

    def _declared(self) -> Declaration:
        """The declaration beside the manifest, its kinds those of the fields unless it says so."""
        # A variant that is no field is of no kind that anybody makes.
        fields = [e for e in self._entries.values() if not is_bad_input(e["variant"])]
        kinds = sorted({(int(e["kind"][0]), int(e["kind"][1])) for e in fields})
        if not (self._folder / DECLARATION).exists():
            return Declaration(self.spec, limits=Scope(kinds=tuple(kinds)))
        said = self._json(DECLARATION, "")
        limits = said.get("limits", {}) if isinstance(said, dict) else None
        if isinstance(limits, dict):
            said = {**said, "limits": {"kinds": [list(kind) for kind in kinds], **limits}}
        return declared(said, self.spec)

    def _json(self, name: str, hint: str) -> Any:
        """The contents of a JSON file in the folder; raises `AdapterError`."""
        path = self._folder / name
        try:
            return parse(path.read_bytes())
        except FileNotFoundError:
            raise UnknownName(f"{path} does not exist; {hint}") from None
        except (OSError, ValueError) as error:
            raise AdapterError(f"{path} cannot be read: {error}") from error


def _check_entry(entry: Mapping[str, Any], manifest: Path) -> None:
    """Raise `AdapterError` unless an entry of the manifest names files below it, and a kind."""
    for name in ("values", "nrrd"):
        path = str(entry.get(name, ""))
        parts = PurePosixPath(path).parts
        fit = path.isprintable() and len(path) <= LONGEST_PATH and path[:1] not in ("/", "~", "\\")
        if ".." in parts or not fit or max(map(len, parts), default=0) > LONGEST_NAME:
            raise AdapterError(f"{manifest}: {name} {path!r:.80} is no path below the manifest")
    n, m = entry["kind"]
    if not n >= m >= 1 or n > MOST_AXES:
        raise AdapterError(f"{manifest}: there is no kind {[n, m]!r:.80}: n >= m >= 1 are wanted")


def _answers(values: Path) -> list[Path]:
    """The files beside these values that hold an answer."""
    stem = values.name.removesuffix(".npy")
    names = [stem + suffix for suffix in (*MESH_FILES, ".json", VERTICES)]
    return [values.with_name(name) for name in names if values.with_name(name).exists()]


def export(directory: Path, fields: Iterable[Case | Request]) -> int:
    """The folder holds these fields, of any kind, and a manifest; their number.

    Cases are written as they stand, requests with their variant. The folder appears whole or not
    at all.

    Raises
    ------
    AdapterError
        for a folder that exists and is not empty.
    """
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise AdapterError(f"{directory} exists and is not empty; name a new folder")
    stage = directory.with_name(directory.name + ".partial")
    stage.mkdir(parents=True)
    try:
        entries = [_write(stage, _request(field)) for field in fields]
        manifest = {"format": FORMAT, "conventions": dict(LAYOUT), "fields": entries}
        text = written(manifest, indent=1)
        (stage / MANIFEST).write_text(text + "\n", encoding="utf-8")
        os.replace(stage, directory)
    except BaseException:
        shutil.rmtree(stage)
        raise
    return len(entries)


def _request(field: Case | Request) -> Request:
    """A case as the request for it as it stands."""
    if isinstance(field, Request):
        return field
    return Request(field.id, "plain", field.build(), field.isovalues)


def _write(folder: Path, request: Request) -> dict[str, Any]:
    """The manifest's entry of a request whose files are written."""
    field, variant = request.field, request.variant
    stem = request.case if variant == "plain" else f"{request.case}@{variant}"
    values = folder / f"{stem}.npy"
    values.parent.mkdir(parents=True, exist_ok=True)
    given = samples(field)
    np.save(values, np.ascontiguousarray(given))
    files = {"values": f"{stem}.npy"}
    if given.ndim == field.dimension:
        _write_nrrd(values.with_suffix(".nrrd"), field)
        files["nrrd"] = f"{stem}.nrrd"
    return {
        "id": request.case,
        "variant": variant,
        "kind": list(request.kind),
        **files,
        "isovalues": [isovalue(one) for one in request.isovalues],
        "shape": list(field.shape),
        "dtype": field.values.dtype.str,
        "spacing": list(field.spacing),
        "origin": list(field.origin),
        "sha256": fingerprint(field, request.isovalues),
    }


def _write_nrrd(path: Path, field: Field) -> None:
    """The file holds the samples and their place in space."""
    try:
        import nrrd
    except ImportError as error:
        raise AdapterError(f'{error}: pip install "isograde[volumes]"') from error
    values = samples(field)
    widened = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:])
    header = {
        "space dimension": field.dimension,
        "space directions": np.diag(field.spacing),
        "space origin": np.asarray(field.origin),
        "encoding": "gzip",
    }
    nrrd.write(str(path), values.astype(widened) if widened else values, header)


def fingerprint(field: Field, isovalues: Sequence[float]) -> str:
    """SHA-256 of the samples, their type and place, and the isovalues.

    >>> fingerprint(Field.of([[0, 1]]), (0.5,)) == fingerprint(Field.of([[0, 1]]), (0.25,))
    False
    """
    values = samples(field)
    levels = tuple(map(float, isovalues))
    place = (values.dtype.str, values.shape, field.spacing, field.origin, levels)
    total = hashlib.sha256(repr(place).encode())
    total.update(np.ascontiguousarray(values).tobytes())
    return total.hexdigest()
