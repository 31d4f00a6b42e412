"""Folders in which the grader and an implementation exchange files.

Every process that grades has one folder of its own in the temporary folder, locked as long as it
lives; whoever starts later removes those of processes that were killed. In it each adapter has a
folder that goes with it. An implementation may write, remove and replace there what it likes:
nothing outside is ever deleted, since everything is reached through an open descriptor of the
folder that was made, and links are not followed.
"""

from __future__ import annotations

import atexit
import contextlib
import errno
import multiprocessing
import os
import shutil
import stat
import tempfile
import weakref
from pathlib import Path

from isograde.adapters.system import require

PREFIX = "isograde-run-"
VARIABLE = "ISOGRADE_EXCHANGE"
FULL = (errno.ENOSPC, errno.EDQUOT)
# Less than this many bytes free are none.
SPARE = 1 << 16


class TemporaryFull(RuntimeError):  # noqa: N818 - a state of the machine, not of the program
    """The temporary folder is full; the message says which it is, and what to do."""

    @classmethod
    def of(cls, folder: Path) -> TemporaryFull:
        """The fault of this folder."""
        return cls(
            f"the temporary folder {folder} is full: free some space, or set TMPDIR to another "
            "folder; what was judged is kept, and the same command goes on"
        )


class Exchange:
    """A folder of an adapter, gone when that is.

    path : where it stands; another one after it was removed or replaced
    """

    path: Path

    def __init__(self) -> None:
        self._make()

    def intact(self) -> bool:
        """Whether the folder is still the one that was made; else there is a new one."""
        try:
            same = os.path.samestat(os.lstat(self.path), os.fstat(self._descriptor))
        except OSError:
            same = False
        if not same:
            self._finalize()
            self._make()
        return same

    def empty(self) -> None:
        """There is nothing in the folder that was made, wherever it is now."""
        _empty(self._descriptor)

    def full(self) -> bool:
        """Whether next to nothing can be written."""
        with contextlib.suppress(OSError):
            return shutil.disk_usage(self.path).free < SPARE
        return False

    def _make(self) -> None:
        """A new folder, open."""
        try:
            self.path = Path(tempfile.mkdtemp(dir=base()))
        except OSError as error:
            if error.errno in FULL:
                raise TemporaryFull.of(base()) from error
            raise
        self._descriptor = os.open(self.path, os.O_RDONLY)
        self._finalize = weakref.finalize(self, _remove, self.path, self._descriptor)


def _empty(descriptor: int) -> None:
    """There is nothing in this open folder; links in it are removed, not what they lead to."""
    for name in os.listdir(descriptor):
        with contextlib.suppress(OSError, RecursionError):
            mode = os.lstat(name, dir_fd=descriptor).st_mode
            if stat.S_ISDIR(mode):
                shutil.rmtree(name, dir_fd=descriptor)
            else:
                os.unlink(name, dir_fd=descriptor)


def _remove(path: Path, descriptor: int) -> None:
    """The folder that was made is empty and gone; what stands in its place stays."""
    _empty(descriptor)
    with contextlib.suppress(OSError):
        if os.path.samestat(os.lstat(path), os.fstat(descriptor)):
            path.rmdir()
    os.close(descriptor)


_BASES: dict[int, Path] = {}


def base() -> Path:
    """The folder of this process, or of the one that started it to grade with it."""
    require()
    known = _BASES.get(os.getpid())
    if known is not None and known.is_dir():
        return known
    given = os.environ.get(VARIABLE, "")
    if multiprocessing.parent_process() is not None and given and Path(given).is_dir():
        return _BASES.setdefault(os.getpid(), Path(given))
    _sweep()
    made = _new_base()
    _BASES[os.getpid()] = made
    # Processes that this one starts to grade with are told by the environment.
    os.environ[VARIABLE] = str(made)
    return made


def _new_base() -> Path:
    """A new folder in the temporary one, locked until this process ends, and then removed."""
    while True:
        path = Path(tempfile.mkdtemp(prefix=PREFIX))
        descriptor = os.open(path, os.O_RDONLY)
        if _lock(descriptor) and path.is_dir():
            atexit.register(_remove_base, path, descriptor, os.getpid())
            return path
        os.close(descriptor)


def _remove_base(path: Path, descriptor: int, process: int) -> None:
    """The folder is gone, where this process made it."""
    if os.getpid() == process:
        _remove(path, descriptor)


def _lock(descriptor: int) -> bool:
    """Whether this process has the lock now."""
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _sweep() -> None:
    """The folders of processes that were killed are gone: those that nobody has locked."""
    for path in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):
            found = os.lstat(path)
            if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
                continue
            descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
            if _lock(descriptor):
                _remove(path, descriptor)
            else:
                os.close(descriptor)
