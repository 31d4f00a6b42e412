"""The adapter to programs in any language: ``exec:command``.

``isograde new LANGUAGE DIR`` writes a program that has all of this, to start from; what follows is
for any other language. The command is one line for the shell, so a pipeline is a command too. It
speaks JSON as the standard has it, one object a line (``isograde explain protocol`` prints the
schema of every field); arrays stand in files.

It reads from standard input, and answers on standard output::

    {"command": "start", "protocol": 3}
        {"protocol": 3, "declaration": {"name": "mine", "level": 1}}
    {"command": "run", "id": 7, "dtype": "<f8", "shape": [4, 4, 4], "components": 1,
     "spacing": [1.0, 1.0, 1.0], "isovalues": [0.5], "offset": 128, "values": "/tmp/x/values.npy",
     "directory": "/tmp/x", "case": "noise/7"}
        {"id": 7, "vertices": [[0.5, 0.0, 0.0], ..], "simplices": [[0, 1, 2], ..]}
    {"command": "stop"}

An answer returns the ``id`` of its request, so that no answer can pass for another's. Each request
is one line, its keys always in this order, with one blank after each colon and comma: a program
without a JSON library can read it with one ``sscanf``.

The shape has n numbers. The samples are in C order, the last axis fastest, little-endian, from byte
``offset`` of a .npy file; where there are several components, all samples of the first come before
those of the second, and there are as many isovalues. ``dtype`` is one of |b1, |i1, |u1, <i2, <u2,
<i4, <u4, <i8, <u8, <f2, <f4, <f8: bool, signed and unsigned whole numbers and floats, with their
bytes. Vertices are ``index * spacing`` in the order of the array's axes unless the declaration says
otherwise; the grader adds the origin. Which way round simplices are is said in ``isograde explain
python``.

A program whose declaration has the limit ``"directions": true`` also gets fields with one more key,
the last: ``"directions"``, n rows, for each axis of the array the unit vector along which it runs.
Vertices are then ``index * spacing @ directions``.

Simplices are rows of n - m + 1 indices, counted from 0; for surfaces ``"faces"`` is another name
for them. In their place an answer may have

polygons        rows of more than three indices, of one length or of several
polylines       ``"polylines": [[[0.5, 0.0], ..], ..]``; a closed one repeats its first point
.npy files      ``"vertices": "v.npy", "simplices": "s.npy"``; a line has at most 256 megabytes
a mesh file     ``"mesh": "surface.off"`` (.ply, .obj, .off, .stl)
a JSON file     ``"answer": "answer.json"``, which has the vertices and simplices, or polylines

Names of files start at ``directory``.

Refusals, errors, bad input
---------------------------
A field that the program does not take is refused: ``{"id": 7, "unsupported": "cubes only"}``. That
is counted as unsupported, and is no failure. What the declaration's ``limits`` refuse is never
sent. Where something went wrong, it says so: ``{"id": 7, "error": "the isovalue is no number"}``.

Bad input is sent on purpose, to see what is said of it: an isovalue ``"NaN"`` (infinite ones are
``"Infinity"`` and ``"-Infinity"``), samples that are NaN, a shape with an axis of 0 samples or with
one number less than ``spacing``. An error is the right answer; what comes instead is shown, and
held only against who promises otherwise.

JSON knows no NaN or Infinity: a coordinate that is not finite is ``null``.

Standard output belongs to the protocol: any other line on it, and an answer to another request, is
garbage: it costs the case, and the program is started again. Messages for people go to standard
error, which is kept. Where a program, or a library in it, writes to standard output, give the
protocol a descriptor of its own in the command, here 3, and let the program answer on that, or in
the file ``/dev/fd/3``::

    exec:mine --answers 3 3>&1 1>&2

The program runs until it is told to stop or its input ends; remember to flush after each line.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import replace
from typing import Any

import numpy as np

from isograde.adapters.answers import arrays_said
from isograde.adapters.child import MEGABYTE, Child, Ended
from isograde.adapters.conventions import is_field
from isograde.adapters.forms import AnswerError
from isograde.adapters.process import ProcessAdapter, samples
from isograde.adapters.protocol import check_json, declared, form_of
from isograde.adapters.strict import NotJSON, isovalue, parse, written
from isograde.declaration import Declaration
from isograde.model import AdapterError, Outcome, Request, Status

PROTOCOL = 3
OLD = {
    1: "it speaks protocol 1; since then each answer returns the id of its request",
    2: "it speaks protocol 2; since then requests have isovalues and components",
}
# How much of a line that is no answer a report quotes.
QUOTED = 120
# Megabytes a line may have: some five million triangles. More stands in .npy files.
LONGEST = 256


class ExecAdapter(ProcessAdapter):
    """A program that speaks the protocol of this module; `spec` is ``exec:command``."""

    def _spawn(self) -> Child:
        """The program, run by the shell."""
        return Child(self.spec.removeprefix("exec:"))

    def _greet(self, child: Child) -> Declaration:
        """What the program declares."""
        _tell(child, {"command": "start", "protocol": PROTOCOL})
        line, said = _line(child)
        if not isinstance(said, dict):
            raise AdapterError(f"{self.spec}: the answer {_quoted(line)} is not an object")
        spoken = said.get("protocol")
        if isinstance(spoken, int) and spoken in OLD:
            raise AdapterError(f"{self.spec}: {OLD[spoken]}, and that is protocol {PROTOCOL}")
        declaration = declared(said.get("declaration", {}), self.spec)
        check_json(said, "started", f"the answer {_quoted(line)}")
        if declaration.given == "function":
            raise AdapterError(
                f"{self.spec}: a program is sent samples; let it make a function of them, declare "
                "its vertices as its own, and leave out given"
            )
        return declaration

    def _ask(self, child: Child, request: Request) -> Outcome:
        """What the program answered; garbage ends it, for it may be out of step."""
        if rest := child.unread():
            raise Ended(Status.GARBAGE, f"stdout held {_quoted(rest)} before the request")
        _tell(child, self._written(request))
        start = time.perf_counter()
        said = self._answered(child)
        seconds = said.get("seconds", time.perf_counter() - start)
        outcome = replace(self._read(said, request), seconds=seconds, peak_bytes=child.peak_bytes)
        self.tidy()
        return outcome

    def _answered(self, child: Child) -> dict[str, Any]:
        """The answer to the request that was numbered last."""
        said: dict[str, Any]
        try:
            line, said = _line(child, min(LONGEST, self.limits.megabytes) * MEGABYTE)
            check_json(said, form_of(said), f"the answer {_quoted(line)}")
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
        field = request.field
        values = samples(field)
        solid = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        path = self.exchange.path / "values.npy"
        np.save(path, solid)
        several = is_field(field) and values.ndim > field.dimension
        message = {
            "command": "run",
            "id": self.number,
            "dtype": solid.dtype.str,
            "shape": solid.shape[several:],
            "components": len(solid) if several else 1,
            "spacing": field.spacing,
            "isovalues": [isovalue(one) for one in request.isovalues],
            "offset": path.stat().st_size - solid.nbytes,
            "values": str(path),
            "directory": str(self.exchange.path),
            "case": request.case,
        }
        if field.directions is not None:
            message["directions"] = field.directions
        return message

    def _read(self, said: dict[str, Any], request: Request) -> Outcome:
        """What an answer says, its files read."""
        if "error" in said:
            return Outcome(Status.RAISED, detail=said["error"])
        if "unsupported" in said:
            return Outcome(Status.DECLINED, detail=said["unsupported"])
        limit = self.limits.megabytes * MEGABYTE
        try:
            vertices, simplices = arrays_said(said, self.exchange.path, limit, request.kind)
        except AnswerError as error:
            return Outcome(error.status, detail=str(error))
        return Outcome(Status.OK, vertices, simplices)


def _tell(child: Child, message: dict[str, Any]) -> None:
    """The message has been sent as one line."""
    child.write([written(message).encode("utf-8", "surrogateescape") + b"\n"])


def _line(child: Child, limit: int = MEGABYTE) -> tuple[bytes, Any]:
    """The next line, of so many bytes at most, and its JSON; raises `AdapterError` or `Ended`."""
    line = child.read_line(limit)
    try:
        return line, parse(line)
    except NotJSON as error:
        told = f"stdout is for the protocol, and its line {_quoted(line)} is {error}"
        raise AdapterError(told) from None


def _quoted(line: bytes) -> str:
    """The beginning of a line, in quotes."""
    text = line.decode(errors="replace")
    return repr(text if len(text) <= QUOTED else text[:QUOTED] + "..")
