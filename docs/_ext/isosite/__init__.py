"""What the site makes from the repository while it is built.

==============  ====================================================================================
module          what
==============  ====================================================================================
`formulas`      formulas of the source, read and turned into TeX
`mathml`        TeX turned into MathML, so that mathematics needs no network
`prose`         docstrings as pages: headings, definitions, references with DOIs, drawings
`modules`       the parts of a module in the order of its file, and a label for every name
`evidence`      which tests and claims pin what, from what they name
`articles`      pages of modules, plain and fast side by side, pages of tests
`reference`     the interfaces and the catalogue of claims
`repository`    the repository's Markdown as pages with links that work, reports served as they are
`pictures`      what `docs/_ext/pictures` draws, beside the paragraph it explains
`differences`   pages on which two algorithms are compared by counting
`notebooks`     lessons and programs as notebooks
`commands`      commands of the site, run while it is built
`tables`        cells with much text, for narrow pages
`wheel`         the package, to download and install
`works`         the works that are cited, each with its DOI; none without an address
`links`         whether every link inside the built site leads somewhere
`writing`       files made by a build, and removed when nothing makes them any more
==============  ====================================================================================
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

from isosite import (
    articles,
    commands,
    differences,
    mathml,
    notebooks,
    pictures,
    reference,
    repository,
    tables,
    wheel,
    works,
)
from isosite.writing import Pages

# Where a long name may be broken.
BREAK = re.compile(r"(?<=\w[._:/])(?=\w)|(?<=[a-z0-9])(?=[A-Z])")


def make_pages(app: Sphinx) -> None:
    """Write what is made, before Sphinx looks for its sources."""
    pages = Pages(Path(app.srcdir))
    repository.write(pages)
    articles.write(pages, pictures.draw_all(pages))
    reference.write(pages)
    differences.write(pages)
    works.write(pages)
    pages.close()


def beside(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Give articles the chapters of their package for the side; let long names break."""
    if page.startswith(("articles/", "tests/")):
        context.update(articles.sidebar(page))
    if "body" in context:
        named = r"<h([123])>.*?</h\1>" + (r"|<li>.*?</li>" if page == "tests/index" else "")
        context["body"] = re.sub(named, broken, context["body"], flags=re.DOTALL)


def broken(part: re.Match[str]) -> str:
    """The part with places to break a long name: behind dots and the like, before capitals."""
    pieces = re.split(r"(<[^>]+>)", part[0])
    return "".join(piece if n % 2 else BREAK.sub("<wbr>", piece) for n, piece in enumerate(pieces))


def resolve(app: Sphinx, env: BuildEnvironment) -> None:
    """Look up every reference of every page, where only some of them are to be written."""
    if app.config.isosite_resolve:
        # An index of some pages would be none.
        app.builder.search = False
        for page in sorted(env.found_docs):
            env.get_and_resolve_doctree(page, app.builder, tags=app.tags)


def finish(app: Sphinx, failure: Exception | None) -> None:
    """Lay the grader's own pages, the notebooks and the package beside the site's."""
    if failure is None and app.builder.format == "html":
        repository.serve(Path(app.outdir))
        notebooks.write(app)
        wheel.write(app)


def setup(app: Sphinx) -> dict[str, Any]:
    """Tell Sphinx what is made, and when."""
    mathml.setup(app)
    commands.setup(app)
    notebooks.setup(app)
    works.setup(app)
    app.connect("builder-inited", make_pages, priority=100)
    app.connect("doctree-read", tables.mark)
    app.connect("html-page-context", beside)
    app.connect("build-finished", finish)
    app.add_config_value("isosite_resolve", default=False, rebuild="")
    app.connect("env-check-consistency", resolve)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
