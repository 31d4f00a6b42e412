"""Verdicts on some dozens of cases, to be compared with those of another NumPy or processor.

    python -m tests.isograde.repeated              prints them, a line of JSON
    python -m tests.isograde.repeated --oldest     asks the lowest NumPy and SciPy: ``make oldest``
    python -m tests.isograde.repeated --newest     asks the newest there are: ``make newest``
    .. --newest --python PYTHON                    those for another Python, made an environment of

What is compared is what every claim says of every case, but for what calls cost, which no two runs
measure alike.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from fnmatch import fnmatch
from importlib import import_module
from pathlib import Path
from typing import Any

from isograde.model import Limits
from isograde.runner import Options, Task, Worker, cases_for, claims_for, plan

ROOT = Path(__file__).parents[2]
SPECS = ("isoref:asymptotic-decider", "isoref:trilinear-cubes")
CASES = ("magnitudes/*", "tied/*", "ties/point", "structured/*", "simplices/*", "noise/white-5x6x7")
MOST = 900
SAMPLES_OF_ALL = 40
Verdicts = dict[str, dict[str, dict[str, str]]]


def verdicts() -> Verdicts:
    """For each implementation and each case what each claim says."""
    found: Verdicts = {}
    for spec in SPECS:
        worker = Worker.open(spec, Options(limits=Limits(seconds=60)))
        try:
            said = found[spec] = {}
            for task in chosen(worker):
                findings = worker.judge(task).findings
                said[task.case] = {name: str(one.verdict) for name, one in findings.items()}
        finally:
            worker.adapter.close()
    return found


def chosen(worker: Worker) -> list[Task]:
    """The tasks of the default plan on these cases, without what calls cost."""
    declared = worker.declaration
    cases = cases_for(declared, 0)
    tasks = plan(Options(), cases, claims_for(declared))
    fit = [
        one
        for one in tasks
        if any(fnmatch(one.case, pattern) for pattern in CASES) and cases[one.case].samples <= MOST
    ]
    kept = fit[:: max(1, len(fit) // SAMPLES_OF_ALL)]
    return [
        Task(one.case, tuple(c for c in one.claims if not c.startswith("calls."))) for one in kept
    ]


def elsewhere(python: str | Path = sys.executable, **environment: str) -> Verdicts:
    """What a process of this Python says, with these variables."""
    parts = os.pathsep.join(map(str, (ROOT / "reference", ROOT / "validation", ROOT)))
    done = subprocess.run(
        [str(python), "-m", "tests.isograde.repeated"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": parts, **environment},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    said: Verdicts = json.loads(done.stdout.splitlines()[-1])
    return said


def differing(one: Verdicts, other: Verdicts) -> list[str]:
    """The findings that differ, in words."""
    flat = [
        {
            (s, c, n): v
            for s, said in each.items()
            for c, all_ in said.items()
            for n, v in all_.items()
        }
        for each in (one, other)
    ]
    keys = sorted(flat[0].keys() | flat[1].keys())
    return [
        f"{' '.join(k)}: {flat[0].get(k)}, {flat[1].get(k)}"
        for k in keys
        if flat[0].get(k) != flat[1].get(k)
    ]


def features() -> str:
    """What NumPy would choose between on this processor, as NPY_DISABLE_CPU_FEATURES takes it."""
    umath: Any = import_module("numpy._core._multiarray_umath")
    return " ".join(name for name in umath.__cpu_dispatch__ if umath.__cpu_features__.get(name))


def lowest(wanted: list[str]) -> list[str]:
    """The requirements, NumPy and SciPy in the lowest versions that are allowed.

    >>> lowest(["numpy>=1.26", "typer>=0.12"])
    ['numpy==1.26.*', 'typer>=0.12']
    """
    return [
        re.sub(r">=([\d.]+).*", r"==\1.*", one) if re.match("numpy|scipy", one) else one
        for one in wanted
    ]


def compared(requirements: list[str], python: str) -> int:
    """0 where an environment of this Python with these packages gives the same verdicts."""
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([python, "-m", "venv", name], check=True)
        there = Path(name, "bin", "python")
        command = [str(there), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*command, *requirements], check=True)
        versions = (
            "import sys, numpy, scipy; "
            "print('Python', sys.version.split()[0], 'NumPy', numpy.__version__, "
            "'SciPy', scipy.__version__)"
        )
        for one in (sys.executable, there):
            subprocess.run([str(one), "-c", versions], check=True)
        here, said = verdicts(), elsewhere(there)
    told = differing(here, said)
    count = sum(len(claims) for cases in here.values() for claims in cases.values())
    print("\n".join(told) or f"the same {count:,} verdicts")
    return bool(told)


def main() -> int:
    """Print, or compare."""
    parser = argparse.ArgumentParser(description="Verdicts, to be compared.")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--oldest", action="store_true", help="with the lowest NumPy and SciPy")
    which.add_argument("--newest", action="store_true", help="with the newest NumPy and SciPy")
    parser.add_argument("--python", default=sys.executable, help="the Python to ask them with")
    asked = parser.parse_args()
    if asked.oldest or asked.newest:
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        wanted: list[str] = project["dependencies"]
        return compared(lowest(wanted) if asked.oldest else wanted, asked.python)
    print(json.dumps(verdicts()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
