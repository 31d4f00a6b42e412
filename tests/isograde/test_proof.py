"""The proof by enumeration: it holds for the rules that are closed, and nothing else passes it."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from isograde.command import app
from isograde.oracles.halfedges import Surface
from isograde.proof import Proof, corner_place, node_place, prove, tears_by_face
from isoref.asymptotic_decider import RULE as ASYMPTOTIC
from isoref.cube import ambiguous_faces
from isoref.cycles import ALL_JOINED, cycles
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats, Integers
from isoref.lorensen_cline import RULE as LORENSEN_CLINE
from isoref.methods import RULES
from isoref.rule import Average, Rule, Tile
from typer.testing import CliRunner


@pytest.mark.parametrize("name", sorted(set(RULES) - {"lorensen-cline", "trilinear-cubes"}))
def test_holds(name: str) -> None:
    """Every rule of the catalogue but the table of 1987 is closed on every field."""
    proof = prove(RULES[name], pairs=3000)
    assert proof.holds, proof.text()
    bits = RULES[name].bits
    assert proof.tiles == sum(
        2 ** len(ambiguous_faces(signs)) if bits else 1 for signs in range(256)
    )
    assert proof.tried == (3000 if RULES[name].bits else 0)


@pytest.mark.slow
def test_holds_for_trilinear_cubes() -> None:
    """With two more bits for tunnels, every one of them enumerated."""
    proof = prove(RULES["trilinear-cubes"], pairs=3000)
    assert proof.holds, proof.text()
    rule = RULES["trilinear-cubes"]
    assert proof.tiles == sum(
        4 * 2 ** len(ambiguous_faces(signs)) if rule.asks(signs) else 1 for signs in range(256)
    )


def test_the_positions_are_those_of_the_sweep() -> None:
    """A field with one sample inside has its vertices where the proof says the nodes are."""
    for c in range(8):
        values = np.full((2, 2, 2), -1.0)
        corner = tuple(x // 2 for x in corner_place(c))
        values[corner] = 1.0
        mesh = sweep(ASYMPTOTIC, Field.of(values), 0.0)
        found = {tuple(int(x) for x in place) for place in np.rint(2 * mesh.vertices)}
        tile = ASYMPTOTIC.tile(1 << c, 0)
        assert found == {node_place(n) for triangle in tile.triangles for n in triangle}


def test_the_table_of_1987_tears_where_a_sweep_tears() -> None:
    """The pairs of cells that the proof lists are those whose mesh has a hole, on every axis.

    Nielson & Hamann, Figure 3: the hole. All 512 pairs of cells with an ambiguous face between
    them are swept, on each axis.
    """
    proof = prove(LORENSEN_CLINE)
    assert not proof.holds
    assert not proof.faults
    assert len(tears_by_face(proof)) == 6
    listed = {(t.axis, t.low.cell.signs, t.high.cell.signs) for t in proof.tears}
    assert len(listed) == len(proof.tears)
    assert listed == {
        (axis, *pair) for axis in range(3) for pair in ambiguous_pairs(axis) if torn(axis, *pair)
    }


def ambiguous_pairs(axis: int) -> list[tuple[int, int]]:
    """The signs of all pairs of cells with an ambiguous face between them."""
    up = 1 << axis
    pairs = []
    for low, high in product(range(256), repeat=2):
        face = [low >> c & 1 for c in range(8) if c & up]
        same = face == [high >> c & 1 for c in range(8) if not c & up]
        if same and face[0] == face[3] != face[1] == face[2]:
            pairs.append((low, high))
    return pairs


def torn(axis: int, low: int, high: int) -> bool:
    """The two cells' mesh has a boundary edge inside the face between them."""
    values = np.empty([3 if a == axis else 2 for a in range(3)])
    for cell, shift in ((low, 0), (high, 1)):
        for c in range(8):
            index = [c & 1, c >> 1 & 1, c >> 2 & 1]
            index[axis] += shift
            values[tuple(index)] = 1.0 if cell >> c & 1 else -1.0
    mesh = sweep(LORENSEN_CLINE, Field.of(values), 0.0)
    surface = Surface.of(mesh.vertices, mesh.simplices)
    between = (mesh.vertices[surface.open_edges][:, :, axis] == 1.0).all(axis=1)
    return bool(between.any())


Change = Callable[[Tile], Tile]


def spoiled(change: Change, base: Rule = ASYMPTOTIC) -> Rule:
    """The rule with every tile changed."""
    return replace(base, tile=lambda signs, decisions: change(base.tile(signs, decisions)))


def turned(tile: Tile) -> Tile:
    """Every triangle the other way round."""
    return replace(tile, triangles=tuple((c, b, a) for a, b, c in tile.triangles))


def shortened(tile: Tile) -> Tile:
    """The last triangle missing."""
    return replace(tile, triangles=tile.triangles[:-1])


def doubled(tile: Tile) -> Tile:
    """The first triangle there twice."""
    return replace(tile, triangles=tile.triangles + tile.triangles[:1])


def collapsed(tile: Tile) -> Tile:
    """The first triangle names a node twice."""
    a, b, _ = tile.triangles[0] if tile.triangles else (0, 0, 0)
    return replace(tile, triangles=(*tile.triangles, (a, b, b))) if tile.triangles else tile


def fans_on_faces(signs: int, decisions: int) -> Tile:
    """Every polygon a fan from its first node, whatever face its chords lie on."""
    triangles = []
    for polygon in cycles(signs, ALL_JOINED):
        triangles += [(polygon[0], p, q) for p, q in pairwise(polygon[1:])]
    return Tile(tuple(triangles))


def one_middle(signs: int, decisions: int) -> Tile:
    """Every polygon round one and the same interior point."""
    polygons = cycles(signs, decisions)
    triangles = [(a, b, 12) for p in polygons for a, b in zip(p, p[1:] + p[:1], strict=True)]
    return Tile(tuple(triangles), (Average((0,)),))


@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        (spoiled(turned), "inside on its left"),
        (spoiled(shortened), "not on the crossed lattice edges"),
        (spoiled(doubled), "twice in one direction"),
        (spoiled(collapsed), "names a node twice"),
        (Rule("fans", fans_on_faces), "both have the chord"),
        (replace(ASYMPTOTIC, tile=one_middle), "not one fan"),
    ],
    ids=["turned", "shortened", "doubled", "collapsed", "chords", "one middle"],
)
def test_each_statement_is_needed(rule: Rule, reason: str) -> None:
    """A rule spoiled in one way is refused, and the proof says why."""
    proof = prove(rule, pairs=300)
    assert not proof.holds
    assert any(reason in fault for fault in proof.faults)
    assert "Not proved" in proof.text()


def test_decisions_must_belong_to_the_face() -> None:
    """A decision by the whole cell's mean is refused, and named with the values."""

    def by_cell(g: Floats) -> Integers:
        bits = ASYMPTOTIC.decisions(g)
        amended: Integers = np.where(g.mean(axis=0) > 0, bits, 0)
        return amended

    proof = prove(replace(ASYMPTOTIC, decisions=by_cell), pairs=3000)
    assert not proof.tears
    assert any("differently" in fault for fault in proof.faults)


def test_the_command_proves_or_says_what_tears() -> None:
    """`isograde prove`: exit 0 with the result, 1 with the list of tears, 2 for no such rule."""
    run = CliRunner().invoke
    proved = run(app, ["prove", "marching-vesta-connect-H", "--why"])
    assert proved.exit_code == 0
    assert "The argument" in proved.output
    assert "manifold on every field" in proved.output
    torn_rule = run(app, ["prove", "lorensen-cline", "--shown", "3"])
    assert torn_rule.exit_code == 1
    assert "660 pairs of cells tear" in torn_rule.output
    assert torn_rule.output.count("below draws") == 3
    assert run(app, ["prove", "no-such-rule"]).exit_code == 2


def test_a_proof_in_words_says_what_holds_or_the_first_faults_and_how_many_more() -> None:
    """Never both."""
    whole = Proof("rule", 256, 3, (), (), 0)
    assert whole.holds
    assert whole.text().endswith("Closed, oriented and manifold on every field.")
    faulty = Proof("rule", 256, 3, (), tuple(f"fault {n}" for n in range(5)), 7)
    assert "compared on 7 pairs" in faulty.text()
    assert "Closed" not in faulty.text()
    assert faulty.text(shown=3).splitlines()[-3:] == ["  fault 1", "  fault 2", "  and 2 more"]
    assert faulty.text(shown=5).endswith("  fault 4")
