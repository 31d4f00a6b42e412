"""The tests of the one module that was mutated: ``python -m tests.mutation.selected``.

Cosmic Ray changes one file and asks a command whether the tests still pass. Running the whole suite
each time would take days, so the command finds the changed file by its checksum and runs the tests
that bear its name, then those that import it, then those of the claims that use it, and at last the
replay of the faults. It stops at the first failure.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from pathlib import Path

import pytest

GRADER = Path("validation/isograde")
TESTS = Path("tests/isograde")
CHECKSUMS = Path("checksums.json")
#: What judges by every claim: asked last.
LAST = ("test_claims.py", "test_families.py", "faults/test_faults.py")


def checksums() -> dict[str, str]:
    """The checksum of each module that may be mutated."""
    return {
        str(path): hashlib.sha256(path.read_bytes()).hexdigest()
        for part in ("oracles", "claims")
        for path in sorted((GRADER / part).glob("*.py"))
    }


def changed() -> list[str]:
    """The modules that differ from what they were."""
    before: dict[str, str] = json.loads(CHECKSUMS.read_text(encoding="utf-8"))
    now = checksums()
    return sorted(path for path in {*before, *now} if before.get(path) != now.get(path))


def imports(path: Path, module: str) -> bool:
    """Whether a file imports the module ``oracles.name`` or ``claims.name``."""
    part, name = module.split(".")
    text = path.read_text(encoding="utf-8")
    long = re.search(rf"isograde\.{part}\.{name}\b", text)
    return bool(long or re.search(rf"from isograde\.{part} import [^\n]*\b{name}\b", text))


def tests_of(path: str) -> list[str]:
    """The files of tests for a module, the nearest first."""
    part, name = Path(path).parent.name, Path(path).stem
    files = sorted(TESTS.glob("test_*.py"))
    users = [f"{part}.{name}"]
    users += [
        f"{user.parent.name}.{user.stem}"
        for other in ("claims", "oracles")
        for user in sorted((GRADER / other).glob("*.py"))
        if imports(user, f"{part}.{name}")
    ]
    own = [file for file in files if name.rstrip("s") in file.stem]
    near = [file for user in users for file in files if imports(file, user)]
    last = [TESTS / file for file in LAST if (TESTS / file).exists()]
    ordered = [file for file in [*own, *near] if file not in last]
    return [str(file) for file in dict.fromkeys([*ordered, *last])]


def main() -> int:
    """1 where a test of the changed module fails or cannot be collected, else 0.

    Whatever else goes wrong (no such file of tests, no test in it) must not look like a kill: it
    ends with 0, so that the mutant is among the survivors, where somebody looks at it.
    """
    found = changed()
    if len(found) != 1:
        print(f"one module should be changed, and these are: {found}")
        return 0
    options = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "--no-header", "--tb=line"]
    status = pytest.main([*options, *tests_of(found[0])])
    killed = (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED)
    return int(status in killed)


if __name__ == "__main__":
    try:
        told = main()
    except Exception as error:  # noqa: BLE001 - a fault of this program is no kill
        print(f"the choice of tests failed: {error!r}")
        told = 0
    sys.exit(told)
