"""A page opened from disk in a real browser, and what a script found there; Chromium alone.

Chromium runs without a window, with an empty profile, and prints the page as it stands after the
script: no other package is needed.
"""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--virtual-time-budget=20000", "--dump-dom",
)  # fmt: skip
SCRIPT = """
<script>
addEventListener("load", async () => {{
  const told = document.createElement("pre");
  told.id = "what-the-test-found";
  try {{
    told.textContent = JSON.stringify(await (async () => {{ {body} }})());
  }} catch (error) {{
    told.textContent = JSON.stringify({{ error: String(error.stack) }});
  }}
  document.body.append(told);
}});
</script>
"""


def chromium() -> str:
    """The browser's program, or a skip that says how to provide it."""
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip("no chromium: the page was not opened in a browser (apt-get install chromium)")
    return program


def found(page: str, script: str, folder: Path, *flags: str, fragment: str = "") -> Any:
    """What the body of an asynchronous function returns on this page, as JSON."""
    program = chromium()
    file = folder / "page.html"
    body = SCRIPT.format(body=script)
    file.write_text(page.replace("</body>", f"{body}</body>"), encoding="utf-8")
    done = subprocess.run(
        [
            program,
            *FLAGS,
            *flags,
            f"--user-data-dir={folder / 'profile'}",
            f"{file.as_uri()}{fragment}",
        ],
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=True,
    )
    told = re.search(r'<pre id="what-the-test-found">(.*?)</pre>', done.stdout, re.DOTALL)
    assert told, f"the page's script did not end: {done.stderr[-2000:]}"
    answer = json.loads(html.unescape(told[1]))
    assert not (isinstance(answer, dict) and "error" in answer), answer
    return answer
