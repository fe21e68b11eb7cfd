"""Files and bytes from outside: encoding and size, JSON, lines of errors, and what is shown."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.config import Config, parse_config
from pack_core.errors import ConfigError
from pack_core.text.explanation import Lines
from pack_core.text.json_text import parse_json
from pack_core.text.limits import MOST_BYTES, Number
from pack_core.text.reader import decoded, read_text
from pack_core.text.shown import LONGEST_VALUE, listed, printable, shown_value


class Part(Config):
    weight: Number


class Whole(Config):
    parts: list[Part]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("a: 1\nb: é".encode("latin-1"), "line 2: byte 0xe9 is no text in UTF-8"),
        ("a: 1".encode("utf-16"), "line 1: byte 0xff is no text in UTF-8"),
        (b"x" * (MOST_BYTES + 1), "2.0 MB; allowed: up to 2 MB"),
    ],
)
def test_bytes_that_are_no_usable_text_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    (tmp_path / "file").write_bytes(content)
    for read in (lambda: read_text(tmp_path / "file"), lambda: decoded(content, "upload")):
        with pytest.raises(ConfigError) as caught:
            read()
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("name", "words"), [("none", "no such file"), (".", "cannot be read"), ("\0", "cannot")]
)
def test_a_path_that_cannot_be_read_is_named(tmp_path: Path, name: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        read_text(tmp_path / name)


def test_the_mark_that_editors_put_in_front_is_no_part_of_the_text() -> None:
    assert decoded(b"\xef\xbb\xbfa: 1", "file") == "a: 1"


def refusal(text: str) -> str:
    """Why the text is no JSON; empty if it is."""
    try:
        parse_json(text, "the file")
    except ConfigError as error:
        return str(error)
    return ""


@given(st.text())
def test_a_text_is_json_or_refused_by_the_name_of_its_file(text: str) -> None:
    assert not (said := refusal(text)) or said.startswith("the file")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a": 1, "b": 2, "a": 3}', "key 'a' is given twice"),
        ("1" * 5000, "has 5000 digits"),
        ('{"a":' * 60 + "1" + "}" * 60, "deeper than 40 levels"),
        ('{"a":' * 100_000 + "1" + "}" * 100_000, "deeper than 40 levels"),
        (json.dumps([0] * 300_000), "more than 200000 values"),
        ('{"a": "\\ud800"}', "half of a sign"),
        ('{"a": 1,\n}', "text, line 2: is no JSON"),
    ],
)
def test_json_beyond_the_limits_is_refused(text: str, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_json(text, "text")
    assert words in str(caught.value)


def test_whole_signs_of_two_escapes_are_allowed() -> None:
    assert parse_json('["\\ud83d\\ude00"]', "text") == ["😀"]


def test_an_error_names_file_line_key_value_and_what_is_allowed() -> None:
    with pytest.raises(ConfigError) as caught:
        parse_config(Whole, "parts:\n- weight: 1\n- weight: heavy\n  colour: red\n", "w.yaml")
    assert str(caught.value).splitlines() == [
        "w.yaml, line 3: key 'parts.1.weight' is 'heavy'; allowed: a number, not a text",
        "w.yaml, line 4: key 'parts.1.colour' is not known; allowed: weight",
    ]


@pytest.mark.parametrize("given", ["true", "'0.4'", ".nan", ".inf", "null", "[1]"])
def test_what_is_no_finite_number_is_refused(given: str) -> None:
    with pytest.raises(ConfigError, match="weight"):
        parse_config(Part, f"weight: {given}", "part")


@pytest.mark.parametrize(("given", "value"), [("1e-3", 0.001), ("2", 2.0), ("1.5e+2", 150.0)])
def test_numbers_are_read_as_they_are_usually_written(given: str, value: float) -> None:
    assert parse_config(Part, f"weight: {given}", "part").weight == value


def test_lines_are_found_in_json_too() -> None:
    assert Lines('{"a": 1,\n "b": [1,\n 2]}').of(("b", 1)) == 3
    assert Lines("no: [").of(("no",)) is None


@given(st.text())
def test_what_is_shown_has_no_control_character_but_line_breaks(text: str) -> None:
    assert all(line.isprintable() for line in printable(text).split("\n"))


@given(st.text() | st.lists(st.integers()) | st.binary())
def test_values_are_shown_short_and_printable(value) -> None:
    text = shown_value(value)
    assert text.isprintable()
    assert len(text) <= LONGEST_VALUE


def test_a_terminal_is_not_steered() -> None:
    assert printable("a\x1b[2J\u202eb\n") == "a\\x1b[2J\\u202eb\n"


def test_many_problems_are_counted() -> None:
    assert listed([str(k) for k in range(50)]).splitlines()[-1] == "and 30 more problems"
