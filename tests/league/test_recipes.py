"""The league: whole recipes, known declarations; three packages are built and called."""

import shutil
from copy import deepcopy
from functools import partial
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from isograde.adapters import open_adapter
from isograde.checking import check
from isograde.declaration import declaration_from
from isograde.model import CURVES, SURFACES, Limits
from isograde.report.packed import unpacked
from isograde.report.reading import read

from tests.loading import module_at

HERE = Path(__file__).parents[2] / "validation" / "league"


def _league() -> ModuleType:
    """The program, which is in no package."""
    return module_at(HERE / "league.py", "league")


league = _league()
PACKAGES = {package.name: package for package in league.packages()}
WORDS = {44: "Forty-four"}
METHODS = [(name, method) for name, package in PACKAGES.items() for method in package.methods]


def test_there_are_as_many_methods_packages_and_languages_as_the_readme_says() -> None:
    """Issue 16: at least 35 methods of 25 packages in six languages, and no name twice."""
    assert len(METHODS) >= 35
    assert len(PACKAGES) >= 25
    assert len({package.said["language"] for package in PACKAGES.values()}) >= 6
    told = (HERE / "README.md").read_text(encoding="utf-8")
    assert f"{WORDS[len(METHODS)]} methods of {len(PACKAGES)} packages" in told
    others = {name.split(":")[0] for name in league.ready_made_names()} - {"isoref"}
    known = {(package.said["package"], package.said["language"]) for package in PACKAGES.values()}
    about = league.about()
    more = {(about[n].package, about[n].language) for n in about if n.split(":")[0] in others}
    assert f"those of {len(known | more)} packages" in told
    names = [method for _, method in METHODS]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", PACKAGES)
def test_a_recipe_says_what_a_reader_who_chooses_asks_for(name: str) -> None:
    """Version, languages, licence and what it allows, homepage, how it is installed."""
    said = PACKAGES[name].said
    for word in ("package", "version", "language", "written_in", "licence", "homepage"):
        assert said[word], word
    assert said["use"] in league.USES
    (how,) = {"pip", "npm", "cargo", "debian"} & set(said["install"])
    wanted = " ".join(said["install"][how])
    assert how == "debian" or said["version"] in wanted, "the version is not the one installed"


@pytest.mark.parametrize(("name", "method"), METHODS)
def test_a_declaration_is_in_the_words_of_the_schema(name: str, method: str) -> None:
    """The four words, conventions and limits; and the function that is called is in the adapter."""
    declared = declaration_from(PACKAGES[name].declaration(method), method)
    assert declared.name == method
    said = PACKAGES[name].said["methods"][method]
    assert said["calls"]
    if function := said.get("function"):
        (adapter,) = [*(HERE / name).glob("adapter.*"), *(HERE / name).glob("src/main.rs")]
        assert function in adapter.read_text(encoding="utf-8")


def test_the_page_knows_every_method_and_every_ready_made_library() -> None:
    """Language and licence stand beside each; ours are described by the project itself."""
    known = league.about()
    assert {method for _, method in METHODS} <= set(known)
    assert known["skimage:lewiner"].licence == "BSD-3-Clause"


def test_an_unknown_name_is_told_with_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    """Wrong use, status 2."""
    assert league.main(["nobody"]) == 2
    assert "no nobody; there are" in capsys.readouterr().err


def test_what_cannot_be_built_costs_its_own_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program that is not there is named; the reason is kept where the page finds it."""
    monkeypatch.setattr(league, "BUILT", tmp_path)
    monkeypatch.setattr(league.shutil, "which", lambda name: None)
    assert league.main(["octave", "--build"]) == 1
    assert "no octave-cli" in (tmp_path / "octave" / "failed.txt").read_text()


def test_a_method_whose_process_dies_costs_its_own_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The others are graded, those first that took least before; the reason is kept."""
    monkeypatch.setattr(league, "BUILT", tmp_path)
    monkeypatch.setattr(league, "provide", lambda package: None)
    took = {"gts": 5.0, "gts-tetra": 2.0, "gts-tetra-bcl": 9.0, "gts-tetra-bounded": 7.0}
    monkeypatch.setattr(league, "seconds_before", took.__getitem__)
    one_by_one = partial(league.ThreadPoolExecutor, 1)
    monkeypatch.setattr(league, "ThreadPoolExecutor", lambda at_once: one_by_one())
    tried = []

    def apart(method: str, why: str, given: object) -> int:
        tried.append(method)
        return -9 * (method == "gts")

    monkeypatch.setattr(league, "apart", apart)
    monkeypatch.setattr(league, "stale", lambda path, declared: "a reason")
    given = league.parser().parse_args(["gts", "--at-once", "2"])
    assert league.run(list(league.rows([PACKAGES["gts"]], ())), given) == 1
    assert tried == ["gts-tetra", "gts", "gts-tetra-bounded", "gts-tetra-bcl"]
    told = (tmp_path / "gts" / "failed-gts.txt").read_text()
    assert "ended with status -9" in told
    assert len(list((tmp_path / "gts").glob("failed-*"))) == 1


def test_a_report_of_another_plan_or_declaration_is_made_anew(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """So a run that was cut off goes on with those that are left."""
    method = "fast-surface-nets"
    said = PACKAGES["fast_surface_nets"].declaration(method)
    path = league.REPORTS / f"{method}.jsonl.gz"
    header = next(league.lines(path))
    monkeypatch.setattr(league, "PLAN", header["plan"])
    monkeypatch.setattr(league, "scans", frozenset)
    assert not league.stale(path, said)
    otherwise = {"tie": "outside", "nan": "raises"}
    assert "conventions" in league.stale(path, {**said, "conventions": otherwise})
    assert "version" in league.stale(path, {**said, "version": "9"})
    monkeypatch.setattr(league, "scans", lambda: frozenset({"real/one-that-came"}))
    assert "without 1 of the scans" in league.stale(path, said)
    monkeypatch.setattr(league, "PLAN", header["plan"] + 1)
    assert "of plan" in league.stale(path, said)
    assert league.stale(tmp_path / "none.jsonl.gz", said) == "there is no report"


def test_todays_recipe_is_laid_into_what_is_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Another declaration does not install anything again; another version does."""
    monkeypatch.setattr(league, "BUILT", tmp_path)
    package = PACKAGES["vedo"]
    built = []
    monkeypatch.setattr(league, "build", lambda package: built.append(package.name))
    league.provide(package)
    assert built == ["vedo"]
    league.lay(package)
    (package.built / "ready").write_text(package.installs, encoding="utf-8")
    said = deepcopy(package.said)
    said["methods"]["vedo"]["declaration"] = {"conventions": {"nan": "raises"}}
    league.provide(league.Package(package.folder, said))
    assert "raises" in (package.built / "vedo.json").read_text(encoding="utf-8")
    assert {path.name for path in package.built.iterdir()} >= {"adapter.py", "serve.py"}
    assert built == ["vedo"]
    league.provide(league.Package(package.folder, {**said, "version": "9"}))
    assert built == ["vedo", "vedo"]


def test_what_was_built_elsewhere_serves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A link, so that reports name no folder of a machine; never in the place of another."""
    here, there = tmp_path / ".league", tmp_path / "there"
    monkeypatch.setattr(league, "BUILT", here)
    monkeypatch.setenv("ISOGRADE_LEAGUE", str(there))
    assert league.main(["--list"]) == 2
    assert "there is no such folder" in capsys.readouterr().err
    there.mkdir()
    league.linked()
    assert here.resolve() == there
    league.linked()
    monkeypatch.setenv("ISOGRADE_LEAGUE", str(tmp_path))
    with pytest.raises(league.LeagueError, match="remove one"):
        league.linked()


def test_what_was_graded_on_fewer_scans_stands_beside_no_other() -> None:
    """Issue 16: one scoring and one denominator; the reason stands in its row."""

    def made(name: str, *cases: str) -> SimpleNamespace:
        said = {case: {"tags": ["real"] if case.startswith("real/") else []} for case in cases}
        return SimpleNamespace(name=name, kinds=(SURFACES,), cases=said)

    whole = made("whole", "noise/0", "real/head", "real/tooth")
    curves = SimpleNamespace(name="curves", kinds=(CURVES,), cases={})
    assert league.fewer_scans([whole, curves, made("some", "noise/0", "real/head")]) == {
        "some": "graded without 1 of the 2 scans (ISOGRADE_DATA)"
    }
    assert league.fewer_scans([]) == {}


def test_versions_of_unlike_plans_are_not_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A library of which some versions are graded anew, and some not yet, has no trend."""
    monkeypatch.setattr(league, "VERSIONS", tmp_path)
    plans = {"vtk-1": 3, "vtk-2": 3, "libigl-1": 3, "libigl-2": 4}
    for name in plans:
        (tmp_path / f"{name}.jsonl.gz").touch()

    def made(path: Path) -> SimpleNamespace:
        name = path.name.removesuffix(".jsonl.gz")
        return SimpleNamespace(name=name.split("-")[0], plan=plans[name])

    monkeypatch.setattr(league, "read", made)
    links = [link for _, link in league.versions()]
    assert links == [f"{tmp_path.name}/vtk-1.html", f"{tmp_path.name}/vtk-2.html"]


def test_a_grade_that_did_not_end_is_told_in_the_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(league, "REPORTS", tmp_path)
    assert league.begun("octave") == ""
    (tmp_path / "unfinished-octave.jsonl").touch()
    assert league.begun("octave").endswith("a grade of it was begun, and did not end")


@pytest.mark.slow
def test_a_promise_withdrawn_changes_what_is_held_and_nothing_that_was_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Taken back and withdrawn again, the report is what it was; more than that is graded again."""
    monkeypatch.setattr(league, "REPORTS", tmp_path)
    method = "fast-surface-nets"
    kept = HERE.parents[1] / "reports" / "league" / f"{method}.jsonl.gz"
    shutil.copy(kept, tmp_path)
    before = read(kept)
    package = PACKAGES["fast_surface_nets"]
    said = deepcopy(package.said)
    said["methods"][method]["declaration"]["not_promised"].remove("symmetry.orientation")
    league.redeclare(league.Package(package.folder, said), method)
    held = read(tmp_path / f"{method}.jsonl.gz")
    assert {one.id for one in held.broken} - {one.id for one in before.broken} == {
        "symmetry.orientation"
    }
    league.redeclare(package, method)
    # The declaration and the claims have the words of today, of which some may be new.
    again = read(tmp_path / f"{method}.jsonl.gz")
    found, kept_before = (
        [one for one in report.records if one["record"] not in ("header", "claim")]
        for report in (again, before)
    )
    assert found == kept_before
    assert again.declaration["not_promised"] == before.declaration["not_promised"]
    assert {one.id for one in again.broken} == {one.id for one in before.broken}
    said["methods"][method]["declaration"]["conventions"] = {}
    with pytest.raises(league.LeagueError, match="conventions changed: grade it again"):
        league.redeclare(league.Package(package.folder, said), method)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "method", "program"),
    [
        ("marching_cubes_numpy", "marching-cubes-numpy", "python3"),
        ("surface_nets_js", "surface-nets-js", "npm"),
        ("fast_surface_nets", "fast-surface-nets", "cargo"),
    ],
)
def test_a_package_is_built_from_its_registry_and_called_rightly(
    name: str, method: str, program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One in Python, one in JavaScript, one compiled: `check` finds its declaration true.

    Then the program grades it on a few cells, as ``make league`` does on all, and writes the page.
    """
    if shutil.which(program) is None:
        pytest.skip(f"no {program} on this machine")
    monkeypatch.setattr(league, "BUILT", tmp_path)
    package = PACKAGES[name]
    try:
        league.build(package)
    except league.LeagueError as error:
        pytest.skip(f"{name} cannot be had here: {error}")
    spec = f"exec:{tmp_path / name}/run {method}"
    adapter = open_adapter(spec)
    try:
        assert adapter.open(Limits(60, 4096)).name == method
    finally:
        adapter.close()
    found = check(spec, timeout=60.0)
    assert found.started
    wrong = [said for word, said in found.told if word == "wrong" and "declare" in said]
    assert not wrong, "what it declares is not what it does"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "README.md").write_text("\n".join(league.MARKS), encoding="utf-8")
    for what in ("ROOT", "READY_MADE", "README", "REPORTS"):
        place = tmp_path / {"ROOT": "", "README": "README.md"}.get(what, what.lower())
        monkeypatch.setattr(league, what, place)
    part = ["--only", "cells/outside/01*", "bodies/3-1/two-spheres-32*"]
    assert league.main([method, "--at-once", "1", *part]) == 0
    page = unpacked((tmp_path / "reports" / "index.html").read_text(encoding="utf-8"))
    assert f'href="./{method}.html"' in page
    assert "not graded yet" in page, "the others keep their rows"
    own = unpacked((tmp_path / "reports" / f"{method}.html").read_text(encoding="utf-8"))
    assert "promises <b>level" in own


def test_the_readme_shows_the_ten_that_come_first() -> None:
    """Twelve lines, which the program writes between two marks."""
    readme = (HERE.parents[1] / "README.md").read_text(encoding="utf-8")
    best = (league.REPORTS / "league.md").read_text(encoding="utf-8")
    assert len(best.splitlines()) == 12
    assert league.between(readme, best) == readme
    with pytest.raises(league.LeagueError, match="has not the marks"):
        league.between("nothing", best)
