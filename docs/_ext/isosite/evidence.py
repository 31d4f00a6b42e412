"""What pins a function of the reference: tests that name it, and claims whose source is its paper.

Nothing of it is written down. A test pins a function when it imports it, or reaches it through its
module, and names it; where only another function of the test's file calls it, the link goes to the
tests that call that one. A claim belongs to a module when the claim's source names a paper of the
module's references, and to the test that has its id as a text.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[3]
PACKAGES = {"isoref": ROOT / "reference" / "isoref", "isograde": ROOT / "validation" / "isograde"}


@dataclass(frozen=True)
class Test:
    """A test as the site shows it.

    file : path from the repository's root
    says : the first line of its docstring, or its name as words
    pins : dotted names of functions, classes and tables that it names
    texts : the texts in it (ids of claims are among them)
    """

    file: str
    name: str
    says: str
    code: str
    pins: frozenset[str]
    texts: frozenset[str]

    @property
    def page(self) -> str:
        """The page of the test's file, from the root of the site."""
        return "tests/" + self.file.removeprefix("tests/").removesuffix(".py")

    @property
    def label(self) -> str:
        """The label of the test."""
        return f"test.{self.page.removeprefix('tests/').replace('/', '.')}.{self.name}"


def imports(tree: ast.Module) -> dict[str, str]:
    """Names in a file to what they stand for, in our packages."""
    found = {}
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.ImportFrom)
            and node.module
            and node.module.split(".")[0] in PACKAGES
        ):
            for one in node.names:
                found[one.asname or one.name] = f"{node.module}.{one.name}"
        elif isinstance(node, ast.Import):
            for one in node.names:
                if one.name.split(".")[0] in PACKAGES:
                    found[one.asname or one.name] = one.name
    return found


def named(node: ast.AST, known: dict[str, str]) -> set[str]:
    """Dotted names of our packages that stand in the node."""
    found = set()
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and part.id in known:
            found.add(known[part.id])
        elif isinstance(part, ast.Attribute):
            names, inner = [part.attr], part.value
            while isinstance(inner, ast.Attribute):
                names.append(inner.attr)
                inner = inner.value
            if isinstance(inner, ast.Name) and inner.id in known:
                found.add(".".join((known[inner.id], *reversed(names))))
    return found


def tests_of(path: Path) -> list[Test]:
    """The tests of a file, with what each names, itself or through the file's own functions."""
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source)
    known = imports(tree)
    functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    direct = {name: named(node, known) for name, node in functions.items()}
    calls = {
        name: {p.id for p in ast.walk(node) if isinstance(p, ast.Name)}
        | {a.arg for a in node.args.args}  # fixtures come as arguments
        for name, node in functions.items()
    }
    found = []
    for name, node in functions.items():
        if not name.startswith("test_"):
            continue
        reached = {name}
        while more := {c for r in reached for c in calls[r] if c in functions} - reached:
            reached |= more
        doc = ast.get_docstring(node) or ""
        texts = {
            p.value
            for p in ast.walk(node)
            if isinstance(p, ast.Constant) and isinstance(p.value, str)
        }
        start = min([node.lineno, *(d.lineno for d in node.decorator_list)]) - 1
        found.append(
            Test(
                file=path.relative_to(ROOT).as_posix(),
                name=name,
                says=doc.partition("\n\n")[0].replace("\n", " ").strip()
                or name[5:].replace("_", " "),
                code="\n".join(source.splitlines()[start : node.end_lineno]),
                pins=frozenset(set().union(*(direct[r] for r in reached))),
                texts=frozenset(texts),
            )
        )
    return found


@cache
def all_tests() -> tuple[Test, ...]:
    """Every test of the repository, in the order of files and lines."""
    files = sorted((ROOT / "tests").rglob("test_*.py"))
    return tuple(test for path in files for test in tests_of(path))


@cache
def pinned() -> dict[str, tuple[Test, ...]]:
    """Dotted names to the tests that name them: those named closest to the module first."""
    found: dict[str, list[Test]] = {}
    for test in all_tests():
        for name in test.pins:
            found.setdefault(name, []).append(test)

    def far(name: str, test: Test) -> tuple[bool, str]:
        module = name.rpartition(".")[0].rpartition(".")[2]
        return (f"test_{module}" not in test.file, test.file)

    return {name: tuple(sorted(tests, key=lambda t: far(name, t))) for name, tests in found.items()}


@cache
def shown_tests() -> tuple[Test, ...]:
    """The tests that a page links to: they pin the reference, or name a claim."""
    from isograde.claims import CLAIMS

    return tuple(
        test
        for test in all_tests()
        if test.texts & CLAIMS.keys() or any(name.startswith("isoref.") for name in test.pins)
    )
