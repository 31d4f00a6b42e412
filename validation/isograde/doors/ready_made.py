"""Doors to the libraries people use, and to the reference, under short names.

Each library is loaded only in the worker process that runs it. Conventions are declared as
measured (`isograde.doors.measure`); a test holds each declaration to the measurement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field as fresh
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from isoref.field import Field
from isoref.methods import METHODS
from numpy.typing import NDArray

from isograde.doors.loading import Extract
from isograde.model import Conventions, Declaration

Values = NDArray[Any]
Spacing = tuple[float, ...]


@dataclass(frozen=True)
class ReadyMade:
    """An implementation that has a short name.

    load : imports the library; the function to call and the library's version
    install : what to do where the import fails
    """

    load: Callable[[], tuple[Extract, str]]
    install: str
    conventions: Conventions = fresh(default_factory=Conventions)
    level: int = 2
    without: frozenset[str] = fresh(default_factory=frozenset)
    notes: str = ""

    def declaration(self, name: str, version: str) -> Declaration:
        """What it declares."""
        return Declaration(
            name, version, self.level, self.conventions, without=self.without, notes=self.notes
        )


def _version(distribution: str) -> str:
    """The installed version, or "source" where the code is used without being installed."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "source"


def _skimage(method: str) -> tuple[Extract, str]:
    """`skimage.measure.marching_cubes` with this method."""
    from skimage.measure import marching_cubes

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        return marching_cubes(values, isovalue, spacing=spacing, method=method)[:2]

    return extract, _version("scikit-image")


def _isoref(name: str) -> tuple[Extract, str]:
    """The method of the reference with this name."""
    method = METHODS[name]

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        mesh = method(Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    return extract, _version("isograde")


_SKIMAGE = Conventions(tie="outside", normals="to_high", nan="answers", empty="raises")

READY_MADE: dict[str, ReadyMade] = {
    f"skimage:{method}": ReadyMade(partial(_skimage, method), "pip install scikit-image", _SKIMAGE)
    for method in ("lewiner", "lorensen")
} | {f"isoref:{name}": ReadyMade(partial(_isoref, name), "reinstall isograde") for name in METHODS}
