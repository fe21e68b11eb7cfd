"""YAML from outside: what is allowed is read as PyYAML reads it, all else is one error with its line."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fuzz.mutations import BOMB, LINES
from pack_core.errors import ConfigError
from pack_core.paths import config_path
from pack_core.text.limits import MOST_BYTES, MOST_VALUES
from pack_core.text.yaml_text import parse_yaml

# PyYAML writes this line break so that it reads it as a space itself.
TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\x85"))
VALUES = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.integers(-(2**62), 2**62) | TEXTS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=4),
    max_leaves=20,
)


@given(VALUES)
def test_what_is_written_is_read_again(values) -> None:
    assert parse_yaml(yaml.safe_dump(values), "text") == values
    assert parse_yaml(yaml.safe_dump(values, default_flow_style=True, allow_unicode=True), "text") == values


@pytest.mark.parametrize("path", sorted(config_path().rglob("*.yaml")), ids=lambda path: path.name)
def test_the_shipped_files_are_read_as_pyyaml_reads_them(path) -> None:
    text = path.read_text()
    assert parse_yaml(text, str(path)) == yaml.safe_load(text)


def refusal(text: str) -> str:
    """Why the text is not read; empty if it is."""
    try:
        parse_yaml(text, "the file")
    except ConfigError as error:
        return str(error)
    return ""


@given(st.text(alphabet=st.sampled_from("ab:-[]{}&*!<>|%@\"'#\n \t0.1e~?,\\x")) | st.text())
def test_a_text_is_read_or_refused_by_the_name_of_its_file(text: str) -> None:
    assert not (said := refusal(text)) or said.startswith("the file")


@pytest.mark.parametrize("line", LINES)
def test_so_is_a_strange_line_wherever_it_stands(line: str) -> None:
    for text in (line, f"a: 1\n{line}", f"{line}\nb: 2"):
        assert not (said := refusal(text)) or said.startswith("the file")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3", "text, line 3: key 'a' is given twice"),
        ("a: 1\nb: !!python/name:os.system x", "text, line 2: tag 'tag:yaml.org,2002:python/name:os.system'"),
        ("a: !!int spam", "text, line 1: 'spam' is not of the type int"),
        ("a: !!set {b}", "text, line 1: tag 'tag:yaml.org,2002:set' is not allowed"),
        ("[" * 60 + "]" * 60, "deeper than 40 levels"),
        ("a: &x [*x]", "text, line 1: alias '*x' has no '&x' that ends before it"),
        (BOMB, f"more than {MOST_VALUES} values"),
        ("a: " + "9" * 400, "a number of 400 characters"),
        ("a: 99999999999999999999", "is too large; allowed: 64 bits"),
        ("a: [1, 2\nb: 3", "text, line 2: not readable as YAML"),
        ("a: 1\n---\nb: 2", "a second document begins"),
        ("? [a, b]\n: 1", "a key is a list"),
        ("<<: 5", "'<<' is 5; allowed: mappings"),
        ("#" * (MOST_BYTES + 1), "allowed: up to 2 MB"),
        ("a: \x1b[31m", "not readable as YAML"),
    ],
)
def test_what_is_not_allowed_is_named_with_its_line(text: str, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_yaml(text, "text")
    assert words in str(caught.value)


def test_aliases_and_merged_mappings_are_allowed() -> None:
    text = "base: &base {a: 1, b: 2}\nother: {<<: *base, b: 3}\nlist: [*base, *base]"
    assert parse_yaml(text, "text") == yaml.safe_load(text)


def test_a_date_is_a_text() -> None:
    assert parse_yaml("a: 2026-01-01\nb: 2001-99-99", "text") == {"a": "2026-01-01", "b": "2001-99-99"}
