"""Modules as their source has them: parts in the order of the file, a label for every name."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from isosite.evidence import PACKAGES, imports

Definition = ast.FunctionDef | ast.ClassDef


@dataclass(frozen=True)
class Part:
    """A stretch of a module: a definition, a banner (a heading), or statements between.

    name : of a definition; the heading's text of a banner
    names : what statements define
    doc : the docstring of a definition
    code : without that docstring
    """

    kind: str
    name: str
    names: tuple[str, ...]
    doc: str
    code: str


@dataclass(frozen=True)
class Module:
    """A module of one of the packages."""

    name: str
    path: Path
    doc: str
    parts: tuple[Part, ...]
    known: dict[str, str]

    @property
    def title(self) -> str:
        """The first line of the docstring, without its full stop and its marks."""
        first = self.doc.partition("\n")[0].rstrip(".").replace("`", "")
        return re.sub(r"\*(\w[\w ]*)\*", r"\1", first)

    @property
    def page(self) -> str:
        """The page of its article."""
        return f"articles/{self.name.partition('.')[0]}/{self.name}"

    @property
    def names(self) -> set[str]:
        """What it defines."""
        return {
            name
            for part in self.parts
            for name in (part.names or (part.name,))
            if part.kind != "banner"
        }

    def definitions(self) -> dict[str, Part]:
        """Its functions and classes."""
        return {part.name: part for part in self.parts if part.kind in ("function", "class")}


def label_of(dotted: str) -> str:
    """The label of a module, or of a name in it; names that differ in capitals alone stay apart."""
    last = dotted.rpartition(".")[2]
    bare = last.lstrip("_")
    kind = "table" if bare.isupper() else "class" if bare[:1].isupper() else "at"
    return f"{kind}.{dotted}"


def only_imports(statements: list[str]) -> bool:
    """They import, and do nothing else; comments aside."""
    told = [one for one in statements if not one.lstrip().startswith("#")]
    return bool(told) and all(one.startswith(("from ", "import ")) for one in told)


# A heading in the source: a title between two lines, or on one.
BANNER = re.compile(r"^# -{20,}\n((?:# .*\n)+?)# -{20,}$|^# --- (.+?) -{3,}$", re.MULTILINE)


def banners(text: str) -> list[tuple[str, str]]:
    """What stands before each heading, with its title, and what stands behind the last."""
    found: list[tuple[str, str]] = []
    at = 0
    for match in BANNER.finditer(text):
        title = match[2] or " ".join(row.lstrip("# ") for row in match[1].splitlines())
        found.append((text[at : match.start()], title))
        at = match.end()
    return [*found, (text[at:], "")]


def parts_of(source: str) -> tuple[Part, ...]:
    """The parts of a module, its docstring apart."""
    tree = ast.parse(source)
    lines = source.splitlines()
    parts: list[Part] = []
    waiting: list[str] = []
    names: list[str] = []
    seen: set[str] = set()
    at = tree.body[0].end_lineno or 0 if tree.body and ast.get_docstring(tree) else 0

    def statements() -> None:
        code = "\n".join(waiting).strip("\n")
        if code:
            parts.append(Part("statements", "", tuple(names), "", code))
        waiting.clear()
        names.clear()

    body = tree.body[1:] if ast.get_docstring(tree) else tree.body
    for node in body:
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
        between = "\n".join(lines[at : first - 1])
        for piece, title in banners(between):
            if piece.strip():
                waiting.append(piece.strip("\n"))
            if title:
                statements()
                parts.append(Part("banner", title, (), "", ""))
        end = node.end_lineno or first
        # The types of a call, before the function itself.
        overload = any(ast.unparse(d) == "overload" for d in getattr(node, "decorator_list", ()))
        if isinstance(node, Definition) and not overload:
            comment = waiting.pop() if waiting and waiting[-1].lstrip().startswith("#") else ""
            statements()
            doc = ast.get_docstring(node) or ""
            kept = lines[first - 1 : end]
            if doc:
                inner = node.body[0]
                kept = [*lines[first - 1 : inner.lineno - 1], *lines[inner.end_lineno or 0 : end]]
                if len(node.body) == 1:
                    kept.append("    ...")
            kind = "class" if isinstance(node, ast.ClassDef) else "function"
            code = "\n".join([comment, *kept]).strip("\n")
            parts.append(Part(kind, node.name, (), doc, re.sub(r"\n{2,}(?=    )", "\n\n", code)))
        else:
            if not isinstance(node, (ast.Import, ast.ImportFrom)):
                # Let imports be a part of their own.
                if only_imports(waiting):
                    comment = waiting.pop() if waiting[-1].lstrip().startswith("#") else ""
                    statements()
                    waiting.extend([comment] if comment else [])
                targets = (
                    node.targets
                    if isinstance(node, ast.Assign)
                    else [getattr(node, "target", None)]
                )
                new = [t.id for t in targets if isinstance(t, ast.Name) and t.id not in seen]
                names.extend(new)
                seen.update(new)
            waiting.append("\n".join(lines[first - 1 : end]))
        at = end
    statements()
    return tuple(parts)


@cache
def modules(package: str) -> dict[str, Module]:
    """The package's modules by their dotted names."""
    folder = PACKAGES[package]
    found = {}
    for path in sorted(folder.rglob("*.py")):
        if "given" in path.relative_to(folder).parts or path.stem == "__main__":
            continue
        inner = path.relative_to(folder).with_suffix("").parts
        dotted = ".".join((package, *(inner[:-1] if inner[-1] == "__init__" else inner)))
        source = path.read_text(encoding="utf-8")
        tree = ast.parse(source)
        doc = ast.get_docstring(tree)
        if doc is not None:
            found[dotted] = Module(dotted, path, doc, parts_of(source), imports(tree))
    return found


@cache
def everywhere() -> dict[str, Module]:
    """The modules of both packages."""
    return {**modules("isoref"), **modules("isograde")}


@cache
def home(dotted: str) -> str | None:
    """Where a dotted name is defined, following what modules import; None where it has no page."""
    for _ in range(5):
        if dotted in everywhere():
            return dotted
        module, _, name = dotted.rpartition(".")
        owner = everywhere().get(module)
        if owner is None:
            # A method: its class has the page's section.
            outer = module.rpartition(".")[0]
            if outer in everywhere() and module.rpartition(".")[2] in everywhere()[outer].names:
                return module
            return None
        if name in owner.names:
            return dotted
        if name not in owner.known or owner.known[name] == dotted:
            return None
        dotted = owner.known[name]
    return None


def label_in(module: Module, text: str) -> str | None:
    """The label of what is meant by a name in back quotes in this module; None where nothing is."""
    text = text.removesuffix("()")
    if not re.fullmatch(r"[A-Za-z_][\w.]*", text):
        return None
    tried = (
        text,
        f"{module.name}.{text}",
        f"{module.name.rpartition('.')[0]}.{text}",
        f"isoref.{text}",
    )
    for dotted in tried:
        found = home(dotted)
        if found and found != module.name:
            return label_of(found)
    return None
