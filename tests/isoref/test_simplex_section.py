"""Every table triangulates its section; only some of them agree with their neighbours."""

import itertools
from math import factorial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref.simplex_section import (
    PRINTED,
    RULES,
    crossing,
    delaunay,
    disagreements,
    haiman_count,
    induced,
    printed,
    section_table,
    section_types,
    staircase,
    with_epsilon,
)

TYPES = [(p, n + 1 - p) for n in range(1, 6) for p in range(1, n + 1)]


def section_points(psi: np.ndarray, pairs: np.ndarray, p: int) -> np.ndarray:
    """The crossing points of rows of pairs in barycentric coordinates, straight from equation 2."""
    out = np.zeros((*pairs.shape[:-1], len(psi)))
    for where in np.ndindex(pairs.shape[:-1]):
        i, j = pairs[where][0], p + pairs[where][1]
        out[where][j] = psi[i] / (psi[i] - psi[j])
        out[where][i] = -psi[j] / (psi[i] - psi[j])
    return out


def row_volumes(points: np.ndarray) -> np.ndarray:
    """Volumes, times a factorial, of simplices given by their points (T, k, d)."""
    edges = points[:, 1:] - points[:, :1]
    volumes: np.ndarray = np.sqrt(np.abs(np.linalg.det(edges @ edges.transpose(0, 2, 1))))
    return volumes


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("p", "q"), TYPES)
def test_every_table_has_haimans_count(rule: str, p: int, q: int) -> None:
    """Corollary 3.2: (p+q-2)! / ((p-1)! (q-1)!) simplices."""
    count = factorial(p + q - 2) // (factorial(p - 1) * factorial(q - 1))
    assert len(RULES[rule](p, q)) == count == haiman_count(p, q)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("p", "q"), TYPES)
def test_every_table_covers_each_point_of_the_section_once(rule: str, p: int, q: int) -> None:
    """Section 3: a triangulation, on the symmetric section and on uneven ones."""
    rng = np.random.default_rng(10 * p + q)
    pairs = RULES[rule](p, q)
    for psi in (np.repeat([-1.0, 1.0], [p, q]), np.r_[-rng.random(p), rng.random(q)] * 9):
        rows = section_points(psi, pairs, p)
        inside = 0
        weights = rng.dirichlet(np.ones(p), 40), rng.dirichlet(np.ones(q), 40)
        points = np.einsum("xi,xj,ijd->xd", *weights, section_points(psi, grid(p, q), p))
        for simplex in rows:
            barycentric = np.linalg.lstsq(simplex.T, points.T, rcond=None)[0]
            residual = abs(simplex.T @ barycentric - points.T).max()
            assert residual < 1e-9
            inside += (barycentric > -1e-12).all(axis=0)
        assert (np.asarray(inside) == 1).all()


def grid(p: int, q: int) -> np.ndarray:
    """All pairs (i, j)."""
    return np.array(list(itertools.product(range(p), range(q)))).reshape(p, q, 2)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("p", "q"), TYPES)
def test_simplices_of_a_table_meet_in_common_facets(rule: str, p: int, q: int) -> None:
    """A facet has one simplex on it where it lies on the border of the section, else two."""
    owners: dict[frozenset[tuple[int, ...]], int] = {}
    for row in RULES[rule](p, q).tolist():
        for k in range(len(row)):
            facet = frozenset(tuple(e) for e in row[:k] + row[k + 1 :])
            owners[facet] = owners.get(facet, 0) + 1
    for facet, count in owners.items():
        border = len({i for i, _ in facet}) < p or len({j for _, j in facet}) < q
        assert count == (1 if border else 2)


@pytest.mark.parametrize(("p", "q"), [*PRINTED, (4, 3), (4, 4), (5, 2)])
def test_simplices_of_the_symmetric_section_have_equal_volumes(p: int, q: int) -> None:
    """Theorem 3.1: that is why the count is what it is."""
    for rule in ("staircase", "delaunay") + (("printed",) if (p, q) in PRINTED else ()):
        volumes = row_volumes(section_points(np.repeat([-1.0, 1.0], [p, q]), RULES[rule](p, q), p))
        np.testing.assert_allclose(volumes, volumes[0])


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_staircases_agree_on_every_shared_facet(n: int) -> None:
    """Facets of a staircase table are staircase tables, whatever vertex is dropped."""
    assert disagreements("staircase", n)[0] == 0


def test_the_printed_tables_agree_up_to_dimension_four_but_not_in_five() -> None:
    """Table 4, rows (3, 3) beside rows (3, 2) and (4, 2)."""
    assert [disagreements("printed", n)[0] for n in (2, 3, 4)] == [0, 0, 0]
    assert disagreements("printed", 5)[0] > 0
    by_3_3 = [induced("printed", 3, 3, kind=1, dropped=k) for k in range(3)]
    by_4_2 = [induced("printed", 4, 2, kind=0, dropped=k) for k in range(4)]
    assert all(cut == by_4_2[0] for cut in by_4_2)
    assert by_4_2[0] == {frozenset(map(tuple, row)) for row in printed(3, 2).tolist()}
    assert all(cut != by_4_2[0] for cut in by_3_3)


def test_rows_of_table_4_cut_quadrilaterals_along_different_diagonals() -> None:
    """Negatives i < j, positives a < b: rows of (3, 2) and (4, 2) join (i, b) to (j, a)."""

    def diagonals(p: int, q: int) -> set[str]:
        edges = {
            frozenset(tuple(e) for e in pair)
            for row in printed(p, q).tolist()
            for pair in itertools.combinations(row, 2)
        }
        kinds = set()
        for (i, j), (a, b) in itertools.product(
            itertools.combinations(range(p), 2), itertools.combinations(range(q), 2)
        ):
            kinds |= {"falling"} if frozenset({(i, b), (j, a)}) in edges else set()
            kinds |= {"climbing"} if frozenset({(i, a), (j, b)}) in edges else set()
        return kinds

    assert diagonals(2, 2) == diagonals(3, 2) == diagonals(4, 2) == {"falling"}
    assert diagonals(3, 3) == {"falling", "climbing"}


def test_the_symmetric_section_leaves_delaunay_no_unique_answer() -> None:
    """All points of the section psi = -1, +1 have the same distance from its centre."""
    points = section_points(np.repeat([-1.0, 1.0], [3, 3]), grid(3, 3), 3).reshape(9, 6)
    radius = np.linalg.norm(points - points.mean(axis=0), axis=1)
    np.testing.assert_allclose(radius, radius[0])
    assert len(delaunay(3, 3)) == 6


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_orientation_of_a_row_does_not_depend_on_the_values(rule: str, k: int) -> None:
    """(outward, w_0, ..) is oriented like the simplex, checked on random sections."""
    rng = np.random.default_rng(k)
    simplex = rng.normal(size=(k + 1, k))
    whole = np.sign(np.linalg.det(simplex[1:] - simplex[0]))
    for code in range(1, (1 << (k + 1)) - 1):
        table = section_table(rule, k, code)
        psi = rng.random(k + 1) * np.where(code >> np.arange(k + 1) & 1, 1, -1)
        gradient = np.linalg.solve(simplex[1:] - simplex[0], psi[1:] - psi[0])
        for row, sign in zip(table.rows, table.signs, strict=True):
            i = table.negatives[row // len(table.positives)]
            j = table.positives[row % len(table.positives)]
            w = crossing(simplex[i], simplex[j], psi[i], psi[j])
            frame = np.vstack([-gradient, w[1:] - w[0]])
            assert np.sign(np.linalg.det(frame)) == sign * whole


@pytest.mark.parametrize("k", [2, 3, 4, 5])
def test_rows_hand_on_the_order_of_the_vertices(k: int) -> None:
    """Rows climb in (lower vertex, higher vertex); staircase rows climb in both at once."""
    for rule, code in itertools.product(RULES, range(1, (1 << (k + 1)) - 1)):
        table = section_table(rule, k, code)
        i = table.negatives[table.rows // len(table.positives)]
        j = table.positives[table.rows % len(table.positives)]
        key = np.minimum(i, j) * (k + 1) + np.maximum(i, j)
        assert (np.diff(key, axis=1) > 0).all()
        if rule == "staircase":
            assert (np.diff(i, axis=1) >= 0).all()
            assert (np.diff(j, axis=1) >= 0).all()


@given(
    ends=st.lists(st.floats(-10, 10), min_size=4, max_size=4),
    low=st.floats(-10, -1e-300),
    high=st.floats(0, 10),
)
def test_crossings_stay_on_their_edge_and_are_exact_at_a_zero(
    ends: list[float], low: float, high: float
) -> None:
    """Equation 2 never leaves the edge by more than rounding; psi_j = 0 gives v_j itself."""
    a, b = np.array(ends[:2]), np.array(ends[2:])
    point = crossing(a, b, low, high)
    slack = 4e-15 * (1 + abs(a) + abs(b))
    assert (point >= np.minimum(a, b) - slack).all()
    assert (point <= np.maximum(a, b) + slack).all()
    assert (crossing(a, b, low, 0.0) == b).all()


def test_types_are_counted_as_in_section_3() -> None:
    """[(n+1)/2] types of section."""
    for n in range(1, 9):
        assert len(section_types(n)) == (n + 1) // 2


def test_bad_input_is_refused_with_a_reason() -> None:
    """A table that is not printed, a simplex that is not cut, an epsilon that is not one."""
    with pytest.raises(ValueError, match=r"no table for \(4, 3\)"):
        printed(4, 3)
    with pytest.raises(ValueError, match="one sign only"):
        section_table("staircase", 2, 0b111)
    with pytest.raises(ValueError, match="small positive number"):
        with_epsilon([0.0], 0.0)
    assert len(staircase(1, 1)) == 1


@given(
    st.floats(max_value=-5e-324, allow_infinity=False),
    st.floats(min_value=0, allow_infinity=False),
    st.lists(st.tuples(st.integers(-99, 99), st.integers(0, 1)), min_size=2, max_size=5),
)
def test_a_crossing_is_on_its_edge_whatever_the_magnitude(
    negative: float, positive: float, ends: list[tuple[int, int]]
) -> None:
    """Section 3: the procedure is numerically stable, as it only takes points between two."""
    low = np.array([a for a, _ in ends], float)
    high = low + np.array([step for _, step in ends])
    with np.errstate(over="ignore"):
        found = crossing(low[None], high[None], [negative], [positive])[0]
    assert ((low <= found) & (found <= high)).all()
