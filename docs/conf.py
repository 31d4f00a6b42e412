"""The site: texts of the repository, articles from the source, a course, an explorer.

What is written here is how Sphinx is set; what is made for it, and from what, is told in
`_ext/isosite`.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
for folder in (
    HERE / "_ext",
    HERE,
    HERE.parent,
    HERE.parent / "reference",
    HERE.parent / "validation",
):
    sys.path.insert(0, str(folder))

from isosite.notebooks import INSTALL  # noqa: E402 - behind the paths

project = "isograde"
author = "the isograde authors"
copyright = "2026, the isograde authors"
extensions = [
    "myst_parser",
    "sphinx_gallery.gen_gallery",
    "sphinx_design",
    "sphinx_copybutton",
    "isosite",
]
exclude_patterns = ["_build", "examples", "explorer", "ci", "course/solutions", "**/.*"]
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
highlight_language = "text"
nitpicky = True
# Quotes and dots, but no dashes: "--" stands for itself in commands.
smartquotes_action = "qe"

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 4
# TeX becomes MathML while the site is built: no script, no font, no network.
html_math_renderer = "mathml"

html_theme = "pydata_sphinx_theme"
html_title = "isograde"
html_static_path = ["_static"]
html_css_files = ["site.css"]
# Articles and lessons come before tests in what a search finds.
html_search_scorer = str(HERE / "_static" / "scorer.js")
html_show_sourcelink = False
html_copy_source = False
# Nothing is put into it: the search finds names.
html_use_index = False
html_last_updated_fmt = None
# The explorer is a page of its own, at the root of the site.
html_extra_path = ["explorer/explorer.html"]
html_context = {"default_mode": "light"}
html_theme_options = {
    "logo": {"text": "isograde"},
    "navbar_start": ["navbar-logo"],
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-button"],
    "header_links_before_dropdown": 9,
    "navigation_depth": 3,
    "show_nav_level": 1,
    "show_toc_level": 2,
    "collapse_navigation": True,
    "navigation_with_keys": False,
    "secondary_sidebar_items": {"**": ["page-toc"], "index": []},
    "article_footer_items": [],
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {
    "index": [],
    "changelog": [],
    "start/index": [],
    "readme": [],
    "articles/**": ["chapters.html"],
    "tests/**": ["chapters.html"],
}
templates_path = ["_templates"]

# Prompts are not copied.
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "auto_examples",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": "/plot_",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
    "first_notebook_cell": INSTALL,
}

linkcheck_anchors = False
linkcheck_timeout = 8
linkcheck_retries = 1
linkcheck_workers = 8
# A placeholder until the project has a home (pyproject.toml).
# And what is inside the site, which isosite/links.py looks up in it.
linkcheck_ignore = [r"https://isograde\.invalid/.*", r"(?!https?://)"]
