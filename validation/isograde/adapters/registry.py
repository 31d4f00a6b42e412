"""Ready-made implementations by name: where their functions stand, and what they declare.

The tables are those of the modules in `isograde.adapters.libraries`. No library is imported here;
the worker process that runs one does it.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from importlib.metadata import PackageNotFoundError, version
from types import ModuleType
from typing import Any

from isograde.adapters.libraries import (
    contourpy,
    isoref,
    libigl,
    manifold3d,
    pymcubes,
    pymeshlab,
    skimage,
    trimesh,
    vtk,
)
from isograde.declaration import Declaration, declaration_from

LIBRARIES = (skimage, contourpy, pymcubes, libigl, trimesh, vtk, pymeshlab, manifold3d, isoref)


@dataclass(frozen=True)
class ReadyMade:
    """An implementation that has a short name.

    name : the short name
    module : where its function stands, with nothing of isograde in it
    calls : the name of the function there
    options : what is bound to it
    said : its declaration, as JSON
    does : what the function does for the library that its users would have to do
    """

    name: str
    module: ModuleType
    calls: str
    options: Mapping[str, Any]
    said: Mapping[str, Any]
    does: tuple[str, ...]

    @property
    def distribution(self) -> str:
        """The package that brings the library."""
        return str(self.module.LIBRARY["distribution"])

    @property
    def imports(self) -> tuple[str, ...]:
        """The modules of the library that its calls need."""
        return tuple(self.module.LIBRARY["imports"])

    @property
    def version(self) -> str:
        """The installed version, or "source" where the code is used without being installed."""
        try:
            return version(self.distribution)
        except PackageNotFoundError:
            return "source"

    def declaration(self) -> Declaration:
        """What it declares."""
        return declaration_from({"version": self.version, **self.said}, self.name)

    @property
    def given_function(self) -> bool:
        """Whether the library samples a function itself."""
        return self.said.get("given") == "function"

    def function(self) -> Callable[..., Any]:
        """The function of samples, its options bound."""
        function: Callable[..., Any] = getattr(self.module, self.calls)
        bound = partial(function, **self.options) if self.options else function
        if not self.given_function:
            return bound
        from isograde.adapters.interpolants import on_samples  # Here, for lists need no NumPy.

        return on_samples(bound)

    @cached_property
    def source(self) -> str:
        """Lines of Python that define `extract`, of NumPy and the library alone.

        >>> print(READY_MADE["skimage:lewiner"].source)
        from functools import partial
        <BLANKLINE>
        <BLANKLINE>
        def surface(values, isovalue, spacing, method):
            \"\"\"The surface by one of the two methods of `marching_cubes`, with its normals.\"\"\"
            from skimage.measure import marching_cubes
        <BLANKLINE>
            return marching_cubes(values, isovalue, spacing=spacing, method=method)[:3]
        <BLANKLINE>
        <BLANKLINE>
        extract = partial(surface, method='lewiner')
        """
        text = inspect.getsource(self.module)
        imports, others = _needed(text, self.calls)
        bound = "".join(f", {key}={value!r}" for key, value in self.options.items())
        if bound:
            imports = ["from functools import partial", *imports]
        named = f"partial({self.calls}{bound})" if bound else self.calls
        if self.given_function:
            named = f"on_samples({named})"
            more = on_samples_source()
            imports, others = [*more[0], *imports], [*more[1], *others]
        given = f"extract = {named}"
        head = ["\n".join(imports)] if imports else []
        return "\n\n\n".join([*head, *others, given])


def on_samples_source() -> tuple[list[str], list[str]]:
    """The imports and definitions that make a function of samples out of one of a function."""
    from isograde.adapters import interpolants

    return _needed(inspect.getsource(interpolants), "on_samples")


def _needed(text: str, name: str) -> tuple[list[str], list[str]]:
    """The imports of a module, and its other statements, that the definition of a name needs."""
    statements = ast.parse(text).body
    defines = {one: node for node in statements for one in _defined(node)}
    needed, waiting = set(), [name]
    while waiting:
        node = defines.get(waiting.pop())
        if node is not None and node not in needed:
            needed.add(node)
            waiting += [one.id for one in ast.walk(node) if isinstance(one, ast.Name)]
    parts: tuple[list[str], list[str]] = [], []
    for node in statements:
        if node in needed:
            imported = isinstance(node, ast.Import | ast.ImportFrom)
            parts[0 if imported else 1].append(_printed(text.splitlines(), node))
    return parts


def _printed(lines: list[str], node: ast.stmt) -> str:
    """The lines of a statement, with the comment above it."""
    start = node.lineno - 1
    while start and lines[start - 1].startswith("#"):
        start -= 1
    return "\n".join(lines[start : node.end_lineno])


def _defined(node: ast.stmt) -> Iterator[str]:
    """The names that a statement of a module defines."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        yield from ((one.asname or one.name).split(".")[0] for one in node.names)
    elif isinstance(node, ast.FunctionDef):
        yield node.name
    elif isinstance(node, ast.Assign):
        yield from (one.id for one in node.targets if isinstance(one, ast.Name))


READY_MADE: Mapping[str, ReadyMade] = {
    name: ReadyMade(
        name,
        module,
        row["function"],
        row.get("options", {}),
        row["declaration"],
        tuple(row.get("does", ())),
    )
    for module in LIBRARIES
    for name, row in module.METHODS.items()
}
