"""Certificates, and the program that checks them: it accepts what is right, and nothing else."""

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.proof import Check, prove
from isograde.proof import check_certificate as checker
from isograde.proof.certificate import certificate, write_certificate
from isoref.methods import RULES

from tests.isograde.wrong_rules import WRONG

PROVED = sorted(set(RULES) - {"lorensen-cline"})
CHECKER = Path(checker.__file__)
Content = dict[str, Any]


@cache
def made(name: str) -> str:
    """The certificate of a rule, as JSON."""
    return json.dumps(certificate(prove(RULES[name], trials=30)))


def content_of(name: str) -> Content:
    """The certificate of a rule, to be changed."""
    content: Content = json.loads(made(name))
    return content


def is_accepted(content: object) -> bool:
    """What the checker says."""
    try:
        return checker.check(content) > 0
    except checker.WrongError:
        return False


@pytest.mark.parametrize("name", PROVED)
def test_the_certificate_of_each_rule_is_accepted(name: str) -> None:
    """The program counts the tiles that the proof enumerated."""
    content = content_of(name)
    assert checker.check(content) == len(content["tiles"]) >= 256


def test_the_checker_is_short_and_imports_nothing_of_ours() -> None:
    """At most 300 lines, and Python's own library alone."""
    text = CHECKER.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 300
    modules = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            modules |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            modules.add(str(node.module))
    assert modules
    assert {name.split(".")[0] for name in modules} <= sys.stdlib_module_names


def test_the_checker_runs_by_itself(tmp_path: Path) -> None:
    """Without any package: 0 for what is right, 1 for what is wrong, 2 for what is no JSON."""
    right, wrong, broken = (tmp_path / f"{name}.json" for name in ("right", "wrong", "broken"))
    write_certificate(prove(RULES["marching-vesta-connect-L"]), right)
    content = json.loads(right.read_text())
    assert content == json.loads(made("marching-vesta-connect-L"))
    content["tiles"].pop()
    wrong.write_text(json.dumps(content))
    broken.write_text("{")

    def run(*files: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-I", "-S", *map(str, [CHECKER, *files])]
        return subprocess.run(command, capture_output=True, encoding="utf-8", check=False)

    assert run(right).returncode == 0
    assert run(right).stdout == f"{right}: right, 256 tiles\n"
    assert run(right, wrong).returncode == 1
    assert "cases without a tile: 1 of 256" in run(wrong).stdout
    assert run(broken, wrong).returncode == 2
    assert run().returncode == 2
    assert "What is checked" in run("--help").stdout


def changes_of(tile: list[Any], bits: int) -> Iterator[tuple[str, list[list[Any]]]]:
    """Every single change of a tile, in words and as the tiles that stand in its place."""
    signs, decision, interior, triangles = tile
    for t, triangle in enumerate(triangles):
        rest = [*triangles[:t], *triangles[t + 1 :]]
        yield "a triangle less", [[signs, decision, interior, rest]]
        yield "a triangle twice", [[signs, decision, interior, [*triangles, triangle]]]
        yield "a triangle turned", [[signs, decision, interior, [*rest, triangle[::-1]]]]
        for k, node in product(range(3), range(-1, 13 + interior)):
            if node != triangle[k]:
                renamed = [*triangle[:k], node, *triangle[k + 1 :]]
                yield "another node", [[signs, decision, interior, [*rest, renamed]]]
    for other in range(1 << bits):
        if other != decision:
            yield "another decision", [[signs, other, interior, triangles]]
    for other in range(256):
        if other != signs:
            yield "other signs", [[other, decision, interior, triangles]]
    for other in range(interior + 3):
        if other != interior:
            yield "other points", [[signs, decision, other, triangles]]
    yield "a tile less", []
    yield "a tile twice", [tile, tile]
    yield "a decision as text", [[signs, str(decision), interior, triangles]]
    yield "a decision that is a fraction", [[signs, decision / 1, interior, triangles]]


def accepted_after(name: str, tiles: list[int], step: int = 1) -> tuple[int, list[str]]:
    """How many single changes of these tiles were tried, and which were accepted all the same."""
    content = content_of(name)
    assert is_accepted(content)
    tried, accepted = 0, []
    for n in tiles:
        rest = [*content["tiles"][:n], *content["tiles"][n + 1 :]]
        changes = list(changes_of(content["tiles"][n], content["bits"]))
        for kind, changed in changes[::step]:
            tried += 1
            # The order of tiles means nothing; first the one that is changed, to save time.
            if is_accepted({**content, "tiles": [*changed, *rest]}):
                accepted.append(f"{kind} in tile {n}")
    return tried, accepted


def test_every_single_change_of_a_tile_is_refused() -> None:
    """Every triangle, node, decision and sign of a tile with two polygons."""
    tried, accepted = accepted_after("marching-vesta-connect-H", [0b00001001])
    assert tried > 300
    assert accepted == []


@pytest.mark.slow
@pytest.mark.parametrize("name", PROVED)
def test_every_single_change_of_a_sample_is_refused(name: str) -> None:
    """Of every rule the largest tile and one at random; of large certificates every few changes."""
    tiles = content_of(name)["tiles"]
    largest = max(range(len(tiles)), key=lambda n: len(tiles[n][3]))
    some = int(np.random.default_rng(7).integers(0, len(tiles)))
    tried, accepted = accepted_after(name, [largest, some], step=len(tiles) // 60)
    assert tried > 50
    assert accepted == []


def test_other_bits_and_other_asked_signs_are_refused() -> None:
    """The cases are then others."""
    for key, value in (("bits", 5), ("bits", 7), ("bits", "6"), ("bits", True), ("format", "")):
        assert not is_accepted({**content_of("asymptotic-decider"), key: value})
    content = content_of("asymptotic-decider")
    for asked in (content["asked"][1:], [*content["asked"], content["asked"][0]], None, [300]):
        assert not is_accepted({**content, "asked": asked})
    wrongs: list[Any] = [[], {}, None, {**content, "tiles": None}, {**content, "tiles": [[0, 0]]}]
    for wrong in wrongs:
        assert not is_accepted(wrong)


def test_an_unasked_cell_beside_one_that_decides_is_refused() -> None:
    """A rule without the cases of one asked configuration is whole by itself, and tears."""
    content = content_of("asymptotic-decider")
    out = content["asked"][0]
    content["asked"].remove(out)
    content["tiles"] = [tile for tile in content["tiles"] if tile[0] != out or tile[1] == 0]
    with pytest.raises(checker.WrongError, match="differ at a face"):
        checker.check(content)


FORGED = [
    kind
    for kind, wrong in WRONG.items()
    if wrong.check.startswith("condition") or wrong.check == "cells that are not asked"
]


@pytest.mark.parametrize("kind", FORGED)
def test_a_forged_proof_is_refused(kind: str) -> None:
    """Tiles that the prover refuses, written down as if it had not: the program finds out."""
    proof = prove(WRONG[kind].rule, trials=30)
    assert not proof.holds
    forged = replace(proof, checks=(Check("all", "all is well", "by nobody"),))
    with pytest.raises(checker.WrongError):
        checker.check(certificate(forged))


def test_the_table_of_1987_would_be_refused() -> None:
    """Its tiles, written down as a certificate, tear."""
    content = content_of("marching-vesta-connect-L")
    rule = RULES["lorensen-cline"]
    for tile in content["tiles"]:
        made_by = rule.tile(tile[0], 0)
        tile[2:] = [len(made_by.interior), [list(t) for t in made_by.triangles]]
    with pytest.raises(checker.WrongError, match="differ at a face"):
        checker.check(content)
