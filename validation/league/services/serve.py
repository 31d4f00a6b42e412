"""Answers the grader for one method of a Python package, from the package's own environment.

``python serve.py METHOD.json``, beside ``adapter.py``. The environment needs NumPy and the package
alone: this file knows nothing of isograde but its protocol (`isograde explain protocol`).
METHOD.json has the ``function`` of the adapter, the ``options`` bound to it, and the
``declaration``.

What the package prints goes to standard error: standard output belongs to the protocol.
"""

import json
import os
import sys
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import numpy as np


def main(path):
    """Answers requests until there are no more."""
    method = json.loads(Path(path).read_text(encoding="utf-8"))
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    sys.path.insert(0, str(Path(path).resolve().parent))
    extract = getattr(import_module("adapter"), method["function"])
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["command"] == "stop":
            break
        if asked["command"] == "start":
            said = {"protocol": 3, "declaration": method["declaration"]}
        else:
            said = {"id": asked["id"], **answer(asked, extract, method["options"])}
        print(json.dumps(said), file=answers, flush=True)


def answer(asked, extract, options):
    """Files of the mesh, or what was raised."""
    values = np.load(asked["values"])
    (isovalue,) = (float("nan") if one is None else float(one) for one in asked["isovalues"])
    cost = Cost()
    try:
        found = extract(values, isovalue, tuple(asked["spacing"]), **options)
        # Normals that come third are left: the protocol has no place for them.
        vertices, simplices = (
            (found.vertices, found.faces) if hasattr(found, "faces") else found[:2]
        )
    except Exception as error:  # noqa: BLE001 - whatever the package raises is its answer
        return {"error": f"{type(error).__name__}: {error}"}
    seconds = cost.told()
    folder = Path(asked["directory"])
    np.save(folder / "vertices.npy", np.asarray(vertices, np.float64).reshape(-1, 3))
    np.save(folder / "simplices.npy", np.asarray(simplices, np.int64))
    return {"vertices": "vertices.npy", "simplices": "simplices.npy", "seconds": seconds}


class Cost:
    """What a call costs, written as a line into the file that ISOGRADE_COST names."""

    def __init__(self):
        self.path = os.environ.get("ISOGRADE_COST")
        if self.path:
            self.before = memory("VmRSS:")
            with suppress(OSError):
                Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
        self.start, self.used = time.perf_counter(), time.process_time()

    def told(self):
        """The seconds."""
        seconds, used = time.perf_counter() - self.start, time.process_time() - self.used
        if self.path:
            with open(self.path, "a", encoding="ascii") as file:
                print(seconds, used, memory("VmHWM:") - self.before, file=file)
        return seconds


def memory(name):
    """Kilobytes of this process, as Linux counts them; 0 elsewhere."""
    try:
        text = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in text.splitlines() if line.startswith(name)), 0)


if __name__ == "__main__":
    main(sys.argv[1])
