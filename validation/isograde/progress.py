"""A bar while something is graded: on a terminal, in a notebook, or nowhere.

It is gone when it is done. In a notebook it is an HTML ``<progress>`` that is updated in place,
which needs no widgets. What is no terminal, such as a log, gets a line now and then from the
command, and nothing from Python.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from isograde.commands.console import errors
from isograde.grading import Watch
from isograde.model import BAD
from isograde.report.record import Tally

# Update a notebook's bar so many times a second at most.
PER_SECOND = 5
# Write a line into what is no terminal after so many seconds.
LINE_SECONDS = 10.0


@contextmanager
def progress(
    title: str, wanted: bool | None = None, *, by_lines: bool = False
) -> Iterator[Watch | None]:
    """What `isograde.grading.grade` calls after each case; None where nothing is to be shown.

    wanted : True, False, or None for a terminal and a notebook
    by_lines : what is no terminal gets a line now and then
    """
    if wanted is False:
        yield None
    elif by_lines and not errors.is_terminal and not in_notebook():
        yield _line_now_and_then(title)
    elif in_notebook():
        yield from _in_notebook(title)
    else:
        yield from _on_terminal(title, errors.is_terminal or wanted is True)


def in_notebook() -> bool:
    """Whether the session is one whose answers are shown as HTML."""
    ask = getattr(sys.modules.get("IPython"), "get_ipython", None)
    shell = ask() if ask is not None else None
    return getattr(shell, "kernel", None) is not None


def _bad(tally: Tally) -> str:
    """How many findings there are, of what is promised and of what is not, in words."""
    bad = sum(tally.verdicts[verdict.value] for verdict in BAD)
    return f"{bad:,} finding{'s' if bad != 1 else ''}" if bad else ""


def _on_terminal(title: str, shown: bool) -> Iterator[Watch]:
    """A bar on standard error."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("[red]{task.fields[bad]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=errors, transient=True, disable=not shown) as bar:
        task = bar.add_task(title, total=None, bad="")

        def watch(done: int, total: int, tally: Tally) -> None:
            bar.update(task, completed=done, total=total, bad=_bad(tally))

        yield watch


def _line_now_and_then(title: str) -> Watch:
    """A line on standard error every `LINE_SECONDS`, for logs; none for what is quickly done."""
    due = time.monotonic() + LINE_SECONDS

    def watch(done: int, total: int, tally: Tally) -> None:
        nonlocal due
        if time.monotonic() >= due:
            due = time.monotonic() + LINE_SECONDS
            said = ", ".join(filter(None, [f"{title}: {done:,} of {total:,} cases", _bad(tally)]))
            errors.print(said, markup=False)

    return watch


def _in_notebook(title: str) -> Iterator[Watch]:
    """A bar in the cell's answer."""
    from IPython.display import HTML, display

    place: Any = display(HTML(_bar(title, 0, 1, "")), display_id=True)
    due = time.monotonic()

    def watch(done: int, total: int, tally: Tally) -> None:
        nonlocal due
        if time.monotonic() >= due or done == total:
            due = time.monotonic() + 1 / PER_SECOND
            place.update(HTML(_bar(title, done, total, _bad(tally))))

    try:
        yield watch
    finally:
        place.update(HTML(""))


def _bar(title: str, done: int, total: int, bad: str) -> str:
    """The bar as HTML.

    >>> _bar("mine", 3, 10, "1 bad")
    '<progress value="3" max="10"></progress> mine, 3 of 10 cases, 1 bad'
    """
    said = ", ".join([escape(title), f"{done:,} of {total:,} cases", *([bad] if bad else [])])
    return f'<progress value="{done}" max="{total}"></progress> {said}'
