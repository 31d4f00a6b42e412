"""The site: the articles as they stand in the source, and a gallery."""

from __future__ import annotations

from pathlib import Path

HERE = Path(__file__).parent
SOURCES = {
    "isoref": HERE.parent / "reference" / "isoref",
    "isograde": HERE.parent / "validation" / "isograde",
}

project = "isograde"
author = "the isograde authors"
copyright = "2026, the isograde authors"
extensions = ["sphinx_gallery.gen_gallery"]
exclude_patterns = ["_build", "examples"]
html_theme = "alabaster"
html_theme_options = {"description": "Isosurfaces, written to be read, and graded."}
sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "auto_examples",
    "filename_pattern": "/plot_",
    "download_all_examples": False,
    "show_memory": False,
}


def write_articles(package: str, title: str) -> None:
    """One page a module of the package: its source, which is the article."""
    source = SOURCES[package]
    folder = HERE / "articles" / package
    folder.mkdir(parents=True, exist_ok=True)
    modules = sorted(p.relative_to(source) for p in source.rglob("*.py") if p.stem[0] != "_")
    for module in modules:
        name = ".".join((package, *module.with_suffix("").parts))
        path = Path("..") / ".." / ".." / source.relative_to(HERE.parent) / module
        (folder / f"{name}.rst").write_text(
            f"{name}\n{'=' * len(name)}\n\n.. literalinclude:: {path}\n   :language: python\n",
            encoding="utf-8",
        )
    (folder / "index.rst").write_text(
        f"{title}\n{'=' * len(title)}\n\n"
        f".. toctree::\n   :maxdepth: 1\n   :glob:\n\n   {package}.*\n",
        encoding="utf-8",
    )


write_articles("isoref", "The reference")
write_articles("isograde", "The grader")
