"""The command `isograde`.

Exit status: 0 every promise that could be tested holds, 1 one is broken, 2 wrong use, 3 the
implementation did not start, 4 nothing was judged that could have failed.
"""

from __future__ import annotations

import math
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

import isograde
from isograde.commands.console import Exit, stop


def _uncoerced(option: Any) -> Any:
    """The help option, False where it is not given, so that no value has to be coerced.

    Coercion takes pydantic, which takes as long to import as NumPy.
    """
    if option is not None:
        option.default = False
    return option


class QuickGroup(TyperGroup):
    """A group of commands that is quick to start."""

    def get_help_option(self, ctx: Any) -> Any:
        """The option ``--help``."""
        return _uncoerced(super().get_help_option(ctx))


class QuickCommand(TyperCommand):
    """A command without parameters that is quick to start."""

    def get_help_option(self, ctx: Any) -> Any:
        """The option ``--help``."""
        return _uncoerced(super().get_help_option(ctx))


app = typer.Typer(
    name="isograde",
    cls=QuickGroup,
    invoke_without_command=True,
    no_args_is_help=True,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    # Plain help: what draws boxes round it takes longer to import than all the rest.
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Grade an isosurface extractor: what it guarantees, and the smallest case that breaks it.",
    epilog="Start with `isograde check python:mine:extract`, then `isograde grade "
    "python:mine:extract`. Exit status: 0 every promise that could be tested holds, 1 one is "
    "broken, 2 wrong use, 3 the implementation did not start, 4 nothing was judged that could have "
    "failed.",
)


class Format(StrEnum):
    """What `isograde grade` writes beside the JSON lines."""

    HTML = "html"
    MARKDOWN = "md"
    JUNIT = "junit"
    BADGE = "badge"
    SHIELDS = "shields"


class Space(StrEnum):
    """The two ways of counting positions in a patient."""

    RAS = "RAS"
    LPS = "LPS"


@app.callback()
def isograde_(
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Grade an isosurface extractor: what it guarantees, and the smallest case that breaks it."""
    if version:
        print(f"isograde {isograde.__version__}")
        raise typer.Exit


def _finite(value: float | None) -> float | None:
    """The number of seconds; a usage error for one that never ends."""
    if value is not None and not math.isfinite(value):
        raise typer.BadParameter(f"{value} is no number of seconds that ends; write 3600 for long")
    return value


GRADE_HELP = "python:module:function, exec:command, dir:path, or a ready-made name (list them)."
Spec = Annotated[str, typer.Argument(metavar="IMPLEMENTATION", help=GRADE_HELP)]
PACKED_HELP = "Pages of a sixth of the size, which the browser unpacks."


@app.command()
def grade(
    implementation: Annotated[
        str | None, typer.Argument(metavar="IMPLEMENTATION", help=GRADE_HELP)
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Every ready-made implementation, and a comparison.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report: report, or report/only with --only.")
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Every case, and many more in every way.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Other numbers under the same ids.")] = 0,
    only: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Claims or cases with such an id.")
    ] = None,
    timeout: Annotated[
        float, typer.Option(min=0.01, callback=_finite, help="Seconds a call may take.")
    ] = 30.0,
    memory: Annotated[int, typer.Option(min=16, help="Megabytes it may hold.")] = 4096,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Processes; by default as many as processors.")
    ] = None,
    formats: Annotated[
        list[Format] | None,
        typer.Option("--format", help="Beside the JSON lines; by default all of them."),
    ] = None,
    packed: Annotated[bool, typer.Option("--packed", help=PACKED_HELP)] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="A promised claim without evidence fails too, and so does an expected failure "
            "that does not happen.",
        ),
    ] = False,
    cases: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Cases of your own, as isograde search keeps them."),
    ] = None,
    budget: Annotated[
        float | None,
        typer.Option(
            min=1,
            callback=_finite,
            help="Seconds in all; the report has what was judged by then.",
        ),
    ] = None,
    resume: Annotated[
        bool | None,
        typer.Option(
            "--resume/--fresh",
            help="Insist on going on with a run that was stopped, or begin anew; by default "
            "the same command goes on where it was.",
        ),
    ] = None,
    expect: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Failures that are known.")
    ] = None,
    write_expect: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write what fails, to be expected.")
    ] = None,
    shard: Annotated[
        str | None, typer.Option(metavar="I/N", help="The I-th of N parts of the cases.")
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Judge by the workers of this scheduler, tcp://host:8786."
        ),
    ] = None,
) -> None:
    """Grade an implementation and write the report."""
    if everything == (implementation is not None):
        stop(Exit.WRONG_USE, "name one implementation, or --all")
    if everything and (expect or write_expect or shard):
        stop(Exit.WRONG_USE, "--expect, --write-expect and --shard are for one implementation")
    from isograde.commands import grading
    from isograde.model import Limits
    from isograde.runner import Options, processors

    limits = Limits(timeout, memory)
    own = tuple(cases or ())
    jobs = jobs or processors()
    part = grading.shard_named(shard)
    options = Options(seed, full, tuple(only or ()), limits, jobs, own, budget, part, dask)
    kinds = [kind.value for kind in formats or Format]
    out = out or Path("report/only" if only else "report")
    if implementation is None:
        grading.grade_all(options, out, kinds, strict, resume, pack=packed)
    else:
        known = grading.Known(expect, write_expect)
        grading.grade_one(implementation, options, out, kinds, strict, resume, known, pack=packed)


@app.command(name="search")
def search_(
    implementation: Spec,
    minutes: Annotated[float, typer.Option(min=0.05, max=10_000, help="How long to look.")] = 5.0,
    cases: Annotated[
        Path, typer.Option(metavar="FILE", help="Where to keep what is found; added to.")
    ] = Path("isograde-cases.json"),
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="GLOB", help="Claims to break; by default all that are promised."),
    ] = None,
    known: Annotated[
        Path | None,
        typer.Option(metavar="REPORT", help="Leave out claims that failed in this report."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Other fields.")] = 0,
    timeout: Annotated[
        float, typer.Option(min=0.01, callback=_finite, help="Seconds a call may take.")
    ] = 10.0,
    memory: Annotated[int, typer.Option(min=16, help="Megabytes it may hold.")] = 4096,
) -> None:
    """Look for failures that the plan does not contain, and keep them for grade --cases."""
    from isograde.commands import searching
    from isograde.model import Limits

    limits = Limits(timeout, memory)
    searching.search(implementation, minutes, cases, tuple(only or ()), known, seed, limits)


@app.command(name="bench")
def bench_(
    implementation: Annotated[
        str,
        typer.Argument(
            metavar="IMPLEMENTATION",
            help="python:module:function, exec:command, or a ready-made name (list them).",
        ),
    ],
    against: Annotated[
        str | None,
        typer.Option(metavar="OTHER", help="The peer; by default a library that is installed."),
    ] = None,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder of the page.")] = (
        Path("bench")
    ),
    rounds: Annotated[int, typer.Option(min=1, max=1000, help="Rounds a field, at most.")] = 7,
    quick: Annotated[
        bool, typer.Option("--quick", help="Small fields and few rounds: does it run at all?")
    ] = False,
    timeout: Annotated[
        float, typer.Option(min=0.01, callback=_finite, help="Seconds a call may take.")
    ] = 30.0,
    memory: Annotated[int, typer.Option(min=16, help="Megabytes it may hold.")] = 4096,
) -> None:
    """Time it beside a peer, in turn: against samples, active cells and vertices, with plots."""
    from isograde.benching import Plan
    from isograde.commands import benching
    from isograde.model import Limits

    plan = Plan(min(rounds, 3), 1.0, True) if quick else Plan(rounds)
    benching.run(implementation, against, out, plan, Limits(timeout, memory))


@app.command(name="check")
def check_(
    implementation: Spec,
    timeout: Annotated[
        float, typer.Option(min=0.01, callback=_finite, help="Seconds a call may take.")
    ] = 10.0,
) -> None:
    """Try the adapter in a few seconds, with advice on each mistake and a declaration to paste."""
    from isograde.commands import checking

    checking.check(implementation, timeout)


@app.command()
def new(
    language: Annotated[
        str, typer.Argument(metavar="LANGUAGE", help="c, cpp, rust, go, java, javascript.")
    ],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder.")],
) -> None:
    """Write a project in another language, with a marching cubes that `check` accepts at once."""
    from isograde.commands import kits

    kits.new(language, folder)


@app.command(name="export")
def export_(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder.")],
    full: Annotated[bool, typer.Option("--full", help="Every case.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Other numbers under the same ids.")] = 0,
    only: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Claims or cases with such an id.")
    ] = None,
    variants: Annotated[
        bool, typer.Option("--variants", help="Every way a case is posed, not only the plain one.")
    ] = False,
    kinds: Annotated[
        list[str] | None,
        typer.Option(
            "--kind", help="surfaces (unless said), contours, curves, or n,m such as 4,2."
        ),
    ] = None,
) -> None:
    """Write the fields as files, to be judged later as dir:DIR."""
    from isograde.commands import exporting
    from isograde.runner import Options

    asked = Options(seed, full, tuple(only or ()))
    exporting.export(folder, asked, variants, kinds or ["surfaces"])


@app.command(name="frequencies")
def frequencies_(
    volume: Annotated[str, typer.Argument(metavar="VOLUME", help="A file, or a known data set.")],
    isovalue: Annotated[float, typer.Option(help="Value of the surface.")],
) -> None:
    """Count the configurations of the cells, as Table 1 of Nielson & Hamann."""
    from isograde.commands import volumes

    volumes.frequencies(volume, isovalue)


@app.command()
def explain(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="A claim, a family of claims or of cases, or a way in: python, function, exec, "
            "protocol, dir, declaration. Without one, what there is.",
        ),
    ] = None,
) -> None:
    """Say what a claim or a family of cases is, or how to write an implementation."""
    from isograde.commands import listings

    if name is None:
        listings.explained()
    else:
        listings.explain(name)


# A group of commands without parameters, since what checks parameters takes long to import.
lists = typer.Typer(
    cls=QuickGroup, no_args_is_help=True, help="List claims, cases, implementations or levels."
)
app.add_typer(lists, name="list")


@lists.command(cls=QuickCommand)
def claims() -> None:
    """List every claim: its level, the kinds it can be said of, its rule."""
    from isograde.commands import listings

    listings.claims()


@lists.command(cls=QuickCommand)
def cases() -> None:
    """List every case: its kind, its size, and when it runs."""
    from isograde.commands import listings

    listings.cases()


@lists.command(cls=QuickCommand)
def implementations() -> None:
    """List every ready-made name, and which of their packages are not installed."""
    from isograde.commands import listings

    listings.implementations()


@lists.command(cls=QuickCommand)
def levels() -> None:
    """List the levels and what each guarantees."""
    from isograde.commands import listings

    listings.levels()


@app.command()
def diff(before: Path, after: Path) -> None:
    """Show what changed between two reports; status 1 where a case broke."""
    from isograde.commands import comparing

    comparing.diff(before, after)


@app.command()
def join(
    files: Annotated[list[Path], typer.Argument(metavar="REPORT...", help="Every part.")],
    out: Annotated[Path, typer.Option(help="Folder of the joined report.")] = Path("report"),
    formats: Annotated[
        list[Format] | None,
        typer.Option("--format", help="Beside the JSON lines; by default all of them."),
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="As of `isograde grade`.")] = False,
) -> None:
    """Join the parts of a run that was cut with --shard, and write the whole report."""
    from isograde.commands import grading

    grading.join_parts(files, out, [kind.value for kind in formats or Format], strict)


@app.command()
def render(
    files: Annotated[
        list[Path], typer.Argument(metavar="REPORT...", help="Reports, or their folders.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where to; by default beside each report.")
    ] = None,
    formats: Annotated[
        list[Format] | None, typer.Option("--format", help="By default the page alone.")
    ] = None,
    packed: Annotated[bool, typer.Option("--packed", help=PACKED_HELP)] = False,
) -> None:
    """Write the pages of reports again, from their JSON lines."""
    from isograde.commands import rendering

    kinds = [kind.value for kind in formats or [Format.HTML]]
    rendering.render(files, out, kinds, pack=packed)


@app.command()
def dossier(
    implementation: Annotated[
        str | None,
        typer.Argument(metavar="IMPLEMENTATION", help="As of grade; or a report, or its folder."),
    ] = None,
    out: Annotated[Path, typer.Option("-o", "--out", help="The document, a .pdf or .html.")] = Path(
        "dossier.pdf"
    ),
    verify: Annotated[
        Path | None,
        typer.Option(metavar="DOSSIER", help="Check one that was filed, and do nothing else."),
    ] = None,
    sign: Annotated[
        str | None, typer.Option(metavar="KEY", help="A key of GnuPG to sign the checksums with.")
    ] = None,
    full: Annotated[bool, typer.Option("--full", help="As of isograde grade.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="As of isograde grade.")] = 0,
    only: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="As of isograde grade.")
    ] = None,
    timeout: Annotated[float, typer.Option(min=0.01, help="Seconds a call may take.")] = 30.0,
    memory: Annotated[int, typer.Option(min=16, help="Megabytes it may hold.")] = 4096,
) -> None:
    """Make a document to file, with everything it rests on, or check one."""
    if (implementation is None) == (verify is None):
        stop(Exit.WRONG_USE, "name an implementation or a report, or --verify a dossier")
    from isograde.commands import dossiers
    from isograde.model import Limits
    from isograde.runner import Options, processors

    if verify is not None:
        dossiers.verify(verify)
    assert implementation is not None
    limits = Limits(timeout, memory)
    options = Options(seed, full, tuple(only or ()), limits, processors())
    dossiers.make(implementation, options, out, sign)


@app.command()
def compare(
    files: Annotated[list[Path], typer.Argument(metavar="REPORT...")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="An .html or .md file.")] = None,
    choose: Annotated[
        bool, typer.Option("--choose", help="The page to choose by instead, a row each: .html.")
    ] = False,
    packed: Annotated[bool, typer.Option("--packed", help=PACKED_HELP)] = False,
) -> None:
    """Lay reports side by side: claims down, implementations across."""
    from isograde.commands import comparing

    comparing.compare(files, out, choose=choose, pack=packed)


@app.command()
def exercise(
    number: Annotated[int, typer.Argument(metavar="NUMBER", help="That of its lesson.")],
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="Your file; without it one is given.")
    ] = None,
) -> None:
    """Give an exercise of the course, a broken extractor; or say what is still wrong with yours."""
    from isograde.commands import exercising

    exercising.exercise(number, file)


@app.command()
def submissions(
    folder: Annotated[
        Path,
        typer.Argument(metavar="FOLDER", help="NAME/exercise_N.py, or NAME_exercise_N.py, ..."),
    ],
    exercise: Annotated[
        list[int] | None,
        typer.Option("-e", "--exercise", metavar="N", help="Judge this one; again for more."),
    ] = None,
    out: Annotated[
        list[Path] | None,
        typer.Option("-o", "--out", metavar="FILE", help="The table as .csv or .md; both may be."),
    ] = None,
    timeout: Annotated[
        float, typer.Option(metavar="SECONDS", min=1, help="For all calls of one submission.")
    ] = 60.0,
    jobs: Annotated[int, typer.Option("-j", "--jobs", min=1, help="Judged at a time.")] = 1,
) -> None:
    """Judge the exercises that a class handed in: a row each, mended or what is still wrong."""
    from isograde.commands import submitting

    submitting.submissions(folder, exercise or (), out or (), timeout, jobs)


@app.command()
def extract(
    volume: Annotated[
        str, typer.Argument(metavar="VOLUME", help="A file, a DICOM folder, or a known data set.")
    ],
    isovalue: Annotated[
        list[float] | None, typer.Option(help="Value of the surface; several make several files.")
    ] = None,
    label: Annotated[
        list[float] | None, typer.Option(help="In place of an isovalue: the samples that are this.")
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(help="Of isoref: asymptotic-decider unless said; for labels label-cubes."),
    ] = None,
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="ply obj off stl glb 3mf vtp vtk vtu msh npz, ..."),
    ] = Path("mesh.ply"),
    cap: Annotated[
        bool, typer.Option("--cap", help="Close it on the border and beside absent samples.")
    ] = False,
    absent: Annotated[
        bool, typer.Option("--absent", help="NaN and infinity mean no sample, and are no error.")
    ] = False,
    clean: Annotated[
        bool, typer.Option("--clean", help="Remove triangles without area, where it does no harm.")
    ] = False,
    space: Annotated[
        Space | None, typer.Option(help="Write RAS or LPS; by default what the file is in.")
    ] = None,
    dataset: Annotated[
        str | None,
        typer.Option(help="The array to take: of HDF5, Zarr, npz, VTK, or a DICOM series."),
    ] = None,
    shape: Annotated[
        str | None, typer.Option(metavar="NX,NY,NZ", help="Of a raw file, x fastest.")
    ] = None,
    dtype: Annotated[
        str | None, typer.Option("--type", help="Of a raw file: uint8, >i2, float32, ...")
    ] = None,
    spacing: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="In place of the file's.")
    ] = None,
    frames: Annotated[
        str | None,
        typer.Option(
            metavar="WHICH",
            help="Of a time series: all, a number from 0 on, or FIRST:STOP; a numbered file each.",
        ),
    ] = None,
    by_planes: Annotated[
        bool,
        typer.Option(
            "--by-planes",
            help="Volumes and meshes larger than memory: npy raw h5 zarr to ply, cube rules.",
        ),
    ] = False,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="By the workers of this scheduler, tcp://host:8786."),
    ] = None,
) -> None:
    """Extract an isosurface with the reference, where the volume stands, as a mesh file."""
    from isograde.commands import volumes

    wanted = volumes.Wanted(
        tuple(isovalue or ()),
        tuple(label or ()),
        method,
        cap,
        absent,
        clean,
        space.value if space else None,
        volumes.frames_named(frames),
    )
    asked = volumes.asked(dataset, shape, dtype, spacing)
    if dask is not None:
        volumes.extract_by_dask(volume, wanted, out, asked, dask)
    elif by_planes:
        volumes.extract_by_planes(volume, wanted, out, asked)
    else:
        volumes.extract(volume, wanted, out, asked)


@app.command(name="prove")
def prove_(
    rule: Annotated[
        str, typer.Argument(metavar="RULE", help="A rule of isoref, or python:module:RULE.")
    ],
    why: Annotated[bool, typer.Option("--why", help="Also print the argument.")] = False,
    shown: Annotated[int, typer.Option(min=0, help="How many faults of a kind to list.")] = 8,
    trials: Annotated[
        int, typer.Option(min=1, help="On how many pairs of cells to try the decisions.")
    ] = 60_000,
    certificate: Annotated[
        Path | None, typer.Option(help="A file for what was enumerated, to be checked by anyone.")
    ] = None,
) -> None:
    """Prove by enumeration that a cube rule is closed and manifold on every field."""
    from isograde.commands import proving

    proving.prove(rule, why, shown, trials, certificate)


def main() -> None:
    """Run the command. A fault of its own is none of the documented statuses, nor is Ctrl-C."""
    try:
        app()
    except Exception:  # noqa: BLE001 - shown whole, and told apart from claims that fail
        from isograde.commands.console import errors

        errors.print_exception()
        sys.exit(Exit.BROKEN)


if __name__ == "__main__":
    main()
