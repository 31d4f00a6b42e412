"""The ways in which a worker puts a request: what is asked, and in which order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from isograde.adapters.loading import as_called
from isograde.adapters.worker import (
    FORGOTTEN,
    LARGER,
    OTHERS,
    PERIOD,
    WAYS,
    Asked,
    Memory,
)
from isograde.model import CONTOURS, CURVES, SURFACES, Kind

SHAPES = {CONTOURS: (5, 7), SURFACES: (5, 6, 7), CURVES: (2, 5, 6, 7)}


class Recorder:
    """An extractor that answers with the sum of the samples, and knows what it was asked."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self.asked: list[tuple[int, np.ndarray, Any]] = []

    def __call__(self, values: Any, isovalue: Any, spacing: Any) -> Any:
        """One simplex, at a place that the samples tell."""
        self.asked.append((id(values), values.copy(), isovalue))
        k = self.kind.k
        points = np.arange((k + 1) * self.kind.n, dtype=float).reshape(k + 1, -1)
        return points + values.sum(), np.arange(k + 1)[None]


def asked(function: Recorder, seconds: float = 60.0, dtype: str = "f8") -> Asked:
    """A request of some samples at isovalues about their middle."""
    kind = function.kind
    values = np.random.default_rng(0).integers(1, 99, SHAPES[kind]).astype(dtype)
    places = (50.0,) * kind.m, (1.0,) * kind.n
    return Asked(as_called(function, 3), values, places, kind, Memory(), seconds)


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("dtype", ["f8", "u1"])
def test_again_asks_the_real_question_after_a_byte_of_others(kind: Kind, dtype: str) -> None:
    """255 and 256 calls after its halves, and once after an isovalue that differs a little."""
    function = Recorder(kind)
    request = asked(function, dtype=dtype)
    real = request.given.copy()
    assert np.array_equal(WAYS["again"](request)[0], WAYS["once"](request)[0])
    assert np.array_equal(request.given, real)
    assert request.told == ""

    levels = function.asked[-1][2]
    first, *rest = function.asked[:-1]
    assert first[0] not in {one for one, _, _ in rest}
    assert {one for one, _, _ in rest} == {id(request.given)}
    same = [np.array_equal(values, real) for _, values, _ in rest]
    last = len(rest) - 1
    assert np.flatnonzero(same).tolist() == [FORGOTTEN, FORGOTTEN + 1, last]
    close = rest[FORGOTTEN][2]
    assert np.all(np.not_equal(close, levels))
    assert np.allclose(close, levels, rtol=1e-8, atol=0)
    assert all(level == levels for number, (_, _, level) in enumerate(rest) if number != FORGOTTEN)
    assert f"{np.ravel(close)[0]:g}" == f"{np.ravel(levels)[0]:g}"

    # Each half is in the table, and nothing that has more than one sample on its side comes after.
    halves = [rest[last - PERIOD][1], rest[last - PERIOD + 1][1]]
    middle, lattice = real.shape[-kind.n] // 2, np.moveaxis(real, -kind.n, 0)
    assert np.array_equal(np.moveaxis(halves[0], -kind.n, 0)[middle:], lattice[middle:])
    assert np.array_equal(np.moveaxis(halves[1], -kind.n, 0)[:middle], lattice[:middle])
    spikes = np.array([values for _, values, _ in rest[last - PERIOD + 2 : last]])
    high = (spikes > 50).reshape(len(spikes), kind.m, -1)
    assert (high.sum(axis=2) == 1).all()
    count = real.size // kind.m
    assert len(np.unique(high.argmax(axis=2)[:count])) == min(count, PERIOD - 2)


def test_again_returns_the_answer_that_differs() -> None:
    """An answer that is right at the end is not enough."""
    function = Recorder(SURFACES)
    request = asked(function)
    right = request.extract

    def once_wrong(*questions: Any) -> Any:
        vertices, simplices = right(*questions)
        return vertices + (len(function.asked) == FORGOTTEN + 3), simplices

    alone = WAYS["once"](request)
    function.asked.clear()
    request.extract = once_wrong
    assert np.array_equal(WAYS["again"](request)[0], alone[0] + 1)
    assert len(function.asked) == FORGOTTEN + 3


def test_who_is_too_slow_is_not_asked_everything_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """That is said; the question is asked a second time, after another, where time allows."""
    for share, calls in ((0.0, 1), (0.3, 3)):
        now = [0.0]
        monkeypatch.setattr("isograde.adapters.worker.time.monotonic", lambda now=now: now[0])
        function = Recorder(SURFACES)
        request = asked(function, seconds=60.0)
        right = request.extract

        def slow(*questions: Any, right: Any = right, now: Any = now, share: Any = share) -> Any:
            now[0] += 18.0 if share else 19.0
            return right(*questions)

        request.extract = slow
        WAYS["again"](request)
        assert len(function.asked) == calls
        assert request.told.startswith("it is too slow: ")
        function.asked.clear()
        WAYS["kept"](request)
        assert len(function.asked) == 2


def test_samples_that_cannot_be_written_are_not_asked_again() -> None:
    request = asked(Recorder(SURFACES))
    request.given.flags.writeable = False
    with pytest.raises(NotImplementedError, match="cannot be written"):
        WAYS["again"](request)


@pytest.mark.parametrize("kind", SHAPES)
def test_an_answer_is_kept_while_others_and_larger_ones_are_asked(kind: Kind) -> None:
    """Of the same samples in other orders, so that their answers are as large."""
    function = Recorder(kind)
    request = asked(function)
    WAYS["kept"](request)
    (_, real, _), *others = function.asked
    assert len(others) == OTHERS + LARGER
    for _, values, _ in others[:OTHERS]:
        assert values.shape == real.shape
        assert not np.array_equal(values, real)
        assert np.array_equal(np.sort(values, axis=None), np.sort(real, axis=None))
    assert all(values.size == 2 * real.size for _, values, _ in others[OTHERS:])
