"""The slides of the course: reveal.js, by sphinx-revealjs, which brings it along.

    python -m sphinx -W -b revealjs docs/course/slides docs/_build/slides

reveal.js is what lecturers know: arrow keys, an overview, printing to PDF;
and the Sphinx builder takes the same reStructuredText and the same films as the lessons. Nothing
is loaded from a network. The source ends in .txt so that the site does not take it for a page.
"""

project = "Isosurfaces, and how to judge them"
author = "the isograde authors"
copyright = "2026, the isograde authors"
extensions = ["sphinx_revealjs"]
source_suffix = {".txt": "restructuredtext"}
highlight_language = "text"
html_static_path = ["static"]
revealjs_static_path = ["static"]
revealjs_html_theme = "revealjs-simple"
revealjs_style_theme = "white"
revealjs_css_files = ["slides.css"]
revealjs_script_conf = {"hash": True, "slideNumber": "c/t", "transition": "none", "width": 1100}
