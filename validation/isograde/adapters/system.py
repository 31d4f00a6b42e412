"""What the adapters want of the system, and the sentence where it is lacking."""

from __future__ import annotations

from importlib.util import find_spec

from isograde.model import AdapterError

LACKING = (
    "watching an implementation takes process groups and fcntl, which this system lacks: run it on "
    "Linux or macOS, or on Windows in WSL; isoref itself, and what only reads files, works here"
)


def require() -> None:
    """Raise `AdapterError` where an implementation cannot be watched, as on Windows."""
    if find_spec("fcntl") is None:
        raise AdapterError(LACKING)
