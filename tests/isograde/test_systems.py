"""What other systems lack is refused with a sentence, or supplied (issue 13).

Neither Windows nor macOS is here: what they lack is taken away from a Python on Linux, and from all
the Pythons that it starts.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

#: Modules, and names of `os` and `signal`, that Python has on no Windows. What is imported first
#: has a branch of its own there.
WINDOWS = """
import concurrent.futures.process, importlib.abc, importlib.util, multiprocessing.popen_spawn_posix
import os, psutil, shutil, signal, subprocess, sys, tempfile

GONE = {"fcntl", "grp", "pty", "pwd", "resource", "termios"}
OS = (
    "O_CLOEXEC O_DIRECTORY O_NOFOLLOW fchmod fchown fork getegid geteuid getgid getloadavg getpgid "
    "getuid killpg memfd_create mkfifo nice openpty posix_fallocate preadv pwritev "
    "sched_getaffinity sendfile setsid statvfs wait4"
)
SIGNAL = "ITIMER_REAL SIGALRM SIGCHLD SIGHUP SIGKILL SIGXCPU alarm pthread_sigmask setitimer"


class Hide(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name in GONE:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


found = importlib.util.find_spec
importlib.util.find_spec = lambda name, package=None: None if name in GONE else found(name, package)
sys.meta_path.insert(0, Hide())
for name in GONE:
    sys.modules.pop(name, None)
for module, names in ((os, OS), (signal, SIGNAL)):
    for name in names.split():
        if hasattr(module, name):
            delattr(module, name)
"""
#: No /proc, and nothing that Linux alone has; psutil has a branch of its own there.
MACOS = """
import builtins, io, os, sys

for name in "memfd_create posix_fallocate preadv pwritev sched_getaffinity sendfile".split():
    if hasattr(os, name):
        delattr(os, name)


def without_proc(given):
    def opened(path, *more, **named):
        of_psutil = sys._getframe(1).f_globals.get("__name__", "").startswith("psutil")
        if isinstance(path, str | os.PathLike) and str(path).startswith("/proc/") and not of_psutil:
            raise FileNotFoundError(2, "No such file or directory", str(path))
        return given(path, *more, **named)

    return opened


os.open, builtins.open = without_proc(os.open), without_proc(open)
io.open = builtins.open
"""
#: Runs commands one after the other in one process, and prints how each ended.
SEVERAL = """
import sys
from isograde.command import main

for line in sys.argv[1:]:
    sys.argv = ["isograde", *line.split()]
    try:
        status = main()
    except SystemExit as stopped:
        status = stopped.code
    sys.stdout.flush()
    print(f"\\nstatus {status}")
"""


def on(system: str, tmp_path: Path, *commands: str) -> list[tuple[int, str]]:
    """The status of each command, and what it says on standard output and error."""
    (tmp_path / "sitecustomize.py").write_text(system, encoding="utf-8")
    path = os.pathsep.join([str(tmp_path), *(entry for entry in sys.path if entry)])
    done = subprocess.run(
        [sys.executable, "-c", SEVERAL, *commands],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stdout
    assert "Traceback" not in done.stdout, done.stdout
    parts = done.stdout.split("\nstatus ")
    assert len(parts) == len(commands) + 1
    ends = [int(part.split("\n")[0]) for part in parts[1:]]
    said = [" ".join(part.partition("\n")[2].split()) for part in parts[1:]]
    return list(zip(ends, [" ".join(parts[0].split()), *said], strict=False))


def test_a_system_like_windows_is_told_what_it_lacks(tmp_path: Path) -> None:
    """Whatever runs an implementation is refused with one sentence; what reads files works."""
    np.save(tmp_path / "ball.npy", 2 - np.linalg.norm(np.indices((6, 6, 6)) - 2.5, axis=0))
    refused = [
        "grade isoref:lorensen-cline",
        "check isoref:lorensen-cline",
        "bench isoref:lorensen-cline",
        "search isoref:lorensen-cline",
    ]
    works = [
        "extract ball.npy --isovalue 0 --out ball.ply",
        "export fields --only ties/point",
        "explain topology.closed",
        "list levels",
    ]
    found = on(WINDOWS, tmp_path, *refused, *works)
    for status, said in found[: len(refused)]:
        assert status == 3
        assert said.count("takes process groups and fcntl") == 1
    assert [status for status, _ in found[len(refused) :]] == [0] * len(works)
    assert (tmp_path / "ball.ply").stat().st_size > 1000


def test_a_system_like_macos_grades(tmp_path: Path) -> None:
    """Without /proc and without memory that bears no name, in the worker too."""
    ((status, said),) = on(MACOS, tmp_path, "grade isoref:lorensen-cline --only ties/point")
    assert status == 0, said
    assert "Every promise that could be tested holds on every case tried" in said
