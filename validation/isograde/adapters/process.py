"""What adapters to a running process have in common: it is started, asked, and started again."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from abc import ABC, abstractmethod
from multiprocessing.util import get_temp_dir
from pathlib import Path
from typing import Any

from isoref.field import Field
from numpy.typing import NDArray

from isograde.adapters.child import Child, Ended
from isograde.adapters.conventions import refusal, to_house
from isograde.adapters.loading import called
from isograde.declaration import Declaration
from isograde.model import AdapterError, Limits, Outcome, Request, Status

# Imports may be slow on a busy machine, however short a call may be.
START_LIMITS = Limits(seconds=120.0, megabytes=4096)


def own_directory(adapter: object) -> Path:
    """A new folder that goes with the adapter, or with a process that is not let to say goodbye."""
    directory = Path(tempfile.mkdtemp(prefix="isograde-", dir=get_temp_dir()))
    weakref.finalize(adapter, shutil.rmtree, directory, ignore_errors=True)
    return directory


def empty(directory: Path) -> None:
    """The folder has nothing in it."""
    for path in directory.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


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
            return self._ask(self._child, request)
        except AdapterError as error:
            return Outcome(Status.CRASH, detail=f"it did not start again: {error}")
        except Ended as ended:
            assert self._child is not None
            self._child.kill()
            self._child = None
            return Outcome(ended.status, detail=str(ended))

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
