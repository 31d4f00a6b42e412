"""Compiles the theorem and checks the tiles of every rule: `make proof`.

For each rule of isoref that is proved it writes the certificate, has the independent program check
it, turns it into a Coq file, compiles that, and prints the theorem with what it rests on. Needs
coqc (Debian, Ubuntu: apt-get install coq); says so, and ends well, where there is none.

    python make.py [RULE ...]
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import indent

from isograde.commands.proving import CHECKER
from isograde.proof import prove
from isograde.proof.certificate import write_certificate
from isoref.methods import RULES

HERE = Path(__file__).parent
BUILD = HERE / "build"
THEORY = ("Lattice", "Conditions", "Geometry", "Circle", "Surface", "Check")
THEOREMS = ("conditions_suffice", "checked_rule")


def compiled(name: str) -> str:
    """What Coq says while it compiles a file of the build folder."""
    print(f"coqc {name}.v", flush=True)
    command = ["coqc", "-q", "-R", ".", "Proofs", f"{name}.v"]
    done = subprocess.run(command, cwd=BUILD, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        sys.exit(f"{name}.v is refused:\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def theory() -> None:
    """Compile the theorem from nothing, and say what it rests on."""
    shutil.rmtree(BUILD, ignore_errors=True)
    BUILD.mkdir()
    for name in THEORY:
        shutil.copy(HERE / f"{name}.v", BUILD)
        compiled(name)
    for theorem in THEOREMS:
        module = f"assumptions_of_{theorem}"
        (BUILD / f"{module}.v").write_text(
            "From Proofs Require Import Lattice Conditions Surface Check.\n"
            f"Check {theorem}.\nPrint Assumptions {theorem}.\n"
        )
        print(indent(compiled(module), "  "), flush=True)


def rule(name: str) -> bool:
    """The tiles of a rule are checked in Coq; false where the rule is not proved to begin with."""
    proof = prove(RULES[name])
    if not proof.holds:
        print(f"{name}: not proved ({', '.join(proof.broken)}), so there is nothing to check")
        return False
    certificate = BUILD / f"{name}.json"
    write_certificate(proof, certificate)
    for program in ([CHECKER, certificate], [HERE / "export.py", certificate]):
        done = subprocess.run(
            [sys.executable, *program], capture_output=True, encoding="utf-8", check=False
        )
        if done.returncode:
            sys.exit(f"{name}: {program[0]} says: {done.stdout}{done.stderr}")
    module = name.replace("-", "_")
    (BUILD / f"{module}.v").write_text(done.stdout)
    print(indent(compiled(module), "  "), flush=True)
    return True


def main() -> None:
    """The theorem, then every rule that is named, or all of them."""
    if shutil.which("coqc") is None:
        print("There is no coqc here: the proof is skipped (Debian, Ubuntu: apt-get install coq).")
        return
    names = sys.argv[1:] or list(RULES)
    unknown = set(names) - set(RULES)
    if unknown:
        sys.exit(f"no rule {', '.join(unknown)}; there are {', '.join(RULES)}")
    theory()
    proved = [rule(name) for name in names]
    print(f"{sum(proved)} of {len(proved)} rules make surfaces on every field.")


if __name__ == "__main__":
    main()
