"""The explorer's arithmetic and tiles, in a real browser, beside isoref's."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from isograde.report.viewer import turned_case
from isoref import asymptotic_decider, kuhn
from isoref.cube import CORNERS
from isoref.diconex import Mode, diconex
from isoref.fast import simplicial
from isoref.field import Field, Floats
from isoref.methods import METHODS, RULES
from isoref.rule import Rule
from isoref.sweep import cell_crossings

from tests.browser import chromium, found
from tests.loading import module_at

FOLDER = Path(__file__).parent.parent.parent / "docs" / "explorer"
PAGE = FOLDER / "explorer.html"
KUHN = "marching-tetrahedra-kuhn"
MODES: tuple[Mode, ...] = ("disconnect", "connect", "mixed")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def page() -> str:
    """The explorer as it is shipped."""
    return PAGE.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def tables() -> ModuleType:
    """The program that makes the tables."""
    return module_at(FOLDER / "tables.py", "explorer_tables")


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
    noise = rng.uniform(-1, 1, (298, 8))
    # Two roots that are one: body saddles on the isovalue, which is no tunnel.
    touching = np.array([[3.0, -1, -1, -1, -1, -1, -1, 3]]) * [[1], [-1]]
    checkered = rng.uniform(0.05, 1, (300, 8)) * checkers * rng.choice([-1, 1], (300, 1))
    decimals = np.round(rng.uniform(-1, 1, (200, 8)), 1)
    mixed = rng.uniform(-1, 1, (100, 8)) * 10.0 ** rng.integers(-150, 150, (100, 8))
    # Saddles within a unit in the last place of the isovalue: a c and b d nearly equal.
    tied = np.abs(rng.uniform(0.1, 1, (100, 8))) * checkers
    tied[:, 3] = tied[:, 1] * tied[:, 2] / tied[:, 0]
    tied[::2, 3] = np.nextafter(tied[::2, 3], 10)
    return np.concatenate([noise, touching, checkered, decimals, mixed, tied])


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
        cells.map((g) => {{
          const {{ signs, decisions, tile, points }} = explorer.draw(explorer.tables, rule, g);
          return [signs, decisions, tile.triangles, points];
        }})]));
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
    values = np.round(np.random.default_rng(7).uniform(-1, 1, (8, 8, 7)), 3)
    script = f"""
      const grid = {{ shape: [8, 8, 7], values: {json.dumps(values.ravel().tolist())} }};
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
    for name in ("asymptotic-decider", "marching-vesta-mixed-L"):
        assert told[name]["wrong"] == unlike_the_interpolant(RULES[name], values - 0.1)
    assert told["asymptotic-decider"]["wrong"], "tunnels"
    assert set(told["asymptotic-decider"]["wrong"]) < set(told["lorensen-cline"]["wrong"])


def unlike_the_interpolant(rule: Rule, g: Floats) -> list[int]:
    """The cells in which a rule that asks the faces decides unlike the interpolant, in order."""
    wrong = []
    for n, cell in enumerate(np.ndindex(*(side - 1 for side in g.shape))):
        column = np.array([[g[tuple(np.add(cell, corner))]] for corner in CORNERS])
        signs = sum(1 << c for c in range(8) if column[c, 0] >= 0)
        mine, truth = (
            int(one.decisions(column)[0]) if one.asks(signs) else 0
            for one in (rule, RULES["trilinear-cubes"])
        )
        if mine != truth:
            wrong.append(n)
    return wrong


def corners_of(points: Floats, triangles: Any) -> Floats:
    """Triangles as sorted rows of their corners, whatever the numbers of the vertices."""
    corners = np.round(points[triangles], 8)
    first = np.lexsort(corners.transpose(2, 0, 1)[::-1].reshape(3, -1, 3), axis=-1)[:, :1]
    turned = np.take_along_axis(corners, ((first + np.arange(3)) % 3)[..., None], axis=1)
    rows = turned.reshape(len(turned), 9)
    order: Floats = rows[np.lexsort(rows.T[::-1])]
    return order


def test_contours_are_those_of_isoref(page: str, tmp_path: Path) -> None:
    """DICONEX's segments on an image, in each mode, from the explorer's table of squares."""
    values = np.round(np.random.default_rng(6).uniform(-1, 1, (7, 6)), 3)
    script = f"""
      const [values, m, n] = [{json.dumps(values.tolist())}, 7, 6];
      const found = {{ disconnect: [], connect: [], mixed: [] }};
      for (let i = 0; i + 1 < m; i++) for (let j = 0; j + 1 < n; j++) {{
        const g = [0, 1, 2, 3].map((c) => values[i + (c & 1)][j + (c >> 1)]);
        const joined = {{ disconnect: false, connect: true,
          mixed: g[0] + g[3] + (g[1] + g[2]) >= 0 }};
        for (const mode in found) for (const segment of
            explorer.segments(explorer.tables, g, joined[mode]))
          found[mode].push(segment.map(([x, y]) => [x + i, y + j]));
      }}
      return found;
    """
    told = found(page, script, tmp_path)
    for mode in MODES:
        mine = sorted(np.round(told[mode], 9).tolist())
        mesh = diconex(values, 0.0, mode=mode).mesh
        theirs = sorted(np.round(mesh.vertices[mesh.simplices], 9).tolist())
        assert len(mine) > 30
        np.testing.assert_allclose(mine, theirs, atol=1e-8)
    assert told["disconnect"] != told["connect"] != told["mixed"] != told["disconnect"]


def test_a_square_is_decided_as_isoref_decides_it(page: str, tmp_path: Path) -> None:
    """The asymptotic decider on ambiguous squares, saddles on the isovalue among them."""
    rng = np.random.default_rng(9)
    sizes = rng.integers(1, 9, (400, 4)) / 8
    squares = sizes * np.array([1, -1, -1, 1]) * rng.choice([-1, 1], (400, 1))
    script = f"return {json.dumps(squares.tolist())}.map((g) => explorer.saddleJoins(g));"
    a, b, d, c = squares.T  # corner 3 is opposite to corner 0
    apart = asymptotic_decider.separated(a, b, c, d)
    assert found(page, script, tmp_path) == (~apart).tolist()
    assert (a * c == b * d).sum() > 10


def test_the_topology_changes_at_marks_only(page: str, tmp_path: Path) -> None:
    """Along the isovalue signs and decisions change where an event is marked, and nowhere else.

    Events are exact, so between two isovalues without one between them nothing may change. Of the
    other way round, each corner and each saddle of a face that is marked changes something.
    """
    values = np.random.default_rng(12).uniform(-1, 1, (60, 8))
    script = f"""
      const {{ tables }} = explorer, rule = tables.rules.get("trilinear-cubes");
      return {json.dumps(values.tolist())}.map((cell) => {{
        const marks = explorer.events(tables, cell);
        const name = (isovalue) => {{
          const {{ signs, decisions }} = explorer.draw(tables, rule, cell.map((x) => x - isovalue));
          return signs | decisions << 8;
        }};
        let changes = 0, wrong = 0, idle = 0, body = 0;
        for (let i = 0; i < 2000; i++) {{
          const [low, high] = [-1 + i / 1000, -1 + (i + 1) / 1000];
          if (name(low) === name(high)) continue;
          changes++;
          if (!marks.some((one) => low <= one.isovalue && one.isovalue <= high)) wrong++;
        }}
        for (const {{ isovalue, kind }} of marks) {{
          if (kind === "body saddle") body++;
          else if (name(isovalue - 1e-9) === name(isovalue + 1e-9)) idle++;
        }}
        return {{ changes, wrong, idle, body }};
      }});
    """
    told = found(page, script, tmp_path)
    assert sum(one["changes"] for one in told) > 60 * 8
    assert sum(one["body"] for one in told) > 5
    assert [one["wrong"] for one in told] == [0] * 60
    assert [one["idle"] for one in told] == [0] * 60


def test_contours_of_faces_lie_on_the_level_set(page: str, tmp_path: Path) -> None:
    """Pieces of hyperbolas: on each face as many as the polygons have sides there."""
    values = cells()[:600]
    script = f"""
      const {{ tables }} = explorer, rule = tables.rules.get("trilinear-cubes");
      return {json.dumps(values.tolist())}.map((g) => {{
        const {{ signs, decisions, points }} = explorer.draw(tables, rule, g);
        let worst = 0, wrong = 0, pieces = 0;
        for (let f = 0; f < 6; f++) {{
          const rows = explorer.contour(tables, g, f);
          for (const p of rows.flat())
            worst = Math.max(worst, Math.abs(explorer.interpolate(g, p)));
          const edges = tables.faceEdges[f];
          const sides = tables.polygons[signs | (decisions & 63) << 8].flatMap((word) => {{
            const nodes = [...word].map((letter) => parseInt(letter, 36));
            return nodes.map((e, i) => [e, nodes[(i + 1) % nodes.length]]);
          }}).filter((side) => side.every((e) => edges.includes(e)));
          pieces += rows.length;
          // Each piece ends where a side of a polygon does.
          const near = (p, q) => Math.hypot(...p.map((x, k) => x - q[k])) < 1e-6;
          const joins = (row, [a, b]) =>
            (near(row[0], points[a]) && near(row.at(-1), points[b])) ||
            (near(row[0], points[b]) && near(row.at(-1), points[a]));
          const all = sides.every((side) => rows.some((row) => joins(row, side)));
          if (rows.length !== sides.length || !all) wrong++;
        }}
        return {{ worst, wrong, pieces }};
      }});
    """
    told = found(page, script, tmp_path)
    assert sum(one["pieces"] for one in told) > 2000
    assert max(one["worst"] for one in told) < 1e-9
    assert sum(one["wrong"] for one in told) == 0


def test_slices_in_four_dimensions_are_those_of_min(page: str, tmp_path: Path) -> None:
    """The corners of each polygon lie on the level set that is linear on Kuhn's simplices.

    And together the polygons are as large as the slice of isoref's tetrahedra.
    """
    cells = np.round(np.random.default_rng(8).uniform(-1, 1, (20, 16)), 3)
    script = f"""
      return {json.dumps(cells.tolist())}.map((g) =>
        explorer.simplicialSection(explorer.tables, g, 0.37));
    """
    answers = found(page, script, tmp_path)
    for g, polygons in zip(cells, answers, strict=True):
        # Corner c stands at bit a of c along axis a.
        field = Field.of(g.reshape((2,) * 4).transpose(3, 2, 1, 0), dimension=4)
        mesh = simplicial.extract(field, 0.0)
        points = np.array([[*corner, 0.37] for polygon in polygons for corner in polygon])
        assert len(points) > 3
        np.testing.assert_allclose(kuhn.interpolate(field, points), 0, atol=1e-9)
        assert area(polygons) == pytest.approx(area(slices(mesh.vertices[mesh.simplices], 0.37)))


def slices(tetrahedra: Floats, w: float) -> list[list[list[float]]]:
    """The polygons in which these tetrahedra meet w = const, their corners in order."""
    found_polygons = []
    for corners in tetrahedra.tolist():
        low = [corner for corner in corners if corner[3] < w]
        high = [corner for corner in corners if corner[3] >= w]
        spots = [
            [x + (w - a[3]) / (b[3] - a[3]) * (y - x) for x, y in zip(a[:3], b[:3], strict=True)]
            for a in low
            for b in high
        ]
        if len(spots) == 4:
            spots = [spots[i] for i in (0, 1, 3, 2)]
        if spots:
            found_polygons.append(spots)
    return found_polygons


def area(polygons: list[list[list[float]]]) -> float:
    """Together."""
    total = 0.0
    for polygon in polygons:
        corners = np.array(polygon)
        for i in range(2, len(corners)):
            sides = corners[i - 1] - corners[0], corners[i] - corners[0]
            total += float(np.linalg.norm(np.cross(*sides))) / 2
    return total


def test_the_fine_surface_has_the_topology_that_is_decided(
    page: str, made: dict[str, Any], tmp_path: Path
) -> None:
    """On one cell of each topology: the pieces and Euler number of its triangles.

    Discs and a tunnel are counted from the decisions. The fine surface is sampled, so a neck that
    is thinner than a 24th of a cell may be missed: few are.
    """
    script = """
      const { tables } = explorer, fine = new explorer.Tessellator(tables);
      return Object.entries(tables.cells).map(([at, cell]) => {
        const g = cell.map((x) => x / 1024), drawn = fine.draw(g);
        const index = [...drawn.index.subarray(0, drawn.indices)];
        const part = Array.from({ length: drawn.vertices }, (_, n) => n);
        const root = (n) => { while (part[n] !== n) n = part[n] = part[part[n]]; return n; };
        const edges = new Set();
        for (let i = 0; i < index.length; i += 3) for (let k = 0; k < 3; k++) {
          const [a, b] = [index[i + k], index[i + (k + 1) % 3]];
          part[root(a)] = root(b);
          edges.add(Math.min(a, b) * 1e6 + Math.max(a, b));
        }
        const worst = Math.max(0, ...part.map((_, n) => Math.abs(explorer.interpolate(g,
          [0, 1, 2].map((k) => drawn.positions[3 * n + k])))));
        const pieces = new Set(part.map((_, n) => root(n))).size;
        return [+at, pieces, drawn.vertices - edges.size + index.length / 3, worst];
      });
    """
    right = 0
    answers = found(page, script, tmp_path)
    for at, pieces, euler, worst in answers:
        polygons = len(made["polygons"][str(at & 16383)])
        tunnel = at >> 14 > 0
        right += (pieces, euler) == (polygons - tunnel, polygons - 2 * tunnel)
        assert worst < 1e-6, "vertices stand on the surface, but for single precision"
    assert len(answers) == 768
    assert right >= 0.98 * len(answers), right


SHAPES = {
    "cell": (2, 2, 2),
    "pair": (3, 2, 2),
    "field": (4, 3, 2),
    "plane": (3, 4),
    "four": (2,) * 4,
}


def test_a_failing_case_opens_in_the_explorer(page: str, tmp_path: Path) -> None:
    """Issue 17: a link in a report carries the samples and the isovalue, to the last digit."""
    links, sent = [], {}
    for kind, shape in SHAPES.items():
        values = np.random.default_rng(2).uniform(-1, 1, shape)
        record = {
            "case": "mine", "shape": list(shape), "spacing": [1.0] * len(shape),
            "origin": [0.0] * len(shape), "dtype": "float64", "isovalues": [0.1],
            "values": values.ravel().tolist(), "finding": {"detail": "", "numbers": {}},
            "came": {"status": "crash"},
        }  # fmt: skip
        case = turned_case(record, [], "inside")
        assert case is not None
        assert case["explorer"].startswith("explorer.html#")
        link = "#" + case["explorer"].partition("#")[2]
        links.append(f"{link}&v=" + ",".join(map(repr, case["values"])))
        sent[kind] = record["values"]
    # The first as the page opens, the others as it reads them.
    script = f"""
      const {{ app, read, tables, made }} = explorer, found = [structuredClone(app.state)];
      for (const link of {json.dumps(links[1:])}) {{
        app.go(read(link, app.state, [...tables.rules.keys()], made));
        found.push(structuredClone(app.state));
      }}
      return found;
    """
    states = found(page, script, tmp_path, fragment=links[0])
    for (kind, shape), state in zip(SHAPES.items(), states, strict=True):
        assert state["tab"] == kind
        assert state[kind]["shape"] == list(shape)
        assert state[kind]["values"] == sent[kind]
        assert state[kind]["isovalue"] == 0.1


def test_the_page_is_what_its_sources_make(tables: ModuleType, tmp_path: Path) -> None:
    """Built again from the tables of now: byte for byte the page that is shipped."""
    need_node()
    built = tmp_path / "explorer.html"
    place = FOLDER / "build" / "tables.json"
    place.parent.mkdir(exist_ok=True)
    place.write_text(json.dumps(tables.tables(), separators=(",", ":")), encoding="utf-8")
    subprocess.run(["node", "build.mjs", str(built)], cwd=FOLDER, check=True, capture_output=True)
    assert built.read_bytes() == PAGE.read_bytes(), "run make explorer"


def test_readers_use_it_by_mouse_keys_and_fingers() -> None:
    """`npm test`: input, links, names, contrast, motion, a telephone, the cost of a frame."""
    need_node()
    chromium()
    done = subprocess.run(
        ["npm", "test"], cwd=FOLDER, capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stdout[-6000:]
    assert "# fail 0" in done.stdout


def need_node() -> None:
    """A skip that says how to provide node and the packages, where they are absent."""
    if shutil.which("node") is None or not (FOLDER / "node_modules").is_dir():
        pytest.skip("no node with the explorer's packages: run make explorer")
