"""Pages that a build writes beside the source, and removes when nothing makes them any more."""

from __future__ import annotations

from pathlib import Path

RECORD = ".made"


class Pages:
    """Writes files below a folder; what has not changed is not touched, nor read again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.made: set[str] = set()

    def put(self, name: str, content: str | bytes) -> None:
        """Make the file `name` hold this."""
        path = self.folder / name
        data = content.encode() if isinstance(content, str) else content
        self.made.add(name)
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def has(self, name: str) -> bool:
        """The file is there from an earlier build; it stays."""
        if not (self.folder / name).is_file():
            return False
        self.made.add(name)
        return True

    def close(self) -> None:
        """Remove what an earlier build made and this one did not."""
        record = self.folder / RECORD
        before = set(record.read_text(encoding="utf-8").splitlines()) if record.is_file() else set()
        for name in before - self.made:
            (self.folder / name).unlink(missing_ok=True)
        record.write_text("\n".join(sorted(self.made)) + "\n", encoding="utf-8")
