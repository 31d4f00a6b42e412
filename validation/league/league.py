"""The league: every extractor one can install, built and graded, each in its own environment.

``make league``, or ``python validation/league/league.py NAME ..`` for some. A folder beside this
file is a package: ``league.toml`` says how it is installed, which methods it has and what each says
of itself; an adapter in the package's own language calls it as its users do. What is built goes
into ``.league``, the reports into ``reports/league``. Who is built or graded already is left alone,
so a run that was cut off goes on where it was; ``--again`` begins anew. A package that cannot be
built or graded costs its own row, and the reason stands in ``.league/<folder>/failed.txt``.

``league.toml``
---------------
package, version, language, written_in, licence, homepage
use            what the licence allows: permissive, copyleft or non-commercial
[install]      one of ``pip``, ``npm``, ``cargo`` (lists of requirements), or ``debian`` (packages,
               which are looked for and not installed) with ``needs`` (programs that must be there)
[methods.NAME] ``calls`` (the call, for people), ``function`` and ``options`` of the adapter,
               ``declaration`` (`isograde explain declaration`, without the name), ``does`` (what
               the adapter does for the package, to be told with the results)
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from isograde import report as reports
from isograde.adapters import ready_made_names
from isograde.cases import PLAN
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from, declaration_json
from isograde.grading import grade as graded
from isograde.model import SURFACES, AdapterError, Limits
from isograde.progress import progress
from isograde.report.choosing import About, choosing_page, twelve_lines
from isograde.report.headline import headline
from isograde.report.lines import lines, write_lines
from isograde.report.packed import packed
from isograde.report.reading import Report, gather, read
from isograde.report.record import claim_record, tally_of
from isograde.report.speed import Measured, measured
from isograde.runner import NothingToRun, Options, processors

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KITS = HERE.parent / "kits"
BUILT = ROOT / ".league"
REPORTS = ROOT / "reports" / "league"
SPEED, VERSIONS = REPORTS / "speed.json", REPORTS / "versions"
READY_MADE = ROOT / "reports" / "implementations"
SERVICES = HERE / "services"
README = ROOT / "README.md"
# The best of the table stand between these in the README.
MARKS = (
    "<!-- the league, written by validation/league/league.py --page -->",
    "<!-- the league ends -->",
)

USES = ("permissive", "copyleft", "non-commercial")


class LeagueError(Exception):
    """A recipe that is wrong, or a package that could not be built; the message says which."""


@dataclass(frozen=True)
class Package:
    """A folder of the league.

    said : its ``league.toml``
    """

    folder: Path
    said: dict[str, Any]

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.name

    @property
    def built(self) -> Path:
        """Where it is built."""
        return BUILT / self.name

    @property
    def methods(self) -> list[str]:
        """The names of its methods."""
        return list(self.said["methods"])

    def declaration(self, method: str) -> dict[str, Any]:
        """What a method says of itself, with its name and version."""
        said = dict(self.said["methods"][method].get("declaration", {}))
        does = self.said["methods"][method].get("does", "")
        return {"name": method, "version": self.said["version"], "notes": does, **said}

    def laid(self) -> None:
        """What the package is built from stands where it is built."""
        shutil.copytree(self.folder, self.built)

    def command(self, method: str) -> str:
        """What answers the grader, from the root of the repository."""
        return f"{self.built.relative_to(ROOT)}/run {method}"


def packages(names: Sequence[str] = ()) -> list[Package]:
    """The packages with these names or methods, or all; raises `LeagueError` for an unknown one."""
    found = [
        Package(path.parent, tomllib.loads(path.read_text(encoding="utf-8")))
        for path in sorted(HERE.glob("*/league.toml"))
    ]
    known = {name for package in found for name in (package.name, *package.methods)}
    if unknown := set(names) - known:
        raise LeagueError(f"no {', '.join(sorted(unknown))}; there are {', '.join(sorted(known))}")
    return [p for p in found if not names or {p.name, *p.methods} & set(names)]


# -- building --------------------------------------------------------------------------------------


def build(package: Package) -> None:
    """The package is installed, with a program ``run METHOD`` beside it that answers the grader.

    Raises `LeagueError` with what the installer said.
    """
    shutil.rmtree(package.built, ignore_errors=True)
    package.laid()
    for method in package.methods:
        said = package.said["methods"][method]
        told = {
            "function": said.get("function", ""),
            "options": said.get("options", {}),
            "declaration": package.declaration(method),
        }
        (package.built / f"{method}.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
        # The kit for Rust sends a declaration on as it is written, so on one line.
        said_alone = json.dumps(told["declaration"])
        (package.built / f"{method}.declaration.json").write_text(said_alone, encoding="utf-8")
        (package.built / f"{method}.function").write_text(told["function"], encoding="utf-8")
    install = package.said["install"]
    how = next((way for way in INSTALLERS if way in install), None)
    if how is None:
        raise LeagueError(f"{package.name}: [install] has none of {', '.join(INSTALLERS)}")
    program = INSTALLERS[how](package, install[how])
    script = package.built / "run"
    # The kits answer on descriptor 3; what the package prints is for people.
    compiled = how == "cargo" or "make" in install
    given = '"$1.declaration.json" "$(cat "$1.function")"' if compiled else '"$1.json"'
    kept = "3>&1 1>&2" if compiled or how == "npm" else ""
    script.write_text(
        f'#!/bin/sh\ncd "$(dirname "$0")" || exit\nexec {program} {given} {kept}\n',
        encoding="utf-8",
    )
    script.chmod(0o755)
    (package.built / "ready").touch()


def _pip(package: Package, wanted: list[str]) -> str:
    """The service in an environment of its own."""
    shutil.copy(SERVICES / "serve.py", package.built)
    _told([sys.executable, "-m", "venv", str(package.built / "env")])
    pip = [str(package.built / "env/bin/pip"), "install", "--quiet", "--disable-pip-version-check"]
    # What is imported is compiled then; the rest of a large package need not be.
    _told([*pip, "--no-compile", "numpy", *wanted])
    return "env/bin/python serve.py"


def _npm(package: Package, wanted: list[str]) -> str:
    """The service beside its own ``node_modules``."""
    shutil.copy(SERVICES / "serve.mjs", package.built)
    shutil.copy(KITS / "javascript" / "isograde.mjs", package.built)
    (package.built / "package.json").write_text('{"private": true}\n', encoding="utf-8")
    _told(["npm", "install", "--no-audit", "--no-fund", *wanted], package.built)
    return "node serve.mjs"


def _cargo(package: Package, wanted: list[str]) -> str:
    """A program built from the adapter, the kit for Rust and the crates."""
    for source in (KITS / "rust" / "src" / "isograde.rs", SERVICES / "league.rs"):
        shutil.copy(source, package.built / "src")
    (package.built / "Cargo.toml").write_text(
        '[package]\nname = "row"\nversion = "1.0.0"\nedition = "2021"\n\n[workspace]\n',
        encoding="utf-8",
    )
    for crate in wanted:
        _told(["cargo", "add", "--quiet", crate], package.built)
    _told(["cargo", "build", "--quiet", "--release"], package.built)
    return "target/release/row"


def _debian(package: Package, wanted: list[str]) -> str:
    """A program of Debian's packages, which must be there already."""
    install = package.said["install"]
    for program in install["needs"]:
        if shutil.which(program) is None:
            raise LeagueError(f"no {program}: apt-get install {' '.join(wanted)}")
    for service in install.get("services", []):
        shutil.copy(SERVICES / service, package.built)
    if "make" in install:
        for header in (KITS / "c").glob("*.h"):
            shutil.copy(header, package.built)
        _told(["sh", "-c", install["make"]], package.built)
    return str(install["program"])


INSTALLERS = {"pip": _pip, "npm": _npm, "cargo": _cargo, "debian": _debian}


def _told(command: list[str], folder: Path = ROOT) -> None:
    """The command ran; raises `LeagueError` with the end of what it printed where it failed."""
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, encoding="utf-8", check=False
        )
    except FileNotFoundError as error:
        raise LeagueError(f"no {command[0]} on this machine") from error
    if done.returncode:
        raise LeagueError(f"{' '.join(command)}:\n{(done.stdout + done.stderr)[-2000:]}")


# -- grading ---------------------------------------------------------------------------------------


def grade(package: Package, method: str, only: Sequence[str] = ()) -> None:
    """The method's report and pages stand in ``reports/league``.

    Raises `LeagueError` where the program does not start, or nothing of the plan is for it.
    """
    options = Options(0, False, tuple(only), Limits(), processors())
    path = REPORTS / f"{method}.jsonl.gz"
    try:
        with progress(method) as watch:
            found = graded(f"exec:{package.command(method)}", options, path, watch=watch)
    except (AdapterError, NothingToRun) as error:
        raise LeagueError(f"{method}: {error}") from error
    reports.write(found, REPORTS, method, ["html"], pack=True)
    print(headline(found), flush=True)


def redeclare(package: Package, method: str) -> None:
    """The kept report holds against the method what its recipe promises now.

    What is not promised is judged all the same, so the verdicts stay as they are. Raises
    `LeagueError` where there is no report, or more of what is declared than ``not_promised``
    changed.
    """
    path = REPORTS / f"{method}.jsonl.gz"
    if not path.exists():
        raise LeagueError(f"{method}: not graded yet, so nothing is held against it")
    found = read(path)
    declared = declaration_from(package.declaration(method), method)
    said = declaration_json(declared)
    # In the words of today: those that came since have their defaults.
    before = declaration_json(declaration_from(found.declaration, method))
    if other := [word for word in said if word != "not_promised" and said[word] != before[word]]:
        raise LeagueError(f"{method}: {', '.join(other)} changed: grade it again")
    assert found.footer is not None
    head = {**found.header, "declaration": said}
    claims = [claim_record(CLAIMS[name], declared) for name in found.claims]
    kept = [one for one in found.records if one["record"] not in ("header", "claim", "footer")]
    records = [head, *claims, *kept]
    seconds = found.footer["seconds"]
    footer = tally_of(found).footer(seconds, gather(records))
    write_lines([*records, footer], path)
    reports.write(read(path), REPORTS, method, ["html"], pack=True)
    print(footer["headline"], flush=True)


# -- the page --------------------------------------------------------------------------------------


def about() -> dict[str, About]:
    """What is known of each method beside its report, by name."""
    known = {}
    for package in packages():
        for method, said in package.said["methods"].items():
            known[method] = _about(package.said, said["calls"])
    installed = tomllib.loads((HERE / "installed.toml").read_text(encoding="utf-8"))
    for name in ready_made_names():
        if (library := name.split(":")[0]) in installed:
            known[name] = _about(installed[library], "")
    return known


def _about(said: Mapping[str, Any], calls: str) -> About:
    """The same, of one method; raises `LeagueError` for a word that is none."""
    if said["use"] not in USES:
        raise LeagueError(f"{said['package']}: use is {said['use']!r}, not {', '.join(USES)}")
    words = ("package", "language", "written_in", "licence", "use", "homepage")
    return About(**{word: said[word] for word in words}, calls=calls)


def page(*, plain: bool = False) -> Path:
    """``reports/league/index.html``, of the league's reports and the ready-made names'.

    Only reports of the present plan, on the same scans, stand beside each other; of the others it
    is said.
    """
    found, links, absent = [], {}, {}
    for folder in (REPORTS, READY_MADE):
        for path in sorted(folder.glob("*.jsonl.gz")):
            header = next(lines(path))  # The rest is long, and read only where it is shown.
            name, plan = header["declaration"]["name"], header.get("plan", 1)
            if name in links:
                continue
            if plan != PLAN:
                absent[name] = f"graded on plan {plan}, not yet on plan {PLAN}"
                continue
            absent.pop(name, None)
            found.append(read(path))
            stem = path.name.removesuffix(".jsonl.gz")
            links[name] = f"{os.path.relpath(folder, REPORTS)}/{stem}.html"
    absent |= fewer_scans(found)
    found = [one for one in found if one.name not in absent]
    for package in packages():
        reason = package.built / "failed.txt"
        for method in package.methods:
            if method not in links:
                said = reason.read_text(encoding="utf-8").strip() if reason.exists() else ""
                absent[method] = said.splitlines()[0] if said else "not graded yet"
    known = about()
    best = twelve_lines(found, known)
    reports.write_whole(REPORTS / "league.md", best)
    reports.write_whole(README, between(README.read_text(encoding="utf-8"), best))
    text = choosing_page(found, links, known, absent, costs(), versions())
    again = "python validation/league/league.py --page --plain"
    return reports.write_whole(REPORTS / "index.html", text if plain else packed(text, again))


def fewer_scans(found: Sequence[Report]) -> dict[str, str]:
    """By name, of what extracts surfaces, what was graded on fewer scans than the others."""
    scans = {
        one.name: {case for case, said in one.cases.items() if "real" in said["tags"]}
        for one in found
        if SURFACES in one.kinds
    }
    every = set().union(*scans.values())
    return {
        name: f"graded without {len(every - own)} of the {len(every)} scans (ISOGRADE_DATA)"
        for name, own in scans.items()
        if every - own
    }


def between(text: str, best: str) -> str:
    """The text with these lines between its two marks; raises `LeagueError` where it has none."""
    before, mark, rest = text.partition(MARKS[0])
    _, end, after = rest.partition(MARKS[1])
    if not mark or not end:
        raise LeagueError(f"{README.name} has not the marks {' and '.join(MARKS)}")
    return f"{before}{mark}\n{best}{end}{after}"


def costs() -> dict[str, Measured]:
    """What ``speed.py`` has measured, by method."""
    if not SPEED.exists():
        return {}
    kept = json.loads(SPEED.read_text(encoding="utf-8"))
    found = {name: measured(said, name, kept["peer"]) for name, said in kept["methods"].items()}
    return {name: one for name, one in found.items() if one is not None}


def versions() -> list[tuple[Report, str]]:
    """What ``versions.py`` has graded of the present plan, each with its page."""
    return [
        (read(path), f"{VERSIONS.name}/{path.name.removesuffix('.jsonl.gz')}.html")
        for path in sorted(VERSIONS.glob("*.jsonl.gz"))
        if next(lines(path)).get("plan", 1) == PLAN
    ]


def rows(chosen: Sequence[Package], names: Sequence[str]) -> Iterator[tuple[Package, str]]:
    """Every method that was asked for."""
    for package in chosen:
        for method in package.methods:
            if not names or {package.name, method} & set(names):
                yield package, method


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where every row asked for is built and graded, 1 where one is not, 2 for an unknown one."""
    parser = argparse.ArgumentParser(description="Build and grade the league's packages.")
    parser.add_argument("names", nargs="*", help="packages or methods; all unless said")
    parser.add_argument("--build", action="store_true", help="build only")
    parser.add_argument("--again", action="store_true", help="build and grade anew")
    parser.add_argument("--page", action="store_true", help="write the page of what is there")
    parser.add_argument(
        "--redeclare",
        action="store_true",
        help="hold against a graded method what its recipe promises now: not_promised alone",
    )
    parser.add_argument("--plain", action="store_true", help="do not pack that page")
    parser.add_argument("--list", action="store_true", help="name the methods, and do nothing")
    parser.add_argument("--only", nargs="*", default=[], help="globs of claims or cases")
    given = parser.parse_args(arguments)
    try:
        chosen = packages(given.names)
    except LeagueError as error:
        print(error, file=sys.stderr)
        return 2
    if given.list:
        for package, method in rows(chosen, given.names):
            said = package.said
            print(f"{method}: {said['package']} {said['version']}, {said['language']}")
        return 0
    failed = 0
    for package in chosen if not given.page else ():
        failed += not _row(package, given)
    if not given.build:
        print(page(plain=given.plain))
    return int(failed > 0)


def _row(package: Package, given: argparse.Namespace) -> bool:
    """Whether a package was built and the methods asked for were graded; says what it does."""
    try:
        ready = given.redeclare or (package.built / "ready").exists()
        if given.again or not ready:
            print(f"{package.name}: building", flush=True)
            build(package)
        if given.build:
            return True
        for _, method in rows([package], given.names):
            if given.redeclare:
                redeclare(package, method)
            elif given.again or not (REPORTS / f"{method}.jsonl.gz").exists():
                print(f"{method}: grading", flush=True)
                grade(package, method, given.only)
    except LeagueError as error:
        print(f"{package.name}: {error}", file=sys.stderr, flush=True)
        package.built.mkdir(parents=True, exist_ok=True)
        (package.built / "failed.txt").write_text(f"{error}\n", encoding="utf-8")
        return False
    return True


if __name__ == "__main__":
    os.chdir(ROOT)  # The programs are named from here.
    sys.exit(main())
