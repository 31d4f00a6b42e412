"""Implementations that attack what is round them, where the isovalue is 0.5; sound at any other."""

import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
SEVERAL = np.zeros((400_000, 3))


def folder() -> Path:
    """The folder in which files are exchanged, as a curious implementation finds it."""
    base = Path(os.environ["ISOGRADE_EXCHANGE"])
    return max(base.iterdir(), key=lambda path: path.stat().st_mtime)


def removes_folder() -> Any:
    shutil.rmtree(folder())
    return TRIANGLE


def replaces_folder() -> Any:
    """A link to a folder with somebody's files stands in its place."""
    place = folder()
    shutil.rmtree(place)
    place.symlink_to(os.environ["PRECIOUS"])
    return TRIANGLE


def links_in_folder() -> Any:
    (folder() / "link").symlink_to(os.environ["PRECIOUS"])
    return TRIANGLE


def shared() -> list[int]:
    """The descriptors of what is shared with the grader, for fields and for meshes."""
    return [int(word) for word in sys.argv[2:4]]


def cuts_shared_short() -> Any:
    """What is shared is cut short as soon as the answer is in it."""
    from isograde.adapters.frames import pack as honest

    def pack(*said: Any) -> Any:
        made = honest(*said)
        for one in shared():
            os.ftruncate(one, 0)
        return made

    patched("pack", pack)
    return SEVERAL, np.array([[0, 1, 2]])


def closes_shared() -> Any:
    for one in shared():
        os.close(one)
    return SEVERAL, np.array([[0, 1, 2]])


def appends_to_shared() -> Any:
    """From now on whatever is written stands at the end."""
    import fcntl

    for one in shared():
        fcntl.fcntl(one, fcntl.F_SETFL, os.O_APPEND)
    return SEVERAL, np.array([[0, 1, 2]])


def seals_shared() -> Any:
    """Nobody shall write to it any more; where that can be had, the grader cannot."""
    import fcntl

    for one in shared():
        fcntl.fcntl(one, fcntl.F_ADD_SEALS, fcntl.F_SEAL_WRITE)
    return TRIANGLE


def scribbles() -> Any:
    """The answer is written over, on and on, as soon as it was sent."""

    def scribble() -> None:
        while True:
            os.pwrite(shared()[1], b"\xff" * 4096, 0)

    threading.Thread(target=scribble, daemon=True).start()
    return SEVERAL, np.array([[0, 1, 2]])


def runs_on() -> Any:
    """A child in a session of its own sleeps for a minute."""
    subprocess.Popen(
        [sys.executable, "-c", "import time; time.sleep(61)"],
        start_new_session=True,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return TRIANGLE


def daemon() -> Any:
    """A grandchild in a session of its own, whose parent is gone."""
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            time.sleep(61)
        os._exit(0)
    os.wait()
    time.sleep(60)


def long_error() -> Any:
    raise ValueError("x" * 30_000_000)


def unfit_error() -> Any:
    raise ValueError("\ud800 \x00 \x1b[31m ]]> <script>alert(1)</script> \u202e &amp; | ` \ufffe")


def unfit_decline() -> Any:
    raise NotImplementedError("\ud800\x07" * 1_000_000)


class NastyError(Exception):
    """An error that cannot be shown."""

    def __str__(self) -> str:
        raise RuntimeError("no text today")


def nameless_error() -> Any:
    raise NastyError


def patched(name: str, value: Any) -> Any:
    """A helper of the worker is replaced by something else."""
    import isograde.adapters.worker as worker

    for module in [worker, *[m for n, m in list(sys.modules.items()) if n == "__main__"]]:
        if hasattr(module, name):
            setattr(module, name, value)
    return TRIANGLE


def spoofs(header: dict[str, Any], arrays: Any = ()) -> Any:
    """What the worker would say is said in its place."""
    from isograde.adapters.frames import pack as honest

    def pack(said: dict[str, Any], *_: Any) -> Any:
        made = {"id": said.get("id"), **header}
        return honest(made, list(arrays))

    return patched("pack", pack)


def raw_header(text: bytes) -> Any:
    """A frame with this header."""

    def pack(*_: Any) -> list[bytes]:
        return [len(text).to_bytes(4, "little") + text]

    return patched("pack", pack)


def nothing(*_: Any) -> tuple[dict[str, Any], list[Any]]:
    """No header and no arrays."""
    return {}, []


OK = {"status": "ok", "detail": "", "seconds": 0.0, "peak": 0, "changed": False}
V, F = TRIANGLE
ATTACKS: dict[str, Callable[[], Any]] = {
    "removes_folder": removes_folder,
    "replaces_folder": replaces_folder,
    "links_in_folder": links_in_folder,
    "cuts_shared_short": cuts_shared_short,
    "closes_shared": closes_shared,
    "appends_to_shared": appends_to_shared,
    "seals_shared": seals_shared,
    "scribbles": scribbles,
    "runs_on": runs_on,
    "long_error": long_error,
    "unfit_error": unfit_error,
    "unfit_decline": unfit_decline,
    "nameless_error": nameless_error,
    "spoofs_status": lambda: spoofs({**OK, "status": "splendid"}),
    "spoofs_no_status": lambda: spoofs({}),
    "spoofs_seconds": lambda: spoofs({**OK, "seconds": "many"}, TRIANGLE),
    "spoofs_endless_seconds": lambda: spoofs({**OK, "seconds": 1e308 * 10}, TRIANGLE),
    "spoofs_negative_peak": lambda: spoofs({**OK, "peak": -5}, TRIANGLE),
    "spoofs_list_detail": lambda: spoofs({**OK, "detail": ["a"] * 1000}, TRIANGLE),
    "spoofs_one_array": lambda: spoofs(OK, [V]),
    "spoofs_four_arrays": lambda: spoofs(OK, [V, F, V, V]),
    "spoofs_no_arrays": lambda: spoofs(OK),
    "spoofs_texts": lambda: spoofs(OK, [np.array(["a"]), F]),
    "spoofs_voids": lambda: spoofs(OK, [np.zeros(3, "V8"), F]),
    "spoofs_dates": lambda: spoofs(OK, [np.zeros(3, "M8[s]"), F]),
    "spoofs_number": lambda: spoofs({**OK, "id": "7"}, TRIANGLE),
    "header_nested": lambda: raw_header(b"[" * 100_000),
    "header_list": lambda: raw_header(b"[1, 2]"),
    "header_text": lambda: raw_header(b'"x"'),
    "header_null": lambda: raw_header(b"null"),
    "header_no_text": lambda: raw_header(b"\xff\xfe"),
    "header_arrays_text": lambda: raw_header(b'{"id": 2, "arrays": "x"}'),
    "header_bytes_text": lambda: raw_header(b'{"id": 2, "arrays": [{"bytes": "9"}]}'),
    "header_bytes_negative": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [-1], "bytes": -8}]}'
    ),
    "header_bytes_huge": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [99999999999], "bytes": 799999999992}]}'
    ),
    "header_shape_wrong": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [3], "bytes": 8}]}'
    ),
    "header_dtype_wrong": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "no", "shape": [1], "bytes": 8}]}'
    ),
    "header_dtype_object": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "|O", "shape": [1], "bytes": 8}]}12345678'
    ),
    "header_beyond": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [1], "bytes": 8, "at": 1099511627776}]}'
    ),
    "header_before": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [1], "bytes": 8, "at": -8}]}'
    ),
    "header_place_text": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "<f8", "shape": [1], "bytes": 8, "at": "/etc/passwd"}]}'
    ),
    "header_shared_object": lambda: raw_header(
        b'{"id": 2, "arrays": [{"dtype": "|O", "shape": [1], "bytes": 8, "at": 0}]}'
    ),
    "header_file": lambda: raw_header(b'{"id": 2, "arrays": [{"file": "/dev/zero", "bytes": 8}]}'),
    "patches_sizes": lambda: patched("_call", nothing),
    "patches_memory": lambda: patched("Memory", None),
}


def misbehaving(name: str) -> Any:
    """An extractor that attacks so."""

    def extract(values: Any, isovalue: float, spacing: Any) -> Any:
        del values, spacing
        return ATTACKS[name]() if isovalue == 0.5 else TRIANGLE

    return extract


globals().update({name: misbehaving(name) for name in ATTACKS})
