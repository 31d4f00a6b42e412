"""The theorem in Coq: that it is whole, that it speaks of our numbering, and that it can refuse."""

import json
import re
import shutil
import subprocess
import sys
from itertools import product
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from isograde.proof import prove
from isograde.proof.certificate import certificate
from isograde.proof.tiles import node_place
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.methods import RULES

from tests.loading import module_at

PROOFS = Path(__file__).parents[2] / "validation" / "proofs"
NAME = "marching-vesta-connect-L"
WITH_COQ = pytest.mark.skipif(shutil.which("coqc") is None, reason="there is no coqc here")


def run(
    *command: object, cwd: Path | None = None, env: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """A program that ended."""
    words = [str(word) for word in command]
    return subprocess.run(
        words, capture_output=True, encoding="utf-8", check=False, cwd=cwd, env=env
    )


def export_module() -> ModuleType:
    """The program that writes tiles for Coq."""
    return module_at(PROOFS / "export.py", "proofs_export")


def test_nothing_is_admitted() -> None:
    """No theorem is taken for granted, and the README says so."""
    files = sorted(PROOFS.glob("*.v"))
    assert len(files) == 6
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert not re.search(r"\b(Admitted|admit|Axiom|Parameter|Conjecture|Abort)\b", text), file
    assert "Nothing is admitted" in (PROOFS / "README.md").read_text(encoding="utf-8")


def test_the_theorem_numbers_nodes_as_the_rules_do() -> None:
    """`place` in Check.v, the table in export.py, and the places that a sweep gives the nodes."""
    text = (PROOFS / "Check.v").read_text(encoding="utf-8")
    listed = re.findall(r"\| (\d+) => Node \(P (\d) (\d) (\d)\) 0", text)
    places = {int(n): tuple(map(int, place)) for n, *place in listed}
    assert places == {n: node_place(n) for n in range(12)}
    export = export_module()
    assert [tuple(node) for node in export.NODES] == [node_place(n) for n in range(12)]


def test_without_coq_the_proof_is_skipped_with_a_word() -> None:
    """And the status is 0."""
    done = run(sys.executable, PROOFS / "make.py", env={"PATH": ""})
    assert done.returncode == 0, done.stderr
    assert "There is no coqc here: the proof is skipped" in done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the theory compiled in it."""
    folder = tmp_path_factory.mktemp("coq")
    for name in ("Lattice", "Conditions", "Geometry", "Circle", "Surface", "Check"):
        shutil.copy(PROOFS / f"{name}.v", folder)
        done = run("coqc", "-q", "-R", ".", "Proofs", f"{name}.v", cwd=folder)
        assert done.returncode == 0, done.stderr
    return folder


def compiled(folder: Path, content: dict[str, object], more: str = "") -> tuple[int, str]:
    """The status of Coq for the tiles of a certificate, and what it printed."""
    file = folder / "certificate.json"
    file.write_text(json.dumps(content))
    written = run(sys.executable, PROOFS / "export.py", file)
    assert written.returncode == 0, written.stderr
    (folder / "Tiles.v").write_text(written.stdout + more)
    done = run("coqc", "-q", "-R", ".", "Proofs", "Tiles.v", cwd=folder)
    return done.returncode, done.stdout + done.stderr


@WITH_COQ
@pytest.mark.slow
def test_coq_accepts_a_rule_and_rests_on_no_axiom(built: Path) -> None:
    """From the definitions to the theorem of one rule."""
    status, said = compiled(built, certificate(prove(RULES[NAME])))
    assert status == 0, said
    name = NAME.replace("-", "_")
    theorem = f"{name}_makes_surfaces : makes_surfaces (choices {name}) (tile {name})"
    assert " ".join(said.split()) == f"{theorem} Closed under the global context"


@WITH_COQ
@pytest.mark.slow
@pytest.mark.parametrize("change", ["turned", "less", "renamed", "of 1987"])
def test_coq_refuses_wrong_tiles(built: Path, change: str) -> None:
    """A triangle turned or left out, a node renamed, the drawings of 1987."""
    content = certificate(prove(RULES[NAME]))
    tile = content["tiles"][0b00001001]
    if change == "turned":
        tile[3][0].reverse()
    elif change == "less":
        tile[3].pop()
    elif change == "renamed":
        tile[3][0][0] = next(n for n in range(12) if n not in tile[3][0])
    else:
        for one in content["tiles"]:
            triangles = RULES["lorensen-cline"].tile(one[0], 0).triangles
            one[3] = [list(t) for t in triangles]
    status, said = compiled(built, content)
    assert status != 0
    assert f'expected to have type\n "check {NAME.replace("-", "_")} = true"' in said


@WITH_COQ
@pytest.mark.slow
def test_the_mesh_of_the_theorem_is_the_mesh_of_the_sweep(built: Path) -> None:
    """Triangle by triangle, by places: 2 x 3 x 2 cells with random samples of 1 and -1."""
    values = np.random.default_rng(3).choice([-1.0, 1.0], (3, 4, 3))
    inside = [f"({i}, {j}, {k})" for i, j, k in np.argwhere(values > 0).tolist()]
    more = f"""
Require Import ZArith Bool.
Open Scope Z_scope.
Definition inside : list (Z * Z * Z) := [{"; ".join(inside)}].
Definition sampled (p : point) : bool := existsb (fun '(i, j, k) =>
  Z.eqb i (px p) && Z.eqb j (py p) && Z.eqb k (pz p)) inside.
Definition flat (n : node) := [px (at_ n); py (at_ n); pz (at_ n)].
Set Printing Width 1000000. Set Printing Depth 1000000.
Eval vm_compute in map (fun '(a, b, c) => [flat a; flat b; flat c]) (mesh
  (tile {NAME.replace("-", "_")}) sampled (fun _ _ => false) (fun _ => 0%N) (box 2 3 2)).
"""
    status, said = compiled(built, certificate(prove(RULES[NAME])), more)
    assert status == 0, said
    found = re.search(r"= (\[.*\])\s*: list", said, re.DOTALL)
    assert found
    ours = json.loads(found[1].replace(";", ","))
    mesh = sweep(RULES[NAME], Field.of(values), 0.0)
    theirs = np.rint(2 * mesh.vertices).astype(int)[mesh.simplices].tolist()
    assert len(ours) == len(theirs) > 20
    assert sorted(map(turned_first, ours)) == sorted(map(turned_first, theirs))


def turned_first(triangle: list[list[int]]) -> list[list[int]]:
    """The triangle from its least node, in its own direction."""
    return min(triangle[n:] + triangle[:n] for n in range(3))


def test_the_interface_of_every_kind_of_face_is_written() -> None:
    """export.py finds the segments of all 54 kinds: 3 axes, 16 signs and 2 decided again."""
    export = export_module()
    for name in (NAME, "asymptotic-decider"):
        segments, below, above = export.interface(certificate(prove(RULES[name], trials=30)))
        assert len(segments) == len(below) == len(above) == 96
        for axis, corners, decided in product(range(3), range(16), range(2)):
            marks = [corners >> n & 1 for n in range(4)]
            ambiguous = marks[0] == marks[3] != marks[1] == marks[2]
            crossed = sum(marks[a] != marks[b] for a, b in ((0, 1), (0, 2), (1, 3), (2, 3)))
            pieces = segments[corners + 16 * decided + 32 * axis]
            assert len(pieces) == (crossed // 2 if ambiguous or not decided else 0)
