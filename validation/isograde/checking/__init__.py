"""What `isograde check` does: an adapter tried in a few seconds, with advice on each mistake.

It asks for one small level set of each declared kind whose place, orientation and size are known,
looks at the arrays that come back, measures the conventions, tries the ways in which an array can
be presented, and judges the claims of levels 0 to 2 on the smallest cases. At the end stands the
declaration to paste, in the four words, as it was measured. Where a plain field is declined, fields
that are cubes, or bytes, or larger, are tried. Nothing that is raised in between ends it: it is
told, and the next thing is tried.

Grading says what is true of the algorithm; this says what is wrong with the call.
"""

from __future__ import annotations

from collections.abc import Iterator

from isograde.adapters import open_adapter
from isograde.adapters.directory import DirectoryAdapter
from isograde.adapters.process import ProcessAdapter
from isograde.checking.checked import Advice, Checked, paste
from isograde.checking.small import small_cases
from isograde.checking.trying import Try
from isograde.declaration import Declaration
from isograde.model import LEVELS, SURFACES, AdapterError, Kind, Limits, UnknownName, Verdict

__all__ = ["Advice", "Checked", "check", "paste"]

# Look at so many kinds, the smallest.
KINDS_TRIED = 3


def check(spec: str, timeout: float = 10.0) -> Checked:
    """What the adapter to `spec` does, one verdict and one sentence of advice each.

    >>> check("no-such-thing").started
    False
    """
    checked = Checked(python=not spec.startswith(("exec:", "dir:")), spec=spec)
    try:
        adapter = open_adapter(spec)
        declaration = adapter.open(Limits(seconds=timeout, megabytes=4096))
    except AdapterError as error:
        known = not isinstance(error, UnknownName)
        return Checked(False, [(Verdict.ERROR, str(error))], known=known)
    try:
        checked.advice.append((Verdict.PASS, _introduced(declaration)))
        if isinstance(adapter, DirectoryAdapter):
            checked.add(_files(adapter), "the folder")
        else:
            assert isinstance(adapter, ProcessAdapter), "every other adapter leads to a process"
            _kinds(checked, adapter, declaration)
    finally:
        adapter.close()
    return checked


def _introduced(declaration: Declaration) -> str:
    """What the implementation says of itself, in a sentence."""
    name = f"{declaration.name} {declaration.version}".rstrip()
    level = min(declaration.level, declaration.top)
    without = ", ".join(sorted(declaration.not_promised))
    return (
        f"it started: {name} promises level {level} ({LEVELS[level][0]})"
        f"{f', but not {without}' if without else ''}"
    )


def _files(adapter: DirectoryAdapter) -> Iterator[Advice]:
    """How many of the exported fields have a mesh, and which cannot be read."""
    answered, unreadable = adapter.answered(), adapter.unreadable()
    yield (
        Verdict.PASS,
        f"{answered} of {adapter.exported()} exported fields have a mesh beside them",
    )
    for name, reason in unreadable:
        yield Verdict.FAIL, f"{name}: {reason}"


def _kinds(checked: Checked, adapter: ProcessAdapter, declaration: Declaration) -> None:
    """Each of the smallest declared kinds is tried; `checked` has the declaration to paste."""
    kinds = sorted((Kind(*kind) for kind in declaration.limits.kinds), key=_size)
    told, nowhere, answered = declaration, False, False
    for kind in kinds[:KINDS_TRIED]:
        trial = Try(adapter, declaration, kind)
        checked.add(trial.calls(), f"{kind}: the calls")
        if trial.answered:
            answered = True
            checked.add(trial.cells(), f"{kind}: single cells")
            told = trial.told(told)
            nowhere = nowhere or trial.misplaced
            if trial.measured is not None and not trial.misplaced:
                known = trial.rows_right or trial.rows_wrong
                rows = trial.rows_right if known else None
                found = small_cases(
                    adapter, told, kind, declaration, rows, trial.within, ended=trial.ended
                )
                checked.add(found, f"{kind}: small cases")
    if len(kinds) > KINDS_TRIED:
        left = len(kinds) - KINDS_TRIED
        checked.advice.append((Verdict.SKIP, f"{left} more kinds that it declares were not tried"))
    # Where a surface is not in its place, or there is none, no declaration helps.
    checked.paste = paste(told, checked.spec) if answered and not nowhere else ""


def _size(kind: Kind) -> tuple[bool, int, int]:
    """What makes a kind small: surfaces first, then fewer axes."""
    return kind != SURFACES, kind.n, kind.m
