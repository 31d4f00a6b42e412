"""JSON as the standard has it: what is not, is said with its place and what to write instead."""

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from isograde.adapters.answers import arrays_said
from isograde.adapters.strict import NotJSON, isovalue, parse, written
from isograde.model import SURFACES


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"v": [0.5, nan]}', "not JSON at column 13: nan; write null"),
        ('{"v": [0.5, NaN]}', "not JSON at column 13: NaN; write null"),
        ('{"v": [0.5, -Infinity]}', "not JSON at column 13: -Infinity; write null"),
        ('{"v": [0.5, -inf]}', "not JSON at column 13: -inf; write null"),
        ('{"v": [0.5, -nan(ind)]}', "not JSON at column 13: -nan(ind); write null"),
        ('{"v": [0.5, 1.#QNAN]}', "not JSON at column 14: .#QNAN"),
        ('{"NaN": "Infinity", "v": Infinity}', "not JSON at column 26: Infinity; write null"),
        ("{'v': 1}", "not JSON at column 2: 'v'; texts stand in double quotes"),
        ('{"v": True}', "not JSON at column 7: True; write true"),
        ('{"v": None}', "not JSON at column 7: None; write null"),
        ("[1, 2,]", "not JSON at column 7: ]; is there a comma too many before it?"),
        ("[1, 2", "not JSON at column 6: it ends there"),
        ("", "not JSON at column 1: it ends there"),
        ("[1,\n 2, nan]", "not JSON at line 2, column 5: nan; write null"),
        ("[" * 100_000, "nested too deeply"),
        ("9" * 5000, "not JSON that can be read"),
    ],
)
def test_what_is_not_json_is_said_with_its_place(text: str, words: str) -> None:
    with pytest.raises(NotJSON) as told:
        parse(text)
    assert words in str(told.value)


def test_bytes_that_are_no_text_are_said_so() -> None:
    with pytest.raises(NotJSON, match="not UTF-8 at byte 2"):
        parse(b"[\xff]")


@given(st.text() | st.binary())
def test_whatever_comes_is_json_or_said_not_to_be(text: str | bytes) -> None:
    """Fuzz: nothing but `NotJSON` is raised, in one line that quotes little."""
    try:
        parse(text)
    except NotJSON as error:
        told = str(error)
    else:
        told = ""
    assert len(told) < 300


@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers()
        | st.text()
        | st.floats(allow_nan=False, allow_infinity=False),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
        max_leaves=20,
    )
)
def test_what_is_written_is_read_back(message: object) -> None:
    assert parse(written(message)) == message


@given(st.text(alphabet='{}[]",:0123456789.-eENaInfinity tru\\', max_size=40))
def test_strict_reading_agrees_with_python_where_no_word_is_foreign(text: str) -> None:
    """Whatever Python's reader takes without NaN and Infinity, ours takes, and the same."""
    foreign: list[str] = []
    try:
        expected = json.loads(text, parse_constant=foreign.append)
    except ValueError:
        with pytest.raises(NotJSON):
            parse(text)
        return
    if foreign:
        with pytest.raises(NotJSON, match="write null"):
            parse(text)
    else:
        assert parse(text) == expected or math.isnan(expected)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_message_has_no_bare_word(value: float) -> None:
    assert isinstance(json.loads(written({"isovalues": [isovalue(value)]}))["isovalues"][0], str)
    with pytest.raises(ValueError, match=r"not JSON compliant"):
        written([value])


def test_null_is_a_coordinate_that_is_not_finite() -> None:
    said = {"vertices": [[0, 0, None], [1, 0, 0], [0, 1, 0]], "simplices": [[0, 1, 2]]}
    vertices, _ = arrays_said(said, Path(), 1000, SURFACES)
    assert math.isnan(vertices[0, 2])
