"""The grader's vocabulary: what goes in, what comes back, what is judged, what is said of it.

Data flows one way. A `Case` is a field with an isovalue; it goes through an `Adapter` as a
`Request`, an `Outcome` comes back; each `Claim` judges a `Trial` (the case and the outcomes it
asked for) and answers with `Finding`, which the report keeps.

Glossary
--------
implementation  the extractor under test, behind an adapter, in a process of its own
discipline      the kind of thing it makes: surfaces, contours, curves, simplices
level           what an implementation promises (`LEVELS`); a claim of a higher level is judged
                and shown, but not held against it
variant         a changed way to pose the same case (scaled values, mirrored axes, ..) whose
                answer is known from the plain one
vector          a case with frozen numbers and a stable id

The grader shares `Field` and `Mesh` with the reference, as words are shared, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as fresh
from enum import StrEnum
from functools import cached_property
from typing import Any, Literal, Protocol

import numpy as np
from isoref.field import Field
from isoref.mesh import Mesh
from numpy.typing import NDArray

LEVELS: Mapping[int, tuple[str, str]] = {
    0: ("runs", "gives a well-formed mesh for every field"),
    1: ("watertight", "closed, manifold, oriented, separates inside from outside samples"),
    2: ("consistent", "every cell is legal; the same answer however the field is presented"),
    3: ("bilinear", "faces are connected as the bilinear interpolant connects them"),
    4: ("trilinear", "the topology of the trilinear interpolant in every cell"),
}


class Verdict(StrEnum):
    """What is said of one claim on one case. Nothing but PASS counts as a pass."""

    PASS = "pass"
    FAIL = "fail"
    UNSUPPORTED = "unsupported"  # the implementation declares that it does not do this
    SKIP = "skip"  # what the case needs is absent here (a volume, a package)
    ERROR = "error"  # the implementation raised where it should have answered
    CRASH = "crash"  # its process died
    TIMEOUT = "timeout"  # it ran out of time or memory
    NOT_RUN = "not run"  # an earlier fault left nothing to judge


@dataclass(frozen=True)
class Conventions:
    """How an implementation differs from the house's conventions; the defaults are the house's.

    tie : side on which a sample equal to the isovalue counts
    normals : where right-hand normals point, in the implementation's own coordinates
    axes : order of a vertex's coordinates: of the array's axes, or reversed
    units : vertices scaled by the spacing, or counted in samples
    nan : what a sample that is not a number does: an error, or something else
    empty : what a field without a surface gives: an empty mesh, or an error
    """

    tie: Literal["inside", "outside"] = "inside"
    normals: Literal["to_low", "to_high"] = "to_low"
    axes: Literal["array", "reversed"] = "array"
    units: Literal["world", "index"] = "world"
    nan: Literal["raises", "answers"] = "raises"
    empty: Literal["mesh", "raises"] = "mesh"


@dataclass(frozen=True)
class Declaration:
    """What an implementation says of itself."""

    name: str
    version: str = ""
    level: int = 2
    conventions: Conventions = Conventions()
    discipline: str = "surfaces"
    # Properties it does not promise, each named by a claim's `unless`: "welded" (faces share
    # vertices), "manifold", "spacing", "on-edges", "linear-crossing", "symmetric-choices", ..
    without: frozenset[str] = frozenset()
    notes: str = ""
    # How it resolves every ambiguous face, where it promises that: "disconnect" the inside
    # corners, "connect" them, or "mixed", by the average of the face (`cases.cycles`).
    connectivity: str = ""
    # What it answers for two surfaces that are the same, where it promises that: "nothing".
    identical: str = ""


@dataclass(frozen=True)
class Case:
    """A field, an isovalue and what is known of the surface; built when it is needed.

    id : stable, slash-separated: "cells/outside/137", "analytic/sphere-32"
    build : the field; deterministic
    tags : families it belongs to ("cells", "pairs", "noise", "analytic", "real", "ties", ..);
        "full" marks what only ``--full`` runs
    facts : known truths, by name: "area", "volume", "euler", "components", ..
    samples : number of samples, so that the smallest failure can be named without building
    """

    id: str
    build: Callable[[], Field]
    isovalue: float
    samples: int
    tags: frozenset[str] = frozenset()
    facts: Mapping[str, Any] = fresh(default_factory=dict)


@dataclass(frozen=True)
class Request:
    """One call of the implementation."""

    case: str
    variant: str
    field: Field
    isovalue: float


class Status(StrEnum):
    """How a call ended."""

    OK = "ok"
    RAISED = "raised"
    DECLINED = "declined"  # it said that it does not do this case: verdict unsupported
    GARBAGE = "garbage"  # it answered with something that is no pair of arrays
    CRASH = "crash"
    TIMEOUT = "timeout"
    MEMORY = "memory"


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came back from one call, already in the house's conventions.

    vertices, faces : the arrays as they came (any numeric type), or None where status is not OK
    detail : the error's text, or what was wrong with the answer
    input_changed : the implementation wrote into the array it was given
    seconds, peak_bytes : cost of the call, as measured in the implementation's process
    """

    status: Status
    vertices: NDArray[Any] | None = None
    faces: NDArray[Any] | None = None
    detail: str = ""
    input_changed: bool = False
    seconds: float = 0.0
    peak_bytes: int = 0

    @cached_property
    def mesh(self) -> Mesh | None:
        """The mesh, or None where there is none that can be judged beyond its structure."""
        if self.status is not Status.OK or self.vertices is None or self.faces is None:
            return None
        shaped = self.vertices.ndim == 2 and self.faces.ndim == 2
        numbers = self.vertices.dtype.kind in "fiu" and self.faces.dtype.kind in "iu"
        if not shaped or not numbers or not np.isfinite(self.vertices).all():
            return None
        if self.faces.size and (self.faces.min() < 0 or self.faces.max() >= len(self.vertices)):
            return None
        return Mesh.of(self.vertices, self.faces)


@dataclass(frozen=True, eq=False)
class Trial:
    """A case with the outcomes its claims asked for, by variant; "plain" is always there."""

    case: Case
    field: Field
    declaration: Declaration
    outcomes: Mapping[str, Outcome]
    # What one claim computed of this trial and another may need again, such as a mesh's edges.
    memory: dict[str, Any] = fresh(default_factory=dict)

    @property
    def plain(self) -> Outcome:
        """The outcome of the case as it stands."""
        return self.outcomes["plain"]

    @property
    def mesh(self) -> Mesh:
        """The plain outcome's mesh; judges of anything but structure are called only with one."""
        mesh = self.plain.mesh
        assert mesh is not None, "the runner calls this judge only where there is a mesh"
        return mesh


@dataclass(frozen=True)
class Finding:
    """What a judge says of one trial; `numbers` are the evidence, JSON values only."""

    verdict: Verdict
    detail: str = ""
    numbers: Mapping[str, Any] = fresh(default_factory=dict)


Judge = Callable[[Trial], Finding]


@dataclass(frozen=True)
class Claim:
    """One sentence that is true or false of an implementation, and who decides it.

    id : family.name, stable
    rule : the sentence
    source : where the rule comes from (paper, section, equation)
    level : the rung of the ladder it belongs to, or None beside the ladder
    weld : which vertices count as one: "as given", or "exact" (equal coordinates)
    judge : decides a trial
    tags : a case is judged when it has one of these (empty: every case)
    variants : the variants the judge compares with the plain outcome; one that the case's
        values do not allow (see `isograde.variants`) is absent from the trial
    needs_mesh : False for judges that look at the raw outcome (structure, robustness)
    unless : a declaration's `without` entry that makes this claim unsupported
    """

    id: str
    rule: str
    source: str
    level: int | None
    judge: Judge
    weld: Literal["as given", "exact"] = "as given"
    tags: frozenset[str] = frozenset()
    variants: tuple[str, ...] = ()
    needs_mesh: bool = True
    unless: frozenset[str] = frozenset()
    discipline: str = "surfaces"

    def applies_to(self, case: Case) -> bool:
        """The claim is judged on this case."""
        return not self.tags or bool(self.tags & case.tags)


@dataclass(frozen=True)
class Limits:
    """What one call may cost."""

    seconds: float = 30.0
    megabytes: int = 4096


# An implementation in Python: a function of samples, isovalue and spacing (`adapters.loading`).
Extract = Callable[[NDArray[Any], float, tuple[float, ...]], Any]


class AdapterError(RuntimeError):
    """The implementation did not start; the message says why and what to install or change."""


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
