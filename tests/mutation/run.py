"""Mutants of oracles and claims, and which of them the tests kill: ``make mutation``.

`Cosmic Ray <https://cosmic-ray.readthedocs.io>`_ makes the mutants: it is kept well, changes source
and not bytecode, and has an operator for each kind of slip. A sample of them is drawn with a seed
(`SEED`). How one is tried is said in `tests.mutation.trying`: in a fork of a process that has
collected the tests, on those that call the function that it changes, the quickest first. All of it
happens in a copy of the tree. What became of each mutant is a line of ``results.jsonl``, so that a
run goes on where it was stopped.

A survivor is either explained (`EXPLAINED`) or asks for a test. Once there are such tests, the open
survivors alone are tried again on the tree of today; the report tells both scores apart.

    python -m tests.mutation.run [--minutes M] [--size N]     makes the sample or goes on with it
    python -m tests.mutation.run --retry                      tries the open survivors on this tree
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
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.mutation.trying import (
    BUDGET,
    SLOWEST,
    Mutant,
    Outcome,
    files_for,
    function_at,
    quick,
    tests_collected,
)

HERE = Path(__file__).resolve().parents[2]
BUILD = HERE / "build" / "mutation"
REPORT = HERE / "reports" / "mutation" / "README.md"
EXPLAINED = HERE / "tests" / "mutation" / "explained.json"
MUTATED = ("validation/isograde/oracles", "validation/isograde/claims")
SEED, SIZE = 13, 400
#: Files of tests that a mutant in a process of its own is tried on first.
NEAREST = 4
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
    copy_to(tree)

    # Draw from the mutants sorted by place, so that a seed means the same anywhere.
    specs = sorted(every_mutant(tree))
    fit = [spec for spec in specs if OPERATORS.match(spec[2])]
    random.Random(SEED).shuffle(fit)
    sample = {"all": len(specs), "fit": len(fit), "commit": commit(), "mutants": fit[:size]}
    (BUILD / "sample.json").write_text(json.dumps(sample), encoding="utf-8")
    print(f"{len(specs)} mutants, {len(fit)} of the chosen kinds, {len(fit[:size])} in the sample")


def copy_to(tree: Path) -> None:
    """What the tests need of this tree is there, and nothing else."""
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    for part in ("reference", "validation", "tests", "benchmarks", "reports"):
        shutil.copytree(HERE / part, tree / part, ignore=shutil.ignore_patterns("__pycache__"))
    for file in ("pyproject.toml", "Makefile", "README.md", "CONTRIBUTING.md"):
        shutil.copy(HERE / file, tree)


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
    """The commit that is checked out, and whether files differ from it; or what there is."""
    command = ["git", "describe", "--always", "--abbrev=7", "--dirty", "--exclude", "*"]
    told = subprocess.run(command, cwd=HERE, capture_output=True, encoding="utf-8", check=False)
    return told.stdout.strip() or "unknown"


def results(build: Path) -> list[dict[str, Any]]:
    """What became of mutants, a line each time that one was tried."""
    place = build / "results.jsonl"
    lines = place.read_text(encoding="utf-8").splitlines() if place.exists() else []
    return [json.loads(line) for line in lines]


def latest(build: Path) -> dict[str, dict[str, Any]]:
    """The last that became of each mutant, by name."""
    return {line["mutant"]: line for line in results(build)}


def run_within(tree: Path, kind: str, minutes: float) -> None:
    """`within` is done in the tree. Raises `subprocess.TimeoutExpired`."""
    # The tree stays as it is; what makes the run is today's.
    ours = HERE / "tests" / "mutation"
    shutil.copytree(
        ours, tree / "tests" / "mutation", dirs_exist_ok=True,
        ignore=shutil.ignore_patterns("__pycache__"),
    )  # fmt: skip
    parts = [tree / "reference", tree / "validation", tree]
    path = os.pathsep.join([*map(str, parts), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path.strip(os.pathsep), "PYTHONHASHSEED": "0"}
    command = [sys.executable, "-m", "tests.mutation.run", "--within", str(BUILD), kind, commit()]
    subprocess.run(command, cwd=tree, env=environment, timeout=max(60 * minutes, 1), check=True)


def go_on(minutes: float) -> None:
    """Mutants are tried until the time is over or none is left."""
    for kind in ("forks", "processes"):
        started = time.monotonic()
        try:
            run_within(BUILD / "tree", kind, minutes)
        except subprocess.TimeoutExpired:
            print("the time is over; the same command goes on from here")
            return
        minutes -= (time.monotonic() - started) / 60


def retry(minutes: float) -> None:
    """The survivors of which nothing is said are tried again, on the tree of today."""
    copy_to(BUILD / "today")
    run_within(BUILD / "today", "again", minutes)


def within(build: Path, kind: str, commit: str) -> None:
    """In the tree: mutants are tried, each with a line of what became of it.

    kind : "forks" those that were not tried; "processes" those that these left to processes of
        their own; "again" the open survivors
    """
    tree, known = Path.cwd(), latest(build)

    def told(mutant: Mutant, outcome: Outcome, by: str, tests: int, seconds: float) -> None:
        diff = difflib.unified_diff(mutant.source.splitlines(), mutant.changed.splitlines(), n=0)
        line = {
            "mutant": mutant.name, "outcome": outcome, "by": by, "tests": tests,
            "seconds": round(seconds, 2), "function": mutant.function, "diff": list(diff)[2:],
        }  # fmt: skip
        if kind == "again":
            line["commit"] = commit
        with (build / "results.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    if kind == "again":
        left: list[Mutant] = []

        def told_or_left(mutant: Mutant, outcome: Outcome, *more: Any) -> None:
            if outcome is Outcome.IMPORTED:
                left.append(mutant)
            else:
                told(mutant, outcome, *more)

        in_forks(build, tree, mutants_again(tree, known), told_or_left)
        in_processes(build, tree, left, told)
        return
    sample = json.loads((build / "sample.json").read_text(encoding="utf-8"))
    specs = [(path, tuple(place), *rest) for path, place, *rest in sample["mutants"]]
    outcomes = {name: line["outcome"] for name, line in known.items()}
    due = "" if kind == "forks" else Outcome.IMPORTED
    mutants = [
        one
        for spec in specs
        if outcomes.get(json.dumps(spec), "") == due and (one := mutant_of(tree, spec)) is not None
    ]
    (in_forks if kind == "forks" else in_processes)(build, tree, mutants, told)


Told = Callable[..., None]


def in_forks(build: Path, tree: Path, mutants: list[Mutant], told: Told) -> None:
    """Each mutant is tried in forks of this process (`tests_collected`)."""
    places = sorted((tree / "tests" / "isograde").glob("test_*.py"))
    files = [str(one) for one in places if JUDGES.search(one.read_text(encoding="utf-8"))]
    files.append(str(tree / "tests" / "isograde" / "faults"))
    if mutants:
        tests_collected(tree, files, mutants, build / "calls.jsonl", told)


def in_processes(build: Path, tree: Path, mutants: list[Mutant], told: Told) -> None:
    """Each mutant is tried in a process of its own (`by_itself`)."""
    measured: dict[str, Any] = {}
    for text in (build / "calls.jsonl").read_text(encoding="utf-8").splitlines():
        measured.update(json.loads(text))
    for mutant in mutants:
        told(mutant, *by_itself(tree, mutant, measured))


def mutants_again(tree: Path, known: dict[str, dict[str, Any]]) -> list[Mutant]:
    """The survivors of which nothing is said, as mutants of this tree; what is gone is named."""
    said = json.loads(EXPLAINED.read_text(encoding="utf-8"))
    found = []
    for name, line in known.items():
        if line["outcome"] != Outcome.SURVIVED or key(line) in said:
            continue
        path = json.loads(name)[0]
        source = (tree / path).read_text(encoding="utf-8")
        again = changed_again(path, source, line["function"], line["diff"])
        if again is None:
            print(f"what it changes is not there any more, or not once: {key(line)}")
        else:
            found.append(Mutant(name, path, source, *again))
    return found


def changed_again(path: str, source: str, function: str, diff: list[str]) -> tuple[str, int] | None:
    r"""The source with the lines of a diff exchanged in a function, and the first one's number.

    None where the function does not have them, or has them twice.

    >>> source = "def f():\n    return 1\n\n\ndef g():\n    return 1\n"
    >>> changed_again("m.py", source, "m.py:g", ["@@ -2 +2 @@", "-    return 1", "+    return 2"])
    ('def f():\n    return 1\n\n\ndef g():\n    return 2\n', 6)
    """
    gone, come = ([line[1:] for line in diff if line.startswith(sign)] for sign in "-+")
    lines, size = source.splitlines(), len(gone)
    places = [
        at
        for at in range(len(lines) - size + 1)
        if lines[at : at + size] == gone and function_at(path, source, at + 1) == function
    ]
    if len(places) != 1:
        return None
    (at,) = places
    return "\n".join([*lines[:at], *come, *lines[at + size :]]) + "\n", at + 1


def by_itself(tree: Path, mutant: Mutant, calls: dict[str, Any]) -> tuple[Outcome, str, int, float]:
    """What becomes of a mutant in a process that imports all anew: tests of its module's users.

    The tests of the nearest files come first, and alone: they kill most, and to collect all files
    takes longer than to run them.
    """
    near = {
        name: one["seconds"]
        for name, one in calls.items()
        if quick(one) and any(called.startswith(f"{mutant.path}:") for called in one["calls"])
    }
    nearest = files_for(tree, mutant.path)[:NEAREST]
    own = {name for name in near if Path(name.split("::")[0]).name in nearest}
    tests, seconds = 0, 0.0
    for stage in (own, near.keys() - own):
        chosen, total = list[str](), 0.0
        for name in sorted(stage, key=lambda name: (near[name], name)):
            total += near[name]
            if total > BUDGET / 2:
                break
            chosen.append(name)
        if not chosen:
            continue
        outcome, by, took = in_a_process(tree, mutant, chosen)
        tests, seconds = tests + len(chosen), seconds + took
        if outcome is not Outcome.SURVIVED:
            return outcome, by, tests, seconds
    return Outcome.SURVIVED, "", tests, seconds


def in_a_process(tree: Path, mutant: Mutant, tests: list[str]) -> tuple[Outcome, str, float]:
    """What becomes of a mutant on these tests, the one that killed it, and the seconds."""
    options = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--no-header", "--tb=no"]
    command = [sys.executable, "-m", "pytest", *options, "-m", "not slow"]
    limit = int(2 * BUDGET)
    file = tree / mutant.path
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    file.write_text(mutant.changed, encoding="utf-8")
    try:
        # Where the mutant changes the names of tests, all tests of their files are run.
        for asked in (tests, list(dict.fromkeys(name.split("::")[0] for name in tests))):
            done = subprocess.run(
                [*command, *asked],
                cwd=tree,
                capture_output=True,
                encoding="utf-8",
                check=False,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
            )
            said = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
            if said or done.returncode != pytest.ExitCode.USAGE_ERROR:
                break
    finally:
        file.write_text(mutant.source, encoding="utf-8")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Outcome.LATE, "", seconds
    nothing = (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED, pytest.ExitCode.USAGE_ERROR)
    if not said and done.returncode in nothing:
        return Outcome.SURVIVED, "", seconds
    return Outcome.KILLED, said[1] if said else "when it is imported", seconds


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
    lines = [one for one in results(BUILD) if one["outcome"] != Outcome.IMPORTED]
    first = {one["mutant"]: one for one in reversed(lines)}
    last = {one["mutant"]: one for one in lines}
    judged = [one for one in first.values() if one["outcome"] != Outcome.LATE]
    dead = [one for one in judged if one["outcome"] in DEAD]
    alive = [last[one["mutant"]] for one in judged if last[one["mutant"]]["outcome"] not in DEAD]
    said: dict[str, str] = json.loads(EXPLAINED.read_text(encoding="utf-8"))
    explained = sum(key(one) in said for one in alive)
    low, high = interval(len(dead), len(judged))
    kinds, dead_kinds = (Counter(map(kind, ones)) for ones in (judged, dead))
    seconds = sorted(one["seconds"] for one in first.values())
    untried = len(sample["mutants"]) - len(first)
    late = len(first) - len(judged)
    text = [
        "# Mutants of oracles and claims",
        "",
        f"**Of {len(judged)} mutants {len(dead)} were killed by a test that fails, "
        f"{100 * len(dead) / len(judged):.1f} %** (95 % interval {100 * low:.1f} to "
        f"{100 * high:.1f} %), {sum(one['outcome'] == Outcome.ENDLESS for one in dead)} of them "
        "because a test took twenty times as long as it does. "
        f"{len(judged) - len(dead)} survived.",
        "",
        *after_mending(judged, last, alive, explained),
        "## How they were drawn and tried",
        "",
        f"Cosmic Ray makes {sample['all']:,} mutants of `isograde.oracles` and `isograde.claims`, "
        f"{sample['fit']:,} of them of the kinds below; {len(sample['mutants'])} were drawn (seed "
        f"{SEED}), and {len(first)} of these tried, on the tree of commit {sample['commit']}. "
        "One inside of a function was tried on the tests that call the function and take less than "
        f"{SLOWEST:g} s, and on the faults, for up to {BUDGET:g} s of the processor. One that runs "
        "while a module is imported was tried in a process of its own, on tests that call the "
        f"module, for up to {BUDGET / 2:g} s. {late} had tests left when the time was over, and "
        "are not counted."
        + (
            f" {untried} that run while a module is imported were not tried yet, so those are too "
            "few here."
            if untried
            else ""
        ),
        "",
        f"A mutant took {seconds[len(seconds) // 2]:.1f} s of the processor in the middle, "
        f"{sum(seconds) / len(seconds):.1f} s on the average.",
        "",
        "Written by `python -m tests.mutation.run --report`; what is said of survivors stands in "
        "`tests/mutation/explained.json`.",
        "",
        "| kind | tried | killed at first |",
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
    print(f"{len(judged)} tried, {len(alive)} alive: {REPORT.relative_to(HERE)}")


def after_mending(
    judged: list[dict[str, Any]],
    last: dict[str, dict[str, Any]],
    alive: list[dict[str, Any]],
    explained: int,
) -> list[str]:
    """The paragraph on survivors that were tried again; nothing where none was."""
    again = [one for one in last.values() if "commit" in one]
    if not again:
        return []
    commits = " or ".join(sorted({one["commit"] for one in again}))
    killed, now = sum(one["outcome"] in DEAD for one in again), len(judged) - len(alive)
    return [
        f"Tests were written for survivors, and {len(again)} of these tried again with them, on "
        f"the tree of commit {commits}: {killed} are killed now, so {now} of {len(judged)} in all. "
        "(That share is of mutants that tests were written for, and says nothing of others.) Of "
        f"the {len(alive)} that are left {explained} are explained below, and "
        f"{len(alive) - explained} are open.",
        "",
    ]


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
    parser.add_argument("--retry", action="store_true", help="try the open survivors on this tree")
    parser.add_argument("--within", nargs=3, help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    if asked.within:
        within(Path(asked.within[0]), *asked.within[1:])
        return 0
    if asked.retry:
        retry(asked.minutes)
    elif not asked.report:
        if asked.again or not (BUILD / "sample.json").exists():
            prepare(asked.size)
        go_on(asked.minutes)
    report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
