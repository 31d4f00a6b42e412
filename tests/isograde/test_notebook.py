"""A notebook, executed by Jupyter's own client: what its cells show, and the bar meanwhile."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from tests.browser import found

# A notebook of three cells: a function, its grade, and two side by side.
CELLS = (
    """
import isograde
from isoref import extract as reference

turns = 0

def mine(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing, method="lorensen-cline")
    return mesh.vertices, mesh.simplices[:, [turns, 1 - turns, 2]]
""",
    'graded = isograde.grade(mine, only=["pairs/0217", "topology.*"], jobs=1)\ngraded',
    'isograde.compare(graded, "isoref:asymptotic-decider", only=["pairs/0217", "topology.*"])',
)


@pytest.fixture(scope="module")
def executed() -> tuple[list[Any], list[str]]:
    """The outputs of each cell, and the HTML of every display that was changed on the way."""
    pytest.importorskip("ipykernel")
    nbclient: Any = pytest.importorskip("nbclient")
    from nbformat.v4 import new_code_cell, new_notebook

    shown: list[str] = []

    class Watched(nbclient.NotebookClient):  # type: ignore[misc]
        """Jupyter's client, which also keeps what was shown only for a while."""

        def process_message(self, msg: Any, cell: Any, cell_index: int) -> Any:
            if msg["msg_type"] in ("display_data", "update_display_data"):
                shown.append(msg["content"]["data"]["text/html"])
            return super().process_message(msg, cell, cell_index)

    notebook = new_notebook(cells=[new_code_cell(source) for source in CELLS])
    Watched(notebook, timeout=120, kernel_name="python3").execute()
    return [cell.outputs for cell in notebook.cells], shown


def test_a_grade_shows_its_findings_and_folds_the_page_away(executed: Any) -> None:
    """A function that only the kernel has, with what it takes from its cell, is graded."""
    _, (bar, answer), _ = executed[0]
    assert bar["output_type"] == "display_data"
    assert answer["output_type"] == "execute_result"
    assert answer["data"]["text/plain"].startswith("<isograde.Grade function:mine - ")
    html = answer["data"]["text/html"]
    above, _, below = html.partition("<details>")
    assert "topology.closed: 1 fail" in above
    assert "topology.sides" not in above  # so the function's own number came with it
    assert "isograde report" in unescape(below)


def test_a_bar_stands_there_while_it_lasts(executed: Any) -> None:
    """From nothing to all of the cases, then an empty place."""
    outputs, shown = executed
    bars = [one for one in shown if "<progress" in one]
    assert bars[0] == '<progress value="0" max="1"></progress> mine, 0 of 1 cases'
    assert re.fullmatch(
        r'<progress value="1" max="1"></progress> mine, 1 of 1 cases, \d+ findings?', bars[1]
    )
    assert shown[-1] == ""
    assert all(output["data"]["text/html"] == "" for cell in outputs for output in cell[:-1])


def test_what_a_notebook_shows_opens_in_a_browser(executed: Any, tmp_path: Path) -> None:
    """Each folded page has a frame of its own, which takes its place when it is unfolded."""
    outputs, _ = executed
    body = "".join(cell[-1]["data"]["text/html"] for cell in outputs[1:])
    page = f"<!doctype html><html><head><title>n</title></head><body>{body}</body></html>"
    script = """
      const all = [...document.querySelectorAll("details")];
      all.forEach(d => { d.open = true; });
      await new Promise(r => setTimeout(r, 1500));
      return all.map(d => {
        const box = d.querySelector("iframe").getBoundingClientRect();
        return [Math.round(box.height) > 300, box.width > 300];
      });"""
    assert found(page, script, tmp_path) == [[True, True], [True, True]]


def test_the_notebook_can_be_written(executed: Any) -> None:
    """Every output is JSON, as a notebook's file is."""
    for cell in executed[0]:
        assert json.loads(json.dumps(cell)) == cell
