"""Every Hypothesis test is deterministic, so that a failure is reproduced by naming the test."""

import os
import re
import subprocess
import sys
import venv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import pytest
from hypothesis import HealthCheck, settings

matplotlib.use("Agg")
settings.register_profile(
    "isograde",
    derandomize=True,
    deadline=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("isograde")


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real volumes, or a skip that says how to provide it."""
    folder = os.environ.get("ISOGRADE_DATA")
    if not folder or not Path(folder).is_dir():
        pytest.skip("real volumes are absent: set ISOGRADE_DATA to the folder that holds them")
    return Path(folder)


@pytest.fixture(scope="session")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel and the sdist, made without a network by the installed hatchling."""
    folder = tmp_path_factory.mktemp("dist")
    root = Path(__file__).parent.parent
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(root)]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="session")
def clean(packages: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that holds the wheel and what it needs, and nothing else."""
    place = tmp_path_factory.mktemp("clean")
    venv.create(place, with_pip=True)
    (wheel,) = packages.glob("*.whl")
    constraints = Path(__file__).parent.parent / "constraints.txt"
    install = [str(place / "bin" / "pip"), "install", "-q", "-c", str(constraints), str(wheel)]
    done = subprocess.run(install, capture_output=True, encoding="utf-8", check=False)
    if done.returncode and re.search(r"connection|resolve|network", done.stderr, re.I):
        pytest.skip(f"no package index: {done.stderr[-200:]}")
    assert done.returncode == 0, done.stderr
    return place


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two workers of dask in processes of their own."""
    distributed: Any = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, memory_limit=0
        ) as cluster,
        distributed.Client(cluster) as found,
    ):
        yield found
