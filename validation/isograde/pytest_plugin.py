"""The options of pytest for `isograde.conformance`; all that is loaded where they are not used.

On the command line ``--isograde NAME``, ``--isograde-only "GLOB .."`` and
``--isograde-expect FILE``, in the ini file::

    [tool.pytest.ini_options]
    isograde = "python:mymodule:extract"
    isograde_only = "bodies/* pairs/*"
    isograde_expect = "known-failures.toml"
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest


@dataclass(frozen=True)
class Setting:
    """An option of the command line that may also stand in the ini file."""

    name: str
    metavar: str
    help: str

    @property
    def option(self) -> str:
        """Its name on the command line."""
        return f"--{self.name.replace('_', '-')}"

    def add(self, parser: pytest.Parser) -> None:
        """The parser knows it, in both places."""
        group = parser.getgroup("isograde", "grading an isosurface extractor")
        group.addoption(self.option, metavar=self.metavar, default=None, help=self.help)
        parser.addini(self.name, self.help, default="")

    def of(self, config: pytest.Config) -> str:
        """What was said: the command line first, then the ini file; nothing where neither does."""
        said = config.getoption(self.option)
        return str(said if said is not None else config.getini(self.name))


IMPLEMENTATION = Setting(
    "isograde", "NAME", "the implementation that pytest --pyargs isograde.conformance grades"
)
ONLY = Setting(
    "isograde_only", "GLOBS", "claims or cases, as isograde grade --only takes them, with spaces"
)
EXPECT = Setting(
    "isograde_expect", "FILE", "failures that are known, as isograde grade --write-expect lists"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """The three options are known."""
    IMPLEMENTATION.add(parser)
    ONLY.add(parser)
    EXPECT.add(parser)
