"""The conda-forge recipe, built by rattler-build, installed and tested as it says itself.

What it asks for comes from a channel of this test's own: packages by the names of those that are
installed here and in their versions, whose only content is where to find them. So the solver sees
real versions, and nothing is fetched.
"""

from __future__ import annotations

import hashlib
import io
import json
import sys
import tarfile
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.test_packages import PROJECT, names

ROOT = Path(__file__).parent.parent
RECIPE = ROOT / "packaging" / "conda-forge" / "recipe.yaml"
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"


def asked_for(recipe: Any) -> list[str]:
    """The packages that a recipe asks for, but for Python itself."""
    lines = [*recipe["requirements"]["host"], *recipe["requirements"]["run"]]
    return sorted({line.split()[0] for line in lines} - {"python"})


def package(channel: Path, name: str, version: str, files: dict[str, bytes | Path]) -> None:
    """A conda package in a channel: files with these contents, or links to these places."""
    index = {
        "name": name, "version": version, "build": "0", "build_number": 0, "depends": [],
        "arch": None, "platform": None, "subdir": "noarch", "noarch": "generic",
    }  # fmt: skip
    paths = [
        {"_path": path, "path_type": "softlink" if isinstance(held, Path) else "hardlink"}
        for path, held in files.items()
    ]
    told = {
        "info/index.json": json.dumps(index).encode(),
        "info/paths.json": json.dumps({"paths": paths, "paths_version": 1}).encode(),
        "info/files": "\n".join(files).encode(),
    }
    file = channel / "noarch" / f"{name}-{version}-0.tar.bz2"
    file.parent.mkdir(parents=True, exist_ok=True)
    with tarfile.open(file, "w:bz2") as archive:
        for path, held in {**told, **files}.items():
            entry = tarfile.TarInfo(path)
            if isinstance(held, Path):
                entry.type, entry.linkname = tarfile.SYMTYPE, str(held)
                archive.addfile(entry)
            else:
                entry.size, entry.mode = len(held), 0o755
                archive.addfile(entry, io.BytesIO(held))
    known = channel / "noarch" / "repodata.json"
    data = json.loads(known.read_text(encoding="utf-8")) if known.exists() else {"packages": {}}
    data["packages"][file.name] = {**index, "size": file.stat().st_size}
    known.write_text(json.dumps({"info": {"subdir": "noarch"}, **data}), encoding="utf-8")


def channel_of_what_is_here(folder: Path, names: list[str]) -> Path:
    """A channel with Python as it runs here, and these distributions as they are installed."""
    channel = folder / "channel"
    program = Path(sys.executable).resolve()
    config = f"home = {program.parent}\ninclude-system-site-packages = false\n"
    links = {f"bin/{name}": program for name in ("python", "python3", f"python{PYTHON}")}
    version = ".".join(map(str, sys.version_info[:3]))
    package(channel, "python", version, {**links, "pyvenv.cfg": config.encode()})
    for name in names:
        place = Path(str(metadata.distribution(name).locate_file("")))
        there = f"lib/python{PYTHON}/site-packages/{name}-is-there.pth"
        package(channel, name, metadata.version(name), {there: f"{place}\n".encode()})
    return channel


@pytest.mark.slow
def test_the_recipe_builds_and_passes_its_own_tests(packages: Path, tmp_path: Path) -> None:
    """Rendered, solved, built from the sdist, installed, imported and run."""
    rattler: Any = pytest.importorskip("rattler_build")
    text = RECIPE.read_text(encoding="utf-8")
    recipe = yaml.safe_load(text)

    # Take the sdist that is here, with its own checksum.
    (sdist,) = packages.glob("*.tar.gz")
    url = recipe["source"]["url"].replace("${{ version }}", recipe["context"]["version"])
    assert url.endswith(sdist.name)
    there = {"url": sdist.as_uri(), "sha256": hashlib.sha256(sdist.read_bytes()).hexdigest()}
    assert recipe["source"].keys() == there.keys()
    path = tmp_path / "recipe.yaml"
    path.write_text(yaml.safe_dump({**recipe, "source": there}), encoding="utf-8")

    # Build it, then install it anew and run the tests it carries.
    channels = [channel_of_what_is_here(tmp_path, asked_for(recipe)).as_uri()]
    (built,) = rattler.Stage0Recipe.from_file(path).run_build(
        variant_config=rattler.VariantConfig({"python_min": [PYTHON]}),
        output_dir=tmp_path / "out",
        channels=channels,
    )
    made = rattler.Package.from_file(built.packages[0])
    assert (made.name, made.version, made.noarch) == ("isograde", PROJECT["version"], "python")
    assert {one.split()[0] for one in made.depends} == names(PROJECT["dependencies"]) | {"python"}
    assert "site-packages/isograde/pytest_plugin.py" in made.files
    found = made.run_tests(channel=channels)
    assert len(found) == len(recipe["tests"]) == 2
    told = "".join(line for one in found for line in one.output)
    assert all(one.success for one in found), told
    assert f"isograde {PROJECT['version']}" in told
    assert "there is no hole" in told
