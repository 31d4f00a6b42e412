"""The package itself, laid into the site: who reads it can install it from there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from sphinx.application import Sphinx

from isosite.evidence import ROOT
from isosite.notebooks import DOWNLOADS


def write(app: Sphinx) -> None:
    """Build the wheel with what is installed, for there is no network; raise what it said."""
    folder = Path(app.outdir) / DOWNLOADS
    for old in folder.glob("isograde-*.whl"):
        old.unlink()
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        raise RuntimeError(f"the wheel was not built:\n{done.stderr}")
