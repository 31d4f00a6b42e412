"""Functions judged as implementations are, by the runner's worker, in this process."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from isograde.adapters.conventions import to_house
from isograde.disciplines.registry import discipline
from isograde.model import (
    Adapter,
    Case,
    Conventions,
    Declaration,
    Finding,
    Limits,
    Outcome,
    Request,
    Status,
)
from isograde.runner import Task, Worker


class Here:
    """An adapter to a function, as `through_adapter` makes it, trusted not to crash."""

    def __init__(self, function: Callable[[Any, float, tuple[float, ...]], Any], kind: str):
        self.function = function
        self.kind = kind

    def open(self, limits: Limits) -> Declaration:
        """Nothing to start."""
        return Declaration("here", discipline=self.kind)

    def run(self, request: Request) -> Outcome:
        """The outcome of one call."""
        samples = np.asarray(request.field.values)
        try:
            answer = self.function(samples, request.isovalue, request.field.spacing)
        except NotImplementedError as error:
            return Outcome(Status.DECLINED, detail=str(error))
        except Exception as error:  # noqa: BLE001 - as an adapter would
            return Outcome(Status.RAISED, detail=str(error))
        return to_house(Outcome(Status.OK, *answer), request, Conventions())

    def close(self) -> None:
        """Nothing to stop."""


def grade(
    adapter: Adapter, declaration: Declaration, asked: Iterable[Case]
) -> Iterator[tuple[str, str, Finding]]:
    """(case, claim, finding) of every claim of the discipline that applies to these cases."""
    told = discipline(declaration.discipline)
    cases = {case.id: case for case in asked}
    worker = Worker(adapter, declaration, cases, told.claims, told.pose)
    for case in cases.values():
        applying = tuple(claim.id for claim in told.claims.values() if claim.applies_to(case))
        for claim, finding in worker.judge(Task(case.id, applying)).findings.items():
            yield case.id, claim, finding
