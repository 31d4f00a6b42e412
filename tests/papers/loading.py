"""The modules of a paper's folder, loaded as the paper's own program finds them."""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from tests.loading import module_at

PAPERS = Path(__file__).parents[2] / "papers"


def importer(paper: str) -> Callable[[str], ModuleType]:
    """A function that imports a module of this paper's folder by its name.

    Every paper has a program `reproduce`: it is loaded under a name of its own.
    """
    folder = PAPERS / paper
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

    def load(name: str) -> ModuleType:
        if name == "reproduce":
            return _own(folder / f"{name}.py")
        # A module may import its own paper's `reproduce`, and not one that another paper left.
        sys.path.remove(str(folder))
        sys.path.insert(0, str(folder))
        sys.modules.pop("reproduce", None)
        return importlib.import_module(name)

    return load


def _own(path: Path) -> ModuleType:
    """The module of this file, loaded once, under the name of its folder and its own."""
    name = f"{path.parent.name}_{path.stem}"
    return sys.modules.get(name) or module_at(path, name)
