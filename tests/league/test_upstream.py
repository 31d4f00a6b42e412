"""The reports to upstream: their lines run, and show what they say, where the library is."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
UPSTREAM = ROOT / "reports" / "league" / "upstream"
REPORTS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(UPSTREAM.glob("*-*.md"))}
# The module that a report's lines need first of all.
MODULES = {
    "itk": "itk",
    "jaxmesh": "jaxmesh",
    "manifold3d": "manifold3d",
    "pygel3d": "pygel3d",
    "pymcubes": "mcubes",
    "pytessel": "pytessel",
    "pysplashsurf": "pysplashsurf",
    "pyvista": "pyvista",
    "scikit-image": "skimage",
    "vtk": "vtkmodules",
    "yt": "yt",
}


def installed(module: str) -> bool:
    """Whether a process of its own imports it: here a folder of that name may pass for one."""
    asked = [sys.executable, "-c", f"import {module}"]
    return subprocess.run(asked, capture_output=True, cwd="/", check=False).returncode == 0


def lines_of(name: str) -> tuple[str, str]:
    """The language and the lines of a report."""
    (block,) = re.findall(r"```(\w+)\n(.*?)```", REPORTS[name], re.DOTALL)
    language, lines = block
    return language, lines


def command(name: str, folder: Path) -> list[str]:
    """What runs the lines of a report, or a skip that says what is missing."""
    language, lines = lines_of(name)
    library = name.rpartition("-")[0]
    if language == "rust":
        return _built_by_cargo(library, lines, folder)
    file = (
        folder
        / f"lines.{ {'python': 'py', 'r': 'R', 'c': 'c', 'js': 'mjs', 'octave': 'm'}[language] }"
    )
    if language == "js":
        built = ROOT / ".league" / library.replace("-", "_") / "node_modules"
        if shutil.which("node") is None or not built.exists():
            pytest.skip(f"{library} is not built (league.py --build)")
        (folder / "node_modules").symlink_to(built)
    file.write_text(lines, encoding="utf-8")
    if language == "python":
        own = ROOT / ".league" / library.replace("-", "_") / "env" / "bin" / "python"
        if own.exists():
            return [str(own), str(file)]
        if not installed(MODULES[library]):
            pytest.skip(f"no {library} here")
        return [sys.executable, str(file)]
    if language == "c":
        asked = subprocess.run(
            ["sh", "-c", "pkg-config --cflags --libs gts"],
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
        if asked.returncode or shutil.which("gcc") is None:
            pytest.skip("no gcc, or no libgts-dev")
        program = folder / "lines"
        flags = asked.stdout.split()
        subprocess.run(["gcc", str(file), "-o", str(program), *flags, "-lm"], check=True)
        return [str(program)]
    if language == "octave":
        if shutil.which("octave-cli") is None:
            pytest.skip("no Octave here")
        return ["octave-cli", "--quiet", "--no-init-file", str(file)]
    if language == "r" and shutil.which("Rscript") is None:
        pytest.skip("no R here")
    return ["node" if language == "js" else "Rscript", str(file)]


def _built_by_cargo(library: str, lines: str, folder: Path) -> list[str]:
    """The program of a report's lines, of the crates that the league's own was built from."""
    built = ROOT / ".league" / library.replace("-", "_")
    if shutil.which("cargo") is None or not (built / "Cargo.lock").exists():
        pytest.skip(f"{library} is not built (league.py --build)")
    (folder / "src").mkdir()
    (folder / "src" / "main.rs").write_text(lines, encoding="utf-8")
    for name in ("Cargo.toml", "Cargo.lock"):
        shutil.copy(built / name, folder)
    asked = ["cargo", "build", "--quiet", "--offline"]
    subprocess.run(asked, cwd=folder, check=True, timeout=120)
    return [str(folder / "target" / "debug" / "row")]


def test_there_are_reports_and_each_says_what_is_right() -> None:
    """Issue 16: title, versions, lines, what is right and why."""
    assert len(REPORTS) >= 8
    for name, text in REPORTS.items():
        assert re.match(r"# \S+ v?[\d.]+", text), name
        assert "Seen with" in text, name
        assert "**What is right.**" in text, name
        assert len(lines_of(name)[1].strip().splitlines()) <= 24, name


@pytest.mark.slow
@pytest.mark.parametrize("name", REPORTS)
def test_the_lines_show_the_defect(name: str, tmp_path: Path) -> None:
    """They end with a failed assertion or a signal; where they do not, it is mended."""
    done = subprocess.run(
        command(name, tmp_path), cwd=tmp_path, capture_output=True, encoding="utf-8",
        errors="replace", timeout=120, check=False,
    )  # fmt: skip
    said = done.stdout + done.stderr
    if "there is no package called" in said:
        pytest.skip("the R package is not here")
    assert done.returncode, f"{name} is mended: {said}"
    ended = done.returncode < 0  # By a signal.
    assert ended or re.search(r"assert|is not TRUE", said, re.IGNORECASE), said
