"""What a newcomer waits for: the command's help, its lists and a check, beside ``import numpy``.

The checks are of a library's function and of a plain function in a file of its own, each with the
process in which it runs.

Each contestant is a new process, in turn, so that a busy machine slows all alike; what is compared
is processor time, which waiting for others does not lengthen. Beside it stands how many modules
each imports, which no machine changes. Writes ``reports/benchmarks/start.md``.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from isograde.stopwatch import Machine

NUMPY = ("-c", "import numpy")
# The contestants, with how many times NumPy's import each may take.
MOST = {
    ("--help",): 1.2,
    ("--version",): 1.2,
    ("list", "levels"): 2.0,
    ("list", "claims"): 2.0,
    ("list", "cases"): 2.0,
    ("list", "implementations"): 2.0,
    # Five seconds, where the import takes 110 milliseconds.
    ("check", "skimage:lewiner"): 45.0,
    ("check", "python:plain.py:extract"): 45.0,
}
PLAIN = """
import isoref


def extract(values, isovalue, spacing):
    mesh = isoref.extract(values, isovalue, spacing)
    return mesh.vertices, mesh.simplices
"""


def processor_seconds(arguments: Sequence[str], folder: Path) -> float:
    """What a new Python with these arguments, and what it starts, take of the processor."""
    process = subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        cwd=folder,
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    # A check that finds a fault ends with 1, and has done as much.
    if process.returncode > ("check" in arguments):
        raise SystemExit(f"{' '.join(arguments)} ended with status {process.returncode}")
    return used.ru_utime + used.ru_stime


def modules(arguments: Sequence[str], folder: Path) -> int:
    """How many modules a new Python with these arguments imports."""
    done = subprocess.run(
        [sys.executable, "-X", "importtime", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        check=False,
        cwd=folder,
    )
    return sum(line.startswith("import time:") for line in done.stderr.splitlines())


def main() -> None:
    """Run the table and write it down; status 1 where a goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/start.md"))
    asked = parser.parse_args()
    machine = Machine()
    runs = {words: ("-m", "isograde", *words) for words in MOST}
    ratios: dict[tuple[str, ...], list[float]] = {words: [] for words in runs}
    alone = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "plain.py").write_text(PLAIN, encoding="utf-8")
        for _ in range(asked.rounds):
            alone.append(processor_seconds(NUMPY, folder))
            for words, run in runs.items():
                ratios[words].append(processor_seconds(run, folder) / alone[-1])
        imported = {run: modules(run, folder) for run in (NUMPY, *runs.values())}
    found = {words: statistics.median(ratios[words]) for words in runs}
    lines = [
        "# What a newcomer waits for\n",
        f"{machine.state()}; processor time of a new process over that of `import numpy` "
        f"({1000 * statistics.median(alone):.0f} ms), medians of {asked.rounds} rounds in turn.\n",
        "| command | over numpy | at most | modules imported |",
        "| --- | ---: | ---: | ---: |",
        f"| `import numpy` | 1 | | {imported[NUMPY]} |",
        *(
            f"| `isograde {' '.join(words)}` | {found[words]:.2f} | {most} | {imported[run]} |"
            for (words, run), most in zip(runs.items(), MOST.values(), strict=True)
        ),
    ]
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    asked.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    if any(found[words] > most for words, most in MOST.items()):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
