r"""Mathematics without a network, a script or a font: TeX becomes MathML in the build.

Every browser draws MathML today, screen readers read it, and it can be copied. KaTeX and MathJax
would do it more finely, for some megabytes of script and fonts on each page that opens from disk.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging

logger = logging.getLogger(__name__)

WORD = re.compile(r'<mrow>(?:<mi mathvariant="italic">[A-Za-z]</mi>){2,}</mrow>')


def mathml(tex: str, *, display: bool) -> str:
    """The formula as MathML; a ValueError says which formula cannot be read."""
    if display and r"\\" in tex and r"\begin" not in tex:
        # Lines below each other, on the left edge.
        tex = r"\begin{array}{l}" + tex + r"\end{array}"
    try:
        made = convert(tex, display="block" if display else "inline")
    except Exception as error:
        raise ValueError(f"the formula {tex!r} cannot be read: {error!r}") from error
    if "merror" in made or "\\" in made:
        raise ValueError(f"the formula {tex!r} has something that is not known: {made}")
    return WORD.sub(_word, str(made))


def _word(match: re.Match[str]) -> str:
    """A word as one name: letter by letter it would be read as a product."""
    return f'<mi class="word">{re.sub("<[^>]+>", "", match[0])}</mi>'


def _write(visitor: Any, node: nodes.math | nodes.math_block, *, display: bool) -> None:
    try:
        made = mathml(node.astext(), display=display)
    except ValueError as error:
        logger.warning("%s", error, location=node)
        made = f"<code>{visitor.encode(node.astext())}</code>"
    if display:
        identifiers = "".join(f'<span id="{name}"></span>' for name in node.get("ids", ()))
        made = f'{identifiers}<div class="math notranslate" tabindex="0">{made}</div>\n'
    visitor.body.append(made)
    raise nodes.SkipNode


def _inline(visitor: Any, node: nodes.math) -> None:
    _write(visitor, node, display=False)


def _block(visitor: Any, node: nodes.math_block) -> None:
    _write(visitor, node, display=True)


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the writer."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )
