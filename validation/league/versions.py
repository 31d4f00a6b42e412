"""What became of four libraries: three versions each, graded on a part of the plan, compared.

``python validation/league/versions.py [LIBRARY ..]`` builds each version of `installed.toml` in an
environment of its own, calls it through the functions of its ready-made name, and grades it on the
same part of the plan (`PART`). Reports are kept in ``reports/league/versions``; what is there is
left alone, so a run that was cut off goes on. The page to choose by shows what was mended and what
broke from one version to the next.
"""

from __future__ import annotations

import argparse
import os
import sys
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import league
from isograde import report as reports
from isograde.adapters.registry import READY_MADE
from isograde.grading import grade as graded
from isograde.model import AdapterError, Limits
from isograde.progress import progress
from isograde.report.headline import headline
from isograde.runner import NothingToRun, Options

KEPT = league.VERSIONS
# Graded of each library, and on which cases: every tile, number types, magnitudes, ties, shapes,
# known bodies and noise. Real scans and what takes long are left out.
METHODS = ("skimage:lewiner", "pymcubes", "vtk:flying-edges", "libigl")
FAMILIES = ("cells", "types", "magnitudes", "ties", "shapes", "bodies", "noise", "structured")
PART = tuple(f"{family}/*" for family in FAMILIES)


@dataclass(frozen=True)
class Version(league.Package):
    """One version of a library whose methods have ready-made names."""

    def sources(self) -> dict[str, Path]:
        """The functions of the ready-made names are the adapter."""
        return {"adapter.py": Path(self.said["functions"]), **league.BESIDE["pip"]}

    @property
    def name(self) -> str:
        """The library and its version."""
        return str(self.said["folder"])

    def command(self, method: str) -> str:
        """What answers the grader, from the root of the repository."""
        return super().command(method.replace(":", "-"))


def versions(library: str) -> list[Version]:
    """The library's versions, the oldest first, as packages to build."""
    said = tomllib.loads((league.HERE / "installed.toml").read_text(encoding="utf-8"))[library]
    ready_made = {
        name: ready
        for name, ready in READY_MADE.items()
        if name.split(":")[0] == library and not ready.given_function
    }
    (functions,) = {str(ready.module.__file__) for ready in ready_made.values()}
    found = []
    for version in said.get("versions", []):
        wanted = [*said.get("beside", {}).get(version, []), f"{said['package']}=={version}"]
        methods = {
            name.replace(":", "-"): {
                "function": ready.calls,
                "options": dict(ready.options),
                "declaration": {**ready.said, "name": name},
            }
            for name, ready in ready_made.items()
        }
        made = {
            **said,
            "folder": f"{library}-{version}",
            "version": version,
            "functions": functions,
            "install": {"pip": wanted},
            "methods": methods,
        }
        found.append(Version(league.HERE, made))
    return found


def libraries() -> list[str]:
    """The libraries of which there are versions."""
    known = tomllib.loads((league.HERE / "installed.toml").read_text(encoding="utf-8"))
    return [name for name, said in known.items() if "versions" in said]


def rows(chosen: Sequence[str]) -> Iterator[tuple[Version, str]]:
    """Each version of these libraries with each method that is graded; all where none is named."""
    with_versions = libraries()
    if unknown := set(chosen) - set(with_versions):
        told = f"no versions of {', '.join(sorted(unknown))}; of {', '.join(with_versions)}"
        raise league.LeagueError(told)
    for library in chosen or with_versions:
        for package in versions(library):
            for method in METHODS:
                if method.split(":")[0] == library:
                    yield package, method


def kept(package: Version, method: str) -> Path:
    """Where the report of a version is."""
    return KEPT / f"{method.replace(':', '-')}-{package.said['version']}.jsonl.gz"


def grade(package: Version, method: str) -> None:
    """The report and page of a version stand in ``reports/league/versions``."""
    path = kept(package, method)
    options = Options(0, False, PART, Limits(), 1)
    spec = f"exec:{package.command(method)}"
    try:
        with progress(f"{method} {package.said['version']}") as watch:
            found = graded(spec, options, path, watch=watch)
    except (AdapterError, NothingToRun) as error:
        raise league.LeagueError(f"{method} {package.said['version']}: {error}") from error
    reports.write(found, KEPT, path.name.removesuffix(".jsonl.gz"), ["html"], pack=True)
    print(headline(found), flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where every version asked for is graded, 1 where one is not, 2 for an unknown library."""
    parser = argparse.ArgumentParser(description="Grade three versions each of four libraries.")
    parser.add_argument("libraries", nargs="*", help="of installed.toml; all unless said")
    parser.add_argument("--build", action="store_true", help="build only")
    parser.add_argument("--again", action="store_true", help="grade anew")
    given = parser.parse_args(arguments)
    failed = 0
    try:
        asked = list(rows(given.libraries))
    except league.LeagueError as error:
        print(error, file=sys.stderr)
        return 2
    for package, method in asked:
        try:
            if not (package.built / "ready").exists():
                print(f"{package.name}: building", flush=True)
                league.build(package)
            if not given.build and (given.again or not kept(package, method).exists()):
                grade(package, method)
        except league.LeagueError as error:
            print(error, file=sys.stderr, flush=True)
            failed = 1
    return failed


if __name__ == "__main__":
    os.chdir(league.ROOT)  # The programs are named from here.
    sys.exit(main())
