"""Pages of modules: prose, then the code in its order, and beside each part what pins it."""

from __future__ import annotations

import re
from functools import cache
from textwrap import indent

from isosite.evidence import PACKAGES, ROOT, Test, all_tests, pinned, shown_tests
from isosite.modules import Module, Part, everywhere, home, label_in, label_of, modules
from isosite.prose import Scope, escaped, heading, line_of, papers_of, references_of, rst_of, slug
from isosite.writing import Pages

SHOWN = 4
# Where the picture of the first page stands.
LANDING = "hero"
# Packages, whose docstring is the introduction of their index.
LEFT_OUT = ("isoref", "isoref.fast", "isograde")


def code_of(code: str, language: str = "python") -> str:
    """A block of code."""
    return f".. code-block:: {language}\n\n" + indent(code, "   ") + "\n\n" if code.strip() else ""


def container(name: str, body: str) -> str:
    """A block with a class of its own."""
    return f".. container:: {name}\n\n" + indent(body.rstrip("\n"), "   ") + "\n\n"


def scope_of(module: Module) -> Scope:
    """How names and citations are found in the module's texts."""
    return Scope(lambda text: label_in(module, text), references_of(module.doc, module.name))


def evidence(tests: tuple[Test, ...]) -> str:
    """Links to the tests that pin a part."""

    def row(test: Test) -> str:
        words = test.name.removeprefix("test_").replace("_", " ")
        says = first_sentence(test.says)
        told = f" ({line_of(says, Scope())})" if says != words else ""
        return f"* :ref:`{words} <{test.label}>`{told}\n"

    body = "Pinned by\n\n" + "".join(row(t) for t in tests[:SHOWN]) + "\n"
    if len(tests) > SHOWN:
        body += folded(f"and {len(tests) - SHOWN} more", "".join(map(row, tests[SHOWN:])) + "\n")
    return container("evidence", body)


def folded(summary: str, body: str) -> str:
    """What is shown when it is asked for."""
    return (
        f".. raw:: html\n\n   <details><summary>{summary}</summary>\n\n"
        f"{body}.. raw:: html\n\n   </details>\n\n"
    )


def first_sentence(text: str) -> str:
    """The first sentence of a test's docstring, without marks."""
    end = (
        r"(?<=[a-z0-9)])(?<!\bFig)(?<!\bFigs)(?<!\beq)(?<!\beqs)(?<!\bEq)(?<!\bEqs)(?<!\bvs)[.:;] "
    )
    return re.sub(r"[`*]", "", re.split(end, text, maxsplit=1)[0]).rstrip(".")


def users(module: Module, name: str) -> list[str]:
    """The definitions of the module whose code names this one."""
    word = re.compile(rf"\b{re.escape(name)}\b")
    return [p.name for p in module.definitions().values() if p.name != name and word.search(p.code)]


def definition(module: Module, part: Part, pictures: str) -> str:
    """A function or class: what its docstring says, its code, and who pins it."""
    dotted = f"{module.name}.{part.name}"
    scope = scope_of(module)
    first = part.doc.partition("\n")[0]
    body = heading(f"``{part.name}``", "~", label_of(dotted))
    if first:
        body += line_of(first, scope) + "\n\n" + rst_of(part.doc, scope)
    body += pictures + code_of(part.code)
    tests = tuple(t for t in pinned().get(dotted, ()) if t in _shown())
    if tests:
        body += evidence(tests)
    elif module.name.startswith("isoref") and (used := users(module, part.name)):
        links = ", ".join(f":ref:`{u} <{label_of(f'{module.name}.{u}')}>`" for u in used)
        body += container("evidence", f"No test names it; it works in {links}.")
    return body


@cache
def _shown() -> frozenset[Test]:
    return frozenset(shown_tests())


def article(module: Module, pictures: dict[str, str]) -> str:
    """The page of a module."""
    scope = scope_of(module)
    text = heading(escaped(module.title), "=", label_of(module.name))
    text += container("module-line", " · ".join(module_line(module))) + "\n"
    text += rst_of(module.doc, scope, level="-", label=module.name)
    text = put_in(text, pictures.get(module.name, ""))
    text += claims_beside(module)
    kinds = [part.kind for part in module.parts]
    before = kinds[: kinds.index("banner")] if "banner" in kinds else kinds
    opening = "Imports" if set(before) == {"statements"} != set(kinds) else "The code"
    begun = False
    for part in module.parts:
        if part.kind == "banner":
            title = escaped(part.name[:1].upper() + part.name[1:])
            text += heading(title, "-", f"{module.name}.code-{slug(part.name)}")
            begun = True
            continue
        if not begun:
            text += heading(opening, "-", f"{module.name}.the-code")
            begun = True
        if part.kind == "statements":
            anchors = "".join(
                f".. _{label_of(f'{module.name}.{name}')}:\n\n" for name in part.names
            )
            imported = not part.names and part.code.startswith(("from ", "import "))
            text += anchors + (
                folded("what it imports", code_of(part.code)) if imported else code_of(part.code)
            )
            tests = {
                t: None
                for n in part.names
                for t in pinned().get(f"{module.name}.{n}", ())
                if t in _shown()
            }
            text += evidence(tuple(tests)) if tests else ""
        else:
            text += definition(module, part, pictures.get(f"{module.name}.{part.name}", ""))
    return text


def put_in(text: str, pictures: str) -> str:
    """The text with the module's pictures before the first heading of its docstring."""
    if not pictures:
        return text
    first = re.search(r"^(?:\.\. _[^\n]*:\n\n)?[^\n]+\n-{3,}$", text, re.MULTILINE)
    at = first.start() if first else len(text)
    return text[:at] + pictures + text[at:]


def module_line(module: Module) -> list[str]:
    """What stands under the title: the name, the twin, the tests, the source."""
    line = [f"``{module.name}``"]
    twin = twin_of(module)
    if twin:
        line.append(f":ref:`beside {twin.name} <twins.{plain_name(module)}>`")
    tests = {
        t.file: t for t in shown_tests() if any(n.startswith(f"{module.name}.") for n in t.pins)
    }
    mine = next(
        (t for f, t in tests.items() if f.endswith(f"test_{module.name.rpartition('.')[2]}.py")),
        None,
    )
    if mine:
        line.append(f":doc:`its tests </{mine.page}>`")
    source = module.path.relative_to(ROOT).as_posix()
    line.append(f":download:`source </../{source}>`")
    return line


def plain_name(module: Module) -> str:
    """The name that a module and its fast twin share."""
    return module.name.rpartition(".")[2]


def twin_of(module: Module) -> Module | None:
    """The fast twin of a plain module, or the plain one of a fast."""
    if not module.name.startswith("isoref."):
        return None
    name = plain_name(module)
    other = f"isoref.{name}" if ".fast." in module.name else f"isoref.fast.{name}"
    return everywhere().get(other) if other != module.name else None


def claims_of(module: Module) -> list[str]:
    """Claims whose source names a paper of the module's references."""
    from isograde.claims import CLAIMS

    references = re.search(r"^References\n-+\n(.*)", module.doc, re.DOTALL | re.MULTILINE)
    mine = {paper["title"] for paper in papers_of(references[1])} if references else set()
    return [c.id for c in CLAIMS.values() if mine & {p["title"] for p in papers_of(c.source)}]


def claims_beside(module: Module) -> str:
    """The claims that come from the module's papers."""
    found = claims_of(module) if module.name.startswith("isoref.") else []
    if not found:
        return ""
    links = ", ".join(f":ref:`{one} <claim.{one}>`" for one in found)
    return container("evidence", f"The grader's claims from these papers: {links}.")


def twins(plain: Module, fast: Module) -> str:
    """A page with what the two have in common, side by side."""
    name = plain_name(plain)
    text = heading(f"{name}: plain and fast", "=", f"twins.{name}")
    text += (
        f"On the left (above, on a narrow screen) :ref:`{plain.name} <{label_of(plain.name)}>`, "
        "the article, as one "
        f"would tell it; on the right :ref:`{fast.name} <{label_of(fast.name)}>`, the same in "
        "arrays. What has one "
        "name in both stands side by side.\n\n"
    )
    shared = [n for n in plain.definitions() if n in fast.definitions()]
    tests = tuple(
        t
        for t in shown_tests()
        if any(n.startswith(f"{plain.name}.") or n == plain.name for n in t.pins)
        and any(n.startswith(f"{fast.name}.") or n == fast.name for n in t.pins)
    )
    if tests:
        text += evidence(tests).replace("Pinned by", "Held to the same answers by")
    for one in shared:
        text += heading(f"``{one}``", "-")
        columns = "".join(
            container(
                "twin",
                f":ref:`{m.name} <{label_of(f'{m.name}.{one}')}>`\n\n"
                + code_of(m.definitions()[one].code),
            )
            for m in (plain, fast)
        )
        text += container("twins", columns)
    rest = [n for n in fast.definitions() if n not in shared]
    if rest:
        links = ", ".join(f":ref:`{n} <{label_of(f'{fast.name}.{n}')}>`" for n in rest)
        text += heading("In the fast one alone", "-") + links + "\n\n"
    return text


def reading_order() -> list[tuple[str, list[str]]]:
    """The chapters of the reference, as the docstring of the package has them."""
    doc = modules("isoref")["isoref"].doc
    chapters = []
    for text in re.split(r"^\d+\. ", doc, flags=re.MULTILINE)[1:]:
        title = text.partition(":")[0]
        names = re.findall(r"`([\w.]+)`", text)
        chapters.append(
            (title, [f"isoref.{name}" for name in names if f"isoref.{name}" in modules("isoref")])
        )
    return chapters


def chapters(package: str) -> list[tuple[str, list[str]]]:
    """The modules of a package by chapter, in the order in which to read them."""
    known = modules(package)
    if package == "isoref":
        fast = [name for name in known if name.startswith("isoref.fast.")]
        found = [*reading_order(), ("The fast twins", fast)]
        listed = {name for _, names in found for name in names}
        rest = [n for n in known if n not in listed and n not in LEFT_OUT]
        return [*found, ("What else there is", rest)] if rest else found
    folders: dict[str, list[str]] = {}
    for name, module in known.items():
        if name in LEFT_OUT:
            continue
        folder = module.path.parent.relative_to(PACKAGES[package]).as_posix()
        key = "From adapter to report" if folder == "." else folder.capitalize()
        folders.setdefault(key, []).append(name)
    return list(folders.items())


TITLES = {"isoref": "Articles: the reference", "isograde": "Articles: the grader"}


def contents(package: str) -> str:
    """The index of a package's articles."""
    known = modules(package)
    text = heading(TITLES[package], "=", f"articles.{package}")
    text += line_of(known[package].doc.partition("\n")[0], Scope()) + "\n\n"
    for chapter, names in chapters(package):
        rows = "".join(f"   {known[n].title} <{n}>\n" for n in names)
        text += heading(escaped(chapter), "-") + f".. toctree::\n   :maxdepth: 1\n\n{rows}\n"
        if chapter == "The fast twins":
            beside = [n.rpartition(".")[2] for n in names if twin_of(known[n])]
            links = ", ".join(f":ref:`{n} <twins.{n}>`" for n in beside)
            text += f"Plain and fast side by side: {links}.\n\n"
    return text


def sidebar(page: str) -> dict[str, object]:
    """What the side of an article shows: the chapters of its package."""
    package = "isograde" if page.startswith("articles/isograde") else "isoref"
    known = modules(package)
    rows = [
        (chapter, {n.removeprefix(f"{package}."): known[n].page for n in names})
        for chapter, names in chapters(package)
    ]
    return {
        "chapters": rows,
        "chapters_title": TITLES[package],
        "chapters_page": f"articles/{package}/index",
        "chapters_known": any(page in named.values() for _, named in rows),
    }


def test_pages() -> dict[str, str]:
    """A page for each file of tests that an article or a claim leads to."""
    from isograde.claims import CLAIMS

    pages: dict[str, str] = {}
    for test in shown_tests():
        if test.page not in pages:
            pages[test.page] = ":orphan:\n\n" + heading(f"``{test.file}``", "=")
        homes = {home(n) for n in test.pins if n.startswith("isoref.")} - {None}
        links = [f":ref:`{n} <{label_of(n)}>`" for n in sorted(n for n in homes if n)]
        links += [f":ref:`{c} <claim.{c}>`" for c in sorted(test.texts & CLAIMS.keys())]
        pages[test.page] += (
            heading(f"``{test.name}``", "-", test.label)
            + line_of(test.says, Scope())
            + "\n\n"
            + code_of(test.code)
            + (container("evidence", "Pins " + ", ".join(links)) if links else "")
        )
    return pages


def check_pictures(pictures: dict[str, str]) -> None:
    """Raise ValueError for a picture beside nothing, which no page would show."""
    places = {
        place
        for module in everywhere().values()
        for place in (module.name, *(f"{module.name}.{name}" for name in module.definitions()))
    }
    lost = pictures.keys() - places - {LANDING}
    if lost:
        raise ValueError(f"pictures beside what is no module, function or class: {sorted(lost)}")


def write(pages: Pages, pictures: dict[str, str]) -> None:
    """Write every article, the twins, the tests and the indices."""
    check_pictures(pictures)
    for package in PACKAGES:
        for name, module in modules(package).items():
            if name not in LEFT_OUT:
                pages.put(f"{module.page}.rst", article(module, pictures))
        pages.put(f"articles/{package}/index.rst", contents(package))
    for name, module in modules("isoref").items():
        twin = twin_of(module)
        if ".fast." in name and twin:
            pages.put(
                f"articles/isoref/twins/{plain_name(module)}.rst",
                ":orphan:\n\n" + twins(twin, module),
            )
    for page, text in test_pages().items():
        pages.put(f"{page}.rst", text)
    index = heading("Tests that an article leads to", "=", "tests")
    index += (
        f"{len(shown_tests())} of {len(all_tests())} tests name something of the reference "
        "or a claim. By file:\n\n"
    )
    index += "".join(
        f"* :doc:`{t.file} </{t.page}>`\n" for t in {t.page: t for t in shown_tests()}.values()
    )
    pages.put("tests/index.rst", index)
