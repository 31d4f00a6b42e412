"""What the page on the trilinear interpolant says, checked on samples."""

import json
import re
from collections import Counter
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.cases.trilinear_cells import far, pair
from isograde.model import Limits
from isograde.oracles.sheets import Fault
from isograde.oracles.trilinear import cells
from isograde.oracles.trilinear_cases import case_name, classes, every_topology
from isoref.cycles import cycles
from numpy.typing import NDArray

from tests.papers.loading import importer

FOLDER = Path(__file__).parents[2] / "papers" / "trilinear"
Floats = NDArray[np.float64]


@pytest.fixture(scope="module")
def module() -> Callable[[str], Any]:
    """Imports a module of the paper's folder."""
    return importer("trilinear")


def saddle_cells(n: int, seed: int) -> Floats:
    """Cells with the roots of their three quadratics in or near the cell."""
    rng = np.random.default_rng(seed)
    x, y, z = np.moveaxis(np.array([0, 1]) - rng.uniform(-0.2, 1.2, (2, n, 3, 1)), 2, 0)
    weights = rng.uniform(-1, 1, (2, n))
    return np.asarray(np.einsum("sn,sni,snj,snk->nijk", weights, x, y, z))


def bernstein(values: Floats, axis: int) -> tuple[Floats, Floats, Floats]:
    """Coefficients of the quadratic of the sweep along `axis`, worked out anew."""
    w = np.moveaxis(values, axis + 1, 1).reshape(len(values), 2, 4)
    a, b = w[:, 0], w[:, 1]
    c0 = a[:, 0] * a[:, 3] - a[:, 1] * a[:, 2]
    c2 = b[:, 0] * b[:, 3] - b[:, 1] * b[:, 2]
    c1 = a[:, 0] * b[:, 3] + b[:, 0] * a[:, 3] - a[:, 1] * b[:, 2] - b[:, 1] * a[:, 2]
    return c0, c1, c2


def test_thirty_three_is_the_number_of_classes() -> None:
    """Chernyaev's title."""
    printed = json.loads((FOLDER / "printed.json").read_text(encoding="utf-8"))
    assert len(classes(mirror=False)) == printed["chernyaev"]["cases"]


def test_every_name_in_use_is_one_class_but_12_2() -> None:
    """Item by item: the names of software after Chernyaev, and the derived classes."""
    printed = json.loads((FOLDER / "printed.json").read_text(encoding="utf-8"))
    found = Counter(case_name(one) for one in classes(mirror=False))
    assert set(found) == set(printed["names"]["list"])
    assert {name: number for name, number in found.items() if number > 1} == {"12.2": 2}


def test_whole_surfaces_are_counted_island_by_island(module: Callable[[str], Any]) -> None:
    """The reference has the components and Euler characteristic of each island's truth."""
    posing, whole = module("posing"), module("whole")
    values = posing.targeted()[1][::300]
    adapter = open_adapter(posing.REFERENCE)
    adapter.open(Limits())
    try:
        good, _ = whole.right(adapter, values, whole.truth(values), 3)
    finally:
        adapter.close()
    assert good.all()
    joined, apart = whole.truth(np.stack(far("4.2", 0))).tolist()
    assert joined != apart


def test_the_three_discriminants_are_one_number() -> None:
    """Cayley's hyperdeterminant."""
    values = saddle_cells(500, 0)
    found = [c1 * c1 - 4 * c0 * c2 for c0, c1, c2 in (bernstein(values, a) for a in range(3))]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found[2], found[0], rtol=1e-9, atol=1e-12)


def test_a_tunnel_is_decided_by_three_quadratics_and_one_sign() -> None:
    """The criterion of the page, beside the truth."""
    values = saddle_cells(40_000, 1)
    inside, sign = np.ones(len(values), bool), np.ones(len(values))
    for axis in range(3):
        c0, c1, c2 = bernstein(values, axis)
        inside &= (c0 * c2 > 0) & (c0 * c1 < 0) & (c1 * c1 > 4 * c0 * c2)
        sign *= np.sign(c0)
    truths = cells(values)
    assert ((inside & (sign < 0)) == (truths.tunnels > 0)).all()
    assert (inside & (sign > 0)).any()


def test_three_faces_round_a_corner_are_two_classes() -> None:
    """Configuration 13: [12], or [3, 6, 3]; and a band of three, [12], occurs in no cell."""
    checkers = 0b01101001
    round_a_corner: set[tuple[int, ...]] = set()
    band: set[tuple[int, ...]] = set()
    for separated in product((0, 1), repeat=6):
        if sum(separated) == 3:
            bits = sum(b << f for f, b in enumerate(separated))
            lengths = tuple(sorted(len(polygon) for polygon in cycles(checkers, bits)))
            mixed = all(separated[2 * a] != separated[2 * a + 1] for a in range(3))
            (round_a_corner if mixed else band).add(lengths)
    assert round_a_corner == {(12,), (3, 3, 6)}
    assert band == {(12,)}
    occurring = {one.faces for one in every_topology() if all(one.faces) and sum(one.faces) == 0}
    assert all(f[2 * a] != f[2 * a + 1] for f in occurring for a in range(3))


def test_scikit_image_draws_a_tunnel_in_4_1_and_none_in_7_4_2(
    module: Callable[[str], Any],
) -> None:
    """The page's sentence about `lewiner`, in the cells of the frozen vectors."""
    posing = module("posing")
    adapter = open_adapter("skimage:lewiner")
    adapter.open(Limits())
    try:
        apart, joined = far("4.2", 0)[1], far("7.4.2", 0)[0]
        found = posing.faults(adapter, np.stack([apart, joined]), side=2)
    finally:
        adapter.close()
    assert found == [Fault.FALSE, Fault.MISSING]


def test_two_tunnels_of_10_1_2_share_a_face_and_an_edge(module: Callable[[str], Any]) -> None:
    """The page's sentence about diagonals on faces: scikit-image crowds, the reference does not."""
    posing = module("posing")
    both = pair("10.1.2", 0, -1, 0)
    for name, expected in (("skimage:lewiner", True), (posing.REFERENCE, False)):
        adapter = open_adapter(name)
        adapter.open(Limits())
        try:
            assert posing.crowded(adapter, both) is expected
        finally:
            adapter.close()


def test_lines_on_a_face_jump_at_its_saddle_unless_they_have_a_vertex_there(
    module: Callable[[str], Any],
) -> None:
    """Straight ones move by the same however small the step; bent ones by the root of it."""
    off, straight, bent = module("continuity").face_jumps(20)
    assert (np.median(straight, axis=1) > 0.3).all()
    assert off.min() > 0.2
    moves = np.median(bent, axis=1)
    np.testing.assert_allclose(moves[:-1] / moves[1:], 10, rtol=0.05)


def test_stacked_cells_stand_where_they_are_looked_for(module: Callable[[str], Any]) -> None:
    """Each posed cell is read back from the field it stands in."""
    posing = module("posing")
    values = posing.random_cells(27, 0)
    field = posing.stacked(values, 3)
    for cell, (i, j, k) in zip(values, posing.places(3), strict=True):
        assert (field[i : i + 2, j : j + 2, k : k + 2] == cell).all()


def test_the_reference_is_right_wherever_it_is_posed(module: Callable[[str], Any]) -> None:
    """A sample of what reproduce.py counts at length."""
    agreement, posing = module("agreement"), module("posing")
    adapter = open_adapter(posing.REFERENCE)
    adapter.open(Limits())
    try:
        assert set(posing.faults(adapter, posing.random_cells(3000, 5))) == {Fault.NONE}
        total, wrong, crowds = agreement.grids_of_noise(adapter, 5, 8)
        assert (wrong, crowds) == (0, 0)
        assert total > 1000
        assert not any(posing.crowded(adapter, pair) for pair in posing.tunnel_pairs())
    finally:
        adapter.close()


@pytest.mark.parametrize(
    ("name", "by_cells"), [("isoref:asymptotic-decider", True), ("isoref:surface-nets", False)]
)
def test_an_implementation_has_its_row_by_cells_where_its_vertices_allow(
    module: Callable[[str], Any], name: str, by_cells: bool
) -> None:
    """What the report asks of everybody, of three cells; who cannot be judged by cells says why."""
    agreement = module("agreement")
    row = agreement.agreement(name, agreement.posed(2000))
    assert row.why_not == ""
    assert (row.why_not_cells == "") == by_cells
    assert (row.random[1] > 0) == by_cells
    assert sum(row.total.values()) >= 3


def test_orders_are_those_of_the_claims_on_spheres(
    module: Callable[[str], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The claims of accuracy that can be made of the implementation, one finding a shape."""
    geometry = module("geometry")
    spheres = geometry.accuracy.cases()[:1]
    monkeypatch.setattr(geometry.accuracy, "cases", lambda: spheres)
    adapter = open_adapter("isoref:trilinear-cubes")
    try:
        found = geometry.orders(adapter, adapter.open(Limits()))
    finally:
        adapter.close()
    assert list(found) == ["sphere"]
    assert found["sphere"]["accuracy.position"].numbers["order"] > 1.8
    (row,) = module("libraries")._order_rows("trilinear-cubes", found)
    assert row.startswith("| trilinear-cubes | sphere | 1.9")


@pytest.mark.slow
def test_the_report_can_be_made_again(module: Callable[[str], Any], tmp_path: Path) -> None:
    """The tables that need no library and no volume."""
    reproduce = module("reproduce")
    table, cases, _ = reproduce.how_many_cases(share=200)
    assert [row.ours for row in table.rows[:8]] == [33, 31, 57, 768, 32, 0, 1, 620]
    assert "| 13.5.2 | 3, 3+6 | 16 |" in cases
    checked = reproduce.checked_by_refinement(share=400)
    assert not checked.differing()
    module("figures").draw_tunnel(tmp_path / "tunnel.png")
    assert (tmp_path / "tunnel.png").stat().st_size < 300_000


def test_what_is_kept_of_an_implementation_is_not_asked_again(
    module: Callable[[str], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`--resume FOLDER`: the second time nobody is asked; other cells are asked again."""
    libraries, agreement = module("libraries"), module("agreement")
    asked: list[str] = []

    def told(name: str, _: Any) -> Any:
        asked.append(name)
        return agreement.Agreement(name, why_not="not here")

    monkeypatch.setattr(libraries, "agreement", told)
    monkeypatch.setattr(libraries, "_measured", lambda name: (f"| {name} |", [f"| {name} |"]))
    few, more = agreement.posed(2000), agreement.posed(1000)
    first = libraries._answered("skimage:lewiner", few, (2,), tmp_path)
    assert libraries._answered("skimage:lewiner", few, (2,), tmp_path) == first
    assert asked == ["skimage:lewiner"]
    libraries._answered("skimage:lewiner", more, (2,), tmp_path)
    libraries._answered("skimage:lewiner", few, (2,), None)
    assert len(asked) == 3
    assert not list(tmp_path.glob("*.part"))
    assert "not here" in libraries.compared([first])[0]


PAGE = Path(__file__).parents[2] / "reports" / "papers" / "trilinear" / "implementations.md"


def kept_rows() -> dict[str, list[str]]:
    """The first table of the kept page, a row an implementation."""
    table = PAGE.read_text(encoding="utf-8").partition("## Agreement by case\n")[0]
    rows = (line.strip("| ").split("|") for line in table.splitlines() if line.startswith("| "))
    return {cells[0].strip(): [cell.strip() for cell in cells] for cells in rows}


def test_the_kept_page_has_every_ready_made_implementation(module: Callable[[str], Any]) -> None:
    """Each has numbers, or says why it has none."""
    rows = kept_rows()
    for name in module("agreement").implementations():
        assert rows[name][7] or rows[name][-1], name


def test_what_the_reading_says_of_implementations_is_on_the_kept_page() -> None:
    """All tunnels; edges of more than two triangles in 2 and in 3 pairs; no wrong face."""
    rows = {name: cells for name, cells in kept_rows().items() if " of " in cells[7]}
    assert len(rows) >= 40
    every = [name for name, cells in rows.items() if cells[7] == "1,876 of 1,876"]
    assert every == ["isoref:trilinear-cubes"]
    crowded = {name: cells[5] for name, cells in rows.items() if cells[5] not in ("", "0")}
    of_lewiner = ("skimage:lewiner", "skimage:masked", "skimage:no-degenerate")
    two = ("pymeshlab", "pymeshlab:raw", *of_lewiner)
    assert crowded == {**dict.fromkeys(two, "2"), "trimesh": "3"}
    by_case = PAGE.read_text(encoding="utf-8").partition("## Agreement by case\n")[2]
    lines = by_case.partition("## Agreement by case, as a whole")[0].splitlines()
    heads = {line[4]: line[8:].split(", ") for line in lines if line.startswith("- **")}
    for name in ("pymeshlab", "skimage:lewiner"):
        (letter,) = (head for head, names in heads.items() if name in names)
        column = next(line for line in lines if line.startswith("| case")).split(" | ")
        place = [cell.strip("| ") for cell in column].index(letter)
        marks = {
            cells[0].strip("| "): cells[place].strip("| ")
            for cells in (line.split(" | ") for line in lines if re.match(r"\| \d", line))
        }
        assert marks["4.2"] == "✓"
        assert not any("F" in mark for mark in marks.values())
        assert sum("M" in mark for mark in marks.values()) > 3


def test_what_is_said_of_drawings_follows_from_what_was_measured(
    module: Callable[[str], Any],
) -> None:
    """A distance that grows, a triangle more, a crossing, an edge too full, a proof that fails."""
    drawing = module("drawing")

    def row(far: float, triangles: float, *, crossings: int = 0, crowded: int = 0) -> Any:
        return drawing.Drawn(far, far, triangles, 30.0, 0.01, crossings, crowded)

    good = {
        drawing.PLAIN: row(0.06, 100),
        drawing.NEAR: row(0.05, 100),
        drawing.THREE: row(0.03, 150),
        drawing.TWO: row(0.02, 180),
    }
    proved = {"a": True, "b": True}
    assert not drawing.verdicts({"noise": good}, proved).differing()
    for method, changed, wrong in (
        (drawing.NEAR, row(0.06, 100), 1),
        (drawing.NEAR, row(0.05, 101), 1),
        (drawing.THREE, row(0.019, 150), 1),
        (drawing.TWO, row(0.02, 150), 1),
        (drawing.PLAIN, row(0.01, 100), 2),
        (drawing.NEAR, row(0.05, 100, crossings=1), 1),
        (drawing.NEAR, row(0.05, 100, crowded=1), 1),
    ):
        table = drawing.verdicts({"noise": {**good, method: changed}}, proved)
        assert len(table.differing()) == wrong, method
    assert len(drawing.verdicts({"noise": good}, {"a": True, "b": False}).differing()) == 1


def test_sentences_on_classes_follow_from_the_classes(module: Callable[[str], Any]) -> None:
    """How many are drawn, which are mirror images, and polygons of three separated faces."""
    reproduce = module("reproduce")
    every = classes(mirror=False)
    told = reproduce.caption(every)
    assert told.startswith("The 33 classes as")
    assert told.endswith("Mirror images of each other: 11 and 14, the two 12.2.")
    few = [one for one in every if case_name(one) not in ("14", "12.2")]
    assert reproduce.caption(few).startswith("The 30 classes as")
    assert reproduce.caption(few).endswith("each other: none.")
    thirteen = {(one.signs, one.faces) for one in every_topology() if all(one.faces)}
    assert reproduce.of_three([]) == "0 of them with three faces separated, polygons of none sides"
    told = reproduce.of_three(thirteen)
    assert told.startswith(f"{told.count('3+3+6') + told.count('12')} of them")
    assert told.count("3+3+6") > 0


def test_what_is_said_of_jumps_follows_from_the_medians(module: Callable[[str], Any]) -> None:
    """A rule whose jump falls with the root of the step, and one whose jump stays."""
    conclusion = module("continuity").conclusion
    medians = {
        "trilinear-cubes": np.array([0.41, 0.33, 0.32]),
        "other": np.array([0.3, 0.03, 0.0029]),
    }
    told = conclusion(medians)
    assert "median jump goes from 0.41 to 0.32 of a cell's side as the step goes from 0.01" in told
    assert told.endswith("root of the step, or faster: other.")
    still = conclusion({"trilinear-cubes": medians["other"], "other": medians["trilinear-cubes"]})
    assert still.endswith("root of the step, or faster: trilinear-cubes.")
    assert conclusion({"trilinear-cubes": np.ones(3)}).endswith(
        "root of the step, or faster: none."
    )
