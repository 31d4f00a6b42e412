"""Every link inside the built site leads to a file, and to a place in it.

``python docs/_ext/isosite/links.py docs/_build`` reads each page and ends with status 1 when a
link, a picture or a script leads nowhere. With ``--elsewhere`` it reads what Sphinx's own checker
of the links to other places has written and says which could be reached; without a network that is
none, and it says so.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Collection
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from isograde.report.packed import unpacked


class Page(HTMLParser):
    """The anchors of a page, and what it links to."""

    def __init__(self, path: Path) -> None:
        super().__init__(convert_charrefs=True)
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.feed(unpacked(path.read_text(encoding="utf-8")))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what an element names and links to."""
        for key, value in attrs:
            if value is None:
                continue
            if key == "id" or (tag == "a" and key == "name"):
                self.anchors.add(value)
            elif key in ("href", "src") and tag not in ("base",):
                self.links.append(value)

    handle_startendtag = handle_starttag


@cache
def page(path: Path) -> Page:
    """The page in this file."""
    return Page(path)


def broken(site: Path, unwritten: Collection[str] = ()) -> list[str]:
    """What leads nowhere, as "page: link" with the reason; pages not written count as there."""
    site = site.resolve()
    found = []
    pages = [p for p in sorted(site.rglob("*.html")) if "_static" not in p.relative_to(site).parts]
    for path in pages:
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or link.startswith(("{", "#top")) or not link:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            name = path.relative_to(site).as_posix()
            if not target.is_relative_to(site):
                found.append(f"{name}: {link} leads out of the site")
            elif target.relative_to(site).as_posix() in unwritten:
                continue
            elif not target.is_file():
                found.append(f"{name}: {link} is not there")
            elif (
                parts.fragment and target.suffix == ".html" and not anchored(target, parts.fragment)
            ):
                found.append(f"{name}: {link} has no such place")
    return found


def anchored(path: Path, fragment: str) -> bool:
    """The page has the place; the explorer's fragments are its state, not places."""
    return unquote(fragment) in page(path).anchors or path.name == "explorer.html"


def elsewhere(folder: Path) -> str:
    """What Sphinx's checker found of the links that leave the site."""
    rows = [
        json.loads(row)
        for row in (folder / "output.json").read_text(encoding="utf-8").splitlines()
        if row
    ]
    outside = [row for row in rows if row["uri"].startswith("http") and row["status"] != "ignored"]
    counts = Counter(
        "reached" if row["status"] in ("working", "redirected") else "not reached"
        for row in outside
    )
    told = [f"{counts['reached']} of {len(outside)} links to other places were reached."]
    told += [f"  {row['filename']}:{row['lineno']}: {row['uri']} ({row['info'][:80]})" for row in
    outside
             if row["status"] not in ("working", "redirected")]  # fmt: skip
    if outside and not counts["reached"]:
        told.append("None was: there is no network here, and nothing is known of these links.")
    return "\n".join(told)


def main(arguments: list[str]) -> int:
    """Say what leads nowhere; the exit status."""
    if len(arguments) == 2 and arguments[0] == "--elsewhere":
        if not Path(arguments[1], "output.json").is_file():
            print("no link was looked at: Sphinx ended before; run make site", file=sys.stderr)
            return 1
        print(elsewhere(Path(arguments[1])))
        return 0
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print("usage: links.py [--elsewhere] FOLDER", file=sys.stderr)
        return 2
    found = broken(Path(arguments[0]))
    print("\n".join(found) if found else "every link inside the site leads somewhere")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
