"""The proof by enumeration: it holds for the rules that are closed, and nothing else passes it."""

import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from isograde.command import app
from isograde.oracles.complexes import Complex
from isograde.proof import Check, Proof, prove
from isograde.proof.certificate import certificate
from isograde.proof.loading import RuleError, load_rule
from isograde.proof.meetings import tears_by_face
from isograde.proof.tiles import cases, corner_place, node_place
from isoref.asymptotic_decider import RULE as ASYMPTOTIC
from isoref.cube import ambiguous_faces
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.lorensen_cline import RULE as LORENSEN_CLINE
from isoref.methods import RULES
from typer.testing import CliRunner

from tests.isograde.wrong_rules import WRONG


@pytest.mark.parametrize("name", sorted(set(RULES) - {"lorensen-cline"}))
def test_holds(name: str) -> None:
    """Every rule of the catalogue but the table of 1987 is closed on every field."""
    rule = RULES[name]
    proof = prove(rule, trials=3000)
    assert proof.holds, proof.text()
    inner = 2 ** max(rule.bits - 6, 0)
    assert proof.tiles.keys() == set(cases(rule))
    assert len(proof.tiles) == sum(
        2 ** len(ambiguous_faces(signs)) * inner if rule.asks(signs) else 1 for signs in range(256)
    )
    assert (proof.trials >= 3000) == bool(rule.bits)
    assert ("Given that" in proof.sentence) == bool(rule.bits)


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
    assert proof.broken == ("condition 3",)
    assert len(tears_by_face(proof.tears)) == 6
    listed = {(t.axis, t.low.cell.case.signs, t.high.cell.case.signs) for t in proof.tears}
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
    surface = Complex.of(mesh.vertices, mesh.simplices)
    between = (mesh.vertices[surface.open_facets][:, :, axis] == 1.0).all(axis=1)
    return bool(between.any())


@pytest.mark.parametrize("kind", WRONG)
def test_wrong_rules_are_refused_with_the_check_they_break(kind: str) -> None:
    """Each premise and each condition has a rule that breaks it, and says so in words."""
    wrong = WRONG[kind]
    proof = prove(wrong.rule, trials=2500)
    assert not proof.holds
    assert wrong.check in proof.broken
    faults = [
        fault for check in proof.checks for fault in check.faults if check.name == wrong.check
    ]
    assert any(wrong.words in fault for fault in faults), faults
    assert f"Not proved: {', '.join(proof.broken)}." in proof.text()
    assert "Proved." not in proof.text()
    with pytest.raises(ValueError, match="no certificate"):
        certificate(proof)


def test_each_check_has_a_wrong_rule() -> None:
    """No premise or condition is there for show."""
    names = {check.name for check in prove(ASYMPTOTIC, trials=1).checks}
    assert len(names) == 11
    assert {wrong.check for wrong in WRONG.values()} == names


@pytest.mark.parametrize("kind", ["a mean in walk order", "a saddle by division"])
def test_what_the_trials_find_is_open_on_data_of_one_decimal(kind: str) -> None:
    """The rounded decisions are no matter of taste: their meshes have open edges."""
    rng = np.random.default_rng(1)
    found = 0
    for _ in range(40):
        values = np.pad(rng.integers(-9, 10, (12, 12, 12)) / 10, 1, constant_values=-1.0)
        mesh = sweep(WRONG[kind].rule, Field.of(values), 0.1)
        found += len(Complex.of(mesh.vertices, mesh.simplices).open_facets)
    assert found > 0


def test_a_rule_is_not_blamed_for_what_nobody_decides() -> None:
    """Bits that only the cell uses, or a rule that is never asked, break no premise."""
    never = replace(ASYMPTOTIC, asks=lambda signs: False)
    proof = prove(never, trials=300)
    assert proof.holds, proof.text()
    assert proof.trials == 0
    assert "Given that" not in proof.text()


def test_the_proof_says_how_each_premise_was_checked_and_what_it_proved() -> None:
    """The sentence has its condition, "by index", ties, and what is not claimed."""
    text = prove(ASYMPTOTIC, trials=300).text()
    assert text.count("checked ") == 11
    assert "by trial and not by proof" in text
    assert "Given that a decision on a face is a function of the face's four values" in text
    assert "by index" in text
    assert "vertices of different numbers may coincide" in text
    assert "Not claimed" in text


def test_faults_are_cut_short_and_counted() -> None:
    """The first few of each kind, and how many more; never a proof beside them."""
    faulty = Check("tiles", "There are tiles.", "by looking", tuple(f"fault {n}" for n in range(5)))
    proof = Proof("rule", 0, (), (faulty,))
    assert not proof.holds
    assert proof.text(shown=3).splitlines()[-4:-1] == [
        "    - fault 1",
        "    - fault 2",
        "    and 2 more",
    ]
    assert not Proof("rule", 0, (), ()).holds
    assert not Proof("rule", 0, (), (Check("tiles", "", "", reached=False),)).holds


def test_the_command_proves_or_says_what_tears(tmp_path: Path) -> None:
    """`isograde prove`: 0 with the result, 1 with what is wrong, 2 for no such rule."""
    run = CliRunner().invoke
    file = tmp_path / "one.json"
    proved = run(app, ["prove", "marching-vesta-connect-H", "--why", "--certificate", str(file)])
    assert proved.exit_code == 0
    assert "The argument" in proved.output
    assert "Proved. On every field" in proved.output
    assert file.exists()
    torn_rule = run(app, ["prove", "lorensen-cline", "--shown", "3"])
    assert torn_rule.exit_code == 1
    assert "660 pairs of cells tear" in torn_rule.output
    assert torn_rule.output.count("below draws") == 2
    assert "and 658 more" in torn_rule.output
    assert run(app, ["prove", "no-such-rule"]).exit_code == 2


def test_anybodys_rule_can_be_proved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`python:module:RULE`, from the working directory or by a file's name."""
    (tmp_path / "my_rule.py").write_text(
        "from types import SimpleNamespace\n"
        "from isoref.asymptotic_decider import tile\n"
        "from isoref.rule import no_decisions\n"
        "RULE = SimpleNamespace(name='mine', tile=tile, decisions=no_decisions, bits=0,\n"
        "                       asks=lambda signs: False)\n"
    )
    monkeypatch.chdir(tmp_path)
    run = CliRunner().invoke
    for place in ("my_rule", "my_rule.py", str(tmp_path / "my_rule.py")):
        done = run(app, ["prove", f"python:{place}:RULE"])
        assert done.exit_code == 0, done.output
        assert "the mesh of mine is closed" in done.output


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("asymptotic", "did you mean asymptotic-decider?"),
        ("python:isoref.asymptotic_decider", "is not of the form"),
        ("python:isoref.asymptotic_decider:RULES", "rules there: RULE"),
        ("python:no_such_module:RULE", "No module named"),
        ("python:no_such_file.py:RULE", "no such file"),
    ],
)
def test_a_rule_that_is_not_there_is_said_so(spec: str, words: str) -> None:
    """What was wrong, and what there is."""
    with pytest.raises(RuleError, match=re.escape(words)):
        load_rule(spec)
