"""What pip asks of a source distribution before it keeps it, answered from its own PKG-INFO.

A package's own backend configures a build, which takes minutes and the compilers of three
languages, to tell a name and a version. `tests.peers.fetching` lays this one under its name.
"""

import email
from pathlib import Path
from typing import Any


def prepare_metadata_for_build_wheel(folder: str, settings: Any = None) -> str:
    """The name of a new folder with the METADATA."""
    text = Path("PKG-INFO").read_text(encoding="utf-8")
    said = email.message_from_string(text)
    made = Path(folder, f"{said['Name'].replace('-', '_')}-{said['Version']}.dist-info")
    made.mkdir()
    (made / "METADATA").write_text(text, encoding="utf-8")
    return made.name
