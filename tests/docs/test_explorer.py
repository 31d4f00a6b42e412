"""The explorer's arithmetic and tiles, in a real browser, beside isoref's."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from isoref.cube import CORNERS
from isoref.diconex import diconex
from isoref.fast import sweep
from isoref.fast.simplicial import extract
from isoref.field import Field, Floats
from isoref.kuhn import interpolate
from isoref.methods import METHODS, RULES
from isoref.rule import Rule
from isoref.sweep import cell_crossings

from tests.browser import found

FOLDER = Path(__file__).parent.parent.parent / "docs" / "explorer"
PAGE = FOLDER / "explorer.html"
KUHN = "marching-tetrahedra-kuhn"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def page() -> str:
    """The explorer as it is shipped."""
    return PAGE.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def tables() -> ModuleType:
    """The program that makes the tables."""
    spec = importlib.util.spec_from_file_location("explorer_tables", FOLDER / "tables.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def made(tables: ModuleType) -> dict[str, Any]:
    """The tables, made now."""
    # As JSON, so that keys and rows are what the page has.
    answer: dict[str, Any] = json.loads(json.dumps(tables.tables()))
    return answer


def cells() -> Floats:
    """(n, 8) a thousand cells: noise, near-ties in the last place, decimals, mixed magnitudes."""
    rng = np.random.default_rng(17)
    checkers = np.array([1 - 2 * (sum(corner) % 2) for corner in CORNERS])
    noise = rng.uniform(-1, 1, (300, 8))
    checkered = rng.uniform(0.05, 1, (300, 8)) * checkers * rng.choice([-1, 1], (300, 1))
    decimals = np.round(rng.uniform(-1, 1, (200, 8)), 1)
    mixed = rng.uniform(-1, 1, (100, 8)) * 10.0 ** rng.integers(-150, 150, (100, 8))
    # Saddles within a unit in the last place of the isovalue: a c and b d nearly equal.
    tied = np.abs(rng.uniform(0.1, 1, (100, 8))) * checkers
    tied[:, 3] = tied[:, 1] * tied[:, 2] / tied[:, 0]
    tied[::2, 3] = np.nextafter(tied[::2, 3], 10)
    return np.concatenate([noise, checkered, decimals, mixed, tied])


def rule_of(name: str, tables: ModuleType) -> Rule:
    """The rule of this name; Kuhn's tetrahedra as a rule of one cell."""
    if name in RULES:
        return RULES[name]
    return Rule(name, lambda signs, decisions: tables.cut(signs))


def test_the_page_has_the_tables_that_isoref_makes_now(
    page: str, made: dict[str, Any], tmp_path: Path
) -> None:
    """All 256 signs, all decisions, all tiles, names and cycles: nothing in the page is older."""
    script = """
      const { tables } = explorer;
      const keys = [...new Set([...Object.keys(tables.polygons), ...Object.keys(tables.cases)])];
      const rules = {};
      for (const [name, rule] of tables.rules) {
        rules[name] = {};
        for (const at of keys.map(Number).filter((one) => rule.compares !== "none" || one < 256)
            .filter((one) => rule.compares === "trilinear" || one >> 14 === 0)) {
          const { triangles, interior, separated, tunnel } = rule.tile(at & 255, at >> 8);
          rules[name][at] = [triangles, interior, separated, tunnel];
        }
      }
      return { ...tables, rules };
    """
    shown = found(page, script, tmp_path)
    assert set(shown["rules"]) == set(made["rules"]) > set(RULES)
    letters = "0123456789abcdefghijklmnopqrstuvwxyz"
    for name, rule in made["rules"].items():
        there = shown["rules"][name]
        assert len(there) >= 256
        rows = {str(at): rest for at, *rest in rule["rows"]}
        for at, tile in there.items():
            number, separated, tunnel = rows[at]
            word, interior = made["tiles"][number]
            assert tile == [[letters.index(one) for one in word], interior, separated, tunnel]
    for part in set(made) - {"rules", "tiles"}:
        assert shown[part] == made[part], part


def test_tiles_are_those_of_isoref_for_every_signs_and_decisions(
    made: dict[str, Any], tables: ModuleType
) -> None:
    """The program that makes the tables adds and loses nothing."""
    letters = "0123456789abcdefghijklmnopqrstuvwxyz"
    count = 0
    for name in RULES:
        for at, number, _, _ in made["rules"][name]["rows"]:
            tile = RULES[name].tile(at & 255, at >> 8)
            word, interior = made["tiles"][number]
            nodes = [letters.index(one) for one in word]
            assert nodes == [node for triangle in tile.triangles for node in triangle]
            assert len(interior) == len(tile.interior)
            count += 1
    assert count > 4000


def test_what_a_tile_shows_is_told_rightly(made: dict[str, Any]) -> None:
    """Rules that ask the faces show what was decided; the interpolant's tunnels are tunnels."""
    for name in ("asymptotic-decider", "trilinear-cubes", "marching-vesta-mixed-H"):
        for at, _, separated, tunnel in made["rules"][name]["rows"]:
            assert separated == at >> 8 & 63
            assert tunnel == (at >> 8 & 192 if name == "trilinear-cubes" else 0)
    assert len(made["cases"]) == 768, "the topologies that a cell can have"
    assert len(set(made["cases"].values())) == 32


def test_decisions_and_points_are_those_of_isoref(
    page: str, tables: ModuleType, tmp_path: Path
) -> None:
    """A thousand cells: decisions bit for bit, points to the last digits of a float."""
    values = cells()
    assert len(values) == 1000
    script = f"""
      const cells = {json.dumps(values.tolist())};
      return Object.fromEntries([...explorer.tables.rules].map(([name, rule]) => [name,
        cells.map((g) => {{ const {{ signs, decisions, tile, points }} = explorer.draw(explorer.tables, rule, g);
          return [signs, decisions, tile.triangles, points]; }})]));
    """
    told = found(page, script, tmp_path)
    columns = np.ascontiguousarray(values.T)
    crossings = cell_crossings(columns)
    signs = (1 << np.arange(8)) @ (columns >= 0)
    for name, answers in told.items():
        rule = rule_of(name, tables)
        asked = np.array([rule.asks(one) for one in signs.tolist()])
        wanted = np.where(asked, rule.decisions(columns), 0)
        assert [answer[0] for answer in answers] == signs.tolist()
        assert [answer[1] for answer in answers] == wanted.tolist(), name
        mine, theirs = [], []
        for n, (_, decisions, triangles, points) in enumerate(answers):
            tile = rule.tile(int(signs[n]), decisions)
            assert triangles == [node for triangle in tile.triangles for node in triangle]
            for node in sorted(set(triangles)):
                mine.append(points[node])
                inner = node >= 12
                one = slice(n, n + 1)
                theirs.append(
                    tile.interior[node - 12](columns[:, one], crossings[:, one])[0]
                    if inner
                    else crossings[node, n]
                )
        assert len(mine) > 5_000
        np.testing.assert_allclose(mine, theirs, atol=1e-9, err_msg=name)
    bits = {name: {answer[1] for answer in answers} for name, answers in told.items()}
    assert len(bits["asymptotic-decider"]) > 40
    assert any(one >= 64 for one in bits["trilinear-cubes"])
    assert bits["asymptotic-decider"] != bits["marching-vesta-mixed-L"]


def test_a_swept_field_is_that_of_isoref(page: str, tmp_path: Path) -> None:
    """The same triangles in the same places, for every rule; and the same wrong cells."""
    values = np.round(np.random.default_rng(4).uniform(-1, 1, (6, 5, 4)), 3)
    script = f"""
      const grid = {{ shape: [6, 5, 4], values: {json.dumps(values.ravel().tolist())} }};
      return Object.fromEntries([...explorer.tables.rules].map(([name, rule]) => {{
        const {{ points, triangles }} = explorer.sweep(explorer.tables, rule, grid, 0.1);
        const {{ wrong, active }} = explorer.wrongCells(explorer.tables, rule, grid, 0.1);
        const open = explorer.openEdges({{ points, triangles }}, grid.shape).length;
        return [name, {{ points, triangles, wrong, active, open }}]; }}));
    """
    told = found(page, script, tmp_path)
    for name, answer in told.items():
        mesh = METHODS[name](Field.of(values), 0.1)
        assert len(answer["triangles"]) == len(mesh.simplices)
        assert len(answer["points"]) == len(mesh.vertices)
        mine = corners_of(np.array(answer["points"]), np.array(answer["triangles"]))
        np.testing.assert_allclose(mine, corners_of(mesh.vertices, mesh.simplices), atol=1e-7)
        assert (answer["open"] > 0) == (name == "lorensen-cline"), name
    assert told["trilinear-cubes"]["wrong"] == []
    assert told["asymptotic-decider"]["wrong"] != told["lorensen-cline"]["wrong"]
    assert set(told["asymptotic-decider"]["wrong"]) < set(told["lorensen-cline"]["wrong"])


def corners_of(points: Floats, triangles: Any) -> Floats:
    """Triangles as sorted rows of their corners, whatever the numbers of the vertices."""
    corners = np.round(points[triangles], 8)
    first = np.lexsort(corners.transpose(2, 0, 1)[::-1].reshape(3, -1, 3), axis=-1)[:, :1]
    turned = np.take_along_axis(corners, ((first + np.arange(3)) % 3)[..., None], axis=1)
    rows = turned.reshape(len(turned), 9)
    order: Floats = rows[np.lexsort(rows.T[::-1])]
    return order
