"""The site: the articles as they stand in the source, and a gallery.

The docstring of a module is its text; what follows it is shown as code.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from textwrap import indent

HERE = Path(__file__).parent
SOURCES = {
    "isoref": HERE.parent / "reference" / "isoref",
    "isograde": HERE.parent / "validation" / "isograde",
}
# The order in which to read the reference.
CHAPTERS = {
    "Marching cubes": ("lorensen_cline", "cycles", "cube", "rule", "sweep", "field", "mesh"),
    "Its repair": ("asymptotic_decider", "diagonals", "trilinear_cubes", "methods"),
    "Volume-enclosing surfaces": (
        "diconex",
        "vesta",
        "marching_vesta",
        "freeze_out",
        "hypersurface",
    ),
    "Other families": (
        "dual",
        "surface_nets",
        "dual_marching_cubes",
        "label_cubes",
        "marching_tetrahedra",
        "attributes",
        "capping",
        "degenerate",
        "ties",
    ),
    "Where two isosurfaces meet": (
        "curves",
        "marching_faces",
        "hermite",
        "surface_intersection",
        "plane_waves",
    ),
    "Any dimension and codimension": (
        "kuhn",
        "simplex_section",
        "simplicial",
        "recursive_sections",
        "face_tracing",
        "hypercubes",
        "dyadic",
        "projection",
    ),
    "The fast twins": (
        "fast.sweep",
        "fast.diconex",
        "fast.vesta",
        "fast.dual",
        "fast.marching_tetrahedra",
        "fast.marching_faces",
        "fast.surface_intersection",
        "fast.simplicial",
        "fast.dyadic",
    ),
}

project = "isograde"
author = "the isograde authors"
copyright = "2026, the isograde authors"
extensions = ["sphinx_gallery.gen_gallery"]
exclude_patterns = ["_build", "examples", "explorer"]
highlight_language = "text"
html_theme = "alabaster"
# The explorer is a page of its own, at the root of the site.
html_extra_path = ["explorer/explorer.html"]
html_theme_options = {
    "description": "Isosurfaces, written to be read, and graded.",
    "page_width": "1240px",
    "body_max_width": "960px",
    "code_font_size": "0.82em",
}
sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "auto_examples",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": "/plot_",
    "download_all_examples": False,
    "show_memory": False,
}


def heading(title: str, underline: str) -> str:
    """A title of reStructuredText."""
    return f"{title}\n{underline * len(title)}\n\n"


def is_table(paragraph: str) -> bool:
    """Whether a paragraph is laid out in columns, or as numbered references."""
    return bool(re.search(r"^\S.*? {2,}\S", paragraph, re.MULTILINE) or paragraph.startswith("["))


def prose(docstring: str) -> str:
    """The docstring without its first line: text as text, columns and drawings as they are."""
    _, _, body = docstring.partition("\n")
    parts = [""]
    for paragraph in re.split(r"\n{2,}", body.strip("\n")):
        title = re.fullmatch(r"(\S.*)\n-{4,}(?:\n(.*))?", paragraph, re.DOTALL)
        if title:
            parts.append(heading(title[1], "-"))
            paragraph = title[2] or ""
        drawn = paragraph.startswith(" ") and not parts[-1].rstrip().endswith("::")
        if is_table(paragraph) or (drawn and not parts[-1].startswith(" ")):
            parts.append(literal(paragraph))
        else:
            # A bar is a bar, and no substitution; code stays as it is.
            shown = paragraph if paragraph.startswith(" ") else bars(paragraph)
            parts.append(shown + "\n\n")
    return "".join(parts)


def bars(paragraph: str) -> str:
    """The paragraph with its bars escaped, but for those in code."""
    pieces = re.split(r"(``.*?``)", paragraph, flags=re.DOTALL)
    return "".join(p if p.startswith("``") else p.replace("|", "\\|") for p in pieces)


def literal(text: str) -> str:
    """The text as it is."""
    return ".. code-block:: text\n\n" + indent(text, "   ") + "\n\n"


def article(source: Path, name: str, path: Path) -> str:
    """The page of a module."""
    tree = ast.parse(source.read_text(encoding="utf-8"))
    docstring = ast.get_docstring(tree)
    assert docstring is not None, f"{source} has no docstring"
    title = docstring.partition("\n")[0].rstrip(".").replace("`", "")
    start = (tree.body[0].end_lineno or 0) + 1
    code = f".. literalinclude:: {path}\n   :language: python\n   :lines: {start}-\n"
    return (
        heading(title, "=")
        + f"``{name}``\n\n"
        + prose(docstring)
        + heading("The code", "-")
        + code
        + "   :lineno-match:\n"
    )


def write_articles(package: str, title: str) -> None:
    """One page a module of the package, and their index."""
    source = SOURCES[package]
    folder = HERE / "articles" / package
    folder.mkdir(parents=True, exist_ok=True)
    modules = sorted(p.relative_to(source) for p in source.rglob("*.py") if p.stem[0] != "_")
    for module in modules:
        name = ".".join((package, *module.with_suffix("").parts))
        path = Path("..") / ".." / ".." / source.relative_to(HERE.parent) / module
        (folder / f"{name}.rst").write_text(article(source / module, name, path), encoding="utf-8")
    chapters = CHAPTERS if package == "isoref" else by_folder(modules)
    index = heading(title, "=") + "".join(
        f".. toctree::\n   :maxdepth: 1\n   :caption: {caption}\n\n"
        + "".join(f"   {package}.{name}\n" for name in names)
        + "\n"
        for caption, names in chapters.items()
    )
    (folder / "index.rst").write_text(index, encoding="utf-8")


def by_folder(modules: list[Path]) -> dict[str, tuple[str, ...]]:
    """Dotted names of modules, those of each folder under its name."""
    folders: dict[str, tuple[str, ...]] = {}
    for module in modules:
        key = module.parent.name or "From adapter to report"
        folders[key] = (*folders.get(key, ()), ".".join(module.with_suffix("").parts))
    return folders


write_articles("isoref", "The reference")
write_articles("isograde", "The grader")
