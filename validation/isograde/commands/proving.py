"""The command `prove`."""

from __future__ import annotations

import inspect
from pathlib import Path

import typer

from isograde import proof
from isograde.commands.console import Exit, console, say, stop
from isograde.proof.certificate import write_certificate
from isograde.proof.loading import RuleError, load_rule

CHECKER = Path(proof.__file__).with_name("check_certificate.py")


def prove(spec: str, why: bool, shown: int, trials: int, certificate: Path | None) -> None:
    """Print what was proved of a rule or what is wrong with it, and leave with the status."""
    try:
        rule = load_rule(spec)
    except RuleError as error:
        stop(Exit.WRONG_USE, str(error))
    if why:
        console.print(inspect.getdoc(proof), end="\n\n", markup=False)
    found = proof.prove(rule, trials)
    console.print(found.text(shown), markup=False, soft_wrap=True)
    if not found.holds:
        raise typer.Exit(Exit.FAILS)
    if certificate is not None:
        try:
            write_certificate(found, certificate)
        except OSError as error:
            stop(Exit.WRONG_USE, f"cannot write the certificate: {error}")
        say(f"Certificate in {certificate}; check it with: python {CHECKER} {certificate}")
