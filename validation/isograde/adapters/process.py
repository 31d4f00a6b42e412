"""What adapters to a running process have in common: it is started, asked, and started again."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any

from isoref.field import Field
from numpy.typing import NDArray

from isograde.adapters.child import Child, Ended
from isograde.adapters.conventions import refusal, to_house
from isograde.adapters.exchange import FULL, Exchange, TemporaryFull
from isograde.adapters.loading import called
from isograde.adapters.texts import clean
from isograde.declaration import Declaration
from isograde.model import AdapterError, Limits, Outcome, Request, Status

# Imports may be slow on a busy machine, however short a call may be.
START_LIMITS = Limits(seconds=120.0, megabytes=4096)


def samples(field: Field) -> NDArray[Any]:
    """The samples as they are sent: without an axis for a single component.

    >>> samples(Field.of([[[1.0, 2.0]]], dimension=2)).shape
    (1, 2)
    """
    single = field.values.ndim == field.dimension + 1 and len(field.values) == 1
    values: NDArray[Any] = field.values[0] if single else field.values
    return values


class ProcessAdapter(ABC):
    """An implementation in a process that is reused, and replaced when it died or was killed.

    `number` counts the requests. An answer has to return it, so that one that comes late, or twice,
    cannot pass for the answer to the next request.

    `calls` says that it can put a request in other ways than once (`isograde.model.Calls`).
    """

    calls = False

    def __init__(self, spec: str):
        self.spec = spec
        self.limits = Limits()
        self.declaration = Declaration(spec)
        self.number = 0
        self.exchange = Exchange()
        self._child: Child | None = None

    @abstractmethod
    def _spawn(self) -> Child:
        """A process that has not been spoken to."""

    @abstractmethod
    def _greet(self, child: Child) -> Declaration:
        """What the implementation declares at its start; raises `AdapterError` or `Ended`."""

    @abstractmethod
    def _ask(self, child: Child, request: Request) -> Outcome:
        """The outcome of one call, as it came; raises `Ended` where the process is lost."""

    def open(self, limits: Limits) -> Declaration:
        """Start the implementation; what it declares. Raises `AdapterError`."""
        self.limits = limits
        self._child = self._start()
        return self.declaration

    def run(self, request: Request) -> Outcome:
        """The outcome of one call, in the house's conventions."""
        return to_house(self.answer(request), request, self.declaration.conventions)

    def answer(self, request: Request) -> Outcome:
        """The outcome of one call, as it came; nothing is sent that the limits refuse."""
        if reason := refusal(request, self.declaration):
            return Outcome(Status.DECLINED, detail=reason)
        if request.calls != "once" and not self.calls:
            return Outcome(Status.DECLINED, detail="it answers one question at a time")
        try:
            self._child = self._child or self._start()
            self._child.allow(self.limits)
            self.number += 1
            return self._checked(self._ask(self._child, request))
        except AdapterError as error:
            return Outcome(Status.CRASH, detail=f"it did not start again: {error}")
        except Ended as ended:
            assert self._child is not None
            self._child.kill()
            self._child = None
            self.exchange.intact()
            return self._checked(Outcome(ended.status, detail=str(ended)))
        except OSError as error:
            if error.errno in FULL:
                raise TemporaryFull.of(self.exchange.path.parent) from error
            raise

    def _checked(self, outcome: Outcome) -> Outcome:
        """The outcome, its text fit for a report; raises `TemporaryFull`."""
        if outcome.status not in (Status.OK, Status.DECLINED) and self.exchange.full():
            raise TemporaryFull.of(self.exchange.path.parent)
        told = clean(outcome.detail)
        return outcome if told == outcome.detail else replace(outcome, detail=told)

    def tidy(self) -> None:
        """The folder for files is empty; raises `Ended` where the implementation replaced it."""
        self.exchange.empty()
        if not self.exchange.intact():
            told = "it removed the folder in which files are exchanged, or put another in its place"
            raise Ended(Status.GARBAGE, told)

    def said(self) -> tuple[str, str]:
        """The end of what the implementation printed beside the protocol: to stdout, to stderr."""
        return (self._child.said("prints"), self._child.said()) if self._child else ("", "")

    def close(self) -> None:
        """Stop the implementation."""
        if self._child is not None:
            self._child.finish()
            self._child = None

    def _start(self) -> Child:
        """A process that answered the greeting; raises `AdapterError`."""
        child = self._spawn()
        child.allow(START_LIMITS)
        try:
            self.declaration = self._greet(child)
        except Ended as ended:
            child.kill()
            raise AdapterError(f"{called(self.spec)} did not start: {ended}") from ended
        except AdapterError:
            child.kill()
            raise
        return child
