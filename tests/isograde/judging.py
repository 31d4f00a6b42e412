"""Functions judged as implementations are, by the runner's worker, in this process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import Any

import numpy as np
from isograde.adapters.conventions import to_house
from isograde.adapters.forms import AnswerError, arrays_from, normals_in
from isograde.adapters.loading import as_called
from isograde.adapters.worker import WAYS, Asked, Memory
from isograde.declaration import Declaration
from isograde.model import (
    Adapter,
    Case,
    Finding,
    Limits,
    Outcome,
    Request,
    Status,
    Verdict,
)
from isograde.runner import Task, Worker, claims_for
from numpy.typing import NDArray


class Here:
    """An adapter to a function of samples, isovalue (or isovalues) and spacing, in this process.

    The function is given each array as it lies in memory, and directions where a field has some.

    ways : in which it can be asked here, beside once (`isograde.model.Calls`)
    """

    def __init__(
        self, function: Callable[..., Any], declaration: Declaration, ways: Collection[str] = ()
    ):
        self.function = function
        self.declaration = declaration
        self.ways = ways

    def open(self, limits: Limits) -> Declaration:
        """Nothing to start."""
        return self.declaration

    def run(self, request: Request) -> Outcome:
        """The outcome of one call, or of the calls of one of `ways`."""
        if request.calls != "once":
            if request.calls in self.ways:
                return self._in_company(request)
            return Outcome(Status.DECLINED, detail="asked in the worker only")
        samples = as_it_lies(request.field.values)
        levels = request.isovalues
        try:
            with np.errstate(all="ignore"):
                level = levels[0] if len(levels) == 1 else levels
                more = {}
                if request.field.directions is not None:
                    more["directions"] = np.array(request.field.directions)
                answer = self.function(samples, level, request.field.spacing, **more)
            vertices, simplices = arrays_from(answer, request.kind)
            normals = normals_in(answer, request.kind)
        except NotImplementedError as error:
            return Outcome(Status.DECLINED, detail=str(error))
        except AnswerError as error:
            return Outcome(error.status, detail=str(error))
        except Exception as error:  # noqa: BLE001 - as an adapter would
            raised = Outcome(Status.RAISED, detail=str(error))
            return to_house(raised, request, self.declaration.conventions)
        real = samples.dtype.kind == "f"
        changed = not np.array_equal(samples, request.field.values, equal_nan=real)
        # The fault may keep its arrays and write to them again: judge what they were.
        arrays = vertices.copy(), simplices.copy()
        outcome = Outcome(Status.OK, *arrays, input_changed=changed, normals=normals)
        return to_house(outcome, request, self.declaration.conventions)

    def _in_company(self, request: Request) -> Outcome:
        """The outcome of several calls, put as the worker does; what is raised is let through."""
        places = request.isovalues, request.field.spacing
        call = as_called(self.function, 3)
        samples = as_it_lies(request.field.values)
        asked = Asked(call, samples, places, request.kind, Memory(), Limits().seconds)
        vertices, simplices, *_ = (part.copy() for part in WAYS[request.calls](asked))
        outcome = Outcome(Status.OK, vertices, simplices, detail=asked.told)
        return to_house(outcome, request, self.declaration.conventions)

    def close(self) -> None:
        """Nothing to stop."""


def as_it_lies(values: NDArray[Any]) -> NDArray[Any]:
    """A copy with the strides of the original, gaps and directions included.

    >>> as_it_lies(np.arange(12).reshape(3, 4)[::-1, ::2]).strides
    (-32, 16)
    """
    if not values.size:
        return values.copy()
    reach = [(n - 1) * s for n, s in zip(values.shape, values.strides, strict=True)]
    first = -sum(r for r in reach if r < 0)
    size = first + sum(r for r in reach if r > 0) + values.itemsize
    memory = np.zeros(size, np.uint8)
    copy: NDArray[Any] = np.ndarray(
        values.shape, values.dtype, memory, offset=first, strides=values.strides
    )
    copy[...] = values
    copy.flags.writeable = values.flags.writeable
    return copy


def grade(
    adapter: Adapter, asked: Iterable[Case], only: str = ""
) -> Iterator[tuple[str, str, Finding]]:
    """(case, claim, finding) of every claim of the family that applies to these cases.

    only : the beginning of the claims' ids
    """
    declared = adapter.open(Limits())
    claims = claims_for(declared)
    cases = {case.id: case for case in asked if case.kind in declared.limits.kinds}
    worker = Worker(adapter, declared, cases, claims)
    for case in cases.values():
        applying = tuple(
            claim.id
            for claim in claims.values()
            if claim.applies_to(case) and claim.id.startswith(only)
        )
        for name, finding in worker.judge(Task(case.id, applying)).findings.items():
            yield case.id, name, finding


def verdicts(
    function: Callable[..., Any], declaration: Declaration, asked: Iterable[Case], only: str = ""
) -> dict[str, Counter[Verdict]]:
    """How often each claim has each verdict on these cases, for a function in this process."""
    found: dict[str, Counter[Verdict]] = {}
    for _, name, finding in grade(Here(function, declaration), asked, only):
        found.setdefault(name, Counter())[finding.verdict] += 1
    return found
