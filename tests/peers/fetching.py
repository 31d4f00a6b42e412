"""Source distributions of packages, unpacked: where a wheel brings no tests, they may.

`ISOGRADE_PEERS` names a folder in which they are kept; elsewhere they are fetched by pip into a
temporary one. Nothing of them is built, and nothing is copied into this repository.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

BACKEND = Path(__file__).parent / "backend.py"
#: The backends of the packages whose sources are fetched.
BACKENDS = ("mesonpy", "setuptools.build_meta")


class CannotBeHadError(Exception):
    """The source distribution cannot be had here; the text says why."""


def unpacked(package: str, folder: Path) -> Path:
    """The unpacked source distribution of the version that is installed."""
    try:
        wanted = version(package)
    except PackageNotFoundError as error:
        raise CannotBeHadError(f"{package} is not installed") from error
    kept = Path(os.environ.get("ISOGRADE_PEERS") or folder) / package
    kept.mkdir(parents=True, exist_ok=True)
    if not (archives := list(kept.glob(f"*-{wanted}.tar.gz"))):
        archives = [fetched(package, wanted, kept)]
    with tarfile.open(archives[0]) as archive:
        archive.extractall(folder / "unpacked", filter="data")
    return folder / "unpacked" / archives[0].name.removesuffix(".tar.gz")


def fetched(package: str, wanted: str, folder: Path) -> Path:
    """The archive, fetched by pip, which builds nothing."""
    with tempfile.TemporaryDirectory() as name:
        for backend in BACKENDS:
            module = Path(name, *backend.split(".")).with_suffix(".py")
            module.parent.mkdir(exist_ok=True)
            (module.parent / "__init__.py").touch()
            module.write_text(BACKEND.read_text(encoding="utf-8"), encoding="utf-8")
        done = subprocess.run(
            [
                *(sys.executable, "-m", "pip", "download", "--quiet", "--retries", "1"),
                *("--disable-pip-version-check", "--no-deps", "--no-build-isolation"),
                *("--no-binary", package, "--dest", str(folder), f"{package}=={wanted}"),
            ],
            env={**os.environ, "PYTHONPATH": name},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            timeout=120,
            check=False,
        )
    archives = list(folder.glob(f"*-{wanted}.tar.gz"))
    if done.returncode or len(archives) != 1:
        told = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        why = told[-1] if told else done.stderr.strip()[-200:]
        raise CannotBeHadError(f"the sources of {package} {wanted} cannot be had here: {why}")
    return archives[0]
