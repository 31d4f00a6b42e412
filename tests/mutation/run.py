"""Mutants of oracles and claims, and which of them the tests kill: ``make mutation``.

`Cosmic Ray <https://cosmic-ray.readthedocs.io>`_ makes the mutants: it is kept well, changes source
and not bytecode, has an operator for each kind of slip, and keeps its session in a data base, so
that a run goes on where it was stopped. Added here are a sample with a seed (`SEED`), the tests of
the module at hand (`tests.mutation.selected`) and the report. A copy of the tree is mutated, never
the tree itself. (mutmut was the other candidate: it chooses tests by coverage, which takes one run
of the whole suite under a tracer, and has no sample.)

    python -m tests.mutation.run [--minutes M] [--size N]     makes the session or goes on with it
    python -m tests.mutation.run --report                     writes reports/mutation/README.md
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[2]
BUILD = HERE / "build" / "mutation"
TREE, SESSION, CONFIG = BUILD / "tree", BUILD / "session.sqlite", BUILD / "config.toml"
WHOLE = BUILD / "whole"
REPORT = HERE / "reports" / "mutation" / "README.md"
EXPLAINED = HERE / "tests" / "mutation" / "explained.json"
MUTATED = ("validation/isograde/oracles", "validation/isograde/claims")
SEED, SIZE = 13, 400
#: A normal quantile: 95 in 100 lie within it on either side.
Z = 1.96
#: Comparisons flipped, constants changed, conditions turned round, loops cut.
OPERATORS = re.compile(
    r"core/(ReplaceComparisonOperator_(?!.*_(Is|IsNot|In|NotIn)(_|$))|NumberReplacer|AddNot"
    r"|ReplaceAndWithOr|ReplaceOrWithAnd|ReplaceTrueWithFalse|ReplaceFalseWithTrue"
    r"|ReplaceBinaryOperator_(Add_Sub|Sub_Add|Mul_Div|Div_Mul|BitAnd_BitOr|BitOr_BitAnd)$"
    r"|ReplaceBreakWithContinue|ReplaceContinueWithBreak|ZeroIterationForLoop)"
)
SETTINGS = """\
[cosmic-ray]
module-path = ["validation/isograde/oracles", "validation/isograde/claims"]
timeout = {timeout}
excluded-modules = []
test-command = "{python} -m tests.mutation.selected"

[cosmic-ray.distributor]
name = "local"
"""


def prepare(size: int, timeout: float) -> None:
    """A copy of the tree, and a session of all mutants in which `size` are left to be tried."""
    from cosmic_ray.work_db import WorkDB, use_db

    # Copy what the tests need.
    shutil.rmtree(BUILD, ignore_errors=True)
    TREE.mkdir(parents=True)
    for part in ("reference", "validation", "tests", "benchmarks"):
        shutil.copytree(HERE / part, TREE / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "pyproject.toml", TREE)
    for part in MUTATED:
        shutil.copytree(TREE / part, WHOLE / part)
    CONFIG.write_text(SETTINGS.format(python=sys.executable, timeout=timeout))
    write = "from tests.mutation.selected import *; CHECKSUMS.write_text(json.dumps(checksums()))"
    in_tree([sys.executable, "-c", write])
    in_tree([sys.executable, "-m", "cosmic_ray.cli", "init", str(CONFIG), str(SESSION)])

    # Leave a sample: the mutants sorted by place, so that a seed means the same anywhere.
    with use_db(str(SESSION), WorkDB.Mode.open) as session:
        items = list(session.work_items)
        fit = [item for item in items if OPERATORS.match(item.mutations[0].operator_name)]
        fit.sort(key=lambda item: place(item.mutations[0]))
        random.Random(SEED).shuffle(fit)
        chosen = fit[:size]
        session.clear()
        session.add_work_items(chosen)
    (BUILD / "counts.json").write_text(
        json.dumps({"all": len(items), "fit": len(fit), "commit": commit()})
    )
    print(f"{len(items)} mutants, {len(fit)} of the chosen kinds, {len(chosen)} in the sample")


def commit() -> str:
    """The commit that is checked out, or what there is instead."""
    command = ["git", "rev-parse", "--short", "HEAD"]
    told = subprocess.run(command, cwd=HERE, capture_output=True, encoding="utf-8", check=False)
    return told.stdout.strip() or "unknown"


def place(mutation: Any) -> tuple[Any, ...]:
    """Where a mutation is, and what it does."""
    return (
        str(mutation.module_path),
        mutation.start_pos,
        mutation.operator_name,
        mutation.occurrence,
    )


def in_tree(command: list[str], seconds: float | None = None) -> int:
    """The status of a command that runs in the copy, with its packages before all others."""
    parts = [TREE / "reference", TREE / "validation", TREE]
    path = os.pathsep.join([*map(str, parts), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path.strip(os.pathsep)}
    try:
        return subprocess.run(
            command, cwd=TREE, env=environment, timeout=seconds, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return 0


def go_on(minutes: float) -> None:
    """Mutants are tried until the time is over or none is left."""
    # A run that was cut off may have left a mutant behind.
    for part in MUTATED:
        shutil.copytree(WHOLE / part, TREE / part, dirs_exist_ok=True)
    started = time.monotonic()
    command = [sys.executable, "-m", "cosmic_ray.cli", "exec", str(CONFIG), str(SESSION)]
    in_tree(command, 60 * minutes)
    print(f"{(time.monotonic() - started) / 60:.1f} minutes")


def interval(killed: int, tried: int) -> tuple[float, float]:
    """Wilson's interval of 95 % for a share.

    >>> [round(x, 3) for x in interval(90, 100)]
    [0.826, 0.945]
    """
    share = killed / tried
    middle = (share + Z**2 / (2 * tried)) / (1 + Z**2 / tried)
    half = math.sqrt(share * (1 - share) / tried + (Z / (2 * tried)) ** 2) * Z / (1 + Z**2 / tried)
    return middle - half, middle + half


def report() -> None:
    """`REPORT` has the score, its interval, and every survivor with what is said of it."""
    from cosmic_ray.work_db import WorkDB, use_db
    from cosmic_ray.work_item import TestOutcome

    counts = json.loads((BUILD / "counts.json").read_text())
    with use_db(str(SESSION), WorkDB.Mode.open) as session:
        items = {item.job_id: item.mutations[0] for item in session.work_items}
        judged = {job: result for job, result in session.results if result.test_outcome}
    # Cosmic Ray counts a test that ran out of time as a kill; on a busy machine it is none.
    late = [job for job, result in judged.items() if result.output == "timeout"]
    results = {job: result for job, result in judged.items() if job not in late}
    tried = len(results)
    alive = [job for job, r in results.items() if r.test_outcome == TestOutcome.SURVIVED]
    said: dict[str, str] = json.loads(EXPLAINED.read_text()) if EXPLAINED.exists() else {}
    low, high = interval(tried - len(alive), tried)
    kinds = Counter(kind(items[job].operator_name) for job in results)
    dead = Counter(kind(items[job].operator_name) for job in results if job not in alive)
    text = [
        "# Mutants of oracles and claims",
        "",
        f"Cosmic Ray makes {counts['all']} mutants of `isograde.oracles` and `isograde.claims`, "
        f"{counts['fit']} of them of the kinds below. Of a sample (seed {SEED}) of {len(items)} "
        f"{len(judged)} were tried, each on the tests of its module that are not slow; "
        f"{len(late)} ran out of time and say nothing. (A run of part of the sample is a sample: "
        "its order was drawn. What ran out of time is likelier to live than what did not.) "
        f"The tree is that of commit {counts['commit']}.",
        "",
        f"**{tried - len(alive)} of {tried} were killed by a test that fails, "
        f"{100 * (1 - len(alive) / tried):.1f} %** "
        f"(95 % interval {100 * low:.1f} to {100 * high:.1f} %). {len(alive)} survived.",
        "",
        "Written by `python -m tests.mutation.run --report`; what is said of survivors stands in "
        "`tests/mutation/explained.json`.",
        "",
        "| kind | tried | killed |",
        "| --- | ---: | ---: |",
        *(f"| {name} | {n} | {dead[name]} |" for name, n in sorted(kinds.items())),
        "",
        "## Survivors",
        "",
        "| where | mutant | what is said of it |",
        "| --- | --- | --- |",
    ]
    rows = sorted((place(items[job]), job) for job in alive)
    for _, job in rows:
        name = key(items[job], results[job].diff or "")
        where, change = name.split(" ", 1)
        text.append(
            f"| {where} | `{change.replace('|', chr(92) + '|')}` | {said.get(name, 'open')} |"
        )
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text("\n".join(text) + "\n")
    print(f"{tried} tried, {len(alive)} alive: {REPORT.relative_to(HERE)}")


def kind(operator: str) -> str:
    """The operator's name without its variants.

    >>> kind("core/ReplaceComparisonOperator_Lt_LtE")
    'ReplaceComparisonOperator'
    """
    return operator.removeprefix("core/").split("_")[0]


def key(mutation: Any, diff: str) -> str:
    """What names a mutant: its module and the lines it changes, which outlive a shift of lines."""
    gone = [line[1:].strip() for line in diff.splitlines() if re.match(r"-(?!--)", line)]
    come = [line[1:].strip() for line in diff.splitlines() if re.match(r"\+(?!\+\+)", line)]
    path = Path(mutation.module_path)
    return f"{path.parent.name}/{path.name} {' '.join(gone)} -> {' '.join(come)}"


def main(arguments: list[str] | None = None) -> int:
    """The session goes on, or is begun, or reported."""
    parser = argparse.ArgumentParser(description="Mutants of oracles and claims.")
    parser.add_argument("--minutes", type=float, default=24 * 60.0, help="stop after so long")
    parser.add_argument("--size", type=int, default=SIZE, help="of the sample, when begun")
    parser.add_argument("--timeout", type=float, default=300.0, help="seconds a mutant may take")
    parser.add_argument("--again", action="store_true", help="begin a new session")
    parser.add_argument("--report", action="store_true", help="write the report and stop")
    asked = parser.parse_args(arguments)
    if not asked.report:
        if asked.again or not SESSION.exists():
            prepare(asked.size, asked.timeout)
        go_on(asked.minutes)
    report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
