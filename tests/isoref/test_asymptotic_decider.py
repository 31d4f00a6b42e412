from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isograde.cases import nielson_hamann
from isograde.cases.volumes import block
from isoref import asymptotic_decider as decider
from isoref import cube, cycles
from isoref.fast.sweep import sweep
from isoref.field import Array, Booleans, Field, Floats
from isoref.mesh import Mesh
from isoref.rule import Tile
from isoref.sweep import cell_crossings
from isoref.sweep import sweep as sweep_plain
from scipy import ndimage

E, V = decider.PAPER_EDGES, decider.PAPER_CORNERS

finite = st.floats(allow_nan=False, allow_infinity=False)
not_negative = st.floats(min_value=0, allow_infinity=False)
negative = st.floats(max_value=0, exclude_max=True, allow_infinity=False)
ambiguous = st.tuples(not_negative, negative, not_negative, negative)


def choices(signs: int) -> list[int]:
    """Every decision on the ambiguous faces of these signs."""
    faces = cube.ambiguous_faces(signs)
    return [
        sum(1 << f for i, f in enumerate(faces) if choice >> i & 1)
        for choice in range(1 << len(faces))
    ]


def all_cells() -> Iterator[tuple[int, int]]:
    """All signs with all decisions: every cell there is."""
    return ((signs, d) for signs in range(256) for d in choices(signs))


def saddle_value(a: float, b: float, c: float, d: float) -> Fraction:
    """The exact value at the saddle, from B = k + x s + y t + z s t with its gradient zero.

    The gradient (x + z t, y + z s) vanishes at s = -y / z, t = -x / z.
    """
    A, B, C, D = (Fraction(v) for v in (a, b, c, d))
    k, x, y, z = A, B - A, D - A, A - B + C - D
    s, t = -y / z, -x / z
    return k + x * s + y * t + z * s * t


def row(values: tuple[float, ...]) -> list[Floats]:
    """One face as arrays of one element."""
    return [np.array([v]) for v in values]


# Section 2: the decision


@given(*[not_negative] * 4)
@settings(max_examples=500)
def test_products_are_compared_without_rounding(p: float, q: float, r: float, s: float) -> None:
    """Dekker 1971: whatever their size, subnormal or near the largest number."""
    exact = Fraction(p) * Fraction(q) < Fraction(r) * Fraction(s)
    assert decider.product_below(*row((p, q, r, s)))[0] == exact


@given(st.integers(1, 2**26), st.integers(1, 2**26), st.integers(-2, 2), st.integers(-900, 900))
@settings(max_examples=300)
def test_products_that_differ_in_the_last_of_106_bits_are_told_apart(
    m: int, n: int, off: int, power: int
) -> None:
    """The products (M - 1)(M + 1) and M M differ by one in 10^32."""
    M = 2**52 + m * n
    r, s = float(M - 1), float(M + 1 + off)
    scale = 2.0**power
    exact = M * M < int(r) * int(s)
    assert decider.product_below(*row((M * scale, M / scale, r, s)))[0] == exact


@given(ambiguous)
@settings(max_examples=500)
def test_inside_corners_are_separated_where_the_exact_saddle_is_outside(
    face: tuple[float, float, float, float],
) -> None:
    """Section 2: alpha > B(S, T), evaluated in rational numbers."""
    assert decider.separated(*row(face))[0] == (saddle_value(*face) < 0)


@given(hnp.arrays(np.float64, 4, elements=st.floats(0.01, 1)))
@settings(max_examples=60)
def test_separated_corners_lie_in_different_parts_of_the_sampled_face(size: Floats) -> None:
    """Figs. 6 and 8: the contour itself, without any formula for the saddle.

    The region B >= alpha is sampled and its connected parts are counted.
    """
    a, b, c, d = size * [1, -1, 1, -1]
    s, t = np.meshgrid(np.linspace(0, 1, 301), np.linspace(0, 1, 301), indexing="ij")
    B = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
    if abs(a * c - b * d) < 0.02 * (a + c - b - d) ** 2:
        return  # the gap between the branches is too narrow for the samples
    parts, _ = ndimage.label(B >= 0)
    together = parts[0, 0] == parts[-1, -1]
    assert decider.separated(*row((a, b, c, d)))[0] == (not together)


@given(ambiguous)
def test_the_decision_is_the_same_from_both_sides_of_the_face_and_any_corner(
    face: tuple[float, float, float, float],
) -> None:
    """Both cells at a face find the same, however each numbers it."""
    a, b, c, d = face
    walks = [(a, b, c, d), (b, c, d, a), (c, d, a, b), (d, a, b, c)]
    walks += [walk[::-1] for walk in walks]
    assert len({bool(decider.separated(*row(walk))[0]) for walk in walks}) == 1


@given(
    st.tuples(*[st.floats(1e-90, 1e90)] * 4), st.integers(-700, 700), st.sampled_from([1.0, -1.0])
)
@settings(max_examples=200)
def test_the_decision_does_not_change_under_scaling_by_a_power_of_two(
    sizes: tuple[float, float, float, float], power: int, sign: float
) -> None:
    """The choice for overflow and underflow of the products: exact comparison."""
    face = np.array(sizes)[:, None] * sign * np.array([[1], [-1], [1], [-1]])
    scaled = np.ldexp(face, power)
    assert decider.separated(*scaled)[0] == decider.separated(*face)[0]


@given(ambiguous.filter(lambda f: saddle_value(*f) != 0 and f[0] > 0 and f[2] > 0))
def test_exchanging_inside_and_outside_exchanges_separated_and_joined(
    face: tuple[float, float, float, float],
) -> None:
    """Symmetric wherever nothing lies exactly on the isovalue."""
    there, back = row(face), row(tuple(-v for v in face))
    assert decider.separated(*there)[0] != decider.separated(*back)[0]


def test_a_saddle_on_the_isovalue_is_not_separated() -> None:
    """Section 2: "if alpha > B(S, T) .. else": equality is the else, from both diagonals."""
    assert not decider.separated(*row((1.0, -2.0, 4.0, -2.0)))[0]
    assert not decider.separated(*row((-2.0, 1.0, -2.0, 4.0)))[0]
    # One unit in the last place away the answer is what the exact saddle says.
    below = np.nextafter(4.0, 0)
    assert decider.separated(*row((1.0, -2.0, below, -2.0)))[0]


def test_an_inside_sample_on_the_isovalue_is_cut_off() -> None:
    """Degenerate faces: a c = 0 < b d, so the saddle is outside."""
    assert decider.separated(*row((0.0, -1e-300, 1e300, -1e-300)))[0]
    assert decider.separated(*row((0.0, -1.0, 0.0, -1.0)))[0]


@given(finite.filter(lambda v: v != 0), st.floats(0, 1), st.floats(0, 1))
def test_the_denominator_of_an_ambiguous_face_is_never_zero(x: float, s: float, t: float) -> None:
    """B00 + B11 = B01 + B10 happens on other faces only: S, T and B(S, T) are always finite."""
    a, b = abs(x) * s, -abs(x) * t
    assume(b < 0)
    found = decider.saddle(*row((a, b, 0.0, b)))
    assert np.isfinite(found).all()
    assert 0 <= found[0][0] <= 1
    assert 0 <= found[1][0] <= 1


@given(st.tuples(st.floats(0, 9), st.floats(-9, -1e-6), st.floats(0, 9), st.floats(-9, -1e-6)))
def test_both_derivatives_vanish_at_the_saddle(face: tuple[float, float, float, float]) -> None:
    """Section 2: S and T as printed; the value with a minus where the scan has a plus."""
    corners = row(face)
    S, T, value = decider.saddle(*corners)
    here = decider.bilinear(S, T, *corners)
    assert decider.bilinear(S + 1, T, *corners) == pytest.approx(here, abs=1e-12)
    assert decider.bilinear(S, T + 1, *corners) == pytest.approx(here, abs=1e-12)
    assert value == pytest.approx(here, abs=1e-12)
    assert value[0] == pytest.approx(float(saddle_value(*face)), abs=1e-12)


@given(hnp.arrays(np.float64, (8, 6), elements=st.sampled_from([-2.0, -1.0, -0.5, 0.0, 0.5, 1, 2])))
def test_decisions_of_many_cells_are_those_of_each_face_alone(g: Floats) -> None:
    """Every fast path has a plain twin: bit f is the exact saddle of face f."""
    for cell, bits in zip(g.T, decider.decisions(g), strict=True):
        signs = sum(1 << c for c in range(8) if cell[c] >= 0)
        for f, walk in enumerate(cube.FACE_CORNERS):
            expected = cube.is_ambiguous(signs, f) and saddle_value(*cell[list(walk)]) < 0
            assert bool(bits >> f & 1) == expected


# Section 3: variants


def test_every_cell_has_a_name_and_every_name_its_polygons() -> None:
    """Section 3: the number of sides of the boundary polygons of each variant."""
    sides = defaultdict(set)
    for signs, d in all_cells():
        sides[decider.variant(signs, d)].add(tuple(sorted(map(len, cycles.cycles(signs, d)))))
    assert set(decider.VARIANTS) <= set(sides)
    assert all(len(found) == 1 for found in sides.values())
    expected = {
        "3A": (3, 3), "3B": (6,), "6A": (7,), "6B": (3, 4),
        "7A": (3, 3, 3), "7B": (3, 6), "7C": (9,), "7D": (3, 6),
        "10A": (4, 4), "10B": (8,), "10C": (4, 4), "10D": (8,),
        "12A": (3, 5), "12B": (8,), "12C": (3, 5), "12D": (8,),
        "13A": (3, 3, 3, 3), "13B": (3, 3, 6), "13C": (6, 6), "13D": (3, 9), "13E": (12,),
        "13F": (12,), "13G": (6, 6), "13H": (3, 9), "13I": (3, 3, 6), "13J": (3, 3, 3, 3),
        "13K": (3, 3, 6),
    }  # fmt: skip
    assert {name: sides[name] for name in expected} == {n: {s} for n, s in expected.items()}


def test_the_name_does_not_depend_on_how_the_cell_is_turned() -> None:
    """A variant is a class under rotation; 10B and 10D are one, told apart by the drawing."""
    merged = {"10D": "10B"}
    for signs, d in all_cells():
        name = decider.variant(signs, d)
        for move in cube.ROTATIONS:
            turned = cube.moved_signs(signs, move), decider.moved_faces(d, move)
            found = decider.variant(*turned)
            assert merged.get(found, found) == merged.get(name, name)


def test_configuration_13_has_twelve_classes_of_which_the_paper_names_ten() -> None:
    """Section 3 counts two classes with three separated faces; there are four.

    The two it misses: the mirror image of 13E, and 13K, three faces that meet in a marked corner.
    """
    target = decider.drawing(13)
    stabiliser = [m for m in cube.ROTATIONS if cube.moved_signs(target, m) == target]
    classes = {frozenset(decider.moved_faces(d, m) for m in stabiliser) for d in range(64)}
    assert len(classes) == 12
    by_number = Counter(next(iter(c)).bit_count() for c in classes)
    assert by_number == {0: 1, 1: 1, 2: 2, 3: 4, 4: 2, 5: 1, 6: 1}
    names = Counter(decider.variant(target, min(c)) for c in classes)
    assert names == {f"13{letter}": 1 + (letter == "E") for letter in "ABCDEFGHIJK"}


def test_no_values_decide_for_13c_13e_or_13g() -> None:
    """If two opposite faces are separated, no other two opposite faces are both joined.

    Multiply the inequalities of both faces: the product of all four inside values is below that
    of the outside ones for a separated pair, and not below it for a joined one.
    """
    pairs = [0b000011, 0b001100, 0b110000]
    barred = {
        decider.variant(decider.drawing(13), d)
        for d in range(64)
        if any(d & p == p for p in pairs) and any(not d & p for p in pairs)
    }
    assert barred == {"13C", "13E", "13G"}
    marks = np.array([cube.inside(decider.drawing(13), c) for c in range(8)])
    size = np.random.default_rng(1).choice([0.5, 1.0, 2.0, 3.0, 7.0], size=(8, 100_000))
    found = np.unique(decider.decisions(size * np.where(marks, 1, -1)[:, None]))
    assert {decider.variant(decider.drawing(13), int(d)) for d in found} == {
        f"13{letter}" for letter in "ABDFHIJK"
    }


def nearly_degenerate(n: int) -> Floats:
    """(8, n) values of configuration 13 with all six saddles within rounding of the isovalue."""
    p2, p4, p5, p7 = np.random.default_rng(0).uniform(0.3, 3, (4, n))
    # On each face the product of the marked values is that of the others: solve for the others.
    q1 = np.sqrt(p2 * p4 * p5 / p7)
    others = {1: -q1, 3: -p2 * p4 / q1, 6: -p2 * p5 / q1, 8: -p4 * p5 / q1}
    values = {2: p2, 4: p4, 5: p5, 7: p7} | others
    return np.array([values[v] for v in sorted(V, key=lambda v: V[v])])


def test_exact_decisions_avoid_what_cannot_be_where_rounded_ones_do_not() -> None:
    """Saddles within rounding of the isovalue: plain products decide for 13C, 13E or 13G."""
    g = nearly_degenerate(100_000)
    rounded = np.zeros(g.shape[1], np.int64)
    for f, walk in enumerate(cube.FACE_CORNERS):
        a, b, c, d = g[list(walk)]
        below = np.where(a >= 0, a * c < b * d, b * d < a * c)
        rounded |= below.astype(np.int64) << f
    barred = [
        d for d in range(64) if decider.variant(decider.drawing(13), d) in ("13C", "13E", "13G")
    ]
    assert not np.isin(decider.decisions(g), barred).any()
    assert np.isin(rounded, barred).sum() > 100


def test_marked_corners_of_a_complement_are_the_outside_ones() -> None:
    """Section 1: marked and unmarked may be exchanged; separated is said of the marked ones."""
    for signs, d in all_cells():
        there, back = decider.exchanged(signs, d)
        assert decider.exchanged(there, back) == (signs, d)
        if signs.bit_count() != 4:
            assert decider.variant(signs, d) == decider.variant(there, back)


# Section 3: what cannot be triangulated


def complexes(polygon: tuple[int, ...]) -> bool:
    """Whether any set of triangles on the polygon's corners fills it, of whatever topology.

    Each side must lie in one triangle, each chord in none or two, and no chord on a face.
    A search by the side or chord that still needs a triangle; it shares no code with `cycles`.
    """
    ring = [frozenset((a, b)) for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True)]
    faces = [frozenset(edges) for edges in cube.FACE_EDGES]

    def allowed(pair: frozenset[int]) -> bool:
        return pair in ring or not any(pair <= face for face in faces)

    sides_of = {
        frozenset(t): [frozenset(p) for p in combinations(t, 2)]
        for t in combinations(polygon, 3)
        if all(allowed(frozenset(p)) for p in combinations(t, 2))
    }

    def fill(used: Counter[frozenset[int]], chosen: frozenset[frozenset[int]]) -> bool:
        waiting = [s for s in ring if not used[s]]
        waiting += [p for p, n in used.items() if n == 1 and p not in ring]
        if not waiting:
            return True
        for t, pairs in sides_of.items():
            if waiting[0] in pairs and t not in chosen:
                more = used + Counter(pairs)
                fits = all(more[p] <= (1 if p in ring else 2) for p in pairs)
                if fits and fill(more, chosen | {t}):
                    return True
        return False

    return fill(Counter(), frozenset())


def octagon() -> tuple[int, ...]:
    """The boundary polygon of 10B, Fig. 12."""
    (polygon,) = cycles.cycles(decider.drawing(10), decider.bits_of(decider.VARIANTS["10B"]))
    return polygon


def test_the_polygon_of_figure_12_has_the_sides_of_the_argument() -> None:
    """Section 3: it runs through e1 e3 e12 e10 e5 e7 e11 e9."""
    number = {e: n for n, e in E.items()}
    names = [number[e] for e in octagon()]
    start = names.index(1)
    there = names[start:] + names[:start]
    assert [1, 3, 12, 10, 5, 7, 11, 9] in (there, [1, *there[:0:-1]])


def test_only_two_corners_can_join_either_free_side_of_the_octagon() -> None:
    """Section 3: with e9 e11 only e1 and e7, with e10 e12 only e3 and e5."""
    number = {e: n for n, e in E.items()}
    polygon = octagon()
    sides = {frozenset(p) for p in zip(polygon, polygon[1:] + polygon[:1], strict=True)}
    partners = {}
    for p, q in ((9, 11), (10, 12)):
        partners[p, q] = {
            number[apex]
            for apex in polygon
            if apex not in (E[p], E[q])
            and all(
                {apex, end} in sides or not cycles.share_face(apex, end) for end in (E[p], E[q])
            )
        }
    assert partners == {(9, 11): {1, 7}, (10, 12): {3, 5}}


def test_the_octagon_of_10b_and_10d_cannot_be_triangulated() -> None:
    """Section 3, by exhaustion: no set of triangles on its corners fills it, disc or not."""
    for name in ("10B", "10D"):
        faces = decider.bits_of(decider.VARIANTS[name])
        (polygon,) = cycles.cycles(decider.drawing(10), faces)
        assert not complexes(polygon)
        assert cycles.triangulate(polygon) is None


def test_the_nonagons_of_7c_13d_and_13h_cannot_be_triangulated() -> None:
    """Section 3, by exhaustion: they take an additional vertex because they have to."""
    for name in ("7C", "13D", "13H"):
        faces = decider.bits_of(decider.VARIANTS[name])
        polygons = cycles.cycles(decider.drawing(int(name[:-1])), faces)
        (polygon,) = (p for p in polygons if len(p) == 9)
        assert not complexes(polygon)
        assert cycles.triangulate(polygon) is None


def number_of_discs(polygon: tuple[int, ...]) -> int:
    """How many triangulations the polygon has, by the recursion for Catalan numbers."""
    n = len(polygon)
    faces = [set(edges) for edges in cube.FACE_EDGES]
    count = {(i, i + 1): 1 for i in range(n - 1)}
    for width in range(2, n):
        for i in range(n - width):
            j = i + width
            barred = width < n - 1 and any({polygon[i], polygon[j]} <= face for face in faces)
            fillings = sum(count[i, k] * count[k, j] for k in range(i + 1, j))
            count[i, j] = 0 if barred else fillings
    return count[0, n - 1]


def pierced(nodes: Floats, triangle: cycles.Triangle, side: tuple[int, ...]) -> Booleans:
    """In which of n cells a side passes through a triangle; nodes are (N, n, 3)."""

    def volume(*corners: int) -> Floats:
        """Six times the signed volume of tetrahedra."""
        x, y, z = (nodes[v] - nodes[corners[0]] for v in corners[1:])
        return np.asarray(np.einsum("ni,ni->n", np.cross(x, y), z))

    (a, b, c), (p, q) = triangle, side
    if {p, q} & {a, b, c}:
        return np.zeros(nodes.shape[1], bool)
    through = volume(a, b, c, p) * volume(a, b, c, q) < -1e-18
    turns = np.sign([volume(p, q, x, y) for x, y in ((a, b), (b, c), (c, a))])
    return np.asarray(through & (np.abs(turns.sum(axis=0)) == 3))


def sides_of(triangles: Sequence[cycles.Triangle]) -> list[tuple[int, ...]]:
    """The sides of all triangles, each once."""
    return sorted({tuple(sorted(pair)) for t in triangles for pair in combinations(t, 2)})


def nodes_of(tile: Tile, g: Floats) -> Floats:
    """The places of the crossings and interior points of a tile in n cells."""
    crossings = cell_crossings(g)
    return np.concatenate([crossings, *(place(g, crossings)[None] for place in tile.interior)])


@pytest.mark.parametrize("name", sorted(set(decider.VARIANTS) - {"13C", "13E", "13G"}))
def test_no_two_triangles_of_a_cell_cross(name: str) -> None:
    """Wherever the crossings and e0 stand: the sheets of a cell lie beside each other."""
    g = cells_of(name, 500)
    assert g.shape[1] > 20
    faces = decider.bits_of(decider.VARIANTS[name])
    tile = decider.tile(decider.drawing(int(name[:-1])), faces)
    nodes = nodes_of(tile, g)
    pairs = product(tile.triangles, sides_of(tile.triangles))
    assert not any(pierced(nodes, t, side).any() for t, side in pairs)


def test_the_12_gon_of_13f_has_no_triangulation_and_those_of_13e_cross_themselves() -> None:
    """Section 3: neither can be triangulated. For 13E that is not a matter of edges on faces.

    It has 294 triangulations whose chords stay inside the cell, but for each of them there are
    values at which it passes through itself.
    """
    crossings = cell_crossings(cells_of("13E", 3))
    meet = cache(lambda t, side: pierced(crossings, t, side).any())
    for name, number in (("13E", 294), ("13F", 0)):
        faces = decider.bits_of(decider.VARIANTS[name])
        (polygon,) = cycles.cycles(decider.drawing(13), faces)
        assert len(polygon) == 12
        assert number_of_discs(polygon) == number
        found = list(cycles.triangulations(polygon))
        assert len(set(found)) == number
        for triangles in found:
            assert any(meet(t, side) for t, side in product(triangles, sides_of(triangles)))


def test_the_search_finds_a_filling_wherever_the_rule_needs_no_interior_point() -> None:
    """The search of the test above can succeed: it does for every other polygon up to 9 sides."""
    polygons = {
        p for name, faces in decider.VARIANTS.items()
        for p in cycles.cycles(decider.drawing(int(name[:-1])), decider.bits_of(faces))
        if len(p) < 10
    }  # fmt: skip
    assert {len(p) for p in polygons} == {3, 4, 5, 6, 7, 8, 9}
    for polygon in polygons:
        assert complexes(polygon) == (cycles.triangulate(polygon) is not None)


def test_interior_points_stand_in_the_variants_the_paper_names() -> None:
    """Section 3: 10B/D, 7C and 13D/E/F/H, one each; no other."""
    need = {
        decider.variant(signs, d): len(decider.tile(signs, d).interior)
        for signs, d in all_cells()
        if decider.tile(signs, d).interior
    }
    assert need == dict.fromkeys(("7C", "10B", "10D", "13D", "13E", "13F", "13H"), 1)


# Section 3: the place of e0


def cells_of(name: str, n: int, seed: int = 0) -> Floats:
    """Values (8, n) of cells in the drawing of a variant, found among random ones."""
    number, rng = int(name[:-1]), np.random.default_rng(seed)
    marks = np.array([cube.inside(decider.drawing(number), c) for c in range(8)])
    g = rng.exponential(size=(8, 200_000)) * np.where(marks, 1, -1)[:, None]
    if name == "13E":  # no values have its decisions, but e0 is placed whatever they are
        return np.asarray(g[:, :n])
    fits = decider.decisions(g) == decider.bits_of(decider.VARIANTS[name])
    return np.asarray(g[:, fits][:, :n])


@pytest.mark.parametrize(
    ("name", "v", "w"),
    [("7C", 2, 8), ("13D", 8, 2), ("13E", 8, 2), ("13F", 8, 2), ("13H", 3, 5)],
)
def test_e0_stands_on_the_body_diagonal_of_the_paper(name: str, v: int, w: int) -> None:
    """Section 3: e0 = (1 - u) v + u w, where the linear interpolant on the diagonal is alpha."""
    g = cells_of(name, 20)
    assert g.shape[1] > 3
    tile = decider.tile(decider.drawing(int(name[:-1])), decider.bits_of(decider.VARIANTS[name]))
    (e0,) = (place(g, cell_crossings(g)) for place in tile.interior)
    u = (0 - g[V[v]]) / (g[V[w]] - g[V[v]])
    ends = [np.array(cube.CORNERS[V[x]]) for x in (v, w)]
    assert np.allclose(e0, (1 - u)[:, None] * ends[0] + u[:, None] * ends[1])


@pytest.mark.parametrize("name", ["10B", "10D"])
def test_e0_stands_between_the_two_saddles(name: str) -> None:
    """Section 3: on the line from saddle to saddle, where the value interpolated is alpha."""
    g = cells_of(name, 20)
    assert g.shape[1] == 20
    tile = decider.tile(decider.drawing(10), decider.bits_of(decider.VARIANTS[name]))
    (e0,) = (place(g, cell_crossings(g)) for place in tile.interior)
    # The top and bottom face are y = 1 and y = 0; solve for their saddles in x and z.
    for cell, point in zip(g.T, e0, strict=True):
        F = cell.reshape(2, 2, 2)  # F[z, y, x]
        ends = []
        for y in (0, 1):
            (k, x), (z, zx) = F[:, y]
            mixed = k - x - z + zx
            p, q = (k - z) / mixed, (k - x) / mixed
            value = (k * zx - x * z) / mixed
            ends.append((np.array([p, y, q]), value))
        (low, F_low), (high, F_high) = ends
        assert F_low * F_high < 0
        u = F_low / (F_low - F_high)
        assert np.allclose(point, (1 - u) * low + u * high)
        assert (0 < point).all()
        assert (point < 1).all()


@pytest.mark.parametrize("name", ["7C", "10B", "10D", "13D", "13F", "13H"])
@pytest.mark.parametrize("power", [-980, -600, 600, 1018])
def test_e0_is_the_same_for_values_scaled_by_a_power_of_two(name: str, power: int) -> None:
    """No overflow and no underflow on the way, however large or small the values."""
    g = cells_of(name, 5)
    scaled = np.ldexp(g, power)
    assert (decider.decisions(scaled) == decider.decisions(g)).all()
    tile = decider.tile(decider.drawing(int(name[:-1])), int(decider.decisions(g)[0]))
    (place,) = tile.interior
    here, there = (place(x, np.empty((12, 0, 3))) for x in (g, scaled))
    assert np.allclose(here, there, rtol=0, atol=1e-12)


def test_a_saddle_on_the_isovalue_puts_e0_on_the_face() -> None:
    """Degenerate faces: the one case in which e0 is not strictly inside, as the text says."""
    signs = decider.drawing(10)
    g = np.array([[1.0 if cube.inside(signs, c) else -1.0] for c in range(8)])
    g[V[1]] = 0.5  # the bottom face is separated now, the saddle of the top stays at 0
    tile = decider.tile(signs, int(decider.decisions(g)[0]))
    (e0,) = (place(g, np.empty((12, 1, 3))) for place in tile.interior)
    assert e0.tolist() == [[0.5, 1.0, 0.5]]


# Whole meshes


def half_edges(mesh: Mesh) -> Counter[tuple[int, int]]:
    """The oriented edges of the triangles, with the number of times each occurs."""
    return Counter((int(t[i]), int(t[(i + 1) % 3])) for t in mesh.simplices for i in range(3))


def assert_closed_manifold(mesh: Mesh) -> None:
    """Every edge has two triangles in opposite directions, every vertex one ring of them."""
    halves = half_edges(mesh)
    assert set(halves.values()) <= {1}
    assert all((b, a) in halves for a, b in halves)
    link: dict[int, dict[int, int]] = defaultdict(dict)
    for t in mesh.simplices.tolist():
        for i in range(3):
            link[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3]
    for ring in link.values():
        start = here = next(iter(ring))
        steps = 1
        while (here := ring[here]) != start:
            steps += 1
        assert steps == len(ring)


@given(
    hnp.arrays(np.int8, st.tuples(*[st.integers(1, 3)] * 3), elements=st.integers(-2, 2)),
    st.sampled_from([0.0, 0.5, 1.0]),
)
@settings(max_examples=150)
def test_the_surface_is_closed_manifold_and_oriented_on_any_field(
    values: Array, isovalue: float
) -> None:
    """Section 1: consistent choices and proper triangulations give a topologically correct surface.

    Small integers make ties and saddles on the isovalue frequent.
    """
    mesh = sweep(decider.RULE, Field.of(np.pad(values, 1, constant_values=-3)), isovalue)
    assert_closed_manifold(mesh)


def test_noise_meets_every_configuration_and_is_closed() -> None:
    """The same on noise, where every configuration and nearly every variant occurs."""
    values = np.random.default_rng(5).normal(size=(24, 24, 24))
    padded = np.pad(values, 1, constant_values=-5)
    assert_closed_manifold(sweep(decider.RULE, Field.of(padded), 0.0))


def lattice_edge_of(point: Floats) -> tuple[int, int, int, int]:
    """The lattice edge that carries a crossing: its lower end and its axis."""
    axis = int(np.argmax(np.abs(point - np.round(point))))
    low = np.round(point).astype(int)
    low[axis] = int(np.floor(point[axis]))
    return (int(low[0]), int(low[1]), int(low[2]), axis)


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_faces_are_connected_as_the_interpolant_connects_them(seed: int) -> None:
    """Level 3: on each ambiguous face of a mesh the branches of the hyperbola.

    The truth is read off the interpolant: along the line s = S (parallel to no branch) the value
    keeps the saddle's sign, so corners on the same side as the saddle are joined across it.
    """
    values = np.random.default_rng(seed).normal(size=(4, 4, 4))
    mesh = sweep(decider.RULE, Field.of(values), 0.0)
    carried = {
        lattice_edge_of(p): i for i, p in enumerate(mesh.vertices) if np.sum(p % 1 != 0) == 1
    }
    drawn = {frozenset(pair) for pair in half_edges(mesh)}
    met = 0
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        for low in map(np.array, np.ndindex(4, 4, 4)):
            if (low + u + v > 3).any():
                continue
            a, b, c, d = (values[tuple(p)] for p in (low, low + u, low + u + v, low + v))
            if not ((a >= 0) == (c >= 0) != (b >= 0) == (d >= 0)):
                continue
            met += 1
            iu, iv = (axis + 1) % 3, (axis + 2) % 3
            ab, bc = carried[(*low, iu)], carried[(*(low + u), iv)]
            dc, ad = carried[(*(low + v), iu)], carried[(*low, iv)]
            # Corner a is cut off by itself exactly where the saddle lies on the other side of 0.
            alone = (saddle_value(a, b, c, d) >= 0) != (a >= 0)
            pairs = [{ab, ad}, {bc, dc}] if alone else [{ab, bc}, {ad, dc}]
            others = [{ab, bc}, {ad, dc}] if alone else [{ab, ad}, {bc, dc}]
            assert all(frozenset(p) in drawn for p in pairs)
            assert not any(frozenset(p) in drawn for p in others)
    assert met > 0


def test_exchanging_inside_and_outside_turns_the_same_surface_over() -> None:
    """Section 1: marked and unmarked may be switched; diagonals of polygons are ours to choose."""
    values = np.random.default_rng(6).normal(size=(12, 12, 12))
    there, back = (sweep(decider.RULE, Field.of(v), 0.0).canonical() for v in (values, -values))
    assert np.allclose(there.vertices, back.vertices, rtol=0, atol=1e-12)
    # Sides of polygons lie on faces of cells: compare the half-edges that do.
    on_faces = [
        {
            (a, b)
            for a, b in half_edges(mesh)
            if np.any((mesh.vertices[a] == mesh.vertices[b]) & (mesh.vertices[a] % 1 == 0))
        }
        for mesh in (there, back)
    ]
    assert len(on_faces[0]) > 1000
    assert on_faces[0] == {(b, a) for a, b in on_faces[1]}


def test_scaling_the_field_by_a_power_of_two_changes_nothing() -> None:
    """The same vertices and the same triangles, near the ends of the range of numbers."""
    values = np.round(np.random.default_rng(2).normal(size=(6, 7, 8)) * 64) / 64
    plain = sweep(decider.RULE, Field.of(values), 0.0)
    for power in (-1000, -540, 540, 1000):
        scaled = sweep(decider.RULE, Field.of(np.ldexp(values, power)), 0.0)
        assert np.array_equal(scaled.simplices, plain.simplices)
        assert np.allclose(scaled.vertices, plain.vertices)


def test_both_sweeps_agree_where_interior_points_are_frequent() -> None:
    """The readable rule and the vectorised sweep: noise with a point e0 in many cells."""
    values = np.random.default_rng(9).normal(size=(9, 9, 9))
    field = Field.of(values, spacing=(1, 2, 3), origin=(5, 0, -1))
    fast, plain = (make(decider.RULE, field, 0.0).canonical() for make in (sweep, sweep_plain))
    inner = (np.sum((fast.vertices - field.origin) / field.spacing % 1 > 1e-9, axis=1) > 1).sum()
    assert inner > 3
    assert np.allclose(fast.vertices, plain.vertices)
    assert np.array_equal(fast.simplices, plain.simplices)


def same_triangles(field: Field, isovalue: float) -> bool:
    """Whether the readable sweep and the vectorised one put the same triangles in place."""
    fast, plain = (
        sorted(map(tuple, mesh.vertices[mesh.simplices].reshape(-1, 9).tolist()))
        for mesh in (make(decider.RULE, field, isovalue) for make in (sweep, sweep_plain))
    )
    return len(fast) > 0 and fast == plain


def test_both_sweeps_agree_round_an_ambiguous_cell_of_example_3() -> None:
    """Table 1's third example, where the drawings of 1987 tear."""
    values = nielson_hamann.example_3().values - nielson_hamann.ISOVALUE_3
    g = np.stack([values[i : 49 + i, j : 49 + j, k : 49 + k] for i, j, k in cube.CORNERS])
    asks = np.array([bool(cube.ambiguous_faces(signs)) for signs in range(256)])
    places = np.argwhere(asks[((g >= 0) << np.arange(8).reshape(8, 1, 1, 1)).sum(axis=0)])
    assert len(places) == 12
    part = tuple(slice(max(i, 0), i + 10) for i in places[0] - 4)
    assert same_triangles(Field.of(values[part]), 0.0)


@pytest.mark.parametrize(("name", "isovalue"), [("headsq", 1150), ("stroke", 80), ("carotid", 200)])
def test_both_sweeps_agree_on_real_volumes(name: str, isovalue: float, data: Path) -> None:
    """The readable rule and the vectorised sweep, on integers with ties and on floats."""
    assert data.is_dir()
    assert same_triangles(block(name, (18, 18, 18)), isovalue)
