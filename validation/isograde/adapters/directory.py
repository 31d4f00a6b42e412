"""The adapter to meshes computed elsewhere: ``dir:path``.

`export` writes fields into a folder; whoever runs the implementation, anywhere, puts a mesh beside
each field; the adapter reads them. No program of ours is needed in between::

    folder/manifest.json              every field: id, isovalue, shape, spacing, origin, files
    folder/cells/outside/137.npy      the samples, C order (last axis fastest)
    folder/cells/outside/137.nrrd     the same: NRRD's first axis is the array's first
    folder/cells/outside/137.ply      the answer: .ply, .obj, .off, .stl,
    folder/cells/outside/137.vertices.npy and 137.faces.npy     or a pair of arrays
    folder/declaration.json           optional: what the implementation says of itself

The manifest names the discipline and says how its samples and answers are laid out. For surfaces,
vertices are ``origin + index * spacing`` in the order of the array's axes, faces are 0-based, and
right-hand normals point to lower values, unless the declaration says otherwise. A field without a
mesh counts as declined: no answer is not an empty mesh.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Field

from isograde.adapters.answers import MESH_FILES, AnswerError, Arrays, arrays_in, mesh_in
from isograde.adapters.child import MEGABYTE
from isograde.adapters.conventions import to_house
from isograde.adapters.declaring import check_json, declaration_from
from isograde.model import AdapterError, Case, Declaration, Limits, Outcome, Request, Status

MANIFEST = "manifest.json"
DECLARATION = "declaration.json"
ANSWER = "beside the values, same name: .ply .obj .off .stl, or .vertices.npy and .faces.npy"


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
        self._entries = {(entry["id"], entry["variant"]): entry for entry in manifest["fields"]}
        self.declaration = self._declared(manifest.get("discipline", "surfaces"))
        if self.answered() == 0:
            raise AdapterError(
                f"{self._folder}: no mesh beside any of the {len(self._entries)} fields; "
                f"put each {ANSWER}"
            )
        return self.declaration

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
                    self._read(path)
                except AnswerError as error:
                    reasons.append((str(path.relative_to(self._folder)), str(error)))
        return reasons

    def run(self, request: Request) -> Outcome:
        """The mesh that was found for the request, in the house's conventions."""
        conventions = self.declaration.conventions
        return to_house(self.answer(request), request, conventions, placed=True)

    def answer(self, request: Request) -> Outcome:
        """The mesh that was found for the request, as it stands in the file."""
        entry = self._entries.get((request.case, request.variant))
        if entry is None:
            return Outcome(Status.DECLINED, detail=f"not exported: variant {request.variant}")
        if entry["sha256"] != fingerprint(request.field, request.isovalue):
            return Outcome(Status.DECLINED, detail="exported with other numbers: export again")
        found = _answers(self._folder / entry["values"])
        if len(found) != 1:
            detail = f"more than one answer: {', '.join(p.name for p in found)}"
            status = Status.GARBAGE if found else Status.DECLINED
            return Outcome(status, detail=detail if found else "no mesh was handed in")
        try:
            vertices, faces = self._read(found[0])
        except AnswerError as error:
            return Outcome(error.status, detail=str(error))
        return Outcome(Status.OK, vertices, faces)

    def close(self) -> None:
        """Nothing runs, so there is nothing to stop."""

    def _read(self, path: Path) -> Arrays:
        """The arrays of an answer; raises `AnswerError`."""
        limit = self._limits.megabytes * MEGABYTE
        if path.suffix != ".npy":
            return mesh_in(path, limit)
        faces = path.with_name(path.name.replace(".vertices.npy", ".faces.npy"))
        return arrays_in(path, faces, limit)

    def _declared(self, discipline: str) -> Declaration:
        """The declaration beside the manifest, or the least one for its discipline."""
        if not (self._folder / DECLARATION).exists():
            return Declaration(self.spec, discipline=discipline)
        said = {"discipline": discipline, **self._json(DECLARATION, "")}
        declared = declaration_from(said, self.spec)
        if declared.discipline != discipline:
            raise AdapterError(
                f"{self._folder / DECLARATION} declares {declared.discipline}, but the folder "
                f"holds {discipline}: `isograde export --discipline {declared.discipline}`"
            )
        return declared

    def _json(self, name: str, hint: str) -> Any:
        """The contents of a JSON file in the folder; raises `AdapterError`."""
        path = self._folder / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise AdapterError(f"{path} does not exist; {hint}") from None
        except (OSError, ValueError) as error:
            raise AdapterError(f"{path} cannot be read: {error}") from error


def _answers(values: Path) -> list[Path]:
    """The files beside these values that hold an answer."""
    stem = values.name.removesuffix(".npy")
    names = [stem + suffix for suffix in (*MESH_FILES, ".vertices.npy")]
    return [values.with_name(name) for name in names if values.with_name(name).exists()]


def export(
    directory: Path,
    fields: Iterable[Case | Request],
    discipline: str = "surfaces",
    layout: Mapping[str, str] | None = None,
) -> int:
    """The folder holds these fields and a manifest; their number.

    Cases are written as they stand, requests with their variant; `layout` tells the reader of the
    manifest how samples and answers stand in files. The folder appears whole or not at all.

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
        said = {"discipline": discipline, "conventions": dict(layout or {})}
        manifest = {"format": 1, **said, "fields": entries}
        text = json.dumps(manifest, indent=1)
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
    return Request(field.id, "plain", field.build(), field.isovalue)


def _write(folder: Path, request: Request) -> dict[str, Any]:
    """The manifest's entry of a request whose files are written."""
    field, variant = request.field, request.variant
    stem = request.case if variant == "plain" else f"{request.case}@{variant}"
    values = folder / f"{stem}.npy"
    values.parent.mkdir(parents=True, exist_ok=True)
    np.save(values, np.ascontiguousarray(field.values))
    files = {"values": f"{stem}.npy"}
    if field.values.ndim == field.dimension:
        _write_nrrd(values.with_suffix(".nrrd"), field)
        files["nrrd"] = f"{stem}.nrrd"
    return {
        "id": request.case,
        "variant": variant,
        **files,
        "isovalue": float(request.isovalue),
        "shape": list(field.values.shape),
        "dtype": field.values.dtype.str,
        "spacing": list(field.spacing),
        "origin": list(field.origin),
        "sha256": fingerprint(field, request.isovalue),
    }


def _write_nrrd(path: Path, field: Field) -> None:
    """The file holds the samples and their place in space."""
    import nrrd

    values = field.values
    widened = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:])
    header = {
        "space dimension": field.dimension,
        "space directions": np.diag(field.spacing),
        "space origin": np.asarray(field.origin),
        "encoding": "gzip",
    }
    nrrd.write(str(path), values.astype(widened) if widened else values, header)


def fingerprint(field: Field, isovalue: float) -> str:
    """SHA-256 of the samples, their type and place, and the isovalue.

    >>> fingerprint(Field.of([[0, 1]]), 0.5) == fingerprint(Field.of([[0, 1]]), 0.25)
    False
    """
    values = field.values
    place = (values.dtype.str, values.shape, field.spacing, field.origin, float(isovalue))
    total = hashlib.sha256(repr(place).encode())
    total.update(np.ascontiguousarray(values).tobytes())
    return total.hexdigest()
