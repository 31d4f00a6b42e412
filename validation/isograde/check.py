"""A smoke test of an adapter in a second or two, with advice on each mistake.

It asks for one small surface whose place, facing and size are known, looks at the arrays that come
back, measures the conventions, and tries the ways in which an array can be presented. What it finds
is about the adapter, not about the algorithm: that is what grading is for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.adapters import open_adapter
from isograde.adapters.directory import DirectoryAdapter
from isograde.adapters.measure import LEVEL, ball, measure
from isograde.adapters.process import ProcessAdapter
from isograde.model import (
    LEVELS,
    AdapterError,
    Conventions,
    Declaration,
    Limits,
    Outcome,
    Request,
    Status,
    Verdict,
)

Advice = tuple[Verdict, str]
Array = NDArray[Any]

# Disciplines whose small cases are judged, instead of conventions measured; and how many.
OTHERS = ("contours", "curves", "simplices")
BESIDE = 6
SHORT = Limits(seconds=10.0, megabytes=4096)

ENDED: dict[Status, tuple[Verdict, str]] = {
    Status.RAISED: (Verdict.ERROR, "it raised on a plain field of 5 x 6 x 7 float64 samples"),
    Status.DECLINED: (
        Verdict.UNSUPPORTED,
        "it declined a plain field of 5 x 6 x 7 float64 samples",
    ),
    Status.GARBAGE: (Verdict.FAIL, "its answer is no pair of vertices (V, 3), faces (F, 3)"),
    Status.CRASH: (Verdict.CRASH, "its process died"),
    Status.TIMEOUT: (Verdict.TIMEOUT, "it did not answer a field of 5 x 6 x 7 samples in time"),
    Status.MEMORY: (Verdict.TIMEOUT, "it ran out of memory on a field of 5 x 6 x 7 samples"),
}

# What to do where a convention is measured to be other than declared, by its measured value.
MEND = {
    "inside": "a sample equal to the isovalue counts as inside",
    "outside": "a sample equal to the isovalue counts as outside",
    "to_low": "right-hand normals point to lower values",
    "to_high": "right-hand normals point to higher values: reverse each face, faces[:, ::-1]",
    "array": "coordinates come in the order of the array's axes",
    "reversed": "coordinates come in reversed order (x before z): vertices[:, ::-1]",
    "world": "vertices are scaled by the spacing",
    "index": "vertices are not scaled by the spacing: vertices * spacing",
    "raises nan": "it raises on a sample that is not a number",
    "answers": "it answers a field with NaN as if nothing were wrong: raise an error",
    "mesh": "it gives an empty mesh where there is no surface",
    "raises empty": "it raises where there is no surface: return arrays of shape (0, 3)",
}


def check(spec: str) -> list[Advice]:
    """What the adapter to `spec` does, one verdict and one sentence of advice each.

    >>> [verdict.value for verdict, _ in check("no-such-thing")]
    ['error']
    """
    if spec.partition(":")[0] in OTHERS:
        return _beside(spec)
    try:
        adapter = open_adapter(spec)
        declaration = adapter.open(SHORT)
    except AdapterError as error:
        return [(Verdict.ERROR, str(error))]
    if declaration.discipline in OTHERS:
        adapter.close()
        return _beside(spec)
    try:
        advice = [(Verdict.PASS, _introduced(declaration))]
        if isinstance(adapter, DirectoryAdapter):
            return advice + list(_files(adapter))
        assert isinstance(adapter, ProcessAdapter), "every other adapter leads to a process"
        return advice + list(_calls(adapter, declaration))
    finally:
        adapter.close()


def _beside(spec: str) -> list[Advice]:
    """What an implementation of another discipline than surfaces makes of its smallest cases."""
    # Import what judges only here: for surfaces nobody shall wait for it.
    from isograde.runner import Options, Task, Worker

    try:
        worker = Worker.open(spec, Options(limits=SHORT))
    except AdapterError as error:
        return [(Verdict.ERROR, str(error))]
    advice = [(Verdict.PASS, _introduced(worker.declaration))]
    try:
        for case in sorted(worker.cases.values(), key=lambda case: case.samples)[:BESIDE]:
            claims = [name for name, one in worker.claims.items() if one.level in (0, 1)]
            asked = [name for name in claims if worker.claims[name].applies_to(case)]
            found = worker.judge(Task(case.id, tuple(asked))).findings
            bad = {name: one for name, one in found.items() if one.verdict is not Verdict.PASS}
            advice += [
                (one.verdict, f"{case.id}, {name}: {one.detail}") for name, one in bad.items()
            ]
            if not bad:
                advice.append((Verdict.PASS, f"{case.id}: {len(found)} claims of levels 0 and 1"))
    finally:
        worker.adapter.close()
    return advice


def _introduced(declaration: Declaration) -> str:
    """What the implementation says of itself, in a sentence."""
    name = f"{declaration.name} {declaration.version}".rstrip()
    promise = f"claims level {declaration.level} ({LEVELS[declaration.level][0]})"
    without = f", without {', '.join(sorted(declaration.without))}" if declaration.without else ""
    return f"it started: {name} {promise}{without}"


def _files(adapter: DirectoryAdapter) -> Iterator[Advice]:
    """How many of the exported fields have a mesh, and which cannot be read."""
    answered, unreadable = adapter.answered(), adapter.unreadable()
    yield (
        Verdict.PASS,
        f"{answered} of {adapter.exported()} exported fields have a mesh beside them",
    )
    for name, reason in unreadable:
        yield Verdict.FAIL, f"{name}: {reason}"


def _calls(adapter: ProcessAdapter, declaration: Declaration) -> Iterator[Advice]:
    """What a handful of calls shows, the plain one first."""

    def ask(field: Field, isovalue: float) -> Outcome:
        return adapter.answer(Request("check", "plain", field, isovalue))

    field = ball()
    plain = ask(field, LEVEL)
    if plain.status is not Status.OK:
        verdict, sentence = ENDED[plain.status]
        yield verdict, f"{sentence}: {plain.detail}{_hint(plain)}"
        return
    mistakes = list(malformed(plain))
    yield from ((Verdict.FAIL, mistake) for mistake in mistakes)
    if mistakes:
        return
    milliseconds = 1000 * plain.seconds
    yield Verdict.PASS, f"it gave {len(_faces(plain))} triangles in {milliseconds:.1f} ms"
    yield from _conventions(ask, declaration.conventions, plain)
    yield from _presentations(ask, field, plain)
    yield from _manners(adapter, plain)


def _hint(outcome: Outcome) -> str:
    """What the commonest mistakes of a first call are."""
    if outcome.detail.startswith("TypeError"):
        return "; it is called as function(values, isovalue, spacing)"
    if "of 4" in outcome.detail or "of 3" in outcome.detail:
        return "; return only the first two"
    if "NoneType" in outcome.detail:
        return "; does the function end with `return vertices, faces`?"
    return ""


def malformed(outcome: Outcome) -> Iterator[str]:
    """What is wrong with the arrays of an answer, and what to do."""
    vertices, faces = outcome.vertices, outcome.faces
    assert vertices is not None
    assert faces is not None
    yield from _misshaped("vertices", vertices, "coordinates")
    yield from _misshaped("faces", faces, "indices")
    if vertices.size == 0 or faces.size == 0:
        yield "it gave no surface for a ball in the middle of the field: is the isovalue used?"
        return
    if vertices.dtype.kind == "f" and not np.isfinite(vertices).all():
        yield "vertices have coordinates that are NaN or infinite"
    if faces.dtype.kind not in "iu":
        yield f"faces are {faces.dtype}, not integers: faces.astype(int)"
    elif faces.min() == 1 and faces.max() == len(vertices):
        yield "faces count vertices from 1: subtract 1"
    elif faces.min() < 0 or faces.max() >= len(vertices):
        yield (
            f"faces name vertices {faces.min()} to {faces.max()}, "
            f"but there are {len(vertices)}, counted from 0"
        )


def _misshaped(name: str, array: Array, what: str) -> Iterator[str]:
    """Why an array is not rows of three, and what to do."""
    if array.ndim == 2 and array.shape[1] == 3:
        return
    advice = f"give one row of three {what} each"
    if array.ndim == 2 and array.shape[0] == 3:
        advice = f"it looks transposed: {name}.T"
    elif array.ndim == 1 and array.size % 3 == 0:
        advice = f"it looks flat: {name}.reshape(-1, 3)"
    elif name == "faces" and array.ndim == 2 and array.shape[1] == 4:
        advice = "split each quadrilateral into two triangles, or leave out the leading count"
    yield f"{name} have shape {array.shape}, not (n, 3): {advice}"


def _conventions(
    ask: Callable[[Field, float], Outcome], declared: Conventions, plain: Outcome
) -> Iterator[Advice]:
    """Each convention that is measured to be other than declared."""
    measured = measure(ask)
    if measured.axes is None:
        assert plain.vertices is not None
        low, high = plain.vertices.min(0).round(2), plain.vertices.max(0).round(2)
        yield (
            Verdict.FAIL,
            f"vertices lie between {low.tolist()} and {high.tolist()}: the surface is not there, "
            "whatever the order of the axes, scaled or not; vertex = index * spacing",
        )
        return
    different = measured.differences(declared)
    for name, said, found in different:
        mend = MEND.get(f"{found} {name}", MEND.get(found, ""))
        yield Verdict.FAIL, f'{mend}; or declare "{name}": "{found}" (now "{said}")'
    if not different:
        yield Verdict.PASS, "its conventions are those it declares"


def _presentations(
    ask: Callable[[Field, float], Outcome], field: Field, plain: Outcome
) -> Iterator[Advice]:
    """Ways to present the same samples that are not taken for the same."""
    values = field.values
    gaps = np.zeros([2 * n for n in values.shape])[::2, ::2, ::2]
    gaps[...] = values
    ways = {
        "in Fortran order; np.ascontiguousarray helps": np.asfortranarray(values),
        "with gaps in memory; np.ascontiguousarray helps": gaps,
        "of type float32; values.astype(float) helps": values.astype(np.float32),
        "of type int16; values.astype(float) helps": (1000 * values).astype(np.int16),
    }
    good = True
    for way, array in ways.items():
        isovalue = LEVEL if array.dtype.kind == "f" else 1000 * LEVEL
        outcome = ask(Field.of(array, field.spacing), isovalue)
        if outcome.status is Status.DECLINED:
            yield Verdict.UNSUPPORTED, f"it declines samples {way}: {outcome.detail}"
        elif outcome.status is not Status.OK:
            yield Verdict.FAIL, f"it fails on samples {way}: {outcome.detail}"
        elif len(_faces(outcome)) != len(_faces(plain)):
            yield Verdict.FAIL, f"it gives another surface for the same samples {way}"
        else:
            continue
        good = False
    if good:
        yield Verdict.PASS, "it takes samples of any memory layout and type that was tried"


def _manners(adapter: ProcessAdapter, plain: Outcome) -> Iterator[Advice]:
    """What else it does beside answering."""
    if plain.input_changed:
        yield Verdict.FAIL, "it writes into the samples it is given: work on a copy"
    printed, complained = adapter.said()
    if printed:
        yield Verdict.PASS, f"it prints to standard output, which is kept apart: {_line(printed)}"
    if complained:
        yield Verdict.PASS, f"it prints to standard error, which is kept: {_line(complained)}"


def _line(text: str) -> str:
    """The last line of what was printed, in quotes."""
    return repr(text.splitlines()[-1][:80])


def _faces(outcome: Outcome) -> Array:
    """The faces of an answer that has them."""
    assert outcome.faces is not None
    return outcome.faces
