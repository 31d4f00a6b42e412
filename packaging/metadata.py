"""What the packages say of where the project lives, from the one setting in pyproject.toml.

``[tool.isograde] home`` is the address of the repository, a placeholder until there is one. From it
come the project's links and, in the README as package indices show it, absolute links instead of
those to files of the repository, which lead nowhere there.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
RAW = (".png", ".svg", ".gif", ".jpg")


def links(home: str) -> dict[str, str]:
    """The project's links."""
    return {
        "Homepage": home,
        "Source": home,
        "Issues": f"{home}/issues",
        "Changelog": f"{home}/blob/main/CHANGELOG.md",
        "Documentation": f"{home}#readme",
    }


def absolute(text: str, home: str) -> str:
    """The Markdown with links to files of the repository made absolute.

    >>> absolute("![a](b.png) [c](d/e.md) [f](https://g) [h](#i)", "https://j")
    '![a](https://j/raw/main/b.png) [c](https://j/blob/main/d/e.md) [f](https://g) [h](#i)'
    """

    def made(match: re.Match[str]) -> str:
        mark, said, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        kind = "raw" if mark or target.endswith(RAW) else "blob"
        return f"{mark}[{said}]({home}/{kind}/main/{target})"

    # A badge is a link round a picture: the inner one first, then the outer.
    inner = LINK.sub(made, text)
    return re.sub(
        r"(\[!\[[^\]]*\]\([^)]*\)\])\((?![a-z]+:|#)([^)\s]+)\)", rf"\1({home}/blob/main/\2)", inner
    )


class Metadata(MetadataHookInterface):
    """The hook that hatchling calls for what pyproject.toml calls dynamic."""

    def update(self, metadata: dict[str, Any]) -> None:
        """`metadata` has the links and the README."""
        home = str(self.config["home"]).rstrip("/")
        text = Path(self.root, "README.md").read_text(encoding="utf-8")
        metadata["urls"] = links(home)
        metadata["readme"] = {"content-type": "text/markdown", "text": absolute(text, home)}
