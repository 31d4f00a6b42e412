"""Contestants in environments and processes of their own, timed in turn with those of this one.

Some libraries cannot be installed beside the others: Open3D alone is a gigabyte. The league builds
each in an environment of its own (`validation/league`), and a process of that environment calls it
here, by the league's own adapter, and tells what each call cost. GUDHI's headers are called by a
program of ours in C++. ``python benchmarks/outside.py NAME ..`` builds those that are not there.
Who may run on one processor makes no more threads than that; so the process is held to one.

The process is told lines and answers them: ``call`` with seconds of the clock, seconds of its
processor and the number of triangles; ``memory`` with the bytes by which a call raised its resident
memory at the highest.
"""

from __future__ import annotations

import ctypes
import gc
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
LEAGUE = ROOT / "validation" / "league"
# A league that was built in another copy of the project serves as well.
BUILT = Path(os.environ.get("ISOGRADE_LEAGUE", ROOT / ".league"))
PEERS = ("open3d", "meshlib", "zmesh")


class AbsentError(Exception):
    """The contestant cannot be had here; the message says why."""


class Outside:
    """A process that can be asked to call its contestant; ends with its `with`.

    command : begins the process, which first answers ``ready`` and what its arrays are made of
    made : what these are made of
    """

    def __init__(self, *command: str | Path) -> None:
        self._process = subprocess.Popen(
            [str(part) for part in command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
        )
        try:
            self.made = self._answer().removeprefix("ready").strip()
        except AbsentError:
            self._process.kill()
            self._process.wait()
            raise

    def __enter__(self) -> Outside:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """The process ends, and is waited for."""
        self._process.communicate("end\n")

    @property
    def ended(self) -> int | None:
        """The status with which the process ended, or None while it lives."""
        return self._process.poll()

    def call(self) -> tuple[float, float, int]:
        """Seconds of the clock, seconds of the processor, and triangles, of one call."""
        seconds, processor, triangles, *_ = self.ask("call").split()
        return float(seconds), float(processor), int(triangles)

    def memory(self) -> int:
        """Bytes by which one call raised the resident memory at its highest."""
        return int(self.ask("memory"))

    def ask(self, line: str) -> str:
        """The answer to a line."""
        assert self._process.stdin is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        return self._answer()

    def _answer(self) -> str:
        """The next line that is for us; what libraries print stands before it."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith("> "):
                return line[2:].strip()
        self._process.communicate()
        raise AbsentError(f"its process ended with status {self._process.returncode}")


def library(name: str, values: NDArray[Any], isovalue: float) -> Outside:
    """A library of the league, ready to draw this isosurface; raises `AbsentError`."""
    folder = BUILT / name
    if not (folder / "ready").exists():
        raise AbsentError(f"not built here: `python benchmarks/outside.py {name}`")
    method = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "values.npy"
        np.save(path, values)
        return Outside(
            folder / "env" / "bin" / "python",
            __file__,
            "--serve",
            LEAGUE / name / "adapter.py",
            method["function"],
            json.dumps(method.get("options", {})),
            path,
            repr(isovalue),
        )


def version(name: str) -> str:
    """The version of a library of the league, as "open3d 0.20.0"."""
    import tomllib

    said = tomllib.loads((LEAGUE / name / "league.toml").read_text(encoding="utf-8"))
    return f"{name} {said['version']}"


def gudhi(dimension: int, cells: int, radius: float, edge: float) -> Outside:
    """GUDHI's manifold tracing of a sphere (`gudhi_tracing.cpp`); raises `AbsentError`."""
    program = BUILT / "gudhi" / "gudhi_tracing"
    if not program.exists():
        raise AbsentError("not built here: `python benchmarks/outside.py gudhi`")
    return Outside(program, *map(str, (dimension, cells, radius, edge)))


def build_gudhi() -> None:
    """The program with GUDHI's headers; raises `AbsentError` where these or a compiler lack.

    They are looked for where ISOGRADE_GUDHI says, else where Debian puts them.
    """
    place = BUILT / "gudhi"
    headers = Path(os.environ.get("ISOGRADE_GUDHI", "/usr/include"))
    if not (headers / "gudhi" / "Manifold_tracing.h").exists():
        raise AbsentError("gudhi: no headers here: apt-get install libgudhi-dev libeigen3-dev g++")
    place.mkdir(parents=True, exist_ok=True)
    command = ["g++", "-std=c++17", "-O3", "-DNDEBUG", f"-I{headers}", f"-I{headers / 'eigen3'}"]
    source, program = Path(__file__).with_name("gudhi_tracing.cpp"), place / "gudhi_tracing"
    try:
        subprocess.run([*command, source, "-o", program], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise AbsentError(f"gudhi: {error}") from error


def build(names: list[str]) -> int:
    """Build the libraries that are not there; 0 whatever comes of it, for a row can say so."""
    if "gudhi" in names:
        names.remove("gudhi")
        if not (BUILT / "gudhi" / "gudhi_tracing").exists():
            try:
                build_gudhi()
            except AbsentError as error:
                print(error, file=sys.stderr)
    if not names:
        return 0
    sys.path.insert(0, str(LEAGUE))
    import league

    for package in league.packages(names):
        if not (BUILT / package.name / "ready").exists():
            try:
                league.build(package)
            except league.LeagueError as error:
                print(f"{package.name}: {error}".splitlines()[0], file=sys.stderr)
    return 0


# --- The process ---------------------------------------------------------------------------------


def serve(adapter: str, function: str, options: str, path: str, isovalue: str) -> int:
    """Answer lines until there is none; in the library's environment, which has NumPy alone."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "TBB_NUM_THREADS"), "1"))
    spec = importlib.util.spec_from_file_location("adapter", adapter)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    values, extract = np.load(path), getattr(module, function)

    def run() -> Any:
        return extract(values, float(isovalue), (1.0, 1.0, 1.0), **json.loads(options))

    vertices, triangles = run()
    print(f"> ready {vertices.dtype}, {triangles.dtype}", flush=True)
    for line in sys.stdin:
        if line.strip() == "end":
            break
        print(f"> {_timed(run) if line.strip() == 'call' else _raised(run)}", flush=True)
    return 0


def _timed(run: Callable[[], Any]) -> str:
    """What a call cost, and its triangles."""
    start, used = time.perf_counter(), time.process_time()
    made = run()
    spent = time.process_time() - used
    return f"{time.perf_counter() - start} {spent} {len(made[1])}"


def _raised(run: Callable[[], Any]) -> int:
    """The rise of resident memory while `run` ran, looked at every millisecond."""
    gc.collect()
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)
    before = highest = _resident()
    done = threading.Event()

    def watch() -> None:
        nonlocal highest
        while not done.wait(0.001):
            highest = max(highest, _resident())

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    made = run()
    highest = max(highest, _resident())
    done.set()
    watcher.join()
    del made
    return highest - before


def _resident() -> int:
    """Bytes of resident memory of this process; Linux only."""
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--serve"]:
        sys.exit(serve(*sys.argv[2:]))
    sys.exit(build(sys.argv[1:] or [*PEERS, "gudhi"]))
