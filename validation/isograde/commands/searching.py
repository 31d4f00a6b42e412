"""What `isograde search` does: new failures are looked for, and kept as cases of the user's own."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

import typer
from rich.markup import escape

from isograde.cases import given, own
from isograde.commands.console import Exit, close_to, errors, say, stop
from isograde.model import AdapterError, Claim, Limits
from isograde.report import reading
from isograde.runner import Options, Worker
from isograde.searching import Found, Tally, looked_for
from isograde.searching import search as look

#: A case of at most so many numbers is spelt out.
SPELT_OUT = 27


def search(
    spec: str,
    minutes: float,
    file: Path,
    only: tuple[str, ...],
    known: Path | None,
    seed: int,
    limits: Limits,
) -> None:
    """Failures found in this time are told and in the file; the status is 1 where there are any."""
    try:
        if file.exists():
            own.entries(file)
        failed = _failed(known) if known else ()
        worker = Worker.open(spec, Options(seed=seed, limits=limits))
    except own.OwnCasesError as error:
        stop(Exit.WRONG_USE, f"{error}; name another file with --cases")
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    try:
        claims = looked_for(worker, only, failed)
        if not claims:
            stop(Exit.NO_EVIDENCE, _nothing(worker, only))
        tally = _look(worker, claims, spec, minutes, seed, file)
    finally:
        worker.adapter.close()
    _tell(spec, tally, claims, file)
    raise typer.Exit(Exit.FAILS if tally.found else Exit.HOLDS)


def _failed(known: Path) -> set[str]:
    """The claims that a report says have failed."""
    try:
        return {name for name, one in reading.read(known).summaries.items() if one.failure}
    except (OSError, ValueError) as error:
        stop(Exit.WRONG_USE, f"{known} cannot be read as a report: {error}")


def _nothing(worker: Worker, only: tuple[str, ...]) -> str:
    """Why there is nothing to look for."""
    if only:
        unknown = [
            one for one in only if not any(c in one for c in "*?[") and one not in worker.claims
        ]
        hint = f"; {close_to(unknown[0], worker.claims)}" if unknown else ""
        return f"no claim that drawn fields can be judged by matches {' '.join(only)}{hint}"
    return "every promised claim is known to fail: name one with --only"


def _look(
    worker: Worker, claims: list[Claim], spec: str, minutes: float, seed: int, file: Path
) -> Tally:
    """What a search found; each failure is in the file as soon as it is as small as it gets."""
    written: list[Found] = []

    def watch(tally: Tally) -> None:
        """Keep and tell what is new."""
        for one in tally.found[len(written) :]:
            _keep(file, one)
            written.append(one)
            say(f"[red]{escape(one.claim)}[/] fails: {escape(one.finding.detail[:200])}")
            say(f"    {_shown(one)}")

    say(f"looking for failures of {len(claims)} claims for {minutes:g} minutes")
    try:
        return look(worker, claims, spec, minutes, seed, watch)
    except ModuleNotFoundError as error:
        if error.name != "hypothesis":
            raise
        stop(Exit.WRONG_USE, "the search needs Hypothesis: pip install 'isograde[search]'")
    except KeyboardInterrupt:
        stop(Exit.STOPPED, f"stopped before the end; {len(written)} cases are in {file}")


def _keep(file: Path, one: Found) -> None:
    """The failure is in the file."""
    try:
        own.add(file, [one.entry])
    except (OSError, own.OwnCasesError) as error:
        stop(Exit.WRONG_USE, f"{file} cannot be written: {error}")


def _shown(one: Found) -> str:
    """A case in a line: its id, and spelt out where that is short enough to be pasted."""
    case = own.case_of(one.entry)
    field = case.build()
    size = " x ".join(map(str, field.shape))
    small = field.values.size <= SPELT_OUT and field.values.dtype.isnative
    spelt = f"\n    {given.name(field, case.isovalues)}" if small else ""
    return escape(f"{case.id}: {size} of {field.values.dtype}{spelt}")


def _tell(spec: str, tally: Tally, claims: list[Claim], file: Path) -> None:
    """Print what was done and what to do next."""
    broken = len(tally.found)
    counted = f"{tally.fields:,} fields, {tally.calls:,} calls"
    if not broken:
        say(f"no failure of {len(claims)} claims in {counted}")
        return
    say(
        f"{broken} of {len(claims)} claims fail ({counted}); their cases are in {escape(str(file))}"
    )
    again = f"isograde grade {quote(spec)} --cases {quote(str(file))} --only '{own.PREFIX}*'"
    say(f"again: [bold]{escape(again)}[/]")
    errors.print("[dim]without --only the cases are judged beside the whole plan[/]")
