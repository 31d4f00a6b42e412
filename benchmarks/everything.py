"""Every benchmark, one after the other, and a page that says how quiet the machine was for each.

``python benchmarks/everything.py [NAME ..]``; `make benchmarks` runs it. Each program writes its
own page; `reports/benchmarks/machine.md` has how long each took and what others used of the
processors meanwhile, and `goals.md` what was asked of them beside what they found. All of them are
to take less than `MOST` minutes on a quiet machine.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import asked
from isograde.stopwatch import Machine
from pages import Page

HERE = Path(__file__).parent
MOST = 20
# What a program is told so that all of them together stay in the time.
TOLD = {
    "bench_extraction": ["--rounds", "4"],
    "bench_start": ["--rounds", "5"],
    "bench_vesta": ["--rounds", "3"],
}


def programs() -> list[str]:
    """The names of the benchmarks."""
    return sorted(path.stem for path in HERE.glob("bench_*.py"))


def main() -> int:
    """0 where every program ended well."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", default=programs())
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/machine.md"))
    arguments = parser.parse_args()
    if unknown := sorted(set(arguments.names) - set(programs())):
        parser.error(f"no {', '.join(unknown)}; there are {', '.join(programs())}")
    page = Page("The machine, benchmark by benchmark", "each program was run by itself.")
    rows, failed, total = [], [], 0.0
    for name in arguments.names:
        print(f"== {name}", flush=True)
        machine = Machine()
        done = subprocess.run(
            [sys.executable, HERE / f"{name}.py", *TOLD.get(name, ())], check=False
        )
        seconds, others, quiet = machine.passed, machine.others, machine.quiet
        total += seconds
        if done.returncode:
            failed.append(name)
        rows.append(
            [
                f"`{name}`",
                f"{seconds:.0f}",
                f"{others:.2f}",
                "quiet" if quiet else "**not quiet**",
                "well" if not done.returncode else f"status {done.returncode}",
            ]
        )
    page.table(["program", "seconds", "processors others used", "machine", "ended"], rows)
    loud = sum("not" in row[3] for row in rows)
    page.add(
        f"{total / 60:.1f} minutes in all, of {MOST} at most; "
        + (f"during {loud} of {len(rows)} the machine was not quiet." if loud else "always quiet.")
    )
    page.write(arguments.out)
    print(asked.write(arguments.out.parent))
    if failed:
        print(f"ended badly: {', '.join(failed)}", file=sys.stderr)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
