"""Mutants tried in forks of one process, in which the tests are collected already.

To start Python, import what tests need and collect them takes longer than the test that kills most
mutants. So the tests are collected once, and for each mutant the process forks: the child takes the
mutant's code in place of the function that it changes, and runs the tests that call this function.
It stops at the first that fails.

Files of tests are tried one after the other, those of the module first, then those that import it,
then those of what uses it. Which tests of a file call which function, and how long each takes, is
measured when the file is first asked (``calls.jsonl``); those that killed before come first, then
the quickest. At last come the faults (`tests.isograde.faults`), in the order of their names.

A function is changed where it stands: every object of this function gets the mutant's code, and all
that is cached by functions of ours is forgotten. That does not do for what runs while a module is
imported (tables, claims, defaults). Such mutants are tried by a process of their own that imports
all anew (`Kind.IMPORTED`), and so is every mutant of a function that was called meanwhile.

Glossary
--------
mutant   a module with one change; ``Mutant.function`` is the top-level function or method it is in
late     the tests took longer than so many seconds of the processor in all: neither dead nor alive
endless  one test took twenty times as long as it does: a loop that does not end, and so dead
"""

from __future__ import annotations

import ast
import functools
import gc
import importlib
import json
import os
import re
import resource
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

PARTS = ("isograde/oracles", "isograde/claims")
TESTS, FAULTS = Path("tests/isograde"), "test_faults.py"
# A test that takes longer is not among those that are tried; nor are all together, beyond so much.
SLOWEST, BUDGET = 4.0, 60.0
# What a test may take, beside twenty times what it takes.
SLACK = 5.0


class Outcome(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    ENDLESS = "endless"
    SURVIVED = "survived"
    LATE = "late"
    IMPORTED = "imported"  # To be tried by a process of its own.


@dataclass(frozen=True)
class Mutant:
    """One change of one module.

    path : of the module, from the root of the tree
    source, changed : its text before and after
    line : of the change
    """

    name: str
    path: str
    source: str
    changed: str
    line: int

    @property
    def function(self) -> str:
        """``path:function`` or ``path:Class.method``; the path alone, where it is in neither."""
        return function_at(self.path, self.source, self.line)


def function_at(path: str, source: str, line: int) -> str:
    r"""The top-level function or method of this line.

    >>> function_at("m.py", "x = 1\nclass A:\n    def f(self):\n        return 2\n", 4)
    'm.py:A.f'
    """
    inside = [
        (prefix + node.name)
        for prefix, node in _functions(ast.parse(source))
        if node.body[0].lineno <= line <= (node.end_lineno or 0)
    ]
    return f"{path}:{inside[0]}" if inside else path


def _functions(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef]]:
    """The functions and methods, each with the name of its class and a dot."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield "", node
        if isinstance(node, ast.ClassDef):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef):
                    yield f"{node.name}.", inner


def owner(code: CodeType, root: Path) -> str:
    """``path:function`` of the top-level function a code belongs to; nothing for other modules."""
    if not any(part in code.co_filename for part in PARTS):
        return ""
    path = os.path.relpath(code.co_filename, root)
    return f"{path}:{code.co_qualname.split('.<locals>')[0]}"


class Calls:
    """Which functions are called while a block runs, and its seconds of the processor."""

    def __init__(self) -> None:
        self.codes: set[CodeType] = set()
        self.seconds = 0.0

    def __enter__(self) -> Calls:
        self.start = time.process_time()
        sys.setprofile(self._note)
        return self

    def _note(self, frame: FrameType, event: str, _: object) -> None:
        """Remember the code of a call."""
        if event == "call":
            self.codes.add(frame.f_code)

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)
        self.seconds = time.process_time() - self.start


class Trying:
    """The plug-in of pytest that tries mutants instead of running the tests once."""

    def __init__(
        self, root: Path, known: Path, mutants: Sequence[Mutant], told: Callable[..., None]
    ) -> None:
        self.root, self.known, self.mutants, self.told = root, known, mutants, told
        self.failed = ""
        self.at_import = Calls()
        self.killers: defaultdict[str, dict[str, None]] = defaultdict(dict)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A test failed."""
        if report.failed:
            self.failed = report.nodeid

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Every test is measured, then every mutant tried."""
        sys.setprofile(None)
        imported = {owner(code, self.root) for code in self.at_import.codes} - {""}
        items = {item.nodeid: item for item in session.items}
        self.known_calls = self._read()
        at = defaultdict(list)
        for one in gc.get_objects():
            if isinstance(one, FunctionType) and (name := owner(one.__code__, self.root)):
                at[name].append(one)
        gc.collect()
        gc.freeze()
        for mutant in self.mutants:
            self.told(mutant, *self.tried(mutant, items, imported, at))
        return True

    # --- which tests to run ----------------------------------------------------------------------

    def _read(self) -> dict[str, Any]:
        """What was measured before."""
        kept: dict[str, Any] = {}
        if self.known.exists():
            for line in self.known.read_text(encoding="utf-8").splitlines():
                kept.update(json.loads(line))
        return kept

    def measured(self, items: list[pytest.Item]) -> dict[str, Any]:
        """For each of these tests the functions it calls and its seconds, measured once for all.

        Tests of one file share what its fixtures make, so they are measured in one fork.
        """
        todo = [item for item in items if item.nodeid not in self.known_calls]
        if todo:
            with self.known.open("a", encoding="utf-8") as file:
                for name, found in self._measured(todo):
                    self.known_calls[name] = found
                    file.write(json.dumps({name: found}) + "\n")
        return {item.nodeid: self.known_calls[item.nodeid] for item in items}

    def _measured(self, items: list[pytest.Item]) -> Iterator[tuple[str, Any]]:
        """What tests call, said by a fork; one that takes too long ends it."""
        while items:
            read, write = os.pipe()
            child = os.fork()
            if not child:
                os.close(read)
                self._measure(items, write)
            os.close(write)
            with os.fdopen(read, encoding="utf-8") as pipe:
                lines = [json.loads(line) for line in pipe]
            os.waitpid(child, 0)
            yield from lines
            done = {name for name, _ in lines}
            left = [item for item in items if item.nodeid not in done]
            if left:
                yield left[0].nodeid, {"seconds": None, "calls": []}
            items = left[1:]

    def _measure(self, items: list[pytest.Item], write: int) -> None:
        """The child: a line a test; the alarm ends the process."""
        quiet()
        with os.fdopen(write, "w", encoding="utf-8") as pipe:
            for number, item in enumerate(items):
                self.failed = ""
                signal.setitimer(signal.ITIMER_PROF, 3 * SLOWEST)
                following = items[number + 1] if number + 1 < len(items) else None
                with Calls() as calls:
                    item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
                names = sorted({owner(code, self.root) for code in calls.codes} - {""})
                found = {"seconds": round(calls.seconds, 3), "calls": names}
                if self.failed:  # It fails without a mutant, so it would kill each.
                    found = {"seconds": None, "calls": []}
                pipe.write(json.dumps([item.nodeid, found]) + "\n")
                pipe.flush()
        os._exit(0)

    # --- one mutant ------------------------------------------------------------------------------

    def tried(
        self,
        mutant: Mutant,
        items: dict[str, pytest.Item],
        imported: set[str],
        at: dict[str, list[FunctionType]],
    ) -> tuple[Outcome, str, int, float]:
        """What became of it, the test that killed it, how many tests ran, and the seconds."""
        name = mutant.function
        codes = new_codes(mutant, self.root)
        if codes is None or name in imported:
            # A process of its own asks what the tests of the nearest file call.
            for place in files_for(self.root, mutant.path)[:1]:
                self.measured([i for one, i in items.items() if one.split("::")[0].endswith(place)])
            return Outcome.IMPORTED, "", 0, 0.0
        tests, seconds, left = 0, 0.0, BUDGET
        for place in (*files_for(self.root, mutant.path), FAULTS):
            there = [item for one, item in items.items() if one.split("::")[0].endswith(place)]
            if not there:
                continue
            if place == FAULTS:
                expected = [(item, 1.0) for item in there]
            else:
                calls = self.measured(there)
                expected = [
                    (items[one], said["seconds"])
                    for one, said in calls.items()
                    if name in said["calls"] and quick(said)
                ]
            before = list(self.killers[mutant.path])
            expected.sort(key=lambda pair: (pair[0].nodeid not in before, pair[1]))
            outcome, by, ran, took = self._forked(mutant, expected, at[name], codes, left)
            tests, seconds, left = tests + ran, seconds + took, left - took
            if outcome is not Outcome.SURVIVED:
                return outcome, by, tests, seconds
        return Outcome.SURVIVED, "", tests, seconds

    def _forked(
        self,
        mutant: Mutant,
        tests: list[tuple[pytest.Item, float]],
        functions: list[FunctionType],
        codes: dict[tuple[str, int], CodeType],
        budget: float,
    ) -> tuple[Outcome, str, int, float]:
        """What became of the mutant on these tests, in a fork."""
        if not tests:
            return Outcome.SURVIVED, "", 0, 0.0
        start = time.process_time()
        self._place.write_text("", encoding="utf-8")
        child = os.fork()
        if not child:
            take(functions, codes)
            self._run([item for item, _ in tests], [seconds for _, seconds in tests], budget)
        _, status, used = os.wait4(child, 0)
        seconds = used.ru_utime + used.ru_stime + time.process_time() - start
        done = self._done()
        if os.WIFSIGNALED(status):
            ended = os.WTERMSIG(status) == signal.SIGPROF
            return (Outcome.ENDLESS if ended else Outcome.KILLED), done[-1], len(done), seconds
        outcome = {0: Outcome.SURVIVED, 1: Outcome.KILLED, 2: Outcome.LATE}[os.WEXITSTATUS(status)]
        killer = done[-1] if outcome is Outcome.KILLED else ""
        if killer:
            self.killers[mutant.path][killer] = None
        return outcome, killer, len(done), seconds

    @property
    def _place(self) -> Path:
        """Where a child writes the tests that it began."""
        return self.known.parent / "begun.txt"

    def _done(self) -> list[str]:
        """The tests that the last child began."""
        return self._place.read_text(encoding="utf-8").splitlines() or [""]

    def _run(self, items: list[pytest.Item], seconds: list[float], budget: float) -> None:
        """The child: ends with 1 at the first test that fails, 2 where there is no time left."""
        quiet()
        begun, start = self._place.open("w", encoding="utf-8"), time.process_time()
        following = [*items[1:], None]
        for item, after, expected in zip(items, following, seconds, strict=True):
            if time.process_time() - start + expected > budget:
                os._exit(2)
            begun.write(item.nodeid + "\n")
            begun.flush()
            signal.setitimer(signal.ITIMER_PROF, 20 * expected + SLACK)
            self.failed = ""
            try:
                item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            except BaseException:  # noqa: BLE001 - whatever ends a run of the tests
                os._exit(1)
            if self.failed:
                os._exit(1)
        os._exit(0)


def quick(measured: dict[str, Any]) -> bool:
    """Whether a test passed in less than `SLOWEST` when it was measured.

    >>> [quick({"seconds": seconds}) for seconds in (None, 0.0, 0.2, 5.0)]
    [False, True, True, False]
    """
    seconds = measured["seconds"]
    return seconds is not None and seconds < SLOWEST


def files_for(root: Path, path: str) -> list[str]:
    """The files of tests for a module, the nearest first."""
    part, name = Path(path).parent.name, Path(path).stem
    grader, tests = root / "validation" / "isograde", sorted((root / TESTS).glob("test_*.py"))
    users = [f"{part}.{name}"]
    users += [
        f"{other}.{user.stem}"
        for other in ("claims", "oracles")
        for user in sorted((grader / other).glob("*.py"))
        if imports(user, users[0])
    ]
    own = [file for file in tests if name.rstrip("s") in file.stem]
    near = [file for user in users for file in tests if imports(file, user)]
    return [file.name for file in dict.fromkeys([*own, *near])]


def imports(path: Path, module: str) -> bool:
    """Whether a file imports the module ``oracles.name`` or ``claims.name``."""
    part, name = module.split(".")
    text = path.read_text(encoding="utf-8")
    long = re.search(rf"isograde\.{part}\.{name}\b", text)
    return bool(long or re.search(rf"from isograde\.{part} import [^\n]*\b{name}\b", text))


def quiet() -> None:
    """Nothing of this process is printed, and it does not outlive its alarm."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def new_codes(mutant: Mutant, root: Path) -> dict[tuple[str, int], CodeType] | None:
    """The codes of the mutant's function by name and line; None where more than it is changed."""
    place = str(root / mutant.path)
    old, new = (compile(text, place, "exec") for text in (mutant.source, mutant.changed))
    ours = mutant.function.removeprefix(mutant.path).removeprefix(":")
    before, after = (dict(_codes(code)) for code in (old, new))
    differing = [
        name
        for name in before.keys() | after.keys()
        if not _same(before.get(name), after.get(name))
    ]
    top = {name.split(".<locals>")[0] for name, _ in differing}
    if not ours or top != {ours}:
        return None
    return {key: code for key, code in after.items() if key[0].split(".<locals>")[0] == ours}


def _codes(code: CodeType) -> Iterator[tuple[tuple[str, int], CodeType]]:
    """A code and all that are in it, each with its qualified name and line."""
    yield (code.co_qualname, code.co_firstlineno), code
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _codes(inner)


def _same(one: CodeType | None, other: CodeType | None) -> bool:
    """Whether two codes do the same, those in them apart."""
    if one is None or other is None:
        return False
    plain = [
        [repr(x) for x in code.co_consts if not isinstance(x, CodeType)] for code in (one, other)
    ]
    return one.co_code == other.co_code and plain[0] == plain[1] and one.co_names == other.co_names


def take(functions: list[FunctionType], codes: dict[tuple[str, int], CodeType]) -> None:
    """The functions have these codes, and what ours cached is forgotten."""
    for function in functions:
        old = function.__code__
        new = codes.get((old.co_qualname, old.co_firstlineno))
        if new is not None and new.co_freevars == old.co_freevars:
            function.__code__ = new
    for one in gc.get_objects():
        if isinstance(one, functools._lru_cache_wrapper):
            module = str(getattr(one, "__module__", ""))
            if module.startswith(("isograde.oracles", "isograde.claims", "tests.")):
                one.cache_clear()


def tests_collected(
    root: Path,
    files: Sequence[str],
    mutants: Sequence[Mutant],
    known: Path,
    told: Callable[..., None],
) -> int:
    """The status of pytest, which collects these files and tries the mutants."""
    plugin = Trying(root, known, mutants, told)
    with plugin.at_import:
        for part in PARTS:
            for file in sorted((root / "validation" / part).glob("*.py")):
                importlib.import_module(
                    f"{part.replace('/', '.')}.{file.stem}".removesuffix(".__init__")
                )
        sys.setprofile(plugin.at_import._note)
        options = [
            "-q",
            "-m",
            "not slow",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
            "--no-header",
        ]
        return int(pytest.main([*options, "-p", "no:faulthandler", *files], plugins=[plugin]))
