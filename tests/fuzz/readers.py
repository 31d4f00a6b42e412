"""What is read from outside, and how: seeds, a function of bytes, and the errors that it may raise.

A reader is *sound* on an input where it ends with a value or with one of its own errors, in whose
text there is no control character and no more than is good for a line, within the seconds and the
memory of `tests.fuzz.run`. Anything else is a finding.
"""

from __future__ import annotations

import gzip
import io
import json
import struct
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from isograde.adapters.answers import json_in, load, mesh_in
from isograde.adapters.child import Ended
from isograde.adapters.conventions import to_house
from isograde.adapters.directory import DirectoryAdapter, export
from isograde.adapters.exec import ExecAdapter
from isograde.adapters.forms import AnswerError
from isograde.adapters.frames import FrameError, pack, unpack
from isograde.adapters.shared import Shared
from isograde.cases import all_cases, own
from isograde.declaration import Conventions, Declaration, declaration_json
from isograde.expectations import ExpectationError, expectations
from isograde.formats.reading import VolumeError
from isograde.formats.reading import read as read_volume
from isograde.model import (
    CONTOURS,
    SURFACES,
    AdapterError,
    Case,
    Kind,
    Limits,
    Outcome,
    Request,
    Status,
)
from isograde.report import headline, reading
from isograde.report.lines import ReportError
from isoref.field import Field

LIMITS = Limits(seconds=5, megabytes=64)
BYTES = LIMITS.megabytes << 20
#: Where files of inputs stand: in memory, where the system has such a folder.
SHARED = Path("/dev/shm")


@dataclass(frozen=True)
class Reader:
    """One thing that is read from outside.

    says : what it is
    seeds : good inputs, by the ending of their file
    read : takes a folder, an ending and the bytes
    refuses : the errors that it may raise
    """

    name: str
    says: str
    seeds: Callable[[], Mapping[str, Sequence[bytes]]]
    read: Callable[[Path, str, bytes], Any]
    refuses: tuple[type[Exception], ...]


READERS: dict[str, Reader] = {}


def reader(
    says: str, seeds: Callable[[], Mapping[str, Sequence[bytes]]], *refuses: type[Exception]
) -> Callable[[Any], Any]:
    """A decorator that registers a function as a reader."""

    def register(function: Any) -> Any:
        name = function.__name__.replace("_", "-")
        READERS[name] = Reader(name, says, cache(seeds), function, refuses)
        return function

    return register


def folder() -> Path:
    """A new folder for the files of inputs."""
    shared = str(SHARED) if SHARED.is_dir() else None
    return Path(tempfile.mkdtemp(prefix="isograde-fuzz-", dir=shared))


def of_json(*values: Any) -> list[bytes]:
    """The values as JSON."""
    return [json.dumps(value).encode() for value in values]


# --- the protocol --------------------------------------------------------------------------------

TRIANGLE = {"vertices": [[0.0, 0.5, 0.25], [1, 0, 0], [0, 1, None]], "simplices": [[0, 1, 2]]}
QUADS = {"vertices": [[0.0, 0, 0]] * 5, "faces": [[0, 1, 2, 3], [0, 1, 2, -1], [2, 3, 4, 0]]}
LINES = {"polylines": [[[0.0, 0.5], [1, 0], [0, 1], [0.0, 0.5]], [[2, 2], [3, 3]]]}


def answers() -> Mapping[str, Sequence[bytes]]:
    """Answers of programs."""
    said: list[dict[str, Any]] = [
        TRIANGLE,
        QUADS,
        LINES,
        {"error": "no"},
        {"unsupported": "cubes only"},
    ]
    said += [{"vertices": "v.npy", "simplices": "s.npy"}, {"mesh": "a.off"}, {"answer": "a.json"}]
    said += [{**QUADS, "faces": [[0, 1, 2], [0, 1, 2, 3, 4]], "seconds": 0.5}]
    return {"json": of_json(*({"id": 1, **one} for one in said))}


class Line:
    """A child process that has answered one line."""

    peak_bytes = 0

    def __init__(self, line: bytes) -> None:
        self.line = line

    def read_line(self, limit: int) -> bytes:
        """The line, up to its end."""
        line, end, _ = self.line.partition(b"\n")
        if len(line) > limit:
            raise Ended(Status.GARBAGE, "too long")
        return line + end

    def unread(self) -> bytes:
        """Nothing stands before it."""
        return b""

    def write(self, buffers: list[bytes]) -> None:
        """It is told nothing."""


class Exchange:
    """The folder for files of one call."""

    def __init__(self, path: Path) -> None:
        self.path = path


@cache
def small(kind: Kind) -> Request:
    """A request for a small field of this kind."""
    field = Field.of(np.arange(3.0**kind.n).reshape((3,) * kind.n))
    return Request("fuzz", "plain", field, (4.5,))


@reader("an answer of a program, a line of JSON", answers, Ended, AdapterError)
def protocol(place: Path, ending: str, data: bytes) -> Any:
    """The outcome, as far as it goes without judging it."""
    np.save(place / "v.npy", np.zeros((3, 3)))
    np.save(place / "s.npy", np.zeros((1, 3), np.int64))
    (place / "a.off").write_bytes(OFF)
    (place / "a.json").write_bytes(json.dumps(TRIANGLE).encode())
    adapter = ExecAdapter("exec:fuzz")
    adapter.number, adapter.limits = 1, LIMITS
    adapter.__dict__["exchange"] = Exchange(place)
    said = adapter._answered(Line(data))  # type: ignore[arg-type]
    request = small(CONTOURS if "polylines" in said else SURFACES)
    return looked_at(adapter._read(said, request), request)


def looked_at(outcome: Outcome, request: Request) -> Any:
    """The outcome in the house's conventions, and its mesh if it is one."""
    with np.errstate(all="ignore"):
        housed = to_house(outcome, request, Conventions(normals="to_high", axes="reversed"))
    return housed.mesh_of(request.kind)


DECLARED = (
    {"name": "mine", "version": "1", "level": 3, "notes": "x", "mesh": "indexed", "domain": "open"},
    {"interpolant": "kuhn", "vertices": "cells", "mesh": {"soup": 1e-6}, "domain": ["open"] * 3},
    {"interpolant": {"tetrahedra": [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]}},
    {"vertices": {"own": 1.5}, "given": "function", "domain": {"inset": 0.5, "end": "closed"}},
    {"conventions": {"tie": "outside", "normals": "none", "nan": "answers", "empty": "raises"}},
    {"limits": {"kinds": [[3, 1], [2, 1]], "types": ["uint8"], "least": 2, "greatest": 9}},
    {"promised": ["cells.*"], "not_promised": ["robustness.nan"], "limits": {"cubes": True}},
)


def declarations() -> Mapping[str, Sequence[bytes]]:
    """First answers of programs."""
    return {"json": of_json(*({"protocol": 3, "declaration": one} for one in DECLARED))}


@reader("the first answer of a program, with its declaration", declarations, AdapterError)
def greeting(place: Path, ending: str, data: bytes) -> Any:
    """The declaration, and what it says of a field."""
    declared = ExecAdapter("exec:fuzz")._greet(Line(data))  # type: ignore[arg-type]
    refused = declared.limits.refusal((3, 1), (4, 4, 4), np.dtype("float64"))
    return declaration_json(declared), declared.ends(3), refused


def frames() -> Mapping[str, Sequence[bytes]]:
    """Messages of the worker process."""
    mesh = [np.zeros((4, 3)), np.zeros((2, 3), np.int32)]
    said: list[tuple[Any, Any]] = [
        (
            {"id": 1, "status": "ok", "detail": "", "changed": False, "seconds": 0.1, "peak": 9},
            mesh,
        ),
        ({"id": 1, "status": "raised", "detail": "no"}, []),
        ({"declaration": DECLARED[0]}, [np.zeros(2, "<f4"), np.ones((1, 1, 1), bool)]),
    ]
    made = [b"".join(bytes(part) for part in pack(header, arrays)) for header, arrays in said]
    entry = {"dtype": "<f8", "shape": [3, 3], "bytes": 72, "at": 0}
    text = json.dumps({"id": 1, "status": "ok", "arrays": [entry]}).encode()
    return {"bin": [*made, struct.pack("<I", len(text)) + text]}


@reader("a message of the worker process", frames, FrameError, MemoryError, EOFError)
def worker(place: Path, ending: str, data: bytes) -> Any:
    """The header and its arrays."""
    shared, stream = Shared.make(), io.BytesIO(data)
    shared.put(np.zeros((3, 3)), 0)

    def take(count: int) -> bytearray:
        found = bytearray(stream.read(count))
        if len(found) < count:
            raise EOFError
        return found

    return unpack(take, BYTES, shared)


# --- meshes --------------------------------------------------------------------------------------

OFF = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
STL = b"solid a\nfacet normal 0 0 1\nouter loop\n" + (
    b"vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
)


def npy(array: Any) -> bytes:
    """A .npy file."""
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return file.getvalue()


def meshes() -> Mapping[str, Sequence[bytes]]:
    """Files of answers."""
    points = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    head = PLY.replace(b"ascii", b"binary_little_endian").partition(b"end_header\n")
    binary = head[0] + head[1] + points + struct.pack("<B3i", 3, 0, 1, 2)
    stl = bytes(80) + struct.pack("<I", 1) + struct.pack("<3f", 0, 0, 1) + points + bytes(2)
    return {
        "ply": [PLY, binary],
        "off": [OFF, OFF.replace(b"3 0 1 2", b"3 0 1 2 255 0 0")],
        "obj": [b"# a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2 3\nf 1//1 2//1 3//1\n"],
        "stl": [STL, stl],
        "json": of_json(TRIANGLE, QUADS),
        "npy": [
            npy(np.zeros((4, 3))),
            npy(np.arange(6).reshape(2, 3)),
            npy(np.zeros((2, 2), "<f2")),
        ],
    }


@reader("an answer in a file: .ply, .obj, .off, .stl, .json, .npy", meshes, AnswerError)
def mesh(place: Path, ending: str, data: bytes) -> Any:
    """The mesh."""
    path = place / f"answer.{ending}"
    path.write_bytes(data)
    if ending == "npy":
        return load(path, BYTES)
    read = json_in if ending == "json" else mesh_in
    vertices, simplices = read(path, BYTES, SURFACES)
    return looked_at(Outcome(Status.OK, vertices, simplices), small(SURFACES))


def manifests() -> Mapping[str, Sequence[bytes]]:
    """What `export` writes."""
    place = folder() / "out"
    export(place, [all_cases()[name] for name in ("cells/outside/001", "contours/noise")])
    return {"json": [(place / "manifest.json").read_bytes()]}


@reader("the manifest of a folder of answers", manifests, AdapterError)
def manifest(place: Path, ending: str, data: bytes) -> Any:
    """The declaration of the folder, and what is said of its fields."""
    (place / "manifest.json").write_bytes(data)
    (place / "cells" / "outside").mkdir(parents=True, exist_ok=True)
    (place / "cells" / "outside" / "001.off").write_bytes(OFF)
    adapter = DirectoryAdapter(f"dir:{place}")
    adapter.open(LIMITS)
    return adapter.unreadable()


# --- volumes -------------------------------------------------------------------------------------


def volumes() -> Mapping[str, Sequence[bytes]]:
    """Small volumes in every format that can be written here."""
    from tests.isograde import test_formats_bad as bad

    small = np.random.default_rng(0).random((5, 6, 7)).astype(np.float32)
    nifti, archive = bad.nii(5, 6, 7), io.BytesIO()
    numbers = b" ".join(b"%.3f" % one for one in small.ravel().tolist())
    np.savez(archive, values=small, spacing=np.ones(3))
    found = {
        "npy": [npy(small), npy(small.astype(">u2"))],
        "npz": [archive.getvalue(), bad.npz(values=small)],
        "nii": [nifti],
        "nii.gz": [gzip.compress(nifti)],
        "nrrd": [bad.nrrd("5 6 7"), bad.nrrd("5 6 7", "gzip")],
        "mha": [bad.mha("5 6 7")],
        "vti": [bad.vti("0 4 0 5 0 6").replace(b"1 2 3", numbers)],
        "vtk": [bad.vtk("5 6 7").replace(b"1 2 3", numbers)],
        "mgh": [struct.pack(">7i", 1, 5, 6, 7, 1, 3, 0) + bytes(256) + small.tobytes()],
        "raw": [small.tobytes()],
    }
    with suppress(ImportError):
        import tifffile

        file = io.BytesIO()
        tifffile.imwrite(file, small, metadata={"axes": "ZYX", "spacing": 2.0}, imagej=True)
        found["tif"] = [file.getvalue()]
    with suppress(ImportError):
        import h5py

        file = io.BytesIO()
        with h5py.File(file, "w") as h5:
            h5["values"] = small[:2, :2, :2]
        found["h5"] = [file.getvalue()]
    return found


@reader("a volume in any of a dozen formats", volumes, VolumeError)
def volume(place: Path, ending: str, data: bytes) -> Any:
    """The field."""
    path = place / f"volume.{ending}"
    path.write_bytes(data)
    return read_volume(path)


# --- reports, cases, expectations ----------------------------------------------------------------


def small_report() -> bytes:
    """A report of three cases."""
    from tests.isograde.judging import Here
    from tests.isograde.mistaken import with_epsilon
    from tests.isograde.reporting import graded

    cases = [all_cases()[name] for name in ("cells/outside/001", "types/signed")]
    report = graded(Here(with_epsilon, Declaration("fuzz")), "python:fuzz:extract", cases)
    records: list[Any] = [
        report.header,
        *report.claims.values(),
        *report.cases.values(),
        *report.results,
    ]
    records += [*report.evidence.values(), report.footer]
    return b"".join(json.dumps(one).encode() + b"\n" for one in records if one)


def reports() -> Mapping[str, Sequence[bytes]]:
    """A small report, each of its lines, and one of a header and a few lines."""
    lines = small_report().splitlines(keepends=True)
    claims = [line for line in lines if b'"record": "claim"' in line][:3]
    cases = [line for line in lines if b'"record": "case"' in line]
    short = b"".join([lines[0], *claims, *cases])
    return {"jsonl": [short, *lines], "jsonl.gz": [gzip.compress(short)]}


@reader("a report, as lines of JSON", reports, ReportError)
def report(place: Path, ending: str, data: bytes) -> Any:
    """The report, and the headline on it."""
    path = place / f"report.{ending}"
    path.write_bytes(data)
    found = reading.read(path)
    return headline.headline(found)


def own_cases() -> Mapping[str, Sequence[bytes]]:
    """A file of cases."""
    fields = [all_cases()[name] for name in ("cells/outside/001", "contours/noise")]
    entries = [entry(one) for one in fields if one.samples < 2000]
    return {"json": of_json({"format": own.FORMAT, "cases": entries})}


def entry(case: Case) -> Any:
    """A case as an entry."""
    return own.entry_of(case.build(), case.isovalues, "topology.closed", "fuzz", "it tears")


@reader("a file of cases of one's own", own_cases, own.OwnCasesError)
def cases(place: Path, ending: str, data: bytes) -> Any:
    """The cases, built."""
    path = place / "cases.json"
    path.write_bytes(data)
    return [one.build() for one in own.read(path)]


def expected() -> Mapping[str, Sequence[bytes]]:
    """A file of known failures."""
    text = '["topology.manifold"]\nreason = "sheets that touch"\ncases = ["ties/point", "tied/*"]\n'
    return {"toml": [text.encode(), text.replace('"ties/point", "tied/*"', '"*"').encode()]}


@reader("a file of failures that are known", expected, ExpectationError)
def known(place: Path, ending: str, data: bytes) -> Any:
    """The expectations."""
    path = place / "expect.toml"
    path.write_bytes(data)
    return expectations(path)
