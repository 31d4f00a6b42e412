"""The films of the lessons, computed by `isoref` and, where the grader speaks, by `isograde`.

    python docs/course/figures.py

writes ``docs/course/made/film_N.html``, one fragment a lesson, which lessons and slides include.
The fragments are committed, so that the site builds without this program; a test compares them
with what is made now. No number in a caption is typed in.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
from isograde.proof.meetings import meetings_of
from isograde.proof.tiles import cases, cell_of
from isoref import (
    asymptotic_decider,
    dual,
    dual_marching_cubes,
    kuhn,
    surface_nets,
    trilinear_cubes,
    vesta,
)
from isoref.cube import CORNERS, EDGES, FACE_CORNERS, REPRESENTATIVES, configuration, inside
from isoref.cycles import ALL_JOINED, ALL_SEPARATED, Polygon, cycles, segments, triangulate
from isoref.diconex import diconex
from isoref.fast import simplicial
from isoref.field import Array, Field, Floats
from isoref.methods import RULES
from isoref.simplex_section import haiman_count
from isoref.surface_intersection import (
    enhanced_marching_cubes,
    intersection_curves,
    surface_intersection,
)
from isoref.sweep import sweep

sys.path.insert(0, str(Path(__file__).parent))

from film import BLUE, GOLD, GREEN, GREY, INSIDE, OUTSIDE, RED, Film, Step

MADE = Path(__file__).parent / "made"
CUBE = np.array(CORNERS, float)
COLOURS = (GOLD, BLUE, GREEN, "#c07ad6")


def middle(e: int) -> Floats:
    """The middle of an edge of the unit cube."""
    a, b = EDGES[e]
    return np.asarray((CUBE[a] + CUBE[b]) / 2)


def cube_into(step: Step, signs: int | None = None, at: Iterable[float] = (0, 0, 0)) -> None:
    """A cell is drawn, with its inside and outside corners where they are known."""
    shift = np.array(list(at), float)
    for a, b in EDGES:
        step.line([CUBE[a] + shift, CUBE[b] + shift])
    if signs is not None:
        for c in range(8):
            step.dot(CUBE[c] + shift, INSIDE if inside(signs, c) else OUTSIDE)


def counted(number: int, one: str, many: str = "") -> str:
    """A number with its noun.

    >>> counted(1, "triangle"), counted(2, "triangle")
    ('1 triangle', '2 triangles')
    """
    return f"{number:,} {one if number == 1 else many or one + 's'}"


# --- lessons 1 to 5 -----------------------------------------------------------------------------


def line_of_samples() -> Film:
    """The thermometer of lesson 1, asked for one temperature after the other."""
    values = [3.0, 5.0, 4.0, 1.0, 2.0]
    steps = []
    for isovalue in (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5):
        places = [
            i + (low - isovalue) / (low - high)
            for i, (low, high) in enumerate(pairwise(values))
            if (low >= isovalue) != (high >= isovalue)
        ]
        at = " and ".join(f"{x:.3g}" for x in places)
        tied = values.count(isovalue)
        told = f", {counted(tied, 'sample')} tied and so inside" if tied else ""
        step = Step(
            f"Isovalue {isovalue:g}: {counted(len(places), 'crossing')}"
            f"{f', at {at}' if places else ''}{told}."
        )
        step.line([(-0.3, isovalue), (4.3, isovalue)], BLUE, 2, dash=1)
        step.line(list(enumerate(values)), GREY, 2)
        for i, value in enumerate(values):
            step.dot((i, value), INSIDE if value >= isovalue else OUTSIDE, 7)
            step.text((i, value), f"{value:g}")
        for x in places:
            step.dot((x, isovalue), RED, 5)
        steps.append(step)
    return Film(
        "A line of five samples, and its crossings while the isovalue rises",
        steps, (2, 3), (8.5, 6.2), flat=True,
    )  # fmt: skip


def ambiguous_square() -> Film:
    """One square while the isovalue falls past its saddle; the true contour, finely."""
    a, b, c, d = 4.0, -1.7, 0.5, -1.7
    fine = np.linspace(0, 1, 41)
    s, t = np.meshgrid(fine, fine, indexing="ij")
    bilinear = a * (1 - s) * (1 - t) + b * s * (1 - t) + c * s * t + d * (1 - s) * t
    saddle, mean = (a * c - b * d) / (a + c - b - d), (a + b + c + d) / 4
    corners = {(0, 0): a, (1, 0): b, (1, 1): c, (0, 1): d}
    steps = []
    for isovalue in (0.0, -0.05, -0.1, -0.11, -0.12, -0.2, -0.4, -0.6):
        joined = saddle >= isovalue
        step = Step(
            f"Isovalue {isovalue:g}, which is subtracted: S is {saddle - isovalue:.3f}, "
            f"{'inside: joined' if joined else 'outside: separated'}. The mean is "
            f"{mean - isovalue:.3f}, {'inside' if mean >= isovalue else 'outside'}."
        )
        for one, other in pairwise([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]):
            step.line([one, other], GREY, 2)
        for line in diconex(bilinear, isovalue, mode="mixed").polygons():
            step.line(line / 40, BLUE, 3)
        for place, value in corners.items():
            step.dot(place, INSIDE if value >= isovalue else OUTSIDE, 8)
            step.text(place, f"{value:g}")
        step.dot(((a - d) / (a + c - b - d), (a - b) / (a + c - b - d)), RED, 6)
        steps.append(step)
    return Film(
        "An ambiguous square while the isovalue falls past its saddle, the red point",
        steps, (0.5, 0.5), (2.2, 1.4), flat=True,
    )  # fmt: skip


def fifteen() -> Film:
    """One pattern of each configuration, with its triangles, every ambiguous face separated."""
    steps = []
    for name, corners in enumerate(REPRESENTATIVES):
        signs = sum(1 << c for c in corners)
        like = sum(configuration(one) == name for one in range(256))
        polygons = cycles(signs, ALL_SEPARATED)
        rows = [triangle for polygon in polygons for triangle in triangulate(polygon) or ()]
        step = Step(
            f"Configuration {name}, {counted(len(corners), 'inside corner')}: "
            f"{counted(len(rows), 'triangle')}; {counted(like, 'pattern')} of 256."
        )
        cube_into(step, signs)
        for k, polygon in enumerate(polygons):
            for triangle in triangulate(polygon) or ():
                step.face([middle(e) for e in triangle], COLOURS[k % 4])
        steps.append(step)
    return Film(
        "The fifteen configurations of a cell, each with its triangles",
        steps, (0.5, 0.5, 0.5), (2.0, 1.7),
    )  # fmt: skip


def hole() -> Film:
    """Two cells by the drawings of 1987, and by three rules that close them."""
    values = -np.ones((3, 2, 2))
    values[1, 0, 0] = values[1, 1, 1] = 1.0
    values[2] = 1.0
    field = Field.of(values)
    steps = []
    for rule, words in (
        (RULES["lorensen-cline"], "The drawings of 1987"),
        (RULES["marching-vesta-disconnect-L"], "Inside corners always separated"),
        (RULES["marching-vesta-connect-L"], "Inside corners always joined"),
        (asymptotic_decider.RULE, "The asymptotic decider of lesson 5"),
    ):
        mesh = sweep(rule, field, 0.0)
        ends = open_edges(mesh.simplices, mesh.vertices)
        step = Step(
            f"{words}: {counted(len(mesh.simplices), 'triangle')}, "
            f"{counted(len(ends), 'edge')} on the face between the cells with one triangle."
        )
        for x in (0, 1):
            cube_into(step, at=(x, 0, 0))
        for index in np.ndindex(values.shape):
            step.dot(index, INSIDE if values[index] > 0 else OUTSIDE)
        step.mesh(mesh.vertices, mesh.simplices, GOLD, 0.85)
        for pair in ends:
            step.line(mesh.vertices[list(pair)], RED, 6)
        steps.append(step)
    return Film(
        "Two cells with an ambiguous face between them, and the hole of 1987 in red",
        steps, (1, 0.5, 0.5), (2.6, 1.9), (0.5, 0.3),
    )  # fmt: skip


def open_edges(simplices: Array, vertices: Floats) -> list[tuple[int, ...]]:
    """The edges with one triangle that lie in the plane between the cells."""
    uses: dict[tuple[int, ...], int] = {}
    for row in simplices.tolist():
        for pair in combinations(sorted(row), 2):
            uses[pair] = uses.get(pair, 0) + 1
    return [e for e, n in uses.items() if n == 1 and (vertices[list(e), 0] == 1).all()]


def a_face_decides() -> Film:
    """A cell of configuration 3 while one value falls: its saddle, its mean, and its surface."""
    steps = []
    for value in (1.2, 1.0, 0.8, 0.6, 0.4, 0.3, 0.2):
        g = np.array([2.0, -0.8, -0.9, value, -1.0, -1.0, -1.0, -1.0])
        a, b, c, d = (float(g[corner]) for corner in (0, 1, 3, 2))
        saddle, mean = (a * c - b * d) / (a + c - b - d), (a + b + c + d) / 4
        mesh = sweep(asymptotic_decider.RULE, Field.of(g.reshape(2, 2, 2, order="F")), 0.0)
        step = Step(
            f"The value at corner 3 is {value:g}: saddle {saddle:.3f}, "
            f"{'joined' if saddle >= 0 else 'separated'}, "
            f"{counted(len(mesh.simplices), 'triangle')}. The mean of the face is {mean:.3f}."
        )
        cube_into(step, int(((g >= 0) * (1 << np.arange(8))).sum()))
        step.face(CUBE[list(FACE_CORNERS[4])], GREY, 0.25)
        step.mesh(mesh.vertices, mesh.simplices, GOLD if saddle >= 0 else BLUE)
        step.text(CUBE[3], f"{value:g}")
        steps.append(step)
    return Film(
        "A cell whose lower face is ambiguous, while the value at one corner falls",
        steps, (0.5, 0.5, 0.5), (2.0, 1.7), (0.6, 0.6),
    )  # fmt: skip


# --- lesson 6 -----------------------------------------------------------------------------------

# Two polygons, one of five sides, and an ambiguous face.
FOLLOWED = 0b00011110


def polygons_of_a_cell() -> Film:
    """Segments on the faces, followed to polygons, cut into triangles; and a chord on a face."""
    steps = []
    found = cycles(FOLLOWED, ALL_SEPARATED)

    # Draw the segments face by face.
    drawn: list[tuple[int, int]] = []
    for f in range(6):
        new = segments(FOLLOWED, f, separated=True)
        drawn += new
        step = Step(f"Face {f} has {counted(len(new), 'segment')}; {len(drawn)} so far.")
        cube_into(step, FOLLOWED)
        step.face(CUBE[list(FACE_CORNERS[f])], GREY, 0.2)
        for a, b in drawn:
            step.line([middle(a), middle(b)], RED if (a, b) in new else INSIDE, 3)
        steps.append(step)

    # Follow them.
    for n, polygon in enumerate(found, 1):
        step = Step(
            f"Followed from face to face, polygon {n} of {len(found)} has "
            f"{counted(len(polygon), 'side')}: edges {', '.join(map(str, polygon))}."
        )
        cube_into(step, FOLLOWED)
        for k, one in enumerate(found[:n]):
            step.line([middle(e) for e in (*one, one[0])], COLOURS[k], 4)
        steps.append(step)

    # Cut them.
    cut = [triangulate(polygon) or () for polygon in found]
    step = Step(f"Cut into {counted(sum(map(len, cut)), 'triangle')}, no chord on a face.")
    cube_into(step, FOLLOWED)
    for k, triangles in enumerate(cut):
        for triangle in triangles:
            step.face([middle(e) for e in triangle], COLOURS[k])
    steps.append(step)
    steps.append(_chord_on_a_face())
    return Film(
        "Segments on the faces of a cell are followed to polygons and cut into triangles",
        steps, (0.5, 0.5, 0.5), (2.0, 1.7),
    )  # fmt: skip


def _chord_on_a_face() -> Step:
    """Two cells, mirror images, each of which cuts its polygon along one chord of their face."""
    signs = 0b11110110
    f = dual_marching_cubes.pinched_face(signs)
    assert f is not None
    polygon = next(p for p in cycles(signs, ALL_SEPARATED) if len(p) == 6)
    own = [e for e in polygon if _on_face(e, f)]
    chord = next((a, b) for a, b in combinations(own, 2) if not _neighbours(polygon, a, b))
    parts = _cut_along(polygon, *chord)
    step = Step(
        f"Two cells that both cut their polygon of {len(polygon)} sides along the same chord of "
        f"the face they share: the red edge has {2 * len(parts)} triangles."
    )
    for mirror, colour in ((1, GOLD), (-1, BLUE)):
        # Both cells in the frame of one: the face between them is at half the height.
        def placed(p: Floats, mirror: int = mirror) -> Floats:
            return np.asarray((p - [0.5, 0.5, 0]) * [0.65, 0.65, 0.65 * mirror] + 0.5)

        for a, b in EDGES:
            step.line([placed(CUBE[a]), placed(CUBE[b])])
        for c in range(8):
            step.dot(placed(CUBE[c]), INSIDE if inside(signs, c) else OUTSIDE)
        for part in parts:
            for a, b in pairwise(part[1:]):
                step.face([placed(middle(e)) for e in (part[0], a, b)], colour)
        step.line([placed(middle(chord[0])), placed(middle(chord[1]))], RED, 6)
    return step


def _on_face(e: int, f: int) -> bool:
    """Whether an edge lies on a face."""
    return set(EDGES[e]) <= set(FACE_CORNERS[f])


def _neighbours(polygon: Polygon, a: int, b: int) -> bool:
    """Whether two edges follow each other in a polygon."""
    return {a, b} in [{x, y} for x, y in pairwise((*polygon, polygon[0]))]


def _cut_along(polygon: Polygon, a: int, b: int) -> tuple[Polygon, Polygon]:
    """The two parts of a polygon on either side of a chord."""
    i, j = sorted((polygon.index(a), polygon.index(b)))
    return polygon[i : j + 1], polygon[j:] + polygon[: i + 1]


# --- lesson 7 -----------------------------------------------------------------------------------


def all_meetings() -> Film:
    """Every kind of face at which two cells can meet across axis 0, and the cells there."""
    rule = asymptotic_decider.RULE
    cells = [cell_of(case, rule.tile(case.signs, case.decision)) for case in cases(rule)]
    found = meetings_of(rule.bits, cells)
    pairs = sum(len(below) * len(above) for below, above in found.values())
    steps = []
    for meeting, (below, above) in sorted(found.items()):
        if meeting.axis:
            continue
        drawn = {side.segments for side in below}
        turned = {frozenset((b, a) for a, b in side.segments) for side in above}
        same = "all draw the same" if drawn == turned and len(drawn) == 1 else "THEY DIFFER"
        one = next(iter(drawn))
        decided = f", decided {meeting.decision}" if len(one) > 1 else ""
        says = f"{counted(len(one), 'segment')}{decided}. " if one else ""
        step = Step(
            f"{says}{len(below)} tiles below and {len(above)} above, "
            f"{len(below) * len(above):,} pairs: {same}. "
            f"All {len(found)} kinds of face together: {pairs:,} pairs."
        )
        corners = [(0, 0), (0, 2), (2, 0), (2, 2)]
        for a, b in ((0, 1), (0, 2), (1, 3), (2, 3)):
            step.line([corners[a], corners[b]])
        for corner, is_in in zip(corners, meeting.signs, strict=True):
            step.dot(corner, INSIDE if is_in else OUTSIDE, 9)
        for start, stop in one:
            step.line([start, stop], RED, 5)
        steps.append(step)
    return Film(
        "The kinds of face at which two cells can meet, with the segments that both cells draw",
        steps, (1, 1), (4.5, 2.9), flat=True,
    )  # fmt: skip


# --- lesson 8 -----------------------------------------------------------------------------------

TUNNEL = np.array([0.97, -0.96, -0.95, -0.94, -0.99, -0.99, -1.0, 0.96])


def a_tunnel_opens() -> Film:
    """One cell while the isovalue falls: two pieces, a tunnel, and what the faces tell of it."""
    steps = []
    values = TUNNEL.reshape(2, 2, 2, order="F")
    for isovalue in np.linspace(0.2, -0.9, 12):
        g = (TUNNEL - isovalue).reshape(8, 1)
        mesh = sweep(trilinear_cubes.RULE, Field.of(values), float(isovalue))
        there, joins = (bool(one[0]) for one in trilinear_cubes.tunnels(g))
        signs = int(((g[:, 0] >= 0) * (1 << np.arange(8))).sum())
        number = len(cycles(signs, int(asymptotic_decider.decisions(g)[0])))
        kind = (
            f"a tunnel joins {'inside' if joins else 'outside'} corners" if there else "no tunnel"
        )
        step = Step(
            f"Isovalue {isovalue:.2f}: {counted(number, 'polygon')} on the faces, {kind}; "
            f"{counted(len(mesh.simplices), 'triangle')}, Euler characteristic "
            f"{euler(mesh.simplices)}."
        )
        cube_into(step, signs)
        step.mesh(mesh.vertices, mesh.simplices, GREEN if there else GOLD, 0.75)
        if there:
            corner_of = trilinear_cubes.waist(signs, int(asymptotic_decider.decisions(g)[0]))
            ring = [
                trilinear_cubes.OnWaist(c, corner_of.swap)(g, np.empty((12, 1, 3)))[0]
                for c in corner_of.corners
            ]
            step.line([*ring, ring[0]], RED, 4)
        steps.append(step)
    return Film(
        "A cell whose isovalue falls until a tunnel opens; its waist is red",
        steps, (0.5, 0.5, 0.5), (2.0, 1.7),
    )  # fmt: skip


def euler(simplices: Array) -> int:
    """V - E + F of triangles, the vertices that they use."""
    edges = {frozenset(pair) for row in simplices.tolist() for pair in combinations(row, 2)}
    return len(set(simplices.ravel().tolist())) - len(edges) + len(simplices)


# --- lesson 9 -----------------------------------------------------------------------------------


def two_voxels() -> Film:
    """VESTA from boundary faces to triangles, for two voxels that share an edge."""
    values = np.zeros((2, 2, 1))
    values[0, 0, 0], values[1, 1, 0] = 1.0, 0.8
    faces = [
        (v, r)
        for v in ((0, 0, 0), (1, 1, 0))
        for r in range(6)
        if vesta.neighbour(v, r) not in ((0, 0, 0), (1, 1, 0))
    ]
    first = Step(f"Two active voxels that share an edge have {len(faces)} boundary faces.")
    paths = Step(f"Each face has four paths, {4 * len(faces)} in all, from juncture to juncture.")
    for v, r in faces:
        centre = vesta.centre((v, r)) / 2
        around = [centre + vesta.DIRECTIONS[d] / 2 for d in vesta.JUNCTURES[r]]
        square = [around[i] + around[i - 1] - centre for i in range(4)]
        first.face(square, GOLD, 0.8)
        paths.face(square, GOLD, 0.25)
        for juncture in around:
            paths.line([juncture, centre], BLUE, 2)
            paths.dot(juncture, OUTSIDE, 4)
        paths.dot(centre, INSIDE, 4)
    steps = [first, paths]
    for mode in ("disconnect", "connect"):
        surface = vesta.extract(values, 0.5, mode=mode, border="closed", displaced=False)
        told = " and ".join(f"{count} of {n} points" for n, count in surface.lengths.items())
        step = Step(f"Followed until they close, in mode {mode}: cycles, {told}.")
        cut = Step(f"Mode {mode}, L: {counted(len(surface.mesh('L').simplices), 'triangle')} on "
                   f"{counted(len(surface.points), 'point')}.")  # fmt: skip
        more = surface.mesh("H")
        high = Step(f"Mode {mode}, H: {counted(len(more.simplices), 'triangle')} on "
                    f"{counted(len(more.vertices), 'point')}.")  # fmt: skip
        for k, rows in enumerate(surface.cycles.values()):
            for row in rows:
                ring = surface.points[row]
                inner = ring + 0.12 * (ring.mean(axis=0) - ring)
                step.line([*inner, inner[0]], COLOURS[k], 3)
        cut.mesh(surface.points, surface.mesh("L").simplices, GOLD, 0.85)
        high.mesh(more.vertices, more.simplices, GOLD, 0.85)
        steps += [step, cut, high]
    return Film(
        "VESTA: boundary faces, paths, cycles and triangles of two voxels that share an edge",
        steps, (0.5, 0.5, 0), (3.4, 2.3), (0.5, 0.6),
    )  # fmt: skip


# --- lesson 10 ----------------------------------------------------------------------------------


def simplices_everywhere() -> Film:
    """Kuhn's tetrahedra, the two sections of one, and two spheres in R^4 that meet."""
    steps = []
    for k, chain in enumerate(kuhn.chains(3)):
        step = Step(f"Simplex {k + 1} of {len(kuhn.chains(3))}: axes "
                    f"{', '.join(map(str, kuhn.permutations(3)[k]))}, corners "
                    f"{', '.join(map(str, chain))}.")  # fmt: skip
        cube_into(step)
        for triangle in combinations(chain.tolist(), 3):
            step.face(CUBE[list(triangle)], COLOURS[k % 4], 0.6)
        steps.append(step)
    steps += [_section(1), _section(2)]
    for size in (5, 6, 7):
        side = np.linspace(-1.3, 1.3, size)
        x, y, z, w = np.meshgrid(side, side, side, side, indexing="ij")
        ball = x**2 + y**2 + z**2
        values = np.stack([1 - ball - (w - 0.5) ** 2, 1 - ball - (w + 0.5) ** 2])
        mesh = simplicial.extract(Field.of(values, dimension=4), 0.0)
        step = Step(
            f"Two spheres in R^4 meet in a sphere: {size}^4 samples, "
            f"{counted(len(mesh.simplices), 'triangle')}, Euler characteristic "
            f"{euler(mesh.simplices)}. The fourth coordinate is dropped."
        )
        step.mesh(mesh.vertices[:, :3] / (size - 1) * 1.4 - 0.2, mesh.simplices, GREEN, 0.9)
        steps.append(step)
    return Film(
        "Kuhn's six tetrahedra, sections of a tetrahedron, and an intersection in four dimensions",
        steps, (0.5, 0.5, 0.5), (2.0, 1.7),
    )  # fmt: skip


def _section(high: int) -> Step:
    """A Kuhn tetrahedron cut between its vertices, so many of them inside."""
    chain = kuhn.chains(3)[0].tolist()
    low = chain[: 4 - high]
    up = chain[4 - high :]
    count = haiman_count(len(low), len(up))
    step = Step(
        f"{counted(len(low), 'vertex', 'vertices')} outside and {len(up)} inside: "
        f"{len(low) * len(up)} crossings, {counted(count, 'triangle')}."
    )
    cube_into(step)
    for a, b in combinations(chain, 2):
        step.line([CUBE[a], CUBE[b]], INSIDE, 2)
    for corner in chain:
        step.dot(CUBE[corner], INSIDE if corner in up else OUTSIDE, 6)
    crossing = {(a, b): (CUBE[a] + CUBE[b]) / 2 for a in low for b in up}
    ways = [[(a, up[0]) for a in low]] if high == 1 else [
        [(low[0], up[0]), (low[0], up[1]), (low[1], up[1])],
        [(low[0], up[0]), (low[1], up[0]), (low[1], up[1])],
    ]  # fmt: skip
    assert len(ways) == count
    for k, way in enumerate(ways):
        step.face([crossing[edge] for edge in way], COLOURS[k])
    return step


# --- lesson 11 ----------------------------------------------------------------------------------


def two_surfaces() -> Film:
    """Two surfaces, the voxels that both pass, and the curves in which they meet."""
    n = 8
    x, y, z = (np.indices((n, n, n)) - (n - 1) / 2) / 1.75
    one = Field.of(1.45**2 - x**2 - y**2 - z**2)
    two = Field.of(0.95**2 - (np.hypot(x - 0.7, y) - 1.0) ** 2 - (0.9 * z) ** 2 - 0.35)
    surfaces = [enhanced_marching_cubes(field, 0.0) for field in (one, two)]
    meeting = surface_intersection(*surfaces)
    curves = intersection_curves(one, two)
    both = set(surfaces[0].cells.tolist()) & set(surfaces[1].cells.tolist())
    sizes = [len(surface.mesh.simplices) for surface in surfaces]
    voxels = (n - 1) ** 3
    tests = meeting.tests
    says = [
        f"The first surface has {sizes[0]:,} triangles.",
        f"The second has {sizes[1]:,}. Each with each is {sizes[0] * sizes[1]:,} pairs.",
        f"Of {voxels:,} voxels, {len(both)} hold triangles of both: {tests:,} pairs are tested.",
        f"They meet in {counted(len(meeting.cells), 'segment')}, "
        f"{tests / len(meeting.cells):.1f} tests for each.",
        f"Joined by the identity of their nodes: {counted(len(curves), 'curve')}, "
        f"{sum(curve.closed for curve in curves)} closed.",
    ]
    steps = []
    for k, words in enumerate(says):
        step = Step(words)
        alpha = 0.85 if k < 2 else 0.15
        step.mesh(surfaces[0].mesh.vertices, surfaces[0].mesh.simplices, GOLD, alpha)
        if k:
            step.mesh(surfaces[1].mesh.vertices, surfaces[1].mesh.simplices, BLUE, alpha)
        if k == 2:
            for voxel in both:
                at = np.array(np.unravel_index(voxel, surfaces[0].shape))
                for a, b in EDGES:
                    step.line([CUBE[a] + at, CUBE[b] + at], RED, 1)
        if k == 3:
            for ends in meeting.ends:
                step.line(ends, RED, 3)
        if k == 4:
            for number, curve in enumerate(curves):
                step.line(curve.polyline, (RED, GREEN, INSIDE)[number % 3], 4)
        steps.append(step)
    centre = (n - 1) / 2
    return Film(
        "Two isosurfaces, the voxels that hold both, and the curves in which they meet",
        steps, (centre, centre, centre), (11.0, 8.0),
    )  # fmt: skip


# --- lesson 12 ----------------------------------------------------------------------------------


def dual_surfaces() -> Film:
    """One field three ways: marching cubes, surface nets, and a vertex for each piece."""
    values = -np.ones((4, 4, 4))
    values[1, 1, 1], values[2, 2, 1], values[1, 2, 2] = 1.0, 0.9, 0.8
    field = Field.of(values)
    steps = []
    primal = sweep(asymptotic_decider.RULE, field, 0.0)
    step = Step(
        f"Marching cubes: {counted(len(primal.vertices), 'vertex', 'vertices')} on lattice edges, "
        f"{counted(len(primal.simplices), 'triangle')}."
    )
    step.mesh(primal.vertices, primal.simplices, GOLD)
    steps.append(step)
    for name, rule in (("Surface nets", surface_nets.RULE), ("Dual", dual_marching_cubes.RULE)):
        places, rows = dual.quads(rule, field, 0.0)
        uses: dict[frozenset[int], int] = {}
        for row in rows.tolist():
            for a, b in pairwise([*row, row[0]]):
                uses[frozenset((a, b))] = uses.get(frozenset((a, b)), 0) + 1
        bad = [sorted(edge) for edge, count in uses.items() if count > 2]
        step = Step(
            f"{name}: {counted(len(places), 'vertex', 'vertices')} in cells, "
            f"{counted(len(rows), 'quadrilateral')}; "
            f"{counted(len(bad), 'edge')} with more than two of them."
        )
        step.mesh(places, rows, BLUE if rule is surface_nets.RULE else GREEN)
        for a, b in bad:
            step.line([places[a], places[b]], RED, 6)
        steps.append(step)
    pinched = [signs for signs in range(256) if dual_marching_cubes.pinched_face(signs) is not None]
    for decided, words in ((ALL_SEPARATED, "separated"), (ALL_JOINED, "joined")):
        signs = 0b11110110
        polygons = cycles(signs, decided)
        step = Step(
            f"One of the {len(pinched)} patterns of 256 that pinch: its ambiguous face {words}, "
            f"it has {counted(len(polygons), 'polygon')} and so "
            f"{counted(len(polygons), 'vertex', 'vertices')}."
        )
        shift = np.array([1, 1, 1.0])
        cube_into(step, signs, shift)
        for k, polygon in enumerate(polygons):
            ring = [middle(e) + shift for e in polygon]
            step.line([*ring, ring[0]], COLOURS[k], 4)
            step.dot(np.mean(ring, axis=0), COLOURS[k], 8)
        steps.append(step)
    return Film(
        "One field by marching cubes, by surface nets, and by a dual with a vertex for each piece",
        steps, (1.5, 1.5, 1.5), (3.6, 3.0),
    )  # fmt: skip


# --- lesson 13 ----------------------------------------------------------------------------------


def through_a_tie() -> Film:
    """Contours of whole numbers while the isovalue passes one of them."""
    values = np.array(
        [
            [0, 0, 1, 0, 0, 0],
            [0, 2, 3, 2, 1, 0],
            [1, 3, 2, 3, 2, 0],
            [0, 2, 3, 4, 2, 1],
            [0, 1, 2, 2, 0, 0],
            [0, 0, 0, 1, 0, 0],
        ]
    )
    steps = []
    for isovalue in (1.5, 1.75, 1.9, 1.99, 2.0, 2.01, 2.1, 2.25, 2.5):
        contours = diconex(values, isovalue, mode="mixed")
        ends = contours.points[contours.mesh.simplices]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        places = len(np.unique(np.round(contours.points, 9), axis=0))
        tied = int((values == isovalue).sum())
        state = f"{counted(tied, 'sample')} tied" if tied else "general position"
        step = Step(
            f"Isovalue {isovalue:g}, {state}: {len(contours.points)} points at {places} places, "
            f"{counted(int((length == 0).sum()), 'segment')} of no length."
        )
        for i in range(6):
            step.line([(i, 0), (i, 5)], "#cccccc", 1)
            step.line([(0, i), (5, i)], "#cccccc", 1)
        for start, stop in ends:
            step.line([start, stop], BLUE, 4)
        for i, j in np.ndindex(values.shape):
            value = values[i, j]
            at_it = value == isovalue
            step.dot((i, j), RED if at_it else INSIDE if value > isovalue else OUTSIDE, 6)
            step.text((i, j), str(value))
        steps.append(step)
    return Film(
        "Contours of whole numbers while the isovalue passes one of them; tied samples are red",
        steps, (2.5, 2.6), (8.5, 6.0), flat=True,
    )  # fmt: skip


FILMS: dict[int, Callable[[], Film]] = {
    1: line_of_samples,
    2: ambiguous_square,
    3: fifteen,
    4: hole,
    5: a_face_decides,
    6: polygons_of_a_cell,
    7: all_meetings,
    8: a_tunnel_opens,
    9: two_voxels,
    10: simplices_everywhere,
    11: two_surfaces,
    12: dual_surfaces,
    13: through_a_tie,
}


def main() -> None:
    """Every film is written."""
    MADE.mkdir(exist_ok=True)
    for number, film in FILMS.items():
        (MADE / f"film_{number}.html").write_text(film().fragment(), encoding="utf-8")


if __name__ == "__main__":
    main()
