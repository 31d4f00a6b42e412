"""Claims on calls one after another and side by side, and on what they cost.

A caller keeps an answer while asking for the next ones, writes the next volume into the array of
the last, moves the isovalue a little, asks from several threads, asks a thousand times, asks about
a field eight times as large. A program that returns a buffer of its own, that knows a field again
by its array or an isovalue by its first digits, that keeps what is being made in a global, that
never gives memory back, or that looks for a vertex in a list of all vertices is right on every
field of this plan, and unfit for use. Adapters that call in a process of their own can tell
(`isograde.model.Calls`); of others nothing is said.

Costs are measured: the processor's time, not the clock's, and resident memory. Their bounds leave
room for noise and for what is fixed a call. Whoever searches all vertices for each new one takes 64
times as long for an eightfold field; 32 times is held to be too much, where it is enough to
measure at all. Of a call that leaks its answer or its samples, half of them a call is.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import VERDICT_OF, failed, passed, skipped
from isograde.model import Claim, Finding, Judge, Outcome, Status, Trial, Verdict

DESIGN = "isograde design: concurrent calls, large fields with memory and time that grow as work"
COST = frozenset({"cost"})
WORSE = 4.0
"""Times that a cost may grow faster than the field."""

SECONDS, BYTES = 0.05, 1 << 26
"""Costs of the larger field below which nothing can be told from noise, and nothing is wrong."""

CALLS = 40
"""How often the worker asks, after some calls to warm up, before it looks at the memory."""

LEAK = 1 << 20


def buffer(trial: Trial) -> Finding:
    """Pass when the arrays are the same after other fields were asked."""
    return _same(trial, "kept", "its answer changed when other fields were asked: it is no copy")


def again(trial: Trial) -> Finding:
    """Pass when a question that is asked again, among hundreds of others, gets the same arrays.

    The field is the shifted one, since digits of an isovalue are told from the first that is not
    zero. Who is too slow for all the questions cannot pass.
    """
    found = _same(trial, "again", "the same question got another answer later", "shift")
    if found.verdict is Verdict.PASS and (told := trial.outcomes["again"].detail):
        return skipped(told)
    return found


def threads(trial: Trial) -> Finding:
    """Pass when a call gives the same arrays while other threads call."""
    return _same(trial, "threads", "an answer differs when several threads ask at once")


def _same(trial: Trial, name: str, told: str, once: str = "plain") -> Finding:
    """Pass when this variant has the arrays of the one asked once, number for number."""
    asked, outcome = trial.outcomes.get(once), trial.outcomes.get(name)
    if told_why := _unasked(asked) or _unasked(outcome):
        return told_why
    assert asked is not None
    assert outcome is not None
    plain, other = _arrays(asked), _arrays(outcome)
    if not len(plain[1]):
        return skipped("the answer is empty")
    if all(map(np.array_equal, plain, other)):
        return passed(simplices=len(plain[1]))
    return failed(told, variant=name)


def _unasked(outcome: Outcome | None) -> Finding | None:
    """What is said where there is no answer to this; None where there is one."""
    if outcome is None or outcome.status is Status.DECLINED:
        return skipped(outcome.detail if outcome else "the case was not asked in this way")
    if outcome.status is not Status.OK:
        return Finding(VERDICT_OF[outcome.status], outcome.detail)
    return None


def _arrays(outcome: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """The arrays as they came; empty ones where nothing came."""
    nothing = np.empty((0, 0))
    vertices = nothing if outcome.vertices is None else outcome.vertices
    return vertices, nothing if outcome.simplices is None else outcome.simplices


def growth(trial: Trial) -> Finding:
    """Pass when a field eight times as large takes no more than 32 times the time and memory."""
    small, large = (trial.outcomes.get(name) for name in ("timed", "larger"))
    if told_why := _unasked(small):
        return told_why
    assert small is not None
    if large is not None and large.status is Status.TIMEOUT:
        return failed(f"a field {_times(trial)} times as large: {large.detail}", variant="larger")
    if told_why := _unasked(large):
        return told_why
    assert large is not None
    share = WORSE * _times(trial)
    numbers = {
        "seconds": round(small.seconds, 4),
        "seconds_larger": round(large.seconds, 4),
        "bytes": small.peak_bytes,
        "bytes_larger": large.peak_bytes,
    }
    if large.seconds > max(SECONDS, share * small.seconds):
        return failed(
            f"{large.seconds / max(small.seconds, 1e-6):.0f} times the time for "
            f"{_times(trial)} times the samples",
            variant="larger",
            **numbers,
        )
    if large.peak_bytes > max(BYTES, share * max(small.peak_bytes, trial.field.values.nbytes)):
        return failed(
            f"{large.peak_bytes >> 20} MB for {_times(trial)} times the samples, which took "
            f"{small.peak_bytes >> 20} MB",
            variant="larger",
            **numbers,
        )
    return passed(**numbers)


def _times(trial: Trial) -> int:
    """How many times as many samples the larger field has."""
    return int(2**trial.kind.n)


def leak(trial: Trial) -> Finding:
    """Pass when many calls leave less memory behind than half of their answers, or samples."""
    outcome = trial.outcomes.get("many")
    if told_why := _unasked(outcome):
        return told_why
    assert outcome is not None
    sizes = [sum(part.nbytes for part in _arrays(outcome)), trial.field.values.nbytes]
    allowed = max(LEAK, CALLS * min(sizes) // 2)
    if outcome.peak_bytes <= allowed:
        return passed(bytes_a_call=outcome.peak_bytes // CALLS)
    return failed(
        f"{CALLS} calls leave {outcome.peak_bytes >> 20} MB behind, about "
        f"{outcome.peak_bytes // CALLS // 1024} kB a call",
        variant="many",
        bytes_a_call=outcome.peak_bytes // CALLS,
    )


def _claim(name: str, rule: str, judge: Judge, *asked: str) -> Claim:
    """A claim of this family, beside the ladder: few adapters can tell."""
    return Claim(
        f"calls.{name}",
        rule,
        DESIGN,
        None,
        judge,
        tags=COST,
        variants=asked,
        needs_mesh=False,
        promised=False,
    )


CLAIMS = (
    _claim("buffer", "An answer stays as it is when other fields are asked.", buffer, "kept"),
    _claim(
        "again",
        "The same question gets the same arrays: after other samples were written into its array, "
        "after another isovalue close by, and 255 and 256 calls later.",
        again,
        "shift",
        "again",
    ),
    _claim("threads", "Several threads that ask at once get the same arrays.", threads, "threads"),
    _claim(
        "growth",
        "Time and memory grow about as the field does: no more than four times as fast.",
        growth,
        "timed",
        "larger",
    ),
    _claim("leak", "Memory is given back: many calls take no more than a few.", leak, "many"),
)
