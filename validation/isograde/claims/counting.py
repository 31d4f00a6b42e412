"""Claims on how many triangles there are.

Every polygon of n nodes with discs for a surface takes n - 2 triangles, and two more for every
vertex inside the cell; a tunnel between two polygons takes four more. That is Euler's formula: a
cell's surface of Euler characteristic X with B boundary segments and I inner vertices has

    F = B + 2 I - 2 X

triangles. So the count gives X away, and X can only be the number of polygons, P (discs), or
P - 2 (a tunnel). A bubble, a missing or a doubled triangle gives another.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import failed, on_triangles, passed, traces_of, undecided
from isograde.model import Claim, Finding, Trial


def triangles(trial: Trial) -> Finding:
    """Pass when every cell has as many triangles as discs or one tunnel on its polygons take."""
    traces = traces_of(trial).settled
    judged = ~traces.tied & ~traces.unjudged & (traces.separated | traces.joined).all(axis=1)
    more = traces.excess
    tunnel = (more == 4) & (traces.polygons >= 2)
    bad = np.flatnonzero(judged & (more != 0) & ~tunnel)
    if not len(bad):
        return undecided(trial, traces.unjudged) or passed(
            cells=int(judged.sum()),
            tunnels=int((judged & tunnel).sum()),
            triangles=int(traces.triangles[judged].sum()),
        )
    first = int(bad[0])
    return failed(
        f"{len(bad)} cells; the one at {traces.place[first].tolist()} has "
        f"{int(traces.triangles[first])} triangles where {int(traces.polygons[first])} polygons "
        f"of {int(traces.segments[first])} segments in all and {int(traces.extra[first])} inner "
        f"vertices take {int((traces.triangles - more)[first])}",
        cells=len(bad),
        cell=traces.place[first].tolist(),
        signs=int(traces.signs[first]),
        found=int(traces.triangles[first]),
        wanted=int((traces.triangles - more)[first]),
    )


CLAIMS = (
    Claim(
        id="counting.triangles",
        rule="A cell whose polygons have n nodes each has the sum of n - 2 triangles, two more for "
        "each inner vertex, and four more for a tunnel.",
        source="Euler's formula; Schlei 2010, Tables II to IV; Haiman's count for one simplex",
        level=2,
        judge=on_triangles(triangles),
        unless=frozenset({"on-edges", "welded"}),
    ),
)
