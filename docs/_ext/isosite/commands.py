"""Commands of the site: each is run while the site is built, and shown with what it printed.

::

    .. isograde:: explain topology.closed

shows the command behind a prompt and below it what it printed. An exit status other than the one
that stands in ``:status:`` (0) is a warning, and so stops the build. Commands run in `docs`, where
the site's own examples are.
"""

from __future__ import annotations

import atexit
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from isosite.evidence import ROOT

PROGRESS = re.compile(r"\S+: \d+ of \d+ cases(, \d+ bad)?")


@cache
def folder() -> str:
    """A folder that holds the site's example alone: what is printed names no place of ours."""
    made = tempfile.mkdtemp(prefix="site-")
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    shutil.copy2(ROOT / "docs" / "grade" / "mine.py", made)
    return made


@cache
def ran(arguments: str, width: int = 92) -> tuple[int, str]:
    """The status of ``isograde ARGUMENTS`` and what it printed, its progress left out."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(ROOT / "reference"), str(ROOT / "validation")]),
        "COLUMNS": str(width),
        # As on a machine that has never seen it.
        "XDG_CACHE_HOME": str(Path(folder(), "cache")),
        "NO_COLOR": "1",
        "TERM": "dumb",
        "PYTHONIOENCODING": "utf-8",
    }
    done = subprocess.run(
        [sys.executable, "-m", "isograde", *shlex.split(arguments)],
        cwd=folder(),
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=600,
        check=False,
    )
    rows = [row.rstrip() for row in done.stdout.strip("\n").splitlines()]
    return done.returncode, "\n".join(row for row in rows if not PROGRESS.fullmatch(row))


class Command(SphinxDirective):  # type: ignore[misc]
    """``.. isograde:: ARGUMENTS``: the command and what it printed."""

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, Any]] = {
        "status": directives.nonnegative_int,
        "lines": directives.positive_int,
    }

    def run(self) -> list[nodes.Node]:
        """The block."""
        arguments = self.arguments[0]
        status, printed = ran(arguments)
        wanted = self.options.get("status", 0)
        if status != wanted:
            message = self.state_machine.reporter.warning(
                f"isograde {arguments}: status {status}, not {wanted}:\n{printed}", line=self.lineno
            )
            return [message]
        rows = printed.splitlines()
        most = self.options.get("lines", len(rows))
        if len(rows) > most:
            rows = [*rows[:most], f".. and {len(rows) - most} more lines"]
        text = f"$ isograde {arguments}\n" + "\n".join(rows)
        block = nodes.literal_block(text, text, classes=["command"])
        block["language"] = "text"
        # What is shown hangs on the grader's code.
        self.env.note_dependency(str(Path(__file__)))
        return [block]


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the directive."""
    app.add_directive("isograde", Command)
