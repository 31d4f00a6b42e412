"""What `isograde check` does: an adapter tried in a few seconds, with advice on each mistake.

It asks for one small level set of each declared kind whose place, orientation and size are known,
looks at the arrays that come back, measures the conventions, tries the ways in which an array can
be presented, and judges the claims of levels 0 to 2 on the smallest cases. At the end stands the
declaration to paste, in the four words, as it was measured. Where a plain field is declined, fields
that are cubes, or bytes, or larger, are tried. Nothing that is raised in between ends it: it is
told, and the next thing is tried.

Grading says what is true of the algorithm; this says what is wrong with the call.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from typing import Any

import numpy as np
from isoref.field import Field, Floats
from numpy.typing import NDArray

from isograde.adapters import open_adapter
from isograde.adapters.directory import DirectoryAdapter
from isograde.adapters.measure import Measured, ball, levels, measure
from isograde.adapters.process import ProcessAdapter
from isograde.declaration import Declaration, declaration_from, declaration_json
from isograde.model import (
    BAD,
    LEVELS,
    SURFACES,
    Adapter,
    AdapterError,
    Kind,
    Limits,
    Outcome,
    Request,
    Status,
    Verdict,
)

Advice = tuple[Verdict, str]
Array = NDArray[Any]
Ask = Callable[[Field, tuple[float, ...]], Outcome]

# How a verdict is called here.
SAID = {Verdict.PASS: "right", Verdict.FAIL: "wrong", Verdict.SKIP: "note"}
# Look at so many kinds, the smallest, and judge so many small cases of each in so many seconds.
KINDS_TRIED, CASES_TRIED, SECONDS = 3, 200, 5.0
# Claims of a declared level up to this are judged on small cases.
HIGHEST = 2
# A coordinate this near to a whole number, in cells, is one.
WHOLE = 1e-4

ENDED: dict[Status, tuple[Verdict, str]] = {
    Status.RAISED: (Verdict.ERROR, "it raised"),
    Status.DECLINED: (Verdict.UNSUPPORTED, "it declined"),
    Status.GARBAGE: (
        Verdict.FAIL,
        "its answer is no pair of vertices (V, {n}), simplices (S, {c})",
    ),
    Status.CRASH: (Verdict.CRASH, "its process died"),
    Status.TIMEOUT: (Verdict.TIMEOUT, "it did not answer in time"),
    Status.MEMORY: (Verdict.TIMEOUT, "it ran out of memory"),
}

# What to do where a convention is measured to be other than declared, by its measured value.
MEND = {
    "inside": "a sample equal to the isovalue counts as inside",
    "outside": "a sample equal to the isovalue counts as outside",
    "to_low": "right-hand normals point to lower values",
    "to_high": "right-hand normals point to higher values: reverse each row, simplices[:, ::-1]",
    "none": "simplices are not oriented alike",
    "array": "coordinates come in the order of the array's axes",
    "reversed": "coordinates come in reversed order (x before z): vertices[:, ::-1]",
    "world": "vertices are scaled by the spacing",
    "index": "vertices are not scaled by the spacing: vertices * spacing",
    "raises nan": "it raises on a sample that is not a number",
    "answers": "it answers a field with NaN as if nothing were wrong: raise an error",
    "mesh": "it gives an empty mesh where there is no surface",
    "raises empty": "it raises where there is no surface: return arrays without rows",
}


@dataclass
class Checked:
    """What was found: verdicts with a sentence each, and the declaration to paste."""

    started: bool = True
    advice: list[Advice] = fresh(default_factory=list)
    paste: str = ""

    @property
    def right(self) -> bool:
        """Nothing is to be mended."""
        return all(verdict in (Verdict.PASS, Verdict.SKIP) for verdict, _ in self.advice)

    def add(self, found: Iterable[Advice], what: str) -> None:
        """Take in advice; what is raised on the way is told, and ends nothing."""
        try:
            for one in found:
                self.advice.append(one)
        except Exception as error:  # noqa: BLE001 - told to who asked, as one more finding
            told = f"{what} could not be finished: {type(error).__name__}: {error}"
            self.advice.append((Verdict.ERROR, told))


def check(spec: str, timeout: float = 10.0) -> Checked:
    """What the adapter to `spec` does, one verdict and one sentence of advice each.

    >>> check("no-such-thing").started
    False
    """
    checked = Checked()
    try:
        adapter = open_adapter(spec)
        declaration = adapter.open(Limits(seconds=timeout, megabytes=4096))
    except AdapterError as error:
        return Checked(False, [(Verdict.ERROR, str(error))])
    try:
        checked.advice.append((Verdict.PASS, _introduced(declaration)))
        if isinstance(adapter, DirectoryAdapter):
            checked.add(_files(adapter), "the folder")
        else:
            assert isinstance(adapter, ProcessAdapter), "every other adapter leads to a process"
            _kinds(checked, adapter, declaration)
    finally:
        adapter.close()
    return checked


def _introduced(declaration: Declaration) -> str:
    """What the implementation says of itself, in a sentence."""
    name = f"{declaration.name} {declaration.version}".rstrip()
    level = min(declaration.level, declaration.top)
    without = ", ".join(sorted(declaration.not_promised))
    return (
        f"it started: {name} promises level {level} ({LEVELS[level][0]})"
        f"{f', but not {without}' if without else ''}"
    )


def _files(adapter: DirectoryAdapter) -> Iterator[Advice]:
    """How many of the exported fields have a mesh, and which cannot be read."""
    answered, unreadable = adapter.answered(), adapter.unreadable()
    yield (
        Verdict.PASS,
        f"{answered} of {adapter.exported()} exported fields have a mesh beside them",
    )
    for name, reason in unreadable:
        yield Verdict.FAIL, f"{name}: {reason}"


def _kinds(checked: Checked, adapter: ProcessAdapter, declaration: Declaration) -> None:
    """Each of the smallest declared kinds is tried; `checked` has the declaration to paste."""
    kinds = sorted((Kind(*kind) for kind in declaration.limits.kinds), key=_size)
    told = declaration
    for kind in kinds[:KINDS_TRIED]:
        trial = Try(adapter, declaration, kind)
        checked.add(trial.calls(), f"{kind}: the calls")
        if trial.answered:
            checked.add(trial.small_cases(), f"{kind}: small cases")
            told = trial.told(told)
    if len(kinds) > KINDS_TRIED:
        left = len(kinds) - KINDS_TRIED
        checked.advice.append((Verdict.SKIP, f"{left} more kinds that it declares were not tried"))
    checked.paste = paste(told)


def _size(kind: Kind) -> tuple[bool, int, int]:
    """What makes a kind small: surfaces first, then fewer axes."""
    return kind != SURFACES, kind.n, kind.m


def paste(declaration: Declaration) -> str:
    """The declaration as JSON, without what goes without saying.

    >>> paste(Declaration("mine", vertices="cells", level=1))
    '{"name": "mine", "level": 1, "vertices": "cells"}'
    """
    said, usual = declaration_json(declaration), declaration_json(Declaration("", version=""))
    for name in ("conventions", "limits"):
        said[name] = {k: v for k, v in said[name].items() if v != usual[name][k]}
    kept = {k: v for k, v in said.items() if v != usual[k] and v != {}}
    if "domain" in kept:
        ends = [one["end"] if not one["inset"] else one for one in kept["domain"]]
        kept["domain"] = ends[0] if len(ends) == 1 else ends
    return json.dumps(kept)


@dataclass
class Try:
    """One kind of answer, tried.

    answered : a field was answered with arrays that can be looked at
    asked : the field that was answered
    """

    adapter: ProcessAdapter
    declaration: Declaration
    kind: Kind
    answered: bool = False
    asked: Field | None = None
    measured: Measured | None = None
    words: dict[str, Any] = fresh(default_factory=dict)
    limits: dict[str, Any] = fresh(default_factory=dict)

    def ask(self, field: Field, isovalues: tuple[float, ...]) -> Outcome:
        """The outcome of one call, its answer as it came."""
        return self.adapter.answer(Request("check", "plain", field, isovalues))

    def calls(self) -> Iterator[Advice]:
        """What a handful of calls shows, the plain one first."""
        plain = yield from self._plain()
        if plain is None:
            return
        mistakes = list(malformed(plain, self.kind))
        yield from ((Verdict.FAIL, mistake) for mistake in mistakes)
        if mistakes:
            return
        self.answered = True
        milliseconds = 1000 * plain.seconds
        count = len(_rows(plain))
        yield Verdict.PASS, f"{self.kind}: {count} simplices in {milliseconds:.1f} ms"
        if self.limits:
            return  # What follows asks plain fields, which it does not take.
        yield from self._conventions(plain)
        yield from self._presentations(plain)
        yield from self._manners(plain)

    def _plain(self) -> Generator[Advice, None, Outcome | None]:
        """Yields why plain fields are not answered; returns the first answer that came, or None."""
        field = ball(self.kind)
        outcome = self.ask(field, levels(self.kind))
        if outcome.status is Status.OK:
            self.asked = field
            return outcome
        verdict, told = ENDED[outcome.status]
        shape = " x ".join(map(str, field.shape))
        said = told.format(n=self.kind.n, c=self.kind.k + 1)
        told = f"{self.kind}: {said}, on a plain field of {shape} float64 samples"
        for limits, other, isovalues in other_fields(field, levels(self.kind)):
            again = self.ask(other, isovalues)
            if again.status is Status.OK:
                self.limits, self.asked = limits, other
                yield verdict, f"{told}: {outcome.detail}; it takes one that is {_told(limits)}"
                return again
        yield verdict, f"{told}: {outcome.detail}{_hint(outcome)}"
        return None

    def _conventions(self, plain: Outcome) -> Iterator[Advice]:
        """Each convention that is measured to be other than declared."""
        declared = self.declaration.conventions
        self.measured = measure(self.ask, self.kind)
        if self.measured.axes is None:
            yield Verdict.FAIL, _misplaced(plain, ball(self.kind))
            return
        different = self.measured.differences(declared)
        for name, said, found in different:
            mend = MEND.get(f"{found} {name}", MEND.get(found, ""))
            told = f'{mend}; or declare "{name}": "{found}" (now "{said}")'
            yield Verdict.FAIL, told
        if not different:
            yield Verdict.PASS, f"{self.kind}: its conventions are those it declares"
        if self.kind == SURFACES:
            self.words = words_of(self.ask, plain, self.measured)
            yield from self._words()

    def _words(self) -> Iterator[Advice]:
        """Each of the four words that is measured to be other than declared."""
        said = declaration_json(self.declaration)
        for name, found in self.words.items():
            now = said[name][0]["end"] if name == "domain" else said[name]
            if _said_more(self.declaration, name) or now == found:
                continue
            told = (
                f"{WORDS[name]} looks like {json.dumps(found)}, and it declares {json.dumps(now)}"
            )
            yield Verdict.FAIL, f'{told}: "{name}": {json.dumps(found)}, if it is meant to be'

    def _presentations(self, plain: Outcome) -> Iterator[Advice]:
        """Ways to present the same samples that are not taken for the same."""
        field, isovalues = ball(self.kind), levels(self.kind)
        values = field.values
        gaps = np.zeros([2 * n for n in values.shape])[tuple([slice(None, None, 2)] * values.ndim)]
        gaps[...] = values
        ways: dict[str, tuple[Array, float]] = {
            "in Fortran order; np.ascontiguousarray helps": (np.asfortranarray(values), 1),
            "with gaps in memory; np.ascontiguousarray helps": (gaps, 1),
            "of type float32; values.astype(float) helps": (values.astype(np.float32), 1),
            "of type int16; values.astype(float) helps": ((1000 * values).astype(np.int16), 1000),
        }
        good = True
        for way, (array, scale) in ways.items():
            posed = Field.of(array, field.spacing, dimension=field.dimension)
            outcome = self.ask(posed, tuple(scale * one for one in isovalues))
            found = _presented(outcome, plain, way)
            good = good and found is None
            if found is not None:
                yield found
        if good:
            yield Verdict.PASS, f"{self.kind}: it takes any memory layout and type that was tried"

    def _manners(self, plain: Outcome) -> Iterator[Advice]:
        """What else it does beside answering."""
        if plain.input_changed:
            yield Verdict.FAIL, "it writes into the samples it is given: work on a copy"
        again = self.ask(ball(self.kind), levels(self.kind))
        if not _same(plain, again):
            yield Verdict.FAIL, "asked twice, it gives two answers: is something left from a call?"
        printed, complained = self.adapter.said()
        if printed:
            yield (
                Verdict.SKIP,
                f"it prints to standard output, which is kept apart: {_line(printed)}",
            )
        if complained:
            yield Verdict.SKIP, f"it prints to standard error, which is kept: {_line(complained)}"

    def small_cases(self) -> Iterator[Advice]:
        """What claims of levels 0 to 2 say of the smallest cases, most faults first."""
        # Import what judges only here: who made a mistake above shall not wait for it.
        from isograde.runner import Task, Worker, cases_for, claims_for

        only = replace(self.declaration.limits, kinds=((self.kind.n, self.kind.m),))
        declared = replace(self.declaration, limits=only)
        claims = {
            name: claim
            for name, claim in claims_for(declared).items()
            if claim.level is not None and claim.level <= HIGHEST and not claim.variants
        }
        cases = cases_for(declared, 0)
        adapter: Adapter = self.adapter
        worker = Worker(adapter, declared, cases, claims)
        deadline = time.monotonic() + SECONDS
        bad: Counter[str] = Counter()
        first: dict[str, Advice] = {}
        judged = 0
        for case in _smallest(cases.values()):
            if time.monotonic() > deadline:
                break
            asked = tuple(name for name, claim in claims.items() if claim.applies_to(case))
            found = worker.judge(Task(case.id, asked)).findings
            judged += any(one.verdict in (Verdict.PASS, *BAD) for one in found.values())
            for name, one in found.items():
                if one.verdict in BAD:
                    bad[name] += 1
                    first.setdefault(name, (one.verdict, f"{case.id}: {one.detail}"))
        for name, count in bad.most_common():
            verdict, told = first[name]
            told = f"{self.kind}: {name} fails on {count} of {judged} small cases; {told}"
            if claims[name].held(declared):
                yield verdict, told
            else:
                yield Verdict.SKIP, f"{told} (not promised)"
        if judged and not bad:
            yield (
                Verdict.PASS,
                f"{self.kind}: {len(claims)} claims of levels 0 to {HIGHEST} hold on "
                f"{judged} small cases",
            )
        if not judged:
            yield Verdict.UNSUPPORTED, f"{self.kind}: no small case could be judged"

    def told(self, declaration: Declaration) -> Declaration:
        """The declaration, changed to what was measured of this kind."""
        if self.limits:
            limits = replace(declaration.limits, **self.limits)
            return replace(declaration, limits=limits)
        if self.measured is not None and self.measured.axes is not None:
            found = self.measured.differences(declaration.conventions)
            new: dict[str, Any] = {name: measured for name, _, measured in found}
            conventions = replace(declaration.conventions, **new)
            declaration = replace(declaration, conventions=conventions)
        if self.words:
            words = {k: v for k, v in self.words.items() if not _said_more(declaration, k)}
            said = {**declaration_json(declaration), **words}
            said["level"] = min(said["level"], 4 if _exact(said) else 2)
            declaration = declaration_from(said, declaration.name)
        return declaration


WORDS = {
    "interpolant": "what it draws inside a cell",
    "vertices": "where its vertices are",
    "domain": "how the surface ends at the border",
    "mesh": "how triangles share vertices",
}


def _said_more(declaration: Declaration, word: str) -> bool:
    """Whether the declaration says of a word what a measurement cannot."""
    said = declaration_json(declaration)[word]
    if word == "domain":
        return any(end["inset"] or end["end"] == "periodic" for end in said) or len(said) > 1
    return isinstance(said, dict)


def _exact(said: dict[str, Any]) -> bool:
    """Whether this family's top is above level 2."""
    return bool(said["interpolant"] == "multilinear" and said["vertices"] == "edges")


def other_fields(
    field: Field, isovalues: tuple[float, ...]
) -> Iterator[tuple[dict[str, Any], Field, tuple[float, ...]]]:
    """Limits, with fields that keep them, for who does not take the plain one."""
    n = field.dimension
    spacing = (1.0,) * n
    side = 8
    middle = (side - 1) / 2 + 0.1
    away = np.indices((side,) * n, dtype=float) - middle
    high = 8 - np.einsum("i...,i...->...", away, away)
    cube = high if field.components == 1 else np.stack([high, *away[n - field.components + 1 :]])
    level = (4.0, *isovalues[1:])
    bytes_ = np.clip(128 + 10 * cube, 0, 255).astype(np.uint8)
    byte_level = tuple(128 + 10 * one + 0.5 for one in level)
    for limits, values, asked in (
        ({"cubes": True}, cube, level),
        ({"types": ("float32",)}, field.values.astype(np.float32), isovalues),
        ({"types": ("float32",), "cubes": True}, cube.astype(np.float32), level),
        ({"types": ("uint8",), "cubes": True}, bytes_, byte_level),
    ):
        yield limits, Field.of(values, spacing, dimension=n), asked
    plain = np.clip(128 + 10 * field.values, 0, 255).astype(np.uint8)
    asked = tuple(128 + 10 * one + 0.5 for one in isovalues)
    yield {"types": ("uint8",)}, Field.of(plain, field.spacing, dimension=n), asked


def _told(limits: dict[str, Any]) -> str:
    """Limits in words."""
    parts = ["a cube"] if limits.get("cubes") else []
    parts += [f"of type {', '.join(limits['types'])}"] if "types" in limits else []
    return f"{' '.join(parts)}: declare " + json.dumps({"limits": limits})


def _hint(outcome: Outcome) -> str:
    """What the commonest mistakes of a first call are."""
    if outcome.detail.startswith("TypeError"):
        return "; it is called as function(values, isovalue, spacing)"
    if "inhomogeneous" in outcome.detail:
        return (
            "; return a tuple (vertices, simplices): where there is more, return only the first two"
        )
    if "NoneType" in outcome.detail:
        return "; does the function end with `return vertices, simplices`?"
    return ""


def malformed(outcome: Outcome, kind: Kind) -> Iterator[str]:
    """What is wrong with the arrays of an answer, and what to do."""
    vertices, rows = outcome.vertices, outcome.simplices
    assert vertices is not None
    assert rows is not None
    yield from _misshaped("vertices", vertices, kind.n, "coordinates")
    yield from _misshaped("simplices", rows, kind.k + 1, "indices")
    if vertices.size == 0 or rows.size == 0:
        yield "it gave nothing for a ball in the middle of the field: is the isovalue used?"
        return
    if vertices.dtype.kind == "f" and not np.isfinite(vertices).all():
        yield "vertices have coordinates that are NaN or infinite"
    if rows.dtype.kind not in "iu":
        yield f"simplices are {rows.dtype}, not integers: simplices.astype(int)"
    elif rows.min() == 1 and rows.max() == len(vertices):
        yield "simplices count vertices from 1: subtract 1"
    elif rows.min() < 0 or rows.max() >= len(vertices):
        yield (
            f"simplices name vertices {rows.min()} to {rows.max()}, "
            f"but there are {len(vertices)}, counted from 0"
        )


def _misshaped(name: str, array: Array, width: int, what: str) -> Iterator[str]:
    """Why an array is not rows of so many numbers, and what to do."""
    if array.ndim == 2 and array.shape[1] == width:
        return
    advice = f"give one row of {width} {what} each"
    if array.ndim == 2 and array.shape[0] == width:
        advice = f"it looks transposed: {name}.T"
    elif array.ndim == 1 and array.size % width == 0:
        advice = f"it looks flat: {name}.reshape(-1, {width})"
    yield f"{name} have shape {array.shape}, not (n, {width}): {advice}"


def _misplaced(plain: Outcome, field: Field) -> str:
    """Where the surface is instead, with the mistake that would put it there."""
    assert plain.vertices is not None
    vertices = plain.vertices.astype(float)
    low, high = vertices.min(0).round(2), vertices.max(0).round(2)
    told = f"vertices lie between {low.tolist()} and {high.tolist()}: the surface is not there"
    guess = misplacement(vertices, field)
    if guess:
        return f"{told}; {guess}"
    return f"{told}, whatever the order of the axes, scaled or not; vertex = index * spacing"


def misplacement(vertices: Floats, field: Field) -> str:
    """The mistake that explains where the vertices of `ball` are, or nothing."""
    n, shape = field.dimension, np.asarray(field.shape, float)
    steps = np.asarray(field.spacing)
    centre = (shape - 1) / 2 + np.array([0.1, -0.1, 0.2, -0.2, 0.15, -0.15])[:n]
    reach = np.zeros(n)
    reach[: n - field.components + 1] = 3**0.5
    right = np.stack([centre - reach, centre + reach])
    found = np.stack([vertices.min(0), vertices.max(0)])
    guesses = {
        "half a cell is added to each index: subtract spacing / 2": (right + 0.5) * steps,
        "half a cell is taken from each index: add spacing / 2": (right - 0.5) * steps,
        "half a cell is added to each index: subtract 0.5": right + 0.5,
        "half a cell is taken from each index: add 0.5": right - 0.5,
        "a sample is added to each index, as if the field were padded: subtract spacing": (
            (right + 1) * steps
        ),
        "a sample is added to each index, as if the field were padded: subtract 1": right + 1,
        "indices are scaled by n / (n - 1): index * spacing, not index / (n - 1) * n": (
            right * shape / (shape - 1) * steps
        ),
        "indices are scaled by (n - 1) / n": right * (shape - 1) / shape * steps,
        "it is drawn in the unit cube: vertices * (n - 1) * spacing": right / (shape - 1),
        "it is drawn in a cube from -1 to 1": 2 * right / (shape - 1) - 1,
        "the lattice is centred at 0: add (n - 1) / 2 * spacing": (right - (shape - 1) / 2) * steps,
        "the lattice is centred at 0: add (n - 1) / 2": right - (shape - 1) / 2,
    }
    for order, said in ((slice(None), ""), (slice(None, None, -1), ", and axes are reversed")):
        # Let a guess explain the place to a part of what it changes.
        off = {told: float(np.abs(found[:, order] - box).max()) for told, box in guesses.items()}
        best = min(off, key=lambda told: off[told])
        if off[best] < 0.12 * float(np.ptp(guesses[best], axis=0).max()):
            return best + said
    return ""


def _presented(outcome: Outcome, plain: Outcome, way: str) -> Advice | None:
    """What is wrong with the answer to samples presented in some way."""
    if outcome.status is Status.DECLINED:
        return Verdict.UNSUPPORTED, f"it declines samples {way}: {outcome.detail}"
    if outcome.status is not Status.OK:
        return Verdict.FAIL, f"it fails on samples {way}: {outcome.detail}"
    if len(_rows(outcome)) != len(_rows(plain)):
        return Verdict.FAIL, f"it gives another surface for the same samples {way}"
    return None


def _same(one: Outcome, other: Outcome) -> bool:
    """Whether two outcomes have the same arrays."""
    pairs = (one.vertices, other.vertices), (one.simplices, other.simplices)
    return all(a is not None and b is not None and np.array_equal(a, b) for a, b in pairs)


def _line(text: str) -> str:
    """The last line of what was printed, in quotes."""
    return repr(text.splitlines()[-1][:80])


def _rows(outcome: Outcome) -> Array:
    """The simplices of an answer that has them."""
    assert outcome.simplices is not None
    return outcome.simplices


def _smallest(cases: Iterable[Any]) -> list[Any]:
    """The smallest cases of every family, in turn, those that always run."""
    families: dict[str, list[Any]] = {}
    for case in cases:
        if "full" not in case.tags:
            families.setdefault(case.id.split("/")[0], []).append(case)
    for members in families.values():
        members.sort(key=lambda case: case.samples)
    found: list[Any] = []
    turns = max((len(members) for members in families.values()), default=0)
    for turn in range(turns):
        found += [members[turn] for members in families.values() if turn < len(members)]
        if len(found) >= CASES_TRIED:
            break
    return found[:CASES_TRIED]


def words_of(ask: Ask, plain: Outcome, measured: Measured) -> dict[str, Any]:
    """The four words, as far as the answers on a few balls tell them."""
    field = ball(SURFACES)
    points = _index(plain, field, measured)
    return {
        "interpolant": _interpolant(ask, points, field),
        "vertices": _vertices(points),
        "domain": _domain(ask),
        "mesh": _mesh(plain),
    }


def _index(outcome: Outcome, field: Field, measured: Measured) -> Floats:
    """The vertices in samples, in the order of the array's axes."""
    assert outcome.vertices is not None
    points = outcome.vertices.astype(float)
    points = points[:, ::-1] if measured.axes == "reversed" else points
    return points / np.asarray(field.spacing) if measured.units == "world" else points


def _fractional(points: Floats) -> NDArray[np.bool_]:
    """(V, 3) coordinates that are no whole numbers."""
    away: NDArray[np.bool_] = np.abs(points - points.round()) > WHOLE
    return away


def _interpolant(ask: Ask, points: Floats, field: Field) -> str:
    """Labels where values do not matter, Kuhn's tetrahedra where vertices are on diagonals."""
    seen = np.where(field.values >= 1, 3.0, -1.0)
    again = ask(replace(field, values=seen), (1.0,))
    if again.vertices is not None and again.vertices.shape == points.shape:
        plain = ask(field, levels(SURFACES))
        if plain.vertices is not None and np.allclose(again.vertices, plain.vertices):
            return "labels"
    many = _fractional(points).sum(axis=1) >= 2
    parts = points - np.floor(points)
    inner = np.where(_fractional(points), parts, np.nan)[many]
    # On a diagonal of Kuhn's split every coordinate that is not whole has the same fraction.
    alike = len(inner) and (np.nanmax(inner, axis=1) - np.nanmin(inner, axis=1) < WHOLE).all()
    return "kuhn" if alike and many.mean() > 0.3 else "multilinear"


def _vertices(points: Floats) -> str:
    """On edges, where most vertices have one coordinate that is not whole; else in cells."""
    inner = _fractional(points).sum(axis=1)
    parts = points - np.floor(points)
    diagonal = np.where(_fractional(points), parts, np.nan)
    with np.errstate(invalid="ignore"):
        alike = np.ptp(np.where(np.isnan(diagonal), parts.max(1)[:, None], diagonal), axis=1)
    on_edges = (inner <= 1) | (alike < WHOLE)
    return "edges" if on_edges.mean() > 0.6 else "cells"


def _domain(ask: Ask) -> str:
    """Open or closed: whether the surface of a slab that reaches the border is capped there."""
    place = np.indices((6, 6, 6), dtype=float)
    slab = 1.3 - np.abs(place[0] - 2.55)
    outcome = ask(Field.of(slab), (0.0,))
    mesh = outcome.mesh_of(SURFACES)
    if mesh is None or not len(mesh.simplices):
        return "open"
    _, place_of = np.unique(mesh.vertices.round(5), axis=0, return_inverse=True)
    rows = np.sort(place_of.reshape(-1)[mesh.simplices], axis=1)
    edges = np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [0, 2]]])
    _, uses = np.unique(edges, axis=0, return_counts=True)
    return "open" if (uses == 1).any() else "closed"


def _mesh(plain: Outcome) -> Any:
    """Soup, where each simplex has corners of its own."""
    assert plain.vertices is not None
    corners = _rows(plain).size
    return {"soup": 1e-6} if len(plain.vertices) >= corners else "indexed"
