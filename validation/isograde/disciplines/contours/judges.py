"""What is right for contours in the plane; pure functions of them in index coordinates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.claims.evidence import failed, passed
from isograde.model import Finding
from isograde.oracles import planar
from isograde.oracles.planar import Booleans, Points

Contours = list[Points]

RULES = ("separate", "join", "mean", "saddle")


def no_crossing(contours: Contours) -> Finding:
    """No two segments cross."""
    parts = planar.segments(contours)
    pairs = planar.crossing_pairs(parts)
    if len(pairs):
        at = parts[pairs[0, 0]].mean(axis=0).round(6).tolist()
        return failed(f"{len(pairs)} pairs of segments cross, one near {at}", pairs=len(pairs))
    return passed(segments=len(parts))


def separates(contours: Contours, inside: Booleans) -> Finding:
    """Contours cross the step between two samples oddly often where their sides differ."""
    return _steps(contours, inside, lambda crossed, expected: (crossed - expected) % 2 != 0)


def oriented(contours: Contours, inside: Booleans) -> Finding:
    """Going along a contour, the inside is on the left."""
    return _steps(contours, inside, lambda crossed, expected: crossed != expected)


def _steps(contours: Contours, inside: Booleans, wrong: Callable[[Any, Any], Booleans]) -> Finding:
    """Fails at the first step along either axis whose crossings are wrong for its two sides."""
    parts = planar.segments(contours)
    for axis in (0, 1):
        sides = inside.astype(np.int64)
        crossed = planar.crossings(parts, inside.shape, axis)
        bad = np.argwhere(wrong(crossed, -np.diff(sides, axis=axis)))
        if len(bad):
            i, j = bad[0].tolist()
            return failed(
                f"{len(bad)} steps along axis {axis}, the first from sample ({i}, {j}): crossed "
                f"{int(crossed[i, j])} times from right to left",
                axis=axis,
                sample=[i, j],
            )
    return passed(samples=int(inside.size))


def legal(contours: Contours, inside: Booleans) -> Finding:
    """In each square the segments join edges as one of its legal resolutions does."""
    found = planar.squares(planar.segments(contours))
    expected = planar.legal(inside)
    for square in sorted(found.keys() | expected.keys()):
        pairs = found.get(square, [])
        if len(set(pairs)) != len(pairs) or set(pairs) not in expected.get(square, [set()]):
            shown = [sorted(map(str, pair)) for pair in pairs]
            return failed(f"square {list(square)} has segments {shown}", square=list(square))
    return passed(squares=len(expected))


def one_rule(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """One of the four rules decides every ambiguous square."""
    decided = _decisions(contours, values, isovalue)
    fitting = [
        rule for rule in RULES if all(answer[rule] in (did, None) for did, answer in decided)
    ]
    if not fitting:
        return failed("no rule decides all ambiguous squares so", ambiguous=len(decided))
    return passed(rules=fitting, ambiguous=len(decided))


def bilinear(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """Every ambiguous square is decided by the saddle of the bilinear interpolant."""
    decided = _decisions(contours, values, isovalue)
    wrong = sum(answer["saddle"] not in (did, None) for did, answer in decided)
    if wrong:
        return failed(f"{wrong} of {len(decided)} ambiguous squares are decided otherwise")
    return passed(ambiguous=len(decided))


def _decisions(
    contours: Contours, values: NDArray[Any], isovalue: float
) -> list[tuple[bool, dict[str, bool | None]]]:
    """For each ambiguous square that is legal: whether it is joined, and what the rules say."""
    found = planar.squares(planar.segments(contours))
    decided = []
    for (i, j), answers in planar.legal(values >= isovalue).items():
        pairs = set(found.get((i, j), []))
        if len(answers) == 2 and pairs in answers:
            rules = planar.joins(values[i : i + 2, j : j + 2], isovalue)
            decided.append((pairs == answers[1], rules))
    return decided


def on_edges(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """Every point is where linear interpolation along a lattice edge takes the isovalue."""
    worst, top = 0.0, np.array(values.shape) - 1
    for place in np.concatenate([*contours, np.empty((0, 2))]):
        if not ((place >= 0) & (place <= top)).all():
            return failed(f"point {place.tolist()} is outside the lattice", at=place.tolist())
        edge = planar.edge_of(place)
        if edge is None:
            return failed(f"point {place.tolist()} is on no lattice edge", at=place.tolist())
        i, j, axis = edge
        low, high = (float(values[i + s * (1 - axis), j + s * axis]) - isovalue for s in (0, 1))
        if (low >= 0) == (high >= 0):
            return failed(f"edge {list(edge)} does not take the isovalue", edge=list(edge))
        worst = max(worst, abs(place[axis] - (i, j)[axis] - low / (low - high)))
    if worst > planar.SNAP:
        return failed(f"a point is {worst:.3g} of an edge from where it should be", worst=worst)
    return passed(worst=worst)


def area(contours: Contours, known: Mapping[str, Any]) -> Finding:
    """Closed contours enclose the known area, up to a share that falls with the square's size."""
    found = planar.enclosed_area(contours)
    if abs(found - known["area"]) > known["tolerance"]:
        return failed(f"area {found:.6g}, where it is {known['area']:.6g}", area=found)
    return passed(area=found, expected=known["area"])


def same_transposed(contours: Contours, transposed: Contours) -> Finding:
    """The transposed field has the same segments, with their coordinates exchanged."""
    one = planar.segments(contours)
    other = planar.segments(transposed)[..., ::-1]
    if len(one) != len(other):
        return failed(f"{len(one)} segments, {len(other)} of the transposed field")
    worst = max(planar.farthest(one, other), planar.farthest(other, one))
    if worst > planar.SNAP:
        return failed(f"segments differ by up to {worst:.3g} of an edge", worst=worst)
    return passed(segments=len(one))
