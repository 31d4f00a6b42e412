"""One kind of answer, tried with a handful of calls."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterator
from dataclasses import dataclass, fields, replace
from dataclasses import field as fresh
from typing import Any

import numpy as np
from isoref.field import Field, Floats
from numpy.typing import NDArray

from isograde.adapters.conventions import to_house
from isograde.adapters.measure import Measured, ball, levels, measure
from isograde.adapters.process import ProcessAdapter
from isograde.checking.arrays import doubled, malformed, rows_of, same
from isograde.checking.checked import Advice
from isograde.checking.places import level_at, misplaced, shifted
from isograde.checking.rows import NO_CELL, rows_told
from isograde.checking.sentences import WORDS, another_surface, looks_like, times
from isograde.checking.spans import NEAR, Span, inset, spans, spans_told, stretch
from isograde.checking.words import FIVE, exact, index_of, said_more, words_of
from isograde.declaration import (
    Conventions,
    Declaration,
    declaration_from,
    declaration_json,
)
from isograde.model import SURFACES, Kind, Outcome, Request, Status, Verdict
from isograde.within import TRIED, Within

Array = NDArray[Any]

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
    "to_high": "right-hand normals point to higher values: reverse each row<, simplices[:, ::-1]>",
    "none": "simplices are not oriented alike",
    "array": "coordinates come in the order of the array's axes",
    "reversed": "coordinates come in reversed order, x before z: turn them<, vertices[:, ::-1]>",
    "world": "vertices are scaled by the spacing",
    "index": "vertices are not scaled by the spacing: multiply by it<, vertices * spacing>",
    "raises nan": "it raises on a sample that is not a number",
    "answers": "it answers a field with NaN as if nothing were wrong: better raise an error",
    "mesh": "it gives an empty mesh where there is no surface",
    "raises empty": "it raises where there is no surface: return arrays without rows",
}


# Ways to end that are told wherever there is a surface; what is declined is told by its reason.
UNANSWERED = (Status.RAISED, Status.CRASH, Status.TIMEOUT, Status.MEMORY)
# What is measured and shown, and held against nobody.
NEVER_HELD = {"nan"}


@dataclass
class Try:
    """One kind of answer, tried.

    answered : a field was answered with arrays that can be looked at
    asked, unanswered : fields that were asked, and those with a surface that ended otherwise
    misplaced : the surface is not where it should be, in no order of the axes, scaled or not
    within : the limits under which it was, as they were found out
    steady : asked twice, it gave the same arrays
    rows_right, rows_wrong : each configuration of a cell, asked alone, is answered rightly, or some
        is not; neither where cells are not asked alone
    ended : a long field showed that the surface ends early, or is open inside
    """

    adapter: ProcessAdapter
    declaration: Declaration
    kind: Kind
    answered: bool = False
    misplaced: bool = False
    steady: bool = True
    rows_right: bool = False
    rows_wrong: bool = False
    ended: bool = False
    within: Within = fresh(default_factory=Within)
    asked: int = 0
    unanswered: list[tuple[Field, Outcome]] = fresh(default_factory=list)
    plain: Outcome | None = None
    measured: Measured | None = None
    words: dict[str, Any] = fresh(default_factory=dict)

    def ask(self, field: Field, isovalues: tuple[float, ...]) -> Outcome:
        """The outcome of one call within the limits, its answer as it came."""
        if self.within.whole and not np.isfinite(field.values).all():
            return Outcome(Status.DECLINED, detail=f"no {self.within.type} is NaN")
        posed, levels = self.within.pose(field, isovalues)
        outcome = self.adapter.answer(Request("check", "plain", posed, levels))
        self.asked += 1
        if outcome.status in UNANSWERED and _has_surface(posed, levels):
            self.unanswered.append((posed, outcome))
        return outcome

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
        count = len(rows_of(plain))
        yield Verdict.PASS, f"{self.kind}: {count} simplices in {milliseconds:.1f} ms"
        yield from self._manners(plain)
        twice = list(doubled(plain, self.kind))
        yield from ((Verdict.FAIL, told) for told in twice)
        self.rows_wrong = bool(twice)
        self.unanswered.clear()
        yield from self._conventions(plain)
        yield from self._unanswered()
        if self.steady:
            yield from self._presentations()
        else:
            told = f"{self.kind}: layouts and types were not compared: no two answers are alike"
            yield Verdict.SKIP, told

    def _unanswered(self) -> Iterator[Advice]:
        """The fields with a surface that ended in an error, though others did not."""
        if not self.unanswered:
            return
        field, outcome = self.unanswered[0]
        verdict, told = ENDED[outcome.status]
        shape = " x ".join(map(str, field.shape))
        more = len(self.unanswered) - 1
        others = f", and on {more} more of the {self.asked} fields asked" if more else ""
        yield (
            verdict,
            f"{told} on a field of {shape} {field.values.dtype} samples{others}: "
            + (outcome.detail),
        )

    def _plain(self) -> Generator[Advice, None, Outcome | None]:
        """Yields why plain fields are not answered; returns the first answer that came, or None."""
        field = ball(self.kind)
        outcome = self.ask(field, levels(self.kind))
        if outcome.status is Status.OK:
            return outcome
        verdict, told = ENDED[outcome.status]
        shape = " x ".join(map(str, field.shape))
        said = told.format(n=self.kind.n, c=self.kind.k + 1)
        told = f"{self.kind}: {said}, on a plain field of {shape} float64 samples"
        # Who hangs, or fills the memory, does so on the next field too.
        for limits in () if outcome.status in (Status.TIMEOUT, Status.MEMORY) else TRIED:
            self.within = Within(limits)
            again = self.ask(field, levels(self.kind))
            if again.status is Status.OK:
                yield (
                    verdict,
                    f"{told}: {outcome.detail}; it takes one that is {self.within.told()}",
                )
                return again
        yield verdict, f"{told}: {outcome.detail}{_hint(outcome)}"
        return None

    def _conventions(self, plain: Outcome) -> Iterator[Advice]:
        """Each convention that is measured to be other than declared."""
        declared = self.declaration.conventions
        measured = measure(self.ask, self.kind)
        posed, _ = self.within.pose(ball(self.kind), levels(self.kind))
        if measured.axes is None:
            self.misplaced = True
            yield Verdict.FAIL, misplaced(plain, posed)
            return
        self.measured = replace(measured, nan=None) if self.within.whole else measured
        different = self.measured.differences(declared)
        for name, said, found in different:
            mend = MEND.get(f"{found} {name}", MEND.get(found, ""))
            told = f'{mend}; or declare "{name}": "{found}" (now "{said}")'
            yield (Verdict.SKIP if name in NEVER_HELD else Verdict.FAIL), told
        seen = {one.name: getattr(self.measured, one.name) for one in fields(self.measured)}
        other = {name for name, _, _ in different}
        as_said = [f"{k} {v}" for k, v in seen.items() if v is not None and k not in other]
        if not other - NEVER_HELD:
            yield Verdict.PASS, f"{self.kind}: measured as it declares: {', '.join(as_said)}"
        if self.kind == SURFACES:
            self.words = words_of(self.ask, plain, self.measured)
            self.plain = plain

    def _index(self) -> Floats:
        """The vertices of the plain answer, in samples."""
        assert self.plain is not None
        assert self.measured is not None
        return index_of(self.plain, ball(self.kind), self.measured)

    def _level(self) -> float | None:
        """The isovalue of the surface that came, where it is another than was asked for."""
        return level_at(self._index(), ball(self.kind), levels(self.kind)[0])

    def _off(self) -> Iterator[Advice]:
        """By how much the ball is off its place, though it is about where it should be."""
        widest = 0.2 if self.words["vertices"] == "edges" else 0.6
        if self.words["interpolant"] == "labels" or self.declaration.vertices == "own":
            widest = 0.7
        if told := shifted(self._index(), ball(self.kind), widest=widest):
            yield Verdict.FAIL, told

    def _words(self) -> Iterator[Advice]:
        """Each of the four words that is measured to be other than declared."""
        said = declaration_json(self.declaration)
        for name, found in self.words.items():
            now = said[name][0]["end"] if name == "domain" else said[name]
            if said_more(self.declaration, name) or now == found:
                continue
            if name == "interpolant" and isinstance(found, dict):
                told = f"{WORDS[name]} looks like {FIVE}, and it declares {json.dumps(now)}"
                yield Verdict.FAIL, f"{told}: say so as below, if it is meant to be"
                continue
            yield Verdict.FAIL, looks_like(name, found, now)

    def _presentations(self) -> Iterator[Advice]:
        """Ways to present the same samples that are not taken for the same."""
        good = True
        for way, posed, twin in presentations(*self._posed_ball(), self.within):
            verdict = _presented(self._raw(*posed), self._raw(*twin), way)
            good = good and verdict is None
            if verdict is not None:
                yield verdict
        if good:
            yield Verdict.PASS, f"{self.kind}: it takes any memory layout and type that was tried"

    def _posed_ball(self) -> tuple[Field, tuple[float, ...]]:
        """The ball within the limits."""
        return self.within.pose(ball(self.kind), levels(self.kind))

    def _raw(self, field: Field, isovalues: tuple[float, ...]) -> Outcome:
        """The outcome of one call, posed as it is."""
        return self.adapter.answer(Request("check", "plain", field, isovalues))

    def _manners(self, plain: Outcome) -> Iterator[Advice]:
        """What else it does beside answering."""
        if plain.input_changed:
            yield Verdict.FAIL, "it writes into the samples it is given: work on a copy"
        again = [self.ask(ball(self.kind), levels(self.kind)) for _ in range(2)]
        self.steady = all(same(plain, one) for one in again)
        if not self.steady:
            yield Verdict.FAIL, "asked twice, it gives two answers: is something left from a call?"
        printed, complained = self.adapter.said()
        if printed:
            yield (
                Verdict.SKIP,
                f"it prints to standard output, which is kept apart: {_line(printed)}",
            )
        if complained:
            yield Verdict.SKIP, f"it prints to standard error, which is kept: {_line(complained)}"

    def cells(self) -> Iterator[Advice]:
        """What single cells and long rows of them show, of surfaces whose place is known."""
        if self.kind != SURFACES or self.measured is None or self.measured.units is None:
            return
        level = levels(self.kind)[0]
        declared = self.declaration.soup is not None
        soup = declared or isinstance(self.words["mesh"], dict)
        on_edges = self.words["vertices"] == "edges"
        # A cube round a long sheet would be large.
        cubes = self.within.limits.get("cubes")
        found = [] if cubes else spans(self.house, soup=soup, border=0.0 if on_edges else 1.0)
        if told := stretch(found):
            yield Verdict.FAIL, told
            self.misplaced = self.rows_wrong = True
            return
        yield from self._words()
        if self.rows_wrong:
            return
        if not self.steady:
            yield Verdict.SKIP, "single cells were not looked at: no two answers are alike"
            return
        if (at := self._level()) is not None:
            told = f"it draws the surface of isovalue {round(at, 6) + 0.0:.3g}, asked for {level:g}"
            yield Verdict.FAIL, f"{told}: is the isovalue used as it is given?"
            self.rows_wrong = True
            return
        self._end(found)
        rows = list(self._rows())
        yield from rows
        self.rows_right = bool(rows) and all(verdict is Verdict.PASS for verdict, _ in rows)
        self.rows_wrong = any(v is Verdict.FAIL and told != NO_CELL for v, told in rows)
        if not self.rows_wrong:
            ended = list(spans_told(found))
            yield from ended
            yield from self._off()
            self.ended = bool(ended)
            self.rows_right = self.rows_right and not ended

    def _end(self, found: list[Span]) -> None:
        """The domain to paste knows how far from the samples the surface ends."""
        ends, domain = inset(found), self.words["domain"]
        if domain == "open" and ends and abs(ends) <= 1:
            self.words["domain"] = {"inset": ends, "end": "open"}
        if domain == "closed" and any(span.low < -NEAR for span in found):
            # Caps beyond the samples stand where the padding is crossed, at most one cell away.
            self.words["domain"] = {"inset": -1.0, "end": "closed"}

    def _rows(self) -> Iterator[Advice]:
        """What is wrong with single cells, of who has vertices on their edges and no caps."""
        assert self.measured is not None
        whole = self.words["interpolant"] in ("multilinear", "labels")
        plain_cells = whole and self.words["vertices"] == "edges"
        if plain_cells and self.words["domain"] == "open":
            order = (2, 1, 0) if self.measured.axes == "reversed" else (0, 1, 2)
            halfway = self.words["interpolant"] == "labels"
            yield from rows_told(self.house, order, halfway=halfway)

    def house(self, field: Field, isovalues: tuple[float, ...]) -> Outcome:
        """The outcome of one call, in the house's conventions as they were measured."""
        request = Request("check", "plain", *self.within.pose(field, isovalues))
        conventions = self._conventions_told(self.declaration.conventions)
        return to_house(self.adapter.answer(request), request, conventions)

    def _conventions_told(self, said: Conventions) -> Conventions:
        """The conventions, changed to what was measured of this kind."""
        if self.measured is None or self.measured.axes is None:
            return said
        new: dict[str, Any] = {name: found for name, _, found in self.measured.differences(said)}
        return replace(said, **new)

    def told(self, declaration: Declaration) -> Declaration:
        """The declaration, changed to what was measured of this kind."""
        limits = replace(declaration.limits, **self.within.limits)
        conventions = self._conventions_told(declaration.conventions)
        declaration = replace(declaration, limits=limits, conventions=conventions)
        if self.words:
            words = {k: v for k, v in self.words.items() if not said_more(declaration, k)}
            said = {**declaration_json(declaration), **words}
            said["level"] = min(said["level"], 4 if exact(said) else 2)
            declaration = declaration_from(said, declaration.name)
        return declaration


Posed = tuple[Field, tuple[float, ...]]
# Powers of two, so that nothing rounds; a fixed tolerance is larger or smaller than all values.
SMALLER, LARGER = -24, 24


def presentations(
    field: Field, isovalues: tuple[float, ...], within: Within
) -> Iterator[tuple[str, Posed, Posed]]:
    """Ways to present samples, with the same samples as they are usually presented."""
    values = field.values
    gaps = np.zeros([2 * n for n in values.shape], values.dtype)
    gaps = gaps[tuple([slice(None, None, 2)] * values.ndim)]
    gaps[...] = values
    plain = field, isovalues
    yield (
        "in Fortran order<; np.ascontiguousarray helps>",
        (_with(field, np.asfortranarray(values)), isovalues),
        plain,
    )
    yield (
        "with gaps in memory<; np.ascontiguousarray helps>",
        (_with(field, gaps), isovalues),
        plain,
    )
    if within.type:
        return
    singles = values.astype(np.float32)
    twin = _with(field, singles.astype(float)), isovalues
    yield "of type float32<; values.astype(float) helps>", (_with(field, singles), isovalues), twin
    whole = np.rint(1000 * values).astype(np.int16)
    asked = tuple(1000 * one for one in isovalues)
    twin = _with(field, whole.astype(float)), asked
    yield "of type int16<; values.astype(float) helps>", (_with(field, whole), asked), twin
    for exponent in (SMALLER, LARGER):
        by = 2.0**exponent
        yield (
            times(exponent),
            (_with(field, values * by), tuple(by * one for one in isovalues)),
            plain,
        )


def _has_surface(field: Field, isovalues: tuple[float, ...]) -> bool:
    """Whether some samples of each component are below its isovalue, and some above."""
    parts = field.values if len(isovalues) > 1 else field.values[None]
    return all(
        bool(np.isfinite(part).all() and part.min() < level < part.max())
        for part, level in zip(parts, isovalues, strict=True)
    )


def _with(field: Field, values: Array) -> Field:
    """The field with other samples, in their own layout."""
    return replace(field, values=values)


def _hint(outcome: Outcome) -> str:
    """What the commonest mistakes of a first call are."""
    if outcome.detail.startswith("TypeError"):
        return "<; it is called as function(values, isovalue, spacing)>"
    if "inhomogeneous" in outcome.detail:
        return (
            "; return a tuple (vertices, simplices): where there is more, return only the first two"
        )
    if "NoneType" in outcome.detail:
        return "; does the function end with `return vertices, simplices`?"
    return ""


def _presented(outcome: Outcome, plain: Outcome, way: str) -> Advice | None:
    """What is wrong with the answer to samples presented in some way."""
    if outcome.status is Status.DECLINED:
        return Verdict.UNSUPPORTED, f"it declines samples {way}: {outcome.detail}"
    if outcome.status is not Status.OK:
        return Verdict.FAIL, f"it fails on samples {way}: {outcome.detail}"
    if plain.status is not Status.OK:
        return None
    if len(rows_of(outcome)) != len(rows_of(plain)) or not _alike(outcome, plain):
        return Verdict.FAIL, another_surface(way)
    return None


def _alike(one: Outcome, other: Outcome) -> bool:
    """Whether the boxes round two answers are the same, but for rounding."""
    boxes = [
        np.stack([points.min(0), points.max(0)])
        for points in (one.vertices, other.vertices)
        if points is not None and len(points)
    ]
    return len(boxes) < 2 or bool(np.abs(boxes[0] - boxes[1]).max() < 1e-3)


def _line(text: str) -> str:
    """The last line of what was printed, in quotes."""
    return repr(text.splitlines()[-1][:80])
