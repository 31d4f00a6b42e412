"""What `isograde list` shows, read from a file: to build it takes ten times as long as NumPy.

`catalogue.json` beside this module is made from the registries of claims, cases, implementations
and levels by `isograde.cataloguing` (``make catalogue``), and a test holds it to them. What depends
on the machine, whether a volume is here and a package installed, is looked up when it is shown.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("catalogue.json")

Catalogue = dict[str, list[Any]]


@cache
def read() -> Catalogue:
    """The catalogue as it stands in the file."""
    found: Catalogue = json.loads(FILE.read_text(encoding="utf-8"))
    return found
