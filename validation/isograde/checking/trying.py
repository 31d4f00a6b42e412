"""One kind of answer, tried with a handful of calls."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.adapters.measure import Measured, ball, levels, measure
from isograde.adapters.process import ProcessAdapter
from isograde.checking.arrays import malformed, rows_of, same
from isograde.checking.checked import Advice
from isograde.checking.limits import other_fields, told_limits
from isograde.checking.places import misplaced
from isograde.checking.words import WORDS, exact, said_more, words_of
from isograde.declaration import Declaration, declaration_from, declaration_json
from isograde.model import SURFACES, Kind, Outcome, Request, Status, Verdict

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
        count = len(rows_of(plain))
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
                yield (
                    verdict,
                    f"{told}: {outcome.detail}; it takes one that is {told_limits(limits)}",
                )
                return again
        yield verdict, f"{told}: {outcome.detail}{_hint(outcome)}"
        return None

    def _conventions(self, plain: Outcome) -> Iterator[Advice]:
        """Each convention that is measured to be other than declared."""
        declared = self.declaration.conventions
        self.measured = measure(self.ask, self.kind)
        if self.measured.axes is None:
            yield Verdict.FAIL, misplaced(plain, ball(self.kind))
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
            if said_more(self.declaration, name) or now == found:
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
        if not same(plain, again):
            yield Verdict.FAIL, "asked twice, it gives two answers: is something left from a call?"
        printed, complained = self.adapter.said()
        if printed:
            yield (
                Verdict.SKIP,
                f"it prints to standard output, which is kept apart: {_line(printed)}",
            )
        if complained:
            yield Verdict.SKIP, f"it prints to standard error, which is kept: {_line(complained)}"

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
            words = {k: v for k, v in self.words.items() if not said_more(declaration, k)}
            said = {**declaration_json(declaration), **words}
            said["level"] = min(said["level"], 4 if exact(said) else 2)
            declaration = declaration_from(said, declaration.name)
        return declaration


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


def _presented(outcome: Outcome, plain: Outcome, way: str) -> Advice | None:
    """What is wrong with the answer to samples presented in some way."""
    if outcome.status is Status.DECLINED:
        return Verdict.UNSUPPORTED, f"it declines samples {way}: {outcome.detail}"
    if outcome.status is not Status.OK:
        return Verdict.FAIL, f"it fails on samples {way}: {outcome.detail}"
    if len(rows_of(outcome)) != len(rows_of(plain)):
        return Verdict.FAIL, f"it gives another surface for the same samples {way}"
    return None


def _line(text: str) -> str:
    """The last line of what was printed, in quotes."""
    return repr(text.splitlines()[-1][:80])
