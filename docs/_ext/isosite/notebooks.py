"""Lessons as notebooks: the page's own tree of text, written as cells.

Prose becomes Markdown, examples with ``>>>`` become code without their prompts, commands become
cells that call a shell. The programs of the gallery are notebooks by sphinx-gallery's own hand.
In JupyterLite, where there is no shell, the first cell installs what a notebook needs.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

DOWNLOADS = "_downloads"
FOLDER = f"{DOWNLOADS}/notebooks"
LESSON = re.compile(r"course/lesson_\d+")
INSTALL = """\
import sys

if sys.platform == "emscripten":  # JupyterLite
    %pip install -q numpy scipy matplotlib
    %pip install -q --no-deps isograde
else:
    # Where this fails, install the package; the page "Start" of the site says how.
    import isoref"""


def cell(kind: str, text: str, number: int) -> dict[str, Any]:
    """A cell of the notebook format, version 4.5."""
    made: dict[str, Any] = {"cell_type": kind, "id": f"cell-{number}", "metadata": {}}
    made["source"] = text
    if kind == "code":
        made |= {"execution_count": None, "outputs": []}
    return made


def notebook(parts: list[tuple[str, str]]) -> str:
    """The notebook of these cells: neighbouring prose in one."""
    joined: list[tuple[str, str]] = []
    for kind, text in parts:
        if joined and kind == joined[-1][0] == "markdown":
            joined[-1] = (kind, f"{joined[-1][1]}\n\n{text}")
        elif text.strip():
            joined.append((kind, text))
    made = {
        "cells": [cell(kind, text, n) for n, (kind, text) in enumerate(joined)],
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def inline(node: nodes.Node) -> str:
    """Text with its marks as Markdown."""
    if isinstance(node, nodes.Text):
        return re.sub(r"([*_`$<])", r"\\\1", str(node))
    inner = "".join(inline(child) for child in node.children)
    if isinstance(node, nodes.literal):
        return f"`{node.astext()}`"
    if isinstance(node, nodes.math):
        return f"${node.astext()}$"
    if isinstance(node, nodes.emphasis):
        return f"*{inner}*"
    if isinstance(node, nodes.strong):
        return f"**{inner}**"
    if isinstance(node, nodes.reference) and "refuri" in node:
        return f"[{inner}]({node['refuri']})"
    return inner


def cells(node: nodes.Node, depth: int = 0) -> list[tuple[str, str]]:
    """The cells of a part of a page."""
    if isinstance(node, nodes.title):
        return [("markdown", f"{'#' * max(depth, 1)} {inline(node)}")]
    if isinstance(node, nodes.paragraph):
        return [("markdown", inline(node))]
    if isinstance(node, (nodes.doctest_block, nodes.literal_block)):
        return [block(node)]
    if isinstance(node, nodes.math_block):
        return [("markdown", f"$$\n{node.astext()}\n$$")]
    if isinstance(node, (nodes.bullet_list, nodes.enumerated_list)):
        marks = ("1." if isinstance(node, nodes.enumerated_list) else "*" for _ in node.children)
        rows = [f"{mark} {inline(item)}" for mark, item in zip(marks, node.children, strict=True)]
        return [("markdown", "\n".join(rows))]
    if isinstance(node, nodes.table):
        return [("markdown", table(node))]
    if isinstance(node, nodes.raw):
        return [("markdown", "*(The figure that moves is on the page of this lesson.)*")]
    if isinstance(node, (nodes.Text, nodes.comment, nodes.target)):
        return []
    below = depth + isinstance(node, nodes.section)
    return [part for child in node.children for part in cells(child, below)]


def block(node: nodes.Element) -> tuple[str, str]:
    """An example, a command, code, or what stands as it is."""
    text = node.astext()
    if text.startswith(">>>"):
        shown = [row for row in text.splitlines() if row.startswith((">>>", "..."))]
        return "code", "\n".join(row[4:] for row in shown)
    if node.get("language") == "python":
        return "code", text
    if node.get("language") in ("sh", "bash", "console"):
        return "code", "\n".join(f"!{row}" for row in text.splitlines())
    return "markdown", f"```\n{text}\n```"


def table(node: nodes.table) -> str:
    """A table in Markdown."""
    rows = [[inline(entry) for entry in row.children] for row in node.findall(nodes.row)]
    head, *rest = rows
    lines = [head, ["---"] * len(head), *rest]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def lesson(tree: nodes.document) -> str:
    """The notebook of a lesson's page."""
    parts = cells(tree)
    return notebook([*parts[:1], ("code", INSTALL), *parts[1:]])


def lessons(app: Sphinx) -> list[str]:
    """The pages of the lessons."""
    return sorted(name for name in app.env.found_docs if LESSON.fullmatch(name))


def write(app: Sphinx) -> None:
    """Lay the notebooks of the lessons into the site, and beside them those of the gallery."""
    folder = Path(app.outdir) / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name in lessons(app):
        made = lesson(app.env.get_doctree(name))
        (folder / f"{Path(name).name}.ipynb").write_text(made, encoding="utf-8")
    for path in sorted(Path(app.srcdir, "auto_examples").glob("plot_*.ipynb")):
        shutil.copyfile(path, folder / path.name)


def link(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Put the link to the notebook under the title of a lesson."""
    if doctree is not None and LESSON.fullmatch(page):
        address = f"../{FOLDER}/{Path(page).name}.ipynb"
        line = f'<p class="run-it"><a download href="{address}">This lesson as a notebook</a></p>'
        context["body"] = re.sub(r"(</h1>)", rf"\1\n{line}", context["body"], count=1)


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the links."""
    app.connect("html-page-context", link)
