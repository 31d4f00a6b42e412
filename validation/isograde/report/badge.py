"""A badge: the level reached, as a small SVG, or as JSON from which shields.io draws one."""

from __future__ import annotations

import json
from html import escape

from isograde.report import words
from isograde.report.reading import Report

COLOURS = {None: "#b4262a", 0: "#b4262a", 1: "#b7791f", 2: "#2f855a", 3: "#276749", 4: "#1c4532"}
UNKNOWN = "#6b7280"
# Widths of Verdana 11 px are close to this many pixels a letter.
LETTER, MARGIN = 6.6, 10


def badge(report: Report) -> str:
    """The badge as SVG."""
    left, right = "isograde", _said(report)
    whole = report.footer is not None and not report.partial
    colour = COLOURS[report.reached] if whole else UNKNOWN
    a, b = (round(LETTER * len(text) + 2 * MARGIN) for text in (left, right))
    text = escape(right)
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{a + b}" height="20" role="img" \
aria-label="{left}: {text}">
<title>{left}: {text}</title>
<clipPath id="r"><rect width="{a + b}" height="20" rx="4"/></clipPath>
<g clip-path="url(#r)">
<rect width="{a}" height="20" fill="#374151"/>
<rect x="{a}" width="{b}" height="20" fill="{colour}"/>
</g>
<g fill="#fff" text-anchor="middle" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">
<text x="{a / 2:g}" y="14">{left}</text>
<text x="{a + b / 2:g}" y="14">{text}</text>
</g>
</svg>
"""


def shields(report: Report) -> str:
    """The badge as JSON of the schema that shields.io draws from an address ("endpoint")."""
    whole = report.footer is not None and not report.partial
    colour = COLOURS[report.reached] if whole else UNKNOWN
    said = {"schemaVersion": 1, "label": "isograde", "message": _said(report)}
    return json.dumps({**said, "color": colour.removeprefix("#")}) + "\n"


def _said(report: Report) -> str:
    """The level reached, of how many."""
    said = words.reached(report)
    return f"{said} of {report.top}" if said.startswith("level") else said
