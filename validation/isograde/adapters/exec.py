"""The adapter to programs in any language: ``exec:command``.

The command is one line for the shell, so a pipeline is a command too. It speaks JSON, one object a
line (`protocol.schema.json` beside this file has every field); arrays stand in files.

It reads from standard input, and answers on standard output::

    {"command": "start", "protocol": 2}
        {"protocol": 2, "declaration": {"name": "mine", "level": 1}}
    {"command": "run", "id": 7, "dtype": "<f8", "shape": [4, 4, 4], "spacing": [1.0, 1.0, 1.0],
     "isovalue": 0.5, "offset": 128, "values": "/tmp/x/values.npy", "directory": "/tmp/x",
     "case": "noise/7"}
        {"id": 7, "vertices": [[0.5, 0.0, 0.0], ..], "faces": [[0, 1, 2], ..]}
    {"command": "stop"}

An answer returns the ``id`` of its request, so that no answer can pass for another's. Each request
is one line, its keys always in this order, with one blank after each colon and comma: a program
without a JSON library can read it with one ``sscanf`` (`tests/isograde/foreign/tetrahedra.c` is a
whole implementation in C). An isovalue may be NaN, Infinity or -Infinity.

The samples are in C order, the last axis fastest, little-endian, from byte ``offset`` of a .npy
file. Instead of the arrays an answer may have the names of .npy files, ``"vertices": "v.npy"``, or
of one mesh file, ``"mesh": "surface.off"`` (.ply, .obj, .off, .stl), which start at ``directory``;
or ``"error": ".."``; or ``"unsupported": ".."`` for a field the program does not take. Vertices are
``index * spacing`` in the order of the array's axes unless the declaration says otherwise; the
grader adds the origin.

Other disciplines differ in what the arrays hold, and in nothing else. A field of m components has
the shape [m, N1, .., Nn]. Polylines are the pair of all their points and, for each point, the
number of its polyline. The manifest of ``isograde export --discipline curves`` says how it is for
curves, and so on (`LAYOUT` in the modules of `isograde.disciplines`). None has mesh files.

Standard output belongs to the protocol: any other line on it, and an answer to another request, is
garbage: it costs the case, and the program is started again.
Messages for people go to standard error, which is kept. The program runs until it is told to stop
or its input ends; remember to flush after each line.
"""

from __future__ import annotations

import contextlib
import json
import time
from dataclasses import replace
from typing import Any

import numpy as np

from isograde.adapters.answers import AnswerError, Arrays, arrays_from, arrays_in, mesh_in
from isograde.adapters.child import MEGABYTE, Child, Ended
from isograde.adapters.declaring import check_json, declaration_from
from isograde.adapters.process import ProcessAdapter, empty, own_directory
from isograde.model import AdapterError, Declaration, Outcome, Request, Status

PROTOCOL = 2
OLD = "it speaks protocol 1; now each answer returns the id of its request, and that is protocol 2"
# How much of a line that is no answer a report quotes.
QUOTED = 120


class ExecAdapter(ProcessAdapter):
    """A program that speaks the protocol of this module; `spec` is ``exec:command``."""

    def __init__(self, spec: str):
        super().__init__(spec)
        self._directory = own_directory(self)

    def _spawn(self) -> Child:
        """The program, run by the shell."""
        return Child(self.spec.removeprefix("exec:"))

    def _greet(self, child: Child) -> Declaration:
        """What the program declares."""
        _tell(child, {"command": "start", "protocol": PROTOCOL})
        line, said = _line(child)
        if isinstance(said, dict) and said.get("protocol") == 1:
            raise AdapterError(f"{self.spec}: {OLD}")
        check_json(said, "started", f"the answer {_quoted(line)}")
        return declaration_from(said.get("declaration", {}), self.spec)

    def _ask(self, child: Child, request: Request) -> Outcome:
        """What the program answered; garbage ends it, for it may be out of step."""
        if rest := child.unread():
            raise Ended(Status.GARBAGE, f"stdout held {_quoted(rest)} before the request")
        _tell(child, self._written(request))
        start = time.perf_counter()
        said = self._answered(child)
        seconds = said.get("seconds", time.perf_counter() - start)
        outcome = replace(self._read(said), seconds=seconds, peak_bytes=child.peak_bytes)
        empty(self._directory)
        return outcome

    def _answered(self, child: Child) -> dict[str, Any]:
        """The answer to the request that was numbered last."""
        said: dict[str, Any]
        try:
            line, said = _line(child)
            check_json(said, "answer", f"the answer {_quoted(line)}")
        except AdapterError as error:
            raise Ended(Status.GARBAGE, str(error)) from error
        if said["id"] != self.number:
            other = f"it answered request {said['id']} when asked request {self.number}"
            raise Ended(Status.GARBAGE, other)
        return said

    def close(self) -> None:
        """Tell the program to stop."""
        if self._child is not None:
            with contextlib.suppress(Ended):  # It may have ended by itself: that is no matter.
                _tell(self._child, {"command": "stop"})
        super().close()

    def _written(self, request: Request) -> dict[str, Any]:
        """The request, its samples written to a file."""
        values = request.field.values
        solid = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        path = self._directory / "values.npy"
        np.save(path, solid)
        return {
            "command": "run",
            "id": self.number,
            "dtype": solid.dtype.str,
            "shape": solid.shape,
            "spacing": request.field.spacing,
            "isovalue": float(request.isovalue),
            "offset": path.stat().st_size - solid.nbytes,
            "values": str(path),
            "directory": str(self._directory),
            "case": request.case,
        }

    def _read(self, said: dict[str, Any]) -> Outcome:
        """What an answer says, its files read."""
        if "error" in said:
            return Outcome(Status.RAISED, detail=said["error"])
        if "unsupported" in said:
            return Outcome(Status.DECLINED, detail=said["unsupported"])
        try:
            vertices, faces = self._arrays(said)
        except AnswerError as error:
            return Outcome(error.status, detail=str(error))
        return Outcome(Status.OK, vertices, faces)

    def _arrays(self, said: dict[str, Any]) -> Arrays:
        """The arrays of an answer; raises `AnswerError`."""
        limit = self.limits.megabytes * MEGABYTE
        if "mesh" in said:
            return mesh_in(self._directory / said["mesh"], limit)
        pair = said["vertices"], said["faces"]
        if any(isinstance(part, str) for part in pair):
            vertices, faces = (self._directory / str(part) for part in pair)
            return arrays_in(vertices, faces, limit)
        if self.declaration.discipline == "surfaces":
            pair = _rows_of_three(pair[0]), _rows_of_three(pair[1])
        return arrays_from(pair)


def _rows_of_three(rows: list[Any]) -> Any:
    """The rows; where there are none, JSON cannot say that they would have three entries."""
    return rows or np.empty((0, 3), np.int64)


def _tell(child: Child, message: dict[str, Any]) -> None:
    """The message has been sent as one line."""
    child.write([json.dumps(message).encode() + b"\n"])


def _line(child: Child) -> tuple[bytes, Any]:
    """The next line, and the JSON in it; raises `AdapterError` or `Ended`."""
    line = child.read_line()
    try:
        return line, json.loads(line)
    except ValueError:
        raise AdapterError(f"stdout is for the protocol, but had {_quoted(line)}") from None


def _quoted(line: bytes) -> str:
    """The beginning of a line, in quotes."""
    text = line.decode(errors="replace")
    return repr(text if len(text) <= QUOTED else text[:QUOTED] + "..")
