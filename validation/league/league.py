"""The league: every extractor one can install, built and graded, each in its own environment.

``make league``, or ``python validation/league/league.py NAME ..`` for some. A folder beside this
file is a package: ``league.toml`` says how it is installed, which methods it has and what each says
of itself; an adapter in the package's own language calls it as its users do. What is built goes
into ``.league``, the reports into ``reports/league``.

Who is built already is not built again: where an adapter or a declaration changed, the new one is
laid into what is there. ISOGRADE_LEAGUE names what was built in another copy of the project, and
``.league`` is then a link to it. Who has a report that is of today (`stale` says when it is not) is
left alone, so a run that was cut off goes on where it was; ``--anew`` grades whatever stands there,
and ``--again`` builds anew before. Several methods are graded at a time, those first that were done
soonest before, each in a process of its own. A package that cannot be built or graded costs its own
row, and the reason stands in ``.league/<folder>/failed.txt``, or ``failed-<method>.txt`` where it
is one method's.

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
import gzip
import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from isograde import report as reports
from isograde.adapters import ready_made_names
from isograde.cases import PLAN, all_cases
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from, declaration_json
from isograde.drafts import Busy, unfinished
from isograde.grading import grade as graded
from isograde.model import SURFACES, AdapterError, Limits
from isograde.progress import progress
from isograde.report.choosing import About, choosing_page, twelve_lines
from isograde.report.comparison import fewer_scans
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

# What a grade takes of which it is not known, in seconds.
USUAL = 300.0

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

    @property
    def installs(self) -> str:
        """What is installed of it, as one text."""
        return json.dumps([self.said["version"], self.said["install"]], sort_keys=True)

    @property
    def is_built(self) -> bool:
        """Whether what its recipe installs is there; its adapter may be an older one."""
        ready = self.built / "ready"
        return ready.exists() and ready.read_text(encoding="utf-8") == self.installs

    def sources(self) -> dict[str, Path]:
        """The files that it is built from, by the place where each lies in what is built."""
        own = (path for path in self.folder.rglob("*.*") if "__pycache__" not in path.parts)
        return {str(path.relative_to(self.folder)): path for path in own} | _beside(self.said)

    def failed(self, method: str = "") -> Path:
        """Where it is told why it could not be built, or one of its methods not be graded."""
        return self.built / (f"failed-{method}.txt" if method else "failed.txt")

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


def linked() -> None:
    """``.league`` is what ISOGRADE_LEAGUE names, where it names anything.

    Reports name programs from the root of the repository, so that no path of a machine is in them.
    Raises `LeagueError` where there is another ``.league``, or no such folder.
    """
    if not (elsewhere := os.environ.get("ISOGRADE_LEAGUE")):
        return
    if not Path(elsewhere).is_dir():
        raise LeagueError(f"ISOGRADE_LEAGUE={elsewhere}: there is no such folder")
    if not BUILT.exists() and not BUILT.is_symlink():
        BUILT.symlink_to(Path(elsewhere).resolve())
    if BUILT.resolve() != Path(elsewhere).resolve():
        raise LeagueError(f"ISOGRADE_LEAGUE={elsewhere}, but {BUILT} is another: remove one")


def build(package: Package) -> None:
    """The package is installed, with a program ``run METHOD`` beside it that answers the grader.

    Raises `LeagueError` with what the installer said.
    """
    how = _way(package.said)
    shutil.rmtree(package.built, ignore_errors=True)
    lay(package)
    program = INSTALLERS[how](package, package.said["install"][how])
    script = package.built / "run"
    # The kits answer on descriptor 3; what the package prints is for people.
    compiled = how == "cargo" or "make" in package.said["install"]
    given = '"$1.declaration.json" "$(cat "$1.function")"' if compiled else '"$1.json"'
    answers = "3>&1 1>&2" if compiled or how == "npm" else ""
    script.write_text(
        f'#!/bin/sh\ncd "$(dirname "$0")" || exit\nexec {program} {given} {answers}\n',
        encoding="utf-8",
    )
    script.chmod(0o755)
    (package.built / "ready").write_text(package.installs, encoding="utf-8")


def lay(package: Package) -> bool:
    """What the package is built from stands where it is built; whether any of it was not there."""
    files = {name: path.read_bytes() for name, path in package.sources().items()}
    for method in package.methods:
        said = package.said["methods"][method]
        told = {
            "function": said.get("function", ""),
            "options": said.get("options", {}),
            "declaration": package.declaration(method),
        }
        files[f"{method}.json"] = json.dumps(told, indent=1).encode()
        # The kit for Rust sends a declaration on as it is written, so on one line.
        files[f"{method}.declaration.json"] = json.dumps(told["declaration"]).encode()
        files[f"{method}.function"] = told["function"].encode()
    changed = False
    for name, content in files.items():
        place = package.built / name
        if not place.exists() or place.read_bytes() != content:
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
            changed = True
    return changed


def provide(package: Package) -> None:
    """The package is built from what its folder says today; what it installs is installed once.

    Raises `LeagueError` as `build` does.
    """
    if not package.is_built:
        print(f"{package.name}: building", flush=True)
        build(package)
    elif lay(package):
        print(f"{package.name}: what is built is given today's recipe", flush=True)
        if "cargo" in package.said["install"]:
            _told(CARGO, package.built)
        elif "make" in package.said["install"]:
            _told(["sh", "-c", package.said["install"]["make"]], package.built)


def _way(said: Mapping[str, Any]) -> str:
    """The way a package is installed; raises `LeagueError` where its recipe names none."""
    way = next((way for way in INSTALLERS if way in said["install"]), None)
    if way is None:
        raise LeagueError(f"{said['package']}: [install] has none of {', '.join(INSTALLERS)}")
    return way


def _pip(package: Package, wanted: list[str]) -> str:
    """The service in an environment of its own."""
    _told([sys.executable, "-m", "venv", str(package.built / "env")])
    pip = [str(package.built / "env/bin/pip"), "install", "--quiet", "--disable-pip-version-check"]
    # What is imported is compiled then; the rest of a large package need not be.
    _told([*pip, "--no-compile", "numpy", *wanted])
    return "env/bin/python serve.py"


def _npm(package: Package, wanted: list[str]) -> str:
    """The service beside its own ``node_modules``."""
    (package.built / "package.json").write_text('{"private": true}\n', encoding="utf-8")
    _told(["npm", "install", "--no-audit", "--no-fund", *wanted], package.built)
    return "node serve.mjs"


CARGO = ["cargo", "build", "--quiet", "--release"]


def _cargo(package: Package, wanted: list[str]) -> str:
    """A program built from the adapter, the kit for Rust and the crates."""
    (package.built / "Cargo.toml").write_text(
        '[package]\nname = "row"\nversion = "1.0.0"\nedition = "2021"\n\n[workspace]\n',
        encoding="utf-8",
    )
    for crate in wanted:
        _told(["cargo", "add", "--quiet", crate], package.built)
    _told(CARGO, package.built)
    return "target/release/row"


def _debian(package: Package, wanted: list[str]) -> str:
    """A program of Debian's packages, which must be there already."""
    install = package.said["install"]
    for program in install["needs"]:
        if shutil.which(program) is None:
            raise LeagueError(f"no {program}: apt-get install {' '.join(wanted)}")
    if "make" in install:
        _told(["sh", "-c", install["make"]], package.built)
    return str(install["program"])


INSTALLERS = {"pip": _pip, "npm": _npm, "cargo": _cargo, "debian": _debian}
# What is laid beside an adapter: the service in its language, and the kit that it is written with.
BESIDE = {
    "pip": {"serve.py": SERVICES / "serve.py"},
    "npm": {
        "serve.mjs": SERVICES / "serve.mjs",
        "isograde.mjs": KITS / "javascript" / "isograde.mjs",
    },
    "cargo": {
        "src/isograde.rs": KITS / "rust" / "src" / "isograde.rs",
        "src/league.rs": SERVICES / "league.rs",
    },
}


def _beside(said: Mapping[str, Any]) -> dict[str, Path]:
    """The same, of a recipe; what Debian packages names its service, and may be written in C."""
    install = said["install"]
    found = dict(BESIDE.get(_way(said), {}))
    found |= {name: SERVICES / name for name in install.get("services", [])}
    if "make" in install:
        found |= {path.name: path for path in (KITS / "c").glob("*.h")}
    return found


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


def grade(package: Package, method: str, only: Sequence[str] = (), jobs: int = 1) -> None:
    """The method's report and pages stand in ``reports/league``.

    Raises `LeagueError` where the program does not start, or nothing of the plan is for it.
    """
    options = Options(0, False, tuple(only), Limits(), jobs)
    path = kept(method)
    try:
        with progress(method, by_lines=True) as watch:
            found = graded(f"exec:{package.command(method)}", options, path, watch=watch)
    except (AdapterError, Busy, NothingToRun) as error:
        raise LeagueError(f"{method}: {error}") from error
    reports.write(found, REPORTS, method, ["html"], pack=True)
    print(headline(found), flush=True)


def kept(method: str) -> Path:
    """Where a method's report stands."""
    return REPORTS / f"{method}.jsonl.gz"


def stale(path: Path, declared: Mapping[str, Any]) -> str:
    """Why a method that declares this is graded although it may have a report, or nothing.

    Its report is of another plan, declaration or version, or without scans that are here.
    """
    if not path.exists():
        return "there is no report"
    header = next(lines(path))
    if (plan := header.get("plan", 1)) != PLAN:
        return f"its report is of plan {plan}, and this is plan {PLAN}"
    said = declaration_json(declaration_from(dict(declared), declared["name"]))
    before = declaration_json(declaration_from(header["declaration"], declared["name"]))
    if other := [word for word in said if said[word] != before[word]]:
        return f"it declares otherwise since: {', '.join(other)}"
    if header["only"] or header["seed"]:
        return "its report is of a part of the plan, or of other numbers"
    cases = {one["id"] for one in lines(path) if one["record"] == "case"}
    if list(SURFACES) in header["kinds"] and (missing := scans() - cases):
        return f"its report is without {len(missing)} of the scans that are here"
    return ""


@cache
def scans() -> frozenset[str]:
    """The cases of real scans, of those that are on this machine."""
    return frozenset(
        name
        for name, case in all_cases().items()
        if "real" in case.tags and "full" not in case.tags
    )


def seconds_before(method: str) -> float:
    """What the last grade of a method took; that of most where there is none."""
    try:
        with gzip.open(kept(method), "rt", encoding="utf-8") as file:
            *_, footer = file
        return float(json.loads(footer)["seconds"])
    except (OSError, ValueError, KeyError):
        return USUAL


def apart(method: str, why: str, given: argparse.Namespace) -> int:
    """The status with which a process of its own ends that grades the method, and says why."""
    asked = [sys.executable, str(HERE / "league.py"), method, "--anew", "--no-page"]
    asked += ["--because", why, "--at-once", "1", "--jobs", str(given.jobs)]
    if given.only:
        asked += ["--only", *given.only]
    return subprocess.run(asked, check=False).returncode


def redeclare(package: Package, method: str) -> None:
    """The kept report holds against the method what its recipe promises now.

    What is not promised is judged all the same, so the verdicts stay as they are. Raises
    `LeagueError` where there is no report, or more of what is declared than ``not_promised``
    changed.
    """
    path = kept(method)
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
    rest = [one for one in found.records if one["record"] not in ("header", "claim", "footer")]
    records = [head, *claims, *rest]
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
    absent = {name: f"{why}{begun(name)}" for name, why in absent.items()}
    found = [one for one in found if one.name not in absent]
    for package in packages():
        for method in package.methods:
            reasons = [package.failed(), package.failed(method)]
            told = [one.read_text(encoding="utf-8").strip() for one in reasons if one.exists()]
            if told and (method not in links):
                absent[method] = told[0].splitlines()[0]
            elif method not in links:
                absent.setdefault(method, "not graded yet")
    known = about()
    best = twelve_lines(found, known)
    reports.write_whole(REPORTS / "league.md", best)
    reports.write_whole(README, between(README.read_text(encoding="utf-8"), best))
    text = choosing_page(found, links, known, absent, costs(), versions())
    again = "python validation/league/league.py --page --plain"
    return reports.write_whole(REPORTS / "index.html", text if plain else packed(text, again))


def begun(name: str) -> str:
    """That a grade of a method stands unfinished, to be put after why it has no row; or nothing."""
    return "; a grade of it was begun, and did not end" if unfinished(kept(name)).exists() else ""


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
    speeds = json.loads(SPEED.read_text(encoding="utf-8"))
    found = {n: measured(said, n, speeds["peer"]) for n, said in speeds["methods"].items()}
    return {name: one for name, one in found.items() if one is not None}


def versions() -> list[tuple[Report, str]]:
    """What ``versions.py`` has graded, each with its page, of libraries graded on one plan alone.

    Versions are compared with each other, not with the rows of the table, whose plan may be later.
    """
    paths = sorted(VERSIONS.glob("*.jsonl.gz"))
    found = [(read(path), f"{VERSIONS.name}/{_stem(path)}.html") for path in paths]
    plans: dict[str, set[int]] = {}
    for one, _ in found:
        plans.setdefault(one.name, set()).add(one.plan)
    return [(one, link) for one, link in found if len(plans[one.name]) == 1]


def _stem(path: Path) -> str:
    """The name of a report's file without its endings."""
    return path.name.removesuffix(".jsonl.gz")


def rows(chosen: Sequence[Package], names: Sequence[str]) -> Iterator[tuple[Package, str]]:
    """Every method that was asked for."""
    for package in chosen:
        for method in package.methods:
            if not names or {package.name, method} & set(names):
                yield package, method


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where every row asked for is built and graded, 1 where one is not, 2 for wrong use."""
    given = parser().parse_args(arguments)
    try:
        linked()
        chosen = packages(given.names)
    except LeagueError as error:
        print(error, file=sys.stderr)
        return 2
    asked = list(rows(chosen, given.names))
    if given.list:
        for package, method in asked:
            said = package.said
            why = stale(kept(method), package.declaration(method))
            told = f"to be graded: {why}" if why else "graded"
            print(f"{method}: {said['package']} {said['version']}, {said['language']}; {told}")
        return 0
    # A program that waits for its own threads shall not take the processor from the others.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    failed = 0 if given.page else run(asked, given)
    if not given.build and not given.no_page:
        print(page(plain=given.plain))
    return int(failed > 0)


def parser() -> argparse.ArgumentParser:
    """What the program can be told."""
    told = argparse.ArgumentParser(
        description="Build and grade the league's packages, and write the page to choose by. "
        "What is built, and what has a report of today, is left alone: --list says which that is.",
        epilog="ISOGRADE_LEAGUE: a folder of packages that are built already. "
        "ISOGRADE_DATA: the folder of real scans.",
    )
    told.add_argument("names", nargs="*", help="packages or methods; all unless said")
    told.add_argument("--list", action="store_true", help="name the methods, and do nothing")
    told.add_argument("--build", action="store_true", help="build only")
    told.add_argument("--anew", action="store_true", help="grade also what has a report of today")
    told.add_argument("--because", default="asked for", help=argparse.SUPPRESS)
    told.add_argument("--again", action="store_true", help="the same, and build anew before")
    told.add_argument("--page", action="store_true", help="write the page of what is there")
    told.add_argument("--no-page", action="store_true", help="grade, and do not write the page")
    told.add_argument("--plain", action="store_true", help="do not pack that page")
    told.add_argument(
        "--redeclare",
        action="store_true",
        help="hold against a graded method what its recipe promises now: not_promised alone",
    )
    told.add_argument("--only", nargs="*", default=[], help="globs of claims or cases")
    told.add_argument(
        "--at-once", type=_many, default=processors(), metavar="N",
        help="methods that are graded at a time; as many as processors unless said",
    )  # fmt: skip
    told.add_argument(
        "--jobs", type=_many, default=1, metavar="N", help="processes for each; 1 unless said"
    )
    return told


def _many(text: str) -> int:
    """A number of at least one."""
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return number


def run(asked: Sequence[tuple[Package, str]], given: argparse.Namespace) -> int:
    """Everything asked for is built and graded, several at a time; how many rows are broken."""
    chosen = {package.name: package for package, _ in asked}
    with ThreadPoolExecutor(given.at_once) as pool:
        ready = pool.map(lambda package: _built(package, given), chosen.values())
        built = {name for name, is_built in zip(chosen, ready, strict=True) if is_built}
        left = [row for row in asked if row[0].name in built]
        failed = len(asked) - len(left)
        if given.build:
            return failed
        # Whatever ends a run early, most rows are done by then.
        left.sort(key=lambda row: seconds_before(row[1]))
        return failed + sum(
            not done for done in pool.map(lambda row: _done(row[0], row[1], given), left)
        )


def _built(package: Package, given: argparse.Namespace) -> bool:
    """Whether a package is built; where it is not, the reason is kept and printed."""
    reason = package.failed()
    try:
        if given.again:
            print(f"{package.name}: building", flush=True)
            build(package)
        elif not given.redeclare:
            provide(package)
    except LeagueError as error:
        _keep(reason, f"{package.name}: {error}")
        return False
    reason.unlink(missing_ok=True)
    return True


def _done(package: Package, method: str, given: argparse.Namespace) -> bool:
    """Whether a method has its report; where it has not, the reason is kept and printed."""
    reason = package.failed(method)
    if given.redeclare:
        why = "what it promises"
    elif given.anew or given.again:
        why = given.because
    else:
        why = stale(kept(method), package.declaration(method))
    if not why:
        return True
    reason.unlink(missing_ok=True)
    try:
        if given.redeclare:
            redeclare(package, method)
        elif given.at_once == 1:
            print(f"{method}: grading ({why})", flush=True)
            grade(package, method, given.only, given.jobs)
        elif ended := apart(method, why, given):
            if not reason.exists():
                _keep(reason, f"{method}: the process that graded it ended with status {ended}")
            return False
    except LeagueError as error:
        _keep(reason, str(error))
        return False
    return True


def _keep(place: Path, reason: str) -> None:
    """The reason is printed, and stands where the page finds it."""
    print(reason, file=sys.stderr, flush=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(f"{reason}\n", encoding="utf-8")


if __name__ == "__main__":
    os.chdir(ROOT)  # The programs are named from here.
    sys.exit(main())
