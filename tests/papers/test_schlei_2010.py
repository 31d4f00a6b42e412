"""What the report on Schlei's VESTA rests on: counts, census, comparison, identities."""

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.cases.volumes import REGISTRY, read
from isograde.oracles.self_intersections import self_intersections
from isoref.cube import CORNER_OFFSETS, EDGES
from isoref.fast.vesta import extract
from isoref.field import Field, Integers
from isoref.freeze_out import contour_stack, correspondence_problems
from isoref.methods import METHODS

from tests.papers.loading import importer

FOLDER = Path(__file__).parents[2] / "papers" / "schlei_2010"
FIBERFORM = REGISTRY["fiberform"]
MODES = ("disconnect", "connect", "mixed")


@pytest.fixture(scope="module")
def module() -> Callable[[str], Any]:
    """Imports a module of the paper's folder."""
    return importer("schlei_2010")


@pytest.fixture(scope="module")
def printed() -> Any:
    """The tables of the paper."""
    return json.loads((FOLDER / "tables.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def bunny() -> list[int]:
    """The histogram of the bunny's cells, kept so that its scan is not needed."""
    kept = json.loads((FOLDER / "bunny_cells.json").read_text(encoding="utf-8"))
    histogram: list[int] = kept["histogram"]
    return histogram


def test_table_2_follows_from_256_numbers(
    module: Callable[[str], Any], printed: Any, bunny: list[int]
) -> None:
    """Table II, every count of the global modes, without the scan."""
    counts = module("vesta_counts")
    for mode, separated in counts.GLOBAL.items():
        rows = printed["II"][mode]
        cells = {(signs, separated): n for signs, n in enumerate(bunny) if n}
        found = counts.lengths(cells)
        assert found == {int(N): n for N, n in rows["cycles"].items()}
        points = counts.support_points(cells)
        assert points == rows["L points"]
        assert points + counts.averages(found, "H") == rows["H points"]
        for resolution in ("L", "H"):
            assert counts.triangles(found, resolution) == rows[f"{resolution} triangles"]
            marching = counts.marching_points(found, resolution)
            assert marching == rows[f"marching {resolution} points"]


@pytest.mark.slow
def test_the_histogram_is_that_of_the_scan(
    module: Callable[[str], Any], bunny: list[int], data: Path
) -> None:
    """The kept numbers were counted in the file the project's data folder holds."""
    grey = np.load(data / "bunny_ct.npz")["values"]
    assert module("vesta_counts").histogram(Field.of(grey), 1807).tolist() == bunny


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("border", ["open", "closed"])
def test_cells_count_what_the_surface_has(
    module: Callable[[str], Any], mode: Any, border: Any
) -> None:
    """Signatures of cells and the global algorithm give the same cycles by length."""
    counts = module("vesta_counts")
    field = Field.of(np.random.default_rng(1).integers(0, 9, (9, 7, 8)))
    surface = extract(field, 4.5, mode=mode, border=border)
    cells = counts.signatures(field, 4.5, mode, border)
    assert counts.lengths(cells) == surface.lengths
    if border == "closed":
        assert counts.support_points(cells) == len(surface.points)


def test_one_number_of_the_tables_breaks_their_identities(
    module: Callable[[str], Any], printed: Any
) -> None:
    """Table III, mixed, original: L points lack the 1,565 averages its triangles use."""
    counts = module("vesta_counts")
    broken = []
    for table in ("II", "III", "IV"):
        for mode in MODES:
            rows = printed[table][mode]
            found = {int(N): n for N, n in rows["cycles"].items()}
            supports = printed[table]["disconnect"]["L points"]
            computed = {
                "sum": sum(found.values()),
                "L points": supports + counts.averages(found, "L"),
                "H points": supports + counts.averages(found, "H"),
            }
            for r in ("L", "H"):
                computed[f"{r} triangles"] = counts.triangles(found, r)
                computed[f"marching {r} points"] = counts.marching_points(found, r)
            broken += [(table, mode, k, v - rows[k]) for k, v in computed.items() if v != rows[k]]
    assert broken == [("III", "mixed", "L points", 1539 + 26)]


def test_averages_reach_the_papers_14_types_and_no_more(module: Callable[[str], Any]) -> None:
    """Section II.E: nine types in global modes, 14 in mixed mode; 16 for free decisions."""
    census = module("vesta_census")
    assert len(census.types(global_modes_only=True)) == 9
    assert len(census.types(averages_only=True)) == 14
    assert len(census.types()) == 16


def test_unattainable_decisions_are_12_cycles_and_pairs_of_6_cycles(
    module: Callable[[str], Any],
) -> None:
    """Opposite faces' averages have one sum: some decisions cannot be taken together."""
    census, counts = module("vesta_census"), module("vesta_counts")
    never = Counter(
        tuple(sorted(len(c) for c in census.cycles(*signature)))
        for signature in counts.all_signatures()
        if not census.attainable(*signature)
    )
    assert never == {(12,): 24, (6, 6): 12}


def test_longer_cycles_split_in_twelve_ways_one_of_them_never(
    module: Callable[[str], Any],
) -> None:
    """Fig. 13: panels (a) to (k), and (l), which can never be created."""
    census, figures = module("vesta_census"), module("vesta_figures")
    ways = [(signs, separated) for _, signs, separated in figures.resolutions()]
    split = [way for way in ways if len(census.cycles(*way)) > 1]
    assert len(split) == 12
    (never,) = (way for way in split if not census.attainable(*way))
    assert [len(c) for c in census.cycles(*never)] == [6, 6]


def test_random_values_take_attainable_decisions_only(module: Callable[[str], Any]) -> None:
    """The linear programme is right: no eight numbers contradict it."""
    census = module("vesta_census")
    generator = np.random.default_rng(2)
    g = generator.normal(size=(8, 4000)) ** 3
    signs = ((g >= 0) << np.arange(8)[:, None]).sum(axis=0)
    decisions = module("isoref.marching_vesta").decisions(g)
    pairs = set(zip(signs.tolist(), decisions.tolist(), strict=True))
    assert len(pairs) > 300
    assert all(census.attainable(*pair) for pair in pairs)


def alternating_noise(seed: int) -> Integers:
    """Small whole numbers, in every other case with a chessboard under them."""
    random = np.random.default_rng(seed)
    values = random.integers(0, 9, (3, 3, 4))
    return values + (np.indices(values.shape).sum(axis=0) % 2 * 6 if seed % 2 else 0)


def test_12_cycles_are_found_at_every_isovalue_at_once(module: Callable[[str], Any]) -> None:
    """The spans of a scan count what the global algorithm finds, in steps of a quarter."""
    scan, isovalues = module("vesta_twelve").scan, np.arange(2, 13, 0.25)
    total = 0
    for seed in range(24):
        values = alternating_noise(seed)
        found = scan(values)
        traced = [extract(values, a).lengths.get(12, 0) for a in isovalues]
        assert found.count(isovalues).tolist() == traced
        total += len(found.spans)
        if len(found.spans):
            assert found.richest()[1] == max(traced)
    assert total > 10


def test_a_12_cycle_needs_three_faces_that_join_and_three_that_do_not(
    module: Callable[[str], Any],
) -> None:
    """16 of the 64 sets of decisions, in either tetrahedron; no other signs have any."""
    has_twelve = module("vesta_twelve").has_twelve
    with_twelve = {signs: np.flatnonzero(has_twelve(signs)) for signs in range(256)}
    found = {signs: sets for signs, sets in with_twelve.items() if len(sets)}
    assert [len(sets) for sets in found.values()] == [16, 16]
    assert all(int(bits).bit_count() == 3 for sets in found.values() for bits in sets)


def test_fiberform_has_no_12_cycle_at_any_isovalue(
    module: Callable[[str], Any], data: Path
) -> None:
    """A proved fact of this crop: in none of its cells one tetrahedron lies above the other."""
    found = module("vesta_twelve").scan(read(data / "fiberform.tif", volume=FIBERFORM).values)
    assert (found.cells, found.alternating, len(found.spans)) == (970_299, 0, 0)


def test_six_configurations_differ_from_the_templates(module: Callable[[str], Any]) -> None:
    """Section II.G: none in disconnect, nor in connect for inverted sites; six otherwise."""
    entries = module("vesta_census").comparison()
    differ = {
        column: [e["configuration"] for e in entries if not e[column][1]]
        for column in ("disconnect", "connect", "inverted disconnect", "inverted connect")
    }
    ambiguous = [3, 6, 7, 10, 12, 13]
    assert differ == {
        "disconnect": [],
        "connect": ambiguous,
        "inverted disconnect": ambiguous,
        "inverted connect": [],
    }


def test_the_templates_leave_a_hole_and_vesta_none(module: Callable[[str], Any]) -> None:
    """Fig. 25: four open edges between two cells; none in any of the six surfaces."""
    figures = module("vesta_figures")
    pair = Field.of(module("vesta_census").hole())
    cells = np.array([(0, 0, 0), (0, 0, 1)])
    torn = METHODS["lorensen-cline"](pair, 0.5)
    assert len(figures.inner_boundary(torn, cells)) == 4
    for name, method in METHODS.items():
        if "vesta" in name:
            assert figures.inner_boundary(method(pair, 0.5), cells) == []


def test_the_fireball_splits_where_stacked_contours_cannot_follow(
    module: Callable[[str], Any],
) -> None:
    """Fig. 30: one contour becomes two, the last frame has none; only in the planes of fixed t."""
    fireball = module("fireball")
    stacks = [contour_stack(fireball.temperature(), fireball.FREEZE_OUT, a) for a in range(3)]
    counts = [len(contours) for contours in stacks[0]]
    assert counts[0] == 1
    assert max(counts) == 2
    assert counts[-1] == 0
    assert [len(correspondence_problems(stack)) for stack in stacks] == [1, 0, 0]


def test_reproduce_runs_without_volumes(module: Callable[[str], Any], tmp_path: Path) -> None:
    """The report says what it skipped, and Table II is in it all the same."""
    reproduce = module("reproduce")
    kept = reproduce.bunny({}, tmp_path)
    assert "skipped" in kept[-1]
    assert not kept[0].differing()
    assert len(kept[0].rows) == 20
    assert "Skipped" in reproduce.real_volumes({})[0]


def test_bourkes_tables_have_our_cycles_and_no_rule_of_the_cycle_cuts_them(
    module: Callable[[str], Any],
) -> None:
    """Sections I, III: the same cycles in 254 cells; 34 of 162 oriented cycles cut in two ways."""
    pytest.importorskip("mcubes")
    bourke = module("vesta_bourke")
    found = {signs: bourke.cuts(signs) for signs in range(1, 255)}
    assert None not in found.values()
    every = [cut for own in found.values() for cut in own]
    ways = bourke.by_cycle(every)
    assert (len(ways), sum(len(own) > 1 for own in ways.values())) == (162, 34)
    assert bourke.best_rule_of_the_cycle(every, ways) == 220
    assert sum(bourke.same_triangles(signs, own) for signs, own in found.items()) == 105
    two = {key[0] for key, own in bourke.classes(every).items() if len(own) > 1}
    assert two == {9, 10}


def test_the_six_surfaces_are_proved_in_the_report(module: Callable[[str], Any]) -> None:
    """Section IV: a line a rule, and each proved."""
    lines = [x for x in module("reproduce").proofs().splitlines() if x.startswith("| marching")]
    assert len(lines) == 6
    assert all(line.endswith("| proved |") for line in lines)


def test_the_lettered_figures_show_what_they_say(module: Callable[[str], Any]) -> None:
    """Figs. 1 and 15 to 17: eleven pixels; the paper's numbers of sites, centres and junctures."""
    lettered = module("vesta_lettered")
    assert lettered.IMAGE.sum() == 11
    starts = Counter(start for start, _ in lettered._vectors(lettered.IMAGE))
    assert max(starts.values()) == 2  # a point of ambiguity has two vectors in and two out
    paths = lettered.cell_paths(lettered.signs_of(7))
    assert {lettered.paper_number(lettered.CENTRES[e]) for e in paths} == {6, 9, 11}
    assert [len(c) for c in lettered.cycles(lettered.signs_of(0, 1), 0)] == [4]


def test_the_figures_of_faces_are_those_of_the_algorithm(module: Callable[[str], Any]) -> None:
    """Figs. 2b, 5 and 6b: paths 4 to 3, 3 to 2, 2 to 1, 1 to 4; nine chains in order."""
    faces = module("vesta_faces")
    for r, first in ((faces.X, faces.Z), (-faces.Y, faces.Z), (-faces.Z, faces.X)):
        places = faces.numbered_junctures(r, first)
        paths = faces.face_paths(r, first)
        assert paths == [(4, 3), (3, 2), (2, 1), (1, 4)]
        drawn = {(tuple(places[a - 1]), tuple(places[b - 1])) for a, b in paths}
        assert drawn == faces.paths_of_a_cell_face(r)
    shown = faces.chains()
    assert [len(cycle) for _, cycle in shown] == [3, 4, 4, 5, 7, 6, 6, 6, 6]
    ambiguous = [bool(faces.ambiguous_faces(signs)) for signs, _ in shown]
    assert [letter for letter, told in zip("abcdefghi", ambiguous, strict=True) if told] == [
        "e",
        "g",
    ]
    # A way out on the same voxel bounds, with the way in, a quarter that is active.
    for come, same, other in faces.TURNS:
        assert (np.add(come, same) > 0).all() or (np.add(come, same) < 0).all()
        assert np.add(come, other).sum() == 0
    assert len(faces.five_cycle()[1]) == 5


# The sentences of the report follow from the results they are given


def test_what_averages_leave_out_is_counted(module: Callable[[str], Any]) -> None:
    """Section II.E: with as many types as the paper has, and with one fewer."""
    decisions = module("vesta_words").decisions
    every, averaged = [3, 4, 12, 12, 12], [3, 4, 12]
    told = decisions(100, Counter({(12,): 24, (6, 6): 12}), every, averaged, 3)
    assert "\nfour voxels reach 64 of them" in told
    assert "leave out 12 of 6+6 and 24 of 12; of types, 2 of the 3 types of 12-cycle. The" in told
    assert "paper's 3 types are as many as those" in told
    assert "average meets 5" in told
    other = decisions(100, Counter(), every, every, 3)
    assert "reach 100 of them" in other
    assert "leave out" not in other
    assert "paper's 3 types are not as many as those" in other


def test_the_configurations_that_differ_are_named(module: Callable[[str], Any]) -> None:
    """Section II.G: all with an ambiguous face; 10, 12 and 13 are their own complements."""
    differing = module("vesta_words").differing
    six = [3, 6, 7, 10, 12, 13]
    told = differing(six, six)
    assert told.startswith("Those that differ in connect are all configurations with an ambig")
    assert "Configurations 10, 12 and 13 are their own complements up to a rotation" in told
    told = differing(six[1:], [3, 10])
    assert told.startswith("Those that differ in connect are 5 of the 6 configurations with")
    assert "Configuration 10 is its own complement" in told
    assert "complement" not in differing(six, [3])


def test_what_stacked_contours_leave_open_is_named(module: Callable[[str], Any]) -> None:
    """By planes: one with a problem, none, all."""
    stacked = module("vesta_words").stacked
    assert stacked({"a": 1, "b": 0, "c": 0}) == (
        "Stacking contours leaves open which contour continues which, in a (1); in b and c, and in "
        "three dimensions, nothing has to be matched."
    )
    assert stacked({"a": 0}).startswith("Stacking contours leaves nothing open here; in a, and")
    assert stacked({"a": 2, "b": 1}).endswith("which, in a (2) and b (1).")


def test_a_point_in_l_is_needed_where_no_fan_cuts(module: Callable[[str], Any]) -> None:
    """Section II.D: types of cycle that no fan from one corner cuts."""
    told = module("vesta_words").without_fan
    assert told({8: (0, 3), 9: (1, 1)}).startswith("There is a reason for a point in L: without")
    assert "cuts 0 of the 3 types of 8-cycle, 1 of the 1 types of 9-cycle (" in told(
        {8: (0, 3), 9: (1, 1)}
    )
    assert told({8: (0, 3)}).startswith("There is no need of a point in L: without")


@pytest.mark.parametrize("resolution", ["L", "H"])
def test_cells_before_displacement_touch_themselves_only_where_averages_never_lead(
    module: Callable[[str], Any], resolution: str
) -> None:
    """Section IV: "never self-intersect", of all cells; of a pair of 6-cycles in L it is untrue.

    Crossings stand in the middles of edges. Cells meet in faces, on which no triangle lies.
    """
    census, rule = module("vesta_census"), module("isoref.marching_vesta").rule("mixed", resolution)
    signatures = module("vesta_counts").all_signatures()
    middles = CORNER_OFFSETS[np.array(EDGES)].mean(axis=1)
    points, faces, owner, at = [], [], [], 0
    for k, signature in enumerate(signatures):
        tile = rule.tile(*signature)
        shift = np.array([2.0 * k, 0, 0])
        inner = [place(np.zeros((8, 1)), middles[:, None])[0] for place in tile.interior]
        points.append(np.concatenate([middles, np.reshape(inner, (-1, 3))]) + shift)
        faces += [np.array(t) + at for t in tile.triangles]
        owner += [k] * len(tile.triangles)
        at += len(points[-1])
    assert len(signatures) == 656
    pairs = self_intersections(np.concatenate(points), np.array(faces))
    touching = {signatures[owner[pair[0]]] for pair in pairs}
    lengths = {tuple(len(c) for c in census.cycles(*one)) for one in touching}
    assert not any(census.attainable(*one) for one in touching)
    assert lengths == ({(6, 6)} if resolution == "L" else set())
