"""What `isograde new` does: a project in some language that `isograde check` accepts at once.

The kits stand beside the package in a checkout, and inside it once it is installed. A kit is a file
that speaks the protocol (`isograde explain exec`), a marching cubes with its table, and a program
``run`` that builds what changed and answers requests.
"""

from __future__ import annotations

import difflib
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rich.markup import escape

import isograde
from isograde.commands.console import Exit, say, stop


@dataclass(frozen=True)
class Kit:
    """A kit for one language.

    language : its name in a sentence
    tools : the commands that build and run it
    speaks : the file that speaks the protocol
    extracts : the file with the marching cubes, to be replaced
    others : the rest of the project
    names : other names of the language
    """

    language: str
    tools: tuple[str, ...]
    speaks: str
    extracts: str
    others: tuple[str, ...]
    names: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """Every file of the project."""
        return (self.speaks, self.extracts, *self.others, "run")


KITS: Mapping[str, Kit] = {
    "c": Kit("C", ("cc",), "isograde.h", "marching_cubes.c", ("table.h",)),
    "cpp": Kit(
        "C++", ("c++",), "isograde.hpp", "marching_cubes.cpp", ("table.hpp",), ("c++", "cxx")
    ),
    "rust": Kit(
        "Rust",
        ("cargo",),
        "src/isograde.rs",
        "src/main.rs",
        ("src/table.rs", "Cargo.toml", "rustfmt.toml"),
        ("rs",),
    ),
    "go": Kit(
        "Go", ("go",), "isograde.go", "marching_cubes.go", ("table.go", "go.mod"), ("golang",)
    ),
    "java": Kit("Java", ("javac", "java"), "Isograde.java", "MarchingCubes.java", ("Table.java",)),
    "javascript": Kit(
        "JavaScript",
        ("node",),
        "isograde.mjs",
        "marching_cubes.mjs",
        ("table.mjs",),
        ("js", "typescript", "ts", "node"),
    ),
}


def new(language: str, folder: Path) -> None:
    """The folder holds a project in the language, and what to do with it is told."""
    kit, place = KITS[kit_named(language)], folder_of(kit_named(language))
    missing = [tool for tool in kit.tools if shutil.which(tool) is None]
    try:
        write(kit, place, folder)
    except OSError as error:
        stop(Exit.WRONG_USE, f"{folder}: {error.strerror or error}; name a new folder")
    spec = f"exec:{shlex.quote(str(folder / 'run'))}"
    say(f"[bold]{escape(str(folder))}[/] has a marching cubes in {kit.language}:")
    say(f"  {escape(kit.extracts)}  put your own extractor in its place")
    say(f"  {escape(kit.speaks)}  reads requests and answers them")
    say("  run  builds what changed, and answers")
    if missing:
        say(f"[yellow]not found here: {', '.join(missing)}; install it first[/]")
    say(f"Try it: [bold]isograde check {escape(shlex.quote(spec))}[/]")


def kit_named(language: str) -> str:
    """The name of the kit for this language; stops the command where there is none.

    >>> kit_named("C++"), kit_named("ts")
    ('cpp', 'javascript')
    """
    known = {other: name for name, kit in KITS.items() for other in (name, *kit.names)}
    wanted = language.lower()
    if wanted in ("python", "py"):
        stop(Exit.WRONG_USE, "a Python function needs no kit: isograde explain python")
    if wanted not in known:
        close = difflib.get_close_matches(wanted, known, n=1)
        hint = f"did you mean {close[0]}? There" if close else "there"
        told = f"no kit for {language!r}; {hint} are {', '.join(KITS)}"
        stop(Exit.WRONG_USE, f"{told}; for any other language see isograde explain exec")
    return known[wanted]


def folder_of(name: str) -> Path:
    """Where the kit of this name stands: inside the installed package, or beside it."""
    package = Path(isograde.__file__).parent
    places = (package / "kits" / name, package.parent / "kits" / name)
    return next(place for place in places if place.is_dir())


def write(kit: Kit, source: Path, folder: Path) -> None:
    """The kit's files are in the folder; raises `OSError` where that is not new or empty."""
    folder.mkdir(parents=True, exist_ok=True)
    if any(folder.iterdir()):
        raise FileExistsError(None, "it is not empty")
    for name in kit.files:
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(source / name, folder / name)
    (folder / "run").chmod(0o755)
