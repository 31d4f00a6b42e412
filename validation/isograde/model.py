"""The grader's vocabulary: what goes in, what comes back, what is judged, what is said of it.

Data flows one way. A `Case` is m scalar fields on one n-dimensional lattice with m isovalues; it
goes through an `Adapter` as a `Request`; an `Outcome` comes back, a mesh of (n - m)-simplices; each
`Claim` judges a `Trial` (the case and the outcomes it asked for) and answers with a `Finding`,
which the report keeps.

Glossary
--------
implementation  the extractor under test, behind an adapter, in a process of its own
declaration     what it says of itself, in four words, conventions and limits
                (`isograde.declaration`)
kind            (n, m): contours are (2, 1), surfaces (3, 1), curves in which two isosurfaces meet
                (3, 2)
level           a rung of the ladder of guarantees (`LEVELS`)
promised        a failure of the claim is held against the implementation; every claim that can be
                judged is judged and shown, promised or not
evidence        a case on which the claim could fail: nothing holds without it
variant         a changed way to pose the same case (scaled values, mirrored axes, ..) whose
                answer is known from the plain one

The grader shares `Field` and `Mesh` with the reference, as words are shared, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as fresh
from enum import StrEnum
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from isoref.field import Field
from isoref.mesh import Mesh
from numpy.typing import NDArray

from isograde.declaration import Declaration

LEVELS: Mapping[int, tuple[str, str]] = {
    0: ("runs", "a well-formed mesh for every field within its limits, and known bodies come out"),
    1: ("closed", "closed within its domain, oriented, on the right side of the samples"),
    2: (
        "consistent",
        "manifold, without crossings, vertices where it says they are, every cell legal for its "
        "interpolant, the same answer however the field is posed",
    ),
    3: ("bilinear", "on every face of a cell the topology of the bilinear interpolant"),
    4: ("trilinear", "in every cell the topology of the trilinear interpolant"),
}


class Kind(NamedTuple):
    """What is extracted: the common level set of m fields on an n-dimensional lattice.

    >>> Kind(3, 1).k, str(Kind(3, 2)), str(Kind(4, 2))
    (2, 'curves', '(4, 2)')
    """

    n: int
    m: int

    @property
    def k(self) -> int:
        """The dimension of the simplices, n - m."""
        return self.n - self.m

    def __str__(self) -> str:
        return KINDS.get(self, f"({self.n}, {self.m})")


SURFACES = Kind(3, 1)
CONTOURS = Kind(2, 1)
CURVES = Kind(3, 2)
# The kinds that have a word of their own.
KINDS: Mapping[Kind, str] = {CONTOURS: "contours", SURFACES: "surfaces", CURVES: "curves"}


class Verdict(StrEnum):
    """What is said of one claim on one case. Nothing but PASS counts as a pass."""

    PASS = "pass"
    FAIL = "fail"
    UNSUPPORTED = "unsupported"  # the implementation says that it does not do this
    SKIP = "skip"  # the case is no evidence, or what it needs is absent here
    ERROR = "error"  # the implementation raised where it should have answered
    CRASH = "crash"  # its process died
    TIMEOUT = "timeout"  # it ran out of time or memory
    NOT_RUN = "not run"  # an earlier fault left nothing to judge


# Verdicts that say something went wrong; the rest say that nothing was seen, or all was well.
BAD = (Verdict.FAIL, Verdict.ERROR, Verdict.CRASH, Verdict.TIMEOUT)
# Verdicts of a case on which the claim could fail: evidence.
EVIDENCE = (Verdict.PASS, *BAD)
# How the detail begins where a judge itself failed, a fault of the grader.
JUDGE_FAULT = "the grader's judge failed"


@dataclass(frozen=True)
class Case:
    """m fields, m isovalues and what is known of the level set; built when it is needed.

    id : stable, slash-separated: "cells/outside/137", "bodies/surfaces/torus-33-uint8"
    build : the field, of m components; deterministic
    samples : number of lattice points, so that the smallest failure can be named without building
    tags : families it belongs to ("cells", "pairs", "noise", "bodies", "real", ..); "full" marks
        what only ``--full`` runs, "posed" what is posed in every way, "large" what need not be
        answered within the limits of a call
    facts : what is known, by name: "area", "volume", "euler", "components", ..
    only : globs on the ids of the claims that are judged on it; every claim where there is none
    function : what the samples are samples of, of n coordinates in the field's place, floats or
        arrays, where it is known; for who samples a function
    """

    id: str
    build: Callable[[], Field]
    isovalues: tuple[float, ...]
    samples: int
    tags: frozenset[str] = frozenset()
    facts: Mapping[str, Any] = fresh(default_factory=dict)
    kind: Kind = SURFACES
    only: tuple[str, ...] = ()
    function: Callable[..., Any] | None = None


# How a request is put: once, as most are; or, by adapters that call in their own process, so that
# other answers are made before the first is read ("kept"), again and again in one array that is
# written over in between ("again"), from several threads at once ("threads"), so many times that
# what is never given back shows ("many"), timed ("timed"), or by a process that gave back what it
# could before, so that what the call adds shows ("trimmed").
Calls = Literal["once", "kept", "again", "threads", "many", "timed", "trimmed"]


@dataclass(frozen=True)
class Request:
    """One question to the implementation, and how it is called.

    Of "threads" and "again" the answer that differs from the first comes back, where there is one;
    where time was too short for all of "again", the outcome's `detail` says so. Of "many" the
    outcome's `peak_bytes` are those by which the process grew; of "timed" its `seconds` are the
    processor's, the least of three calls. Who declares to be given a function gets `function`, or
    the interpolant of the samples where there is none.
    """

    case: str
    variant: str
    field: Field
    isovalues: tuple[float, ...]
    calls: Calls = "once"
    function: Callable[..., Any] | None = None

    @property
    def kind(self) -> Kind:
        """(n, m)."""
        return Kind(self.field.dimension, self.field.components)


class Status(StrEnum):
    """How a call ended."""

    OK = "ok"
    RAISED = "raised"
    DECLINED = "declined"  # it says that it does not do this case: verdict unsupported
    GARBAGE = "garbage"  # it answered with something that is no mesh
    CRASH = "crash"
    TIMEOUT = "timeout"
    MEMORY = "memory"


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came back from one call, already in the house's conventions.

    vertices, simplices : the arrays as they came (any numeric type), or None where status is not
        OK; polylines and polygons have become segments and triangles
    detail : the error's text, or what was wrong with the answer
    input_changed : the implementation wrote into the array it was given
    seconds, peak_bytes : cost of the call, as measured in the implementation's process
    processor : seconds of the processors, of all threads; None where that process does not tell
    normals : (V, n) what came beside them, a normal for each vertex, of curves a direction along
        them as long as the confidence in it; None where none came
    """

    status: Status
    vertices: NDArray[Any] | None = None
    simplices: NDArray[Any] | None = None
    detail: str = ""
    input_changed: bool = False
    seconds: float = 0.0
    peak_bytes: int = 0
    normals: NDArray[Any] | None = None
    processor: float | None = None

    @cached_property
    def mesh(self) -> Mesh | None:
        """The mesh, or None where there is none that can be judged beyond its structure."""
        if self.status is not Status.OK or self.vertices is None or self.simplices is None:
            return None
        shaped = self.vertices.ndim == 2 and self.simplices.ndim == 2
        numbers = self.vertices.dtype.kind in "fiu" and self.simplices.dtype.kind in "iu"
        if not shaped or not numbers or not np.isfinite(self.vertices).all():
            return None
        rows = self.simplices
        if rows.size and (rows.min() < 0 or rows.max() >= len(self.vertices)):
            return None
        return Mesh.of(self.vertices, rows)

    def mesh_of(self, kind: Kind) -> Mesh | None:
        """The mesh, where its simplices are of dimension n - m in n dimensions; else None."""
        mesh = self.mesh
        if mesh is None or mesh.vertices.shape[1] != kind.n or mesh.dimension != kind.k:
            return None
        return mesh


@dataclass(frozen=True, eq=False)
class Trial:
    """A case with the outcomes its claims asked for, by variant; "plain" is always there."""

    case: Case
    field: Field
    declaration: Declaration
    outcomes: Mapping[str, Outcome]
    # What one claim computed of this trial and another may need again, such as a mesh's facets.
    memory: dict[str, Any] = fresh(default_factory=dict)

    @property
    def plain(self) -> Outcome:
        """The outcome of the case as it stands."""
        return self.outcomes["plain"]

    @property
    def kind(self) -> Kind:
        """(n, m)."""
        return self.case.kind

    @property
    def isovalues(self) -> tuple[float, ...]:
        """One isovalue a component."""
        return self.case.isovalues

    @property
    def mesh(self) -> Mesh:
        """The plain outcome's mesh; judges of anything but structure are called only with one."""
        mesh = self.plain.mesh_of(self.kind)
        assert mesh is not None, "the runner calls this judge only where there is a mesh"
        return mesh


@dataclass(frozen=True)
class Finding:
    """What a judge says of one trial; `numbers` are the evidence, JSON values only."""

    verdict: Verdict
    detail: str = ""
    numbers: Mapping[str, Any] = fresh(default_factory=dict)


Judge = Callable[[Trial], Finding]


def every_kind(kind: Kind) -> bool:
    """A claim that can be said of every (n, m)."""
    del kind
    return True


def every_family(declaration: Declaration) -> bool:
    """A claim that can be said of every interpolant and every placing of vertices."""
    del declaration
    return True


@dataclass(frozen=True)
class Claim:
    """One sentence that is true or false of an implementation, and who decides it.

    id : family.name, stable
    rule : the sentence
    source : where the rule comes from (paper, section, equation)
    level : the rung of the ladder it belongs to, or None beside the ladder
    judge : decides a trial; PASS only where the trial could have failed, else SKIP
    kinds : the (n, m) it can be said of
    families : the declarations (interpolant, placing of vertices, ..) it can be said of
    tags : a case is judged when it has one of these (empty: every case)
    variants : the variants the judge compares with the plain outcome, as names or, ending in "/",
        as the beginning of names; one that the case's values do not allow is absent from the trial
    needs_mesh : False for judges that look at the raw outcome (structure, robustness)
    promised : it is promised by who says nothing; above the level promised (2 unless declared) and
        for claims of choice it is not
    firm : it cannot be taken out of the promise
    """

    id: str
    rule: str
    source: str
    level: int | None
    judge: Judge
    kinds: Callable[[Kind], bool] = every_kind
    families: Callable[[Declaration], bool] = every_family
    tags: frozenset[str] = frozenset()
    variants: tuple[str, ...] = ()
    needs_mesh: bool = True
    promised: bool = True
    firm: bool = False

    def applies_to(self, case: Case) -> bool:
        """The claim is judged on this case."""
        wanted = not case.only or any(fnmatchcase(self.id, glob) for glob in case.only)
        return wanted and self.kinds(case.kind) and (not self.tags or bool(self.tags & case.tags))

    def held(self, declaration: Declaration) -> bool:
        """A failure of the claim counts against who declares this."""
        return self.firm or declaration.promises(self.id, self.level, self.promised)


@dataclass(frozen=True)
class Limits:
    """What one call may cost."""

    seconds: float = 30.0
    megabytes: int = 4096


# An implementation in Python: a function of samples, isovalue (or isovalues) and spacing.
Extract = Callable[[NDArray[Any], Any, tuple[float, ...]], Any]


class AdapterError(RuntimeError):
    """The implementation did not start; the message says why and what to install or change."""


class UnknownName(AdapterError):  # noqa: N818 - a misspelt name, told as wrong use
    """There is nothing of this name: a mistake in the call, not in the implementation."""


class Adapter(Protocol):
    """A way to an implementation. Opened once, asked many times, survives what it runs."""

    def open(self, limits: Limits) -> Declaration:
        """Start the implementation; what it declares. Raises `AdapterError`."""
        ...

    def run(self, request: Request) -> Outcome:
        """The outcome of one call; never raises for what the implementation does."""
        ...

    def close(self) -> None:
        """Stop the implementation."""
        ...
