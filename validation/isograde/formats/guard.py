"""What stands between a reader of files and a file that would take the machine's memory.

A header of a few bytes can ask for terabytes, and a small archive can unfold to as much. While a
volume is read, the process may not hold more than is free: what asks for more gets a MemoryError,
which is told, where otherwise the system would begin to kill processes.
"""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

# Leave so much of the free memory alone.
SPARE = 1 << 28
CHUNK = 1 << 20
# A MetaImage may have so many axes; its reader loops over as many as the header says.
AXES, MOST_AXES = re.compile(rb"^\s*NDims\s*=\s*(-?\d+)", re.MULTILINE), 8
EXTENT = re.compile(rb'WholeExtent\s*=\s*"\s*' + rb"(-?\d+)\s+" * 5 + rb"(-?\d+)")


def free() -> int:
    """The bytes that a volume may take."""
    return max(SPARE, int(psutil.virtual_memory().available) - SPARE)


def in_words(count: float) -> str:
    """A number of bytes.

    >>> in_words(8e12), in_words(5e8)
    ('8,000.0 GB', '0.5 GB')
    """
    return f"{count / 1e9:,.1f} GB"


@contextmanager
def within_memory() -> Iterator[None]:
    """What asks for more memory than is free gets a MemoryError, where the system can see to it."""
    try:
        import resource
    except ImportError:  # Windows.
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    most = psutil.Process().memory_info().vms + free()
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    if soft != resource.RLIM_INFINITY:
        most = min(most, soft)
    try:
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    except (ValueError, OSError):  # macOS knows the limit and does not take it.
        yield
        return
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def check_gzip(path: Path) -> str:
    """Why a compressed file is damaged or unfolds to more than is free; nothing where it is sound.

    Readers stop at the last sample, before the checksum that would tell.
    """
    most, seen = free(), 0
    try:
        with gzip.open(path) as file:
            while chunk := file.read(CHUNK):
                seen += len(chunk)
                if seen > most:
                    return f"it unfolds to more than the {in_words(most)} of memory that are free"
    except (OSError, EOFError, zlib.error) as error:
        return f"its compression is damaged: {error}"
    return ""


def check_vtk_image(path: Path) -> str:
    """Why an XML image of VTK asks for more than is free; VTK ends the process where it does."""
    with path.open("rb") as file:
        found = EXTENT.search(file.read(CHUNK))
    if found is None:
        return ""
    ends = [int(one) for one in found.groups()]
    samples = 1
    for low, high in zip(ends[::2], ends[1::2], strict=True):
        samples *= max(0, high - low + 1)
    return "" if samples <= free() else f"it says that it has {samples:,} samples"


def check_meta_image(path: Path) -> str:
    """Why the header of a MetaImage is not to be believed, or nothing."""
    with path.open("rb") as file:
        found = AXES.search(file.read(1 << 14))
    if found is not None and not 0 < int(found[1][:20]) <= MOST_AXES:
        return f"it says that it has {int(found[1][:20])} axes"
    return ""
