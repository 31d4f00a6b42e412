"""Mutants of oracles and claims, and which of them the tests kill: ``make mutation``.

`Cosmic Ray <https://cosmic-ray.readthedocs.io>`_ makes the mutants: it is kept well, changes source
and not bytecode, and has an operator for each kind of slip. A sample of them is drawn with a seed
(`SEED`). How one is tried is said in `tests.mutation.trying`: in a fork of a process that has
collected the tests, on those that call the function that it changes, the quickest first. All of it
happens in a copy of the tree. What became of each mutant is a line of ``results.jsonl``, so that a
run goes on where it was stopped.

    python -m tests.mutation.run [--minutes M] [--size N]     makes the sample or goes on with it
    python -m tests.mutation.run --report                     writes reports/mutation/README.md
"""

from __future__ import annotations

import argparse
import difflib
import json
import math
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

from tests.mutation.trying import BUDGET, SLOWEST, Mutant, Outcome, tests_collected

HERE = Path(__file__).resolve().parents[2]
BUILD = HERE / "build" / "mutation"
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
#: Tests that bear on oracles or claims name one of these.
JUDGES = re.compile(r"isograde\.(oracles|claims)|judging|reporting|graded|Worker")
DEAD = (Outcome.KILLED, Outcome.ENDLESS)


def prepare(size: int) -> None:
    """A copy of the tree, and a sample of all mutants of it."""
    shutil.rmtree(BUILD, ignore_errors=True)
    tree = BUILD / "tree"
    tree.mkdir(parents=True)
    for part in ("reference", "validation", "tests", "benchmarks", "reports"):
        shutil.copytree(HERE / part, tree / part, ignore=shutil.ignore_patterns("__pycache__"))
    for file in ("pyproject.toml", "Makefile", "README.md", "CONTRIBUTING.md"):
        shutil.copy(HERE / file, tree)

    # Draw from the mutants sorted by place, so that a seed means the same anywhere.
    specs = sorted(every_mutant(tree))
    fit = [spec for spec in specs if OPERATORS.match(spec[2])]
    random.Random(SEED).shuffle(fit)
    sample = {"all": len(specs), "fit": len(fit), "commit": commit(), "mutants": fit[:size]}
    (BUILD / "sample.json").write_text(json.dumps(sample), encoding="utf-8")
    print(f"{len(specs)} mutants, {len(fit)} of the chosen kinds, {len(fit[:size])} in the sample")


Spec = tuple[str, tuple[int, int], str, int]  # Path, place, operator, and its occurrence there.


def every_mutant(tree: Path) -> list[Spec]:
    """Every mutant that Cosmic Ray knows of the modules."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator, operator_names

    operators = {name: get_operator(name) for name in operator_names()}
    plain = {name: made() for name, made in operators.items() if not made.arguments()}
    found: list[Spec] = []
    for part in MUTATED:
        for file in sorted((tree / part).glob("*.py")):
            path, nodes = (
                str(file.relative_to(tree)),
                list(ast_nodes(get_ast(file.read_text("utf-8")))),
            )
            for name, operator in plain.items():
                places = (start for node in nodes for start, _ in operator.mutation_positions(node))
                found += [(path, tuple(start), name, n) for n, start in enumerate(places)]
    return found


def mutant_of(tree: Path, spec: Spec) -> Mutant | None:
    """The mutant with its text; None where the operator changes nothing."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    path, (line, _), operator, occurrence = spec
    source = (tree / path).read_text(encoding="utf-8")
    changed = mutate_code(source, get_operator(operator)(), occurrence)
    if changed is None or changed == source:
        return None
    return Mutant(json.dumps(spec), path, source, changed, line)


def commit() -> str:
    """The commit that is checked out, or what there is instead."""
    command = ["git", "rev-parse", "--short", "HEAD"]
    told = subprocess.run(command, cwd=HERE, capture_output=True, encoding="utf-8", check=False)
    return told.stdout.strip() or "unknown"


def results(build: Path) -> dict[str, dict[str, Any]]:
    """What became of the mutants that were tried, by name."""
    place = build / "results.jsonl"
    lines = place.read_text(encoding="utf-8").splitlines() if place.exists() else []
    return {line["mutant"]: line for line in map(json.loads, lines)}


def go_on(minutes: float) -> None:
    """Mutants are tried until the time is over or none is left."""
    tree = BUILD / "tree"
    parts = [tree / "reference", tree / "validation", tree]
    path = os.pathsep.join([*map(str, parts), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path.strip(os.pathsep), "PYTHONHASHSEED": "0"}
    command = [sys.executable, "-m", "tests.mutation.run", "--within", str(BUILD)]
    for kind in ("forks", "processes"):
        left = 60 * minutes
        started = time.monotonic()
        try:
            subprocess.run(
                [*command, kind], cwd=tree, env=environment, timeout=max(left, 1), check=True
            )
        except subprocess.TimeoutExpired:
            print("the time is over; the same command goes on from here")
            return
        minutes -= (time.monotonic() - started) / 60


def within(build: Path, kind: str) -> None:
    """In the tree: every mutant that was not tried is, in forks or in processes of their own."""
    tree, known = build / "tree", results(build)
    sample = json.loads((build / "sample.json").read_text(encoding="utf-8"))
    specs = [(path, tuple(place), *rest) for path, place, *rest in sample["mutants"]]
    wanted = [json.dumps(spec) for spec in specs]
    outcomes = {name: known[name]["outcome"] if name in known else "" for name in wanted}
    due = "" if kind == "forks" else Outcome.IMPORTED
    mutants = [
        one
        for spec, name in zip(specs, wanted, strict=True)
        if outcomes[name] == due and (one := mutant_of(tree, spec)) is not None
    ]

    def told(mutant: Mutant, outcome: Outcome, by: str, tests: int, seconds: float) -> None:
        diff = difflib.unified_diff(mutant.source.splitlines(), mutant.changed.splitlines(), n=0)
        line = {
            "mutant": mutant.name, "outcome": outcome, "by": by, "tests": tests,
            "seconds": round(seconds, 2), "function": mutant.function, "diff": list(diff)[2:],
        }  # fmt: skip
        with (build / "results.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    calls = build / "calls.jsonl"
    if kind == "forks":
        places = sorted((tree / "tests" / "isograde").glob("test_*.py"))
        files = [str(one) for one in places if JUDGES.search(one.read_text(encoding="utf-8"))]
        files.append(str(tree / "tests" / "isograde" / "faults"))
        tests_collected(tree, files, mutants, calls, told)
        return
    measured: dict[str, Any] = {}
    for text in calls.read_text(encoding="utf-8").splitlines():
        measured.update(json.loads(text))
    for mutant in mutants:
        told(mutant, *by_itself(tree, mutant, measured))


def by_itself(tree: Path, mutant: Mutant, calls: dict[str, Any]) -> tuple[Outcome, str, int, float]:
    """What becomes of a mutant in a process that imports all anew: tests of its module's users."""
    near = [
        name
        for name, one in calls.items()
        if one["seconds"] is not None
        and one["seconds"] < SLOWEST
        and any(called.startswith(mutant.path) for called in one["calls"])
    ]
    near.sort(key=lambda name: calls[name]["seconds"])
    chosen, total = list[str](), 0.0
    while near and total + calls[near[0]]["seconds"] < BUDGET / 2:
        total += calls[near[0]]["seconds"]
        chosen.append(near.pop(0))
    # One test that judges by every claim first: most slips at import show there.
    options = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--no-header", "--tb=no"]
    command = [sys.executable, "-m", "pytest", *options, *dict.fromkeys(chosen)]
    file = tree / mutant.path
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    file.write_text(mutant.changed, encoding="utf-8")
    try:
        limit = int(4 * BUDGET)
        done = subprocess.run(
            command,
            cwd=tree,
            capture_output=True,
            encoding="utf-8",
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
        )
    finally:
        file.write_text(mutant.source, encoding="utf-8")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode < 0:
        return Outcome.LATE, "", len(chosen), seconds
    killed = done.returncode in (1, 2, 3, 4)
    said = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    by = said[1] if killed and said else "when it is imported" if killed else ""
    return (Outcome.KILLED if killed else Outcome.SURVIVED), by, len(chosen), seconds


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
    sample = json.loads((BUILD / "sample.json").read_text(encoding="utf-8"))
    found = [one for one in results(BUILD).values() if one["outcome"] != Outcome.IMPORTED]
    judged = [one for one in found if one["outcome"] != Outcome.LATE]
    tried, dead = len(judged), [one for one in judged if one["outcome"] in DEAD]
    alive = [one for one in judged if one["outcome"] == Outcome.SURVIVED]
    said: dict[str, str] = json.loads(EXPLAINED.read_text(encoding="utf-8"))
    low, high = interval(len(dead), tried)
    kinds = Counter(kind(one) for one in judged)
    dead_kinds = Counter(kind(one) for one in dead)
    seconds = sorted(one["seconds"] for one in found)
    text = [
        "# Mutants of oracles and claims",
        "",
        f"Cosmic Ray makes {sample['all']:,} mutants of `isograde.oracles` and `isograde.claims`, "
        f"{sample['fit']:,} of them of the kinds below. Of a sample (seed {SEED}) of "
        f"{len(sample['mutants'])} {len(found)} were tried, each on the tests that call what it "
        f"changes and take less than {SLOWEST:g} s, and on the faults, for up to {BUDGET:g} s of "
        f"the processor; {len(found) - tried} were not killed within that and had tests left, and "
        "are not counted. (A run of part of the sample is a sample: its order was drawn.) "
        f"The tree is that of commit {sample['commit']}.",
        "",
        f"**{len(dead)} of {tried} were killed by a test that fails, "
        f"{100 * len(dead) / tried:.1f} %** (95 % interval {100 * low:.1f} to {100 * high:.1f} %), "
        f"{sum(one['outcome'] == Outcome.ENDLESS for one in dead)} of them because a test took "
        f"twenty times as long as it does. {len(alive)} survived.",
        "",
        f"A mutant took {seconds[len(seconds) // 2]:.1f} s of the processor in the middle, "
        f"{sum(seconds) / len(seconds):.1f} s on the average.",
        "",
        "Written by `python -m tests.mutation.run --report`; what is said of survivors stands in "
        "`tests/mutation/explained.json`.",
        "",
        "| kind | tried | killed |",
        "| --- | ---: | ---: |",
        *(f"| {name} | {n} | {dead_kinds[name]} |" for name, n in sorted(kinds.items())),
        "",
        "## Survivors",
        "",
        "| where | mutant | what is said of it |",
        "| --- | --- | --- |",
    ]
    for name in sorted(map(key, alive)):
        where, change = name.split(" ", 1)
        told = said.get(name, "open")
        text.append(f"| {where} | `{change.replace('|', chr(92) + '|')}` | {told} |")
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text("\n".join(text) + "\n", encoding="utf-8")
    print(f"{tried} tried, {len(alive)} alive: {REPORT.relative_to(HERE)}")


def kind(one: dict[str, Any]) -> str:
    """The operator's name without its variants.

    >>> kind({"mutant": '["a.py", [1, 2], "core/ReplaceComparisonOperator_Lt_LtE", 3]'})
    'ReplaceComparisonOperator'
    """
    operator: str = json.loads(one["mutant"])[2]
    return operator.removeprefix("core/").split("_")[0]


def key(one: dict[str, Any]) -> str:
    """What names a mutant: its module and the lines it changes, which outlive a shift of lines."""
    gone = [line[1:].strip() for line in one["diff"] if line.startswith("-")]
    come = [line[1:].strip() for line in one["diff"] if line.startswith("+")]
    path = Path(json.loads(one["mutant"])[0])
    return f"{path.parent.name}/{path.name} {' '.join(gone)} -> {' '.join(come)}"


def main(arguments: list[str] | None = None) -> int:
    """The sample is drawn, gone on with, or reported."""
    parser = argparse.ArgumentParser(description="Mutants of oracles and claims.")
    parser.add_argument("--minutes", type=float, default=24 * 60.0, help="stop after so long")
    parser.add_argument("--size", type=int, default=SIZE, help="of the sample, when begun")
    parser.add_argument("--again", action="store_true", help="begin a new sample")
    parser.add_argument("--report", action="store_true", help="write the report and stop")
    parser.add_argument("--within", nargs=2, metavar=("BUILD", "KIND"), help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    if asked.within:
        within(Path(asked.within[0]), asked.within[1])
        return 0
    if not asked.report:
        if asked.again or not (BUILD / "sample.json").exists():
            prepare(asked.size)
        go_on(asked.minutes)
    report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
