"""The catalogue of claims, and the interfaces of both packages, from the code that defines them."""

from __future__ import annotations

import ast

from isosite.articles import claims_of, code_of, container, evidence, scope_of
from isosite.evidence import all_tests
from isosite.modules import Module, everywhere, home, label_of, modules
from isosite.prose import Scope, escaped, heading, line_of, link_of, papers_of, rst_of
from isosite.writing import Pages


def claims() -> str:
    """The page of all claims."""
    from isograde.catalogue import read
    from isograde.claims import CLAIMS, FAMILIES

    levels = {number: name for number, name, _ in read()["levels"]}
    text = heading("The claims", "=", "claims")
    text += (
        f"{len(CLAIMS)} sentences that are true or false of an implementation. ``isograde "
        "explain ID`` prints one; "
        "a report links here in words. What is held against an implementation follows from its "
        "level and from what "
        "it promises (``isograde explain declaration``).\n\n"
    )
    rows = "".join(
        f"   * - {number}\n     - {name}\n     - {line_of(what, Scope())}\n     - "
        + ", ".join(f":ref:`{c.id} <claim.{c.id}>`" for c in CLAIMS.values() if c.level == number)
        + "\n"
        for number, name, what in read()["levels"]
    )
    text += ".. list-table::\n   :header-rows: 1\n   :widths: 6 10 34 50\n\n"
    text += "   * - level\n     - name\n     - guarantee\n     - claims\n" + rows + "\n"
    beside = ", ".join(f":ref:`{c.id} <claim.{c.id}>`" for c in CLAIMS.values() if c.level is None)
    text += f"Beside the ladder: {beside}.\n\n"
    articles: dict[str, list[str]] = {}
    for name, module in modules("isoref").items():
        for one in claims_of(module):
            articles.setdefault(one, []).append(name)
    for family in FAMILIES:
        name = family.__name__
        module = everywhere()[name]
        text += heading(escaped(module.title), "-")
        text += f"How it is judged: :ref:`{name} <{label_of(name)}>`.\n\n"
        for claim in family.CLAIMS:
            rung = (
                "beside the ladder"
                if claim.level is None
                else f"level {claim.level}, {levels[claim.level]}"
            )
            held = (
                "cannot be taken out of the promise"
                if claim.firm
                else ("promised" if claim.promised else "of choice")
            )
            text += heading(f"``{claim.id}``", "~", f"claim.{claim.id}")
            text += line_of(claim.rule, Scope()) + "\n\n"
            links = " ".join(link_of(p) for p in papers_of(claim.source))
            body = f"{rung}; {held}. Source: {line_of(claim.source, Scope())} {links}\n\n"
            if claim.id in articles:
                refs = ", ".join(f":ref:`{a} <{label_of(a)}>`" for a in articles[claim.id])
                body += f"Articles on the same papers: {refs}.\n\n"
            text += container("module-line", body)
            tests = tuple(t for t in all_tests() if claim.id in t.texts)
            text += evidence(tests) if tests else ""
    return text


def signature(node: ast.FunctionDef, name: str = "") -> str:
    """The function's first line, as one would call it."""
    args = ast.unparse(node.args)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    one = f"{name or node.name}({args}){returns}"
    if len(one) <= 92:
        return one
    inner = ",\n    ".join(a for a in _split(args))
    return f"{name or node.name}(\n    {inner},\n){returns}"


def _split(args: str) -> list[str]:
    """Arguments at the commas outside brackets."""
    parts, depth, last = [], 0, 0
    for at, letter in enumerate(args):
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            parts.append(args[last:at].strip())
            last = at + 1
    return [*parts, args[last:].strip()]


def entry(dotted: str, shown: str) -> str:
    """A public function or class: its call, what it says, its public methods."""
    module = everywhere()[dotted.rpartition(".")[0]]
    name = dotted.rpartition(".")[2]
    tree = ast.parse(module.path.read_text(encoding="utf-8"))
    node = next((n for n in tree.body if getattr(n, "name", None) == name), None)
    scope = scope_of(module)
    text = heading(f"``{shown}``", "-", f"api.{label_of(shown)}")
    if isinstance(node, ast.FunctionDef):
        text += code_of(signature(node)) + said(ast.get_docstring(node) or "", scope)
    elif isinstance(node, ast.ClassDef):
        text += said(ast.get_docstring(node) or "", scope)
        fields = [ast.unparse(n) for n in node.body if isinstance(n, ast.AnnAssign)]
        text += code_of("\n".join(fields)) if fields else ""
        for method in node.body:
            if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
                called = code_of(signature(method, f"{name}.{method.name}"))
                text += container("method", called + said(ast.get_docstring(method) or "", scope))
    else:
        part = next((p for p in module.parts if name in p.names), None)
        if part:
            text += code_of("\n".join(part.code.splitlines()[:12]))
    return (
        text + f"Its article: :ref:`{module.name} <{label_of(home(dotted) or module.name)}>`.\n\n"
    )


def said(doc: str, scope: Scope) -> str:
    """A docstring, its first line too."""
    return line_of(doc.partition("\n")[0], scope) + "\n\n" + rst_of(doc, scope) if doc else ""


def table(package: str) -> str:
    """Every public function and class by module, with the first line of what it says."""
    text = heading("Everything else, by module", "-")
    for name, module in modules(package).items():
        public = {n: p for n, p in module.definitions().items() if not n.startswith("_")}
        if not public or name == package:
            continue
        text += f":ref:`{name} <{label_of(name)}>` {escaped(module.title)}\n\n"
        rows = "".join(
            f"* :ref:`{n} <{label_of(f'{name}.{n}')}>` "
            f"{line_of(p.doc.partition(chr(10))[0], scope_of(module))}\n"
            for n, p in public.items()
        )
        text += container("api-rows", rows)
    return text


def interface(package: str, names: list[str]) -> str:
    """The page of a package's interface."""
    module: Module = modules(package)[package]
    text = heading(f"The interface of {package}", "=", label_of(package))
    text += said(
        module.doc.partition("\n\n")[0] if package == "isoref" else module.doc, scope_of(module)
    )
    for name in names:
        found = home(f"{package}.{name}")
        if found:
            text += entry(found, f"{package}.{name}")
    return text + table(package)


def write(pages: Pages) -> None:
    """Write the pages of the reference that are no articles."""
    import isograde
    import isoref

    pages.put("api/claims.rst", claims())
    pages.put("api/isoref.rst", interface("isoref", list(isoref.__all__)))
    names = [n for n in isograde.__all__ if n != "__version__"]
    pages.put("api/isograde.rst", interface("isograde", names))
