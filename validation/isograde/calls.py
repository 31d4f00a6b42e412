"""The grader from Python: `grade`, `check`, `compare` and `extract`, as `import isograde` has them.

An implementation is a function ``extract(values, isovalue, spacing)`` (`isograde explain python`
says more), or a name as the command takes it. A function of a notebook or of a script will do: it
is sent with its code to the process in which it runs.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from isoref.attributes import filled
from isoref.field import Field
from isoref.label_cubes import one_label
from isoref.mesh import Mesh
from isoref.methods import METHODS, surface
from numpy.typing import ArrayLike

from isograde import checking, grading, progress
from isograde.adapters.functions import Implementation, name_of, named
from isograde.checking import Checked
from isograde.commands.console import close_to
from isograde.commands.volumes import present, stored_named
from isograde.expectations import Given, expectations
from isograde.formats.reading import Asked
from isograde.model import Limits
from isograde.report import comparison, reading
from isograde.results import Comparison, Grade
from isograde.runner import Options, processors


def grade(
    implementation: Implementation,
    *,
    only: str | Sequence[str] = (),
    full: bool = False,
    seed: int = 0,
    timeout: float = 30.0,
    memory: int = 4096,
    jobs: int | None = None,
    expected_failures: Given = None,
    strict: bool = False,
    show_progress: bool | None = None,
) -> Grade:
    """What is true of an implementation, with the smallest case that breaks each claim.

    Parameters
    ----------
    implementation : a function of samples, isovalue and spacing, or a name such as
        "skimage:lewiner", "python:module:function", "exec:./program", "dir:folder"
    only : an id of claims or cases, or a glob of them, or several; empty for all
    full : every case, and many more in every way
    seed : other numbers under the same ids
    timeout, memory : seconds and megabytes a call may take, at least 0.01 and 16
    jobs : processes; by default as many as processors
    expected_failures : reasons by claim, or a file that ``--write-expect`` wrote; what is
        expected to fail does not count, except on known bodies
    strict : a promised claim without evidence counts as a failure, and so does an expected failure
        that does not happen
    show_progress : by default on a terminal and in a notebook

    Raises
    ------
    AdapterError
        where the implementation does not start; `UnknownName`, which is one, where nothing has
        this name.
    NothingToRun
        where no case and claim match `only`.
    ExpectationError
        where `expected_failures` name no claim, or a known body.
    ValueError
        for a number out of its range.

    >>> found = grade("isoref:lorensen-cline", only=["pairs/0217", "topology.closed"])
    >>> found.failures["topology.closed"].partition(": ")[2][:48]
    '4 edges inside the domain belong to one simplex '
    >>> found.holds
    False
    """
    _check_seconds(timeout)
    for name, number, least in (("seed", seed, 0), ("memory", memory, 16), ("jobs", jobs, 1)):
        if number is not None and not (isinstance(number, int) and number >= least):
            raise ValueError(f"{name}={number!r}: give a whole number of at least {least}")
    limits, expected = Limits(timeout, memory), expectations(expected_failures)
    wanted = (only,) if isinstance(only, str) else tuple(only)
    options = Options(seed, full, wanted, limits, processors() if jobs is None else jobs)
    title = implementation if isinstance(implementation, str) else name_of(implementation)
    with (
        named(implementation) as spec,
        tempfile.TemporaryDirectory(prefix="isograde-") as folder,
        progress.progress(title, show_progress) as watch,
    ):
        path = Path(folder) / "report.jsonl"
        report = grading.grade(spec, options, path, watch=watch, expected=expected)
        return Grade(report, strict)


def check(implementation: Implementation, *, timeout: float = 10.0) -> Checked:
    """What the call to an implementation does wrong, in a few seconds, with advice on each mistake.

    `timeout` is in seconds a call; errors are those of `grade`.

    >>> print(check("skimage:levine"))
          error  no implementation 'skimage:levine'; did you mean skimage:lewiner?
    """
    _check_seconds(timeout)
    with named(implementation) as spec:
        return checking.check(spec, timeout)


def _check_seconds(timeout: float) -> None:
    """Raise ValueError unless this is a number of seconds that a call can take."""
    if not (isinstance(timeout, int | float) and 0.01 <= timeout < math.inf):
        raise ValueError(f"timeout={timeout!r}: give seconds, at least 0.01")


def compare(*implementations: Implementation | PathLike[str] | Grade, **options: Any) -> Comparison:
    """Implementations side by side, the best first.

    Each is a result of `grade`, the path of a report (a file, or the folder of one), or what
    `grade` takes; it is then graded with these `options`. Raises what `grade` raises, `ReportError`
    for a file that is no report, and `ValueError` for reports of unlike plans, whose differences
    might be the grader's.

    >>> compare("isoref:lorensen-cline", "isoref:asymptotic-decider", only=["pairs/0217"]).ranking
    ['isoref:asymptotic-decider', 'isoref:lorensen-cline']
    """
    if not implementations:
        raise TypeError("compare needs an implementation, a report, or several")
    grades = tuple(_graded(one, options) for one in implementations)
    if told := comparison.unlike([one.report for one in grades]):
        raise ValueError(told)
    return Comparison(grades)


def _graded(one: Implementation | PathLike[str] | Grade, options: dict[str, Any]) -> Grade:
    """The result of what is one, the report of what is a path, or what grading finds."""
    if isinstance(one, Grade):
        return one
    if isinstance(one, PathLike) or (isinstance(one, str) and Path(one).exists()):
        path = Path(one)
        return Grade(reading.read(path / "report.jsonl" if path.is_dir() else path))
    return grade(one, **options)


def extract(
    volume: ArrayLike | str | PathLike[str],
    isovalue: float | None = None,
    *,
    label: float | None = None,
    method: str | None = None,
    spacing: Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    cap: bool = False,
    absent: bool = False,
) -> Mesh:
    """The isosurface of a volume by one of the reference's methods, where the volume stands.

    Vertices are in the file's own coordinates: RAS for NIfTI, LPS for DICOM and what ITK wrote.

    Parameters
    ----------
    volume : samples (N1, N2, N3), the path of a file, or the name of a known data set
    isovalue : a sample of at least this value is inside
    label : in place of an isovalue: samples that are this number are inside
    method : a key of `isoref.METHODS`; by default "asymptotic-decider", for labels "label-cubes"
    spacing, origin : of an array; a file has its own
    cap : close the surface on the border of the volume, and beside absent samples
    absent : samples that are not finite, or masked, do not count, and are no error

    Raises
    ------
    ValueError
        for an unknown method, samples that are no field, a label that no sample has, or not one of
        isovalue and label.
    VolumeError
        for a file that cannot be read, or a data set that is not here.

    >>> import numpy as np
    >>> x = np.indices((9, 9, 9)) - 4.0
    >>> extract(9 - (x * x).sum(axis=0), 0.0).simplices.shape
    (344, 3)
    """
    if (isovalue is None) == (label is None):
        raise ValueError("give an isovalue, or a label in its place")
    if method is not None and method not in METHODS:
        raise ValueError(f"no method {method!r}; {close_to(method, METHODS)}")
    if not isinstance(volume, str | PathLike):
        samples, gone = filled(volume) if absent else (volume, None)
        field = Field.of(samples, spacing, origin)
    elif spacing is not None or origin is not None:
        raise ValueError("a file has its own spacing and origin")
    else:
        stored = stored_named(str(volume), Asked(absent=absent))
        field, gone = present(stored) if absent else (stored.field, None)
    if label is not None:
        posed, level, usual = one_label(field, label), 0.0, "label-cubes"
    else:
        assert isovalue is not None
        posed, level, usual = field, isovalue, "asymptotic-decider"
    return surface(posed, level, method or usual, cap=cap, absent=gone)
