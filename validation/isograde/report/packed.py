"""A page packed: a small HTML file that carries a large one, and unpacks it where it is opened.

Pages of reports are large (200 to 900 kB) and repeat themselves; packed they are a sixth of that,
so that a repository can keep many. The file carries the title and the description in clear, for
readers of its source, search engines and browsers without script; the page itself as base64 of
gzip; and a script that puts the page in its own place. A link to a part of the page works as
before. It opens from disk: nothing is fetched.

Whoever reads pages as text, a test or a checker of links, reads them through `unpacked`, which
gives any other page back as it is.

>>> page = "<!doctype html><html><head><title>A</title></head><body>" + "b" * 10_000
>>> shell = packed(page, "isograde render a.jsonl.gz")
>>> len(shell) < 3000 and unpacked(shell) == page
True
>>> unpacked("<p>plain</p>")
'<p>plain</p>'
"""

from __future__ import annotations

import gzip
import re
import zlib
from base64 import b64decode, b64encode

from isograde.report.page import environment

# What a packed page begins with, and no other page: the template's first lines.
MARK = "<!doctype html>\n<!-- a page of isograde, packed -->\n"
# Written at so many characters a line; what decodes base64 leaves line ends out.
WIDTH = 120

_TITLE = re.compile(r"<title>(.*?)</title>", re.DOTALL)
_DESCRIPTION = re.compile(r'<meta name="description" content="([^"]*)">')
_CARRIED = re.compile(r'<script type="application/gzip" id="packed">([^<]*)</script>')


def packed(page: str, again: str) -> str:
    """The page packed: the same bytes for the same page.

    again : the command that writes the page plain, for those whose browser cannot unpack it

    Raises ValueError for a page without a title, which the packed one would not have either.
    """
    title = _TITLE.search(page)
    if title is None:
        raise ValueError("a page without a <title> cannot be packed: give it one")
    description = _DESCRIPTION.search(page)
    data = b64encode(gzip.compress(page.encode(), 9, mtime=0)).decode("ascii")
    template = environment().get_template("packed.html")
    # Title and description are text of a page already: they are not escaped again.
    return template.render(
        title=title[1],
        description=description[1] if description else "",
        again=again,
        carried="\n".join(data[at : at + WIDTH] for at in range(0, len(data), WIDTH)),
    )


def unpacked(text: str) -> str:
    """The page that a packed one carries; any other page as it is.

    Raises ValueError for a packed page that is damaged.
    """
    if not text.startswith(MARK):
        return text
    try:
        (carried,) = _CARRIED.findall(text)
        return gzip.decompress(b64decode(carried)).decode()
    except (ValueError, EOFError, OSError, zlib.error) as error:
        raise ValueError(f"a packed page that is damaged: {error}; write it again") from error
