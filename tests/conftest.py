"""Every Hypothesis test is deterministic, so that a failure is reproduced by naming the test."""

import os
import subprocess
import sys
from pathlib import Path

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
