"""How far the answer stays the same: over which magnitudes, and on what offsets.

Level 2 asks for the same answer to values four times as large and to values moved by about their
size (`isograde.claims.symmetry`). How much farther it stays is a matter of degree: a program that
calculates in single precision must overflow somewhere, and one with an absolute tolerance changes
its answer much sooner. So values are multiplied by powers of two from 1e-300 to 1e300, moved by up
to a million times their range, without a digit being lost, and it is said how far the answer went.
What fails of `range.scale` and `range.shift` is an answer that changes within what single precision
has room for: values a thousand million times as small or as large, and a thousand times their range
away from zero. Who keeps the digits of doubles, or bears samples of 1e300 beside ordinary ones, can
promise that as well: `range.digits`, `range.extremes`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from isoref.field import Field
from scipy.ndimage import maximum_filter

from isograde import variants
from isograde.claims import topology
from isograde.claims.evidence import VERDICT_OF, complex_of, failed, on_mesh, passed, skipped
from isograde.claims.symmetry import compared, same_simplices
from isograde.model import Claim, Finding, Status, Trial, Verdict
from isograde.oracles.lattice import components

DESIGN = "isograde design: magnitudes from tiny to huge, offsets that eat the mantissa"
LESS = tuple(word for word in variants.MAGNITUDES if word[2] == "-")
MORE = tuple(word for word in variants.MAGNITUDES if word[2] == "+")


# The answer must not change up to here; beyond, how far it stays is told.
ROOM = ("2^-10", "2^-20", "2^-30", "2^+10", "2^+20", "2^+30", "2^10")
# Offsets at which single precision has at most a few digits left of the range, and doubles all.
BEYOND = tuple(word for word in variants.OFFSETS if word not in ROOM)
# A sample this much smaller than one across the surface is where a coordinate rounds to it.
ROUNDED = 2.0**-48


def scale(trial: Trial) -> Finding:
    """Pass when the answer is the same from 2^-30 to 2^30; how far it stays is measured."""
    return _told(trial, {"least": ("magnitude/", LESS), "greatest": ("magnitude/", MORE)})


def shift(trial: Trial) -> Finding:
    """Pass when the answer is the same 2^10 times the range away; how far it stays is measured."""
    return _told(trial, {"offset": ("offset/", tuple(variants.OFFSETS))})


def digits(trial: Trial) -> Finding:
    """Pass when the answer is the same where single precision has no digits left for the range."""
    if not len(complex_of(trial).simplices):
        return skipped("the answer is empty")
    asked = 0
    for word in BEYOND:
        outcome = trial.outcomes.get(f"offset/{word}")
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        asked += 1
        variant = variants.variant(f"offset/{word}", trial.kind)
        finding = compared(trial, outcome, variant, same_simplices)
        if finding.verdict is not Verdict.PASS:
            return finding
    return passed(offsets=asked) if asked else skipped("neither values nor limits allow it")


def extremes(trial: Trial) -> Finding:
    """Pass when the mesh is closed and on the right side of samples, some of them of 1e300."""
    outcome = trial.outcomes.get("extremes")
    if outcome is None or outcome.status is Status.DECLINED:
        return skipped("neither values nor limits allow it")
    if outcome.status is not Status.OK:
        return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": "extremes"})
    posed = variants.pose("extremes", trial.case, trial.field)
    assert posed is not None, "a variant that was asked was posed"
    field, isovalues = posed
    case = replace(trial.case, isovalues=isovalues)
    if outcome.mesh_of(trial.kind) is None:
        told = "extremes: what came is no mesh of finite coordinates"
        return failed(told, variant="extremes")
    # Who sees inside and outside alone has no crossing near a sample.
    labels = trial.declaration.interpolant == "labels"
    asked = [(topology.closed, field)] if topology.has_facets(trial.kind) else []
    asked.append((topology.sides, field if labels else _touched(field, isovalues)))
    passes = 0
    for judge, posed_field in asked:
        finding = judge(Trial(case, posed_field, trial.declaration, {"plain": outcome}))
        if finding.verdict is Verdict.FAIL:
            return failed(f"extremes: {finding.detail}", variant="extremes")
        passes += finding.verdict is Verdict.PASS
    return passed(held=passes) if passes else skipped("nothing could be judged")


def _touched(field: Field, isovalues: tuple[float, ...]) -> Field:
    """The field, where each sample to which the surface beside it rounds is on the isovalue itself.

    A crossing between 1e300 and 1 is 1e-300 from the sample of 1: no coordinate but 0 tells the two
    apart, so no mesh can be asked on which side of it the sample is. A vertex inside a cell comes
    as near to a corner that shares no edge with the one of 1e300.
    """
    several = np.array(components(field), np.float64)
    for values, isovalue in zip(several, isovalues, strict=True):
        above = values - isovalue
        size, inside = np.abs(above), above >= 0
        outer, inner = (maximum_filter(np.where(side, size, 0.0), 3) for side in (~inside, inside))
        values[size < ROUNDED * np.where(inside, outer, inner)] = isovalue
    return replace(field, values=several.reshape(field.values.shape))


def _told(trial: Trial, ways: dict[str, tuple[str, tuple[str, ...]]]) -> Finding:
    """How far the answer stays in each of these directions."""
    if not len(complex_of(trial).simplices):
        return skipped("the answer is empty")
    numbers: dict[str, str] = {}
    faults: list[Finding] = []
    asked = 0
    for end, (prefix, words) in ways.items():
        numbers[end], fault, count = _farthest(trial, prefix, words)
        asked += count
        faults += [fault] if fault else []
    if not asked:
        return skipped("neither values nor limits allow it")
    if not faults:
        return passed(**numbers)
    told = "; ".join(fault.detail for fault in faults)
    return failed(told, **numbers, variant=faults[0].numbers["variant"])


def _farthest(trial: Trial, prefix: str, words: Iterable[str]) -> tuple[str, Finding | None, int]:
    """The last of the words at which the answer is the plain one, a fault if any, how many."""
    last, asked = "1" if prefix == "magnitude/" else "0", 0
    for word in words:
        outcome = trial.outcomes.get(prefix + word)
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        asked += 1
        variant = variants.variant(prefix + word, trial.kind)
        finding = compared(trial, outcome, variant, same_simplices)
        if finding.verdict is not Verdict.PASS:
            return last, finding if word in ROOM else None, asked
        last = word
    return last, None, asked


CLAIMS = (
    Claim(
        "range.scale",
        "Values and isovalue times any power of two from 2^-30 to 2^30 give the same mesh; it is "
        "measured up to 1e300 and down to 1e-300 how far it stays.",
        DESIGN,
        None,
        on_mesh(scale),
        tags=frozenset({"ranges"}),
        variants=("magnitude/",),
        promised=False,
    ),
    Claim(
        "range.shift",
        "Values and isovalue moved by 2^10 times their range give the same mesh; it is measured up "
        "to a million times how far it stays.",
        DESIGN,
        None,
        on_mesh(shift),
        tags=frozenset({"ranges"}),
        variants=("offset/",),
        promised=False,
    ),
    Claim(
        "range.digits",
        "Values and isovalue moved by a million times their range, which doubles hold without "
        "losing a digit and single precision does not, give the same mesh.",
        DESIGN,
        None,
        on_mesh(digits),
        tags=frozenset({"ranges"}),
        variants=tuple(f"offset/{word}" for word in BEYOND),
        promised=False,
    ),
    Claim(
        "range.extremes",
        "Where samples of 1e300 stand beside ordinary ones, either side of the isovalue, the mesh "
        "is finite, closed, and on the right side of the samples.",
        DESIGN,
        None,
        on_mesh(extremes),
        tags=frozenset({"ranges"}),
        variants=("extremes",),
        promised=False,
    ),
)
