"""Tables of pages from the files of results."""

from dataclasses import replace
from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_lockstep.results.pages import measured, pages, with_tables
from pack_lockstep.results.published import PublishedResult


def result(version: str = "2.0.0", **summary: object) -> PublishedResult:
    return PublishedResult(
        command="pack benchmark packing", date="2026-01-02", version=version, commit="1a2b3c4d5e6f",
        machine="", packages={}, summary=summary, sources={},
    )  # fmt: skip


RESULTS = {
    "packing/ideal": result(success=99, scenes=100, time={"mean": 3.3456}, states={"7 rotate": 2}, auc=None),
    "packing/old": result("1.0.0", success=1),
}


def page(row: str) -> str:
    template = f"| measure | here |\n|---|---|\n{row}"
    return f"# Results\n\n<!-- table\n{template}\n-->\nwhat was here\n<!-- end of table -->\n\nEnd.\n"


def written(row: str) -> list[str]:
    """The lines between template and end."""
    text = with_tables(page(row), RESULTS, "2.0.0")
    assert text.startswith("# Results\n\n<!-- table\n")
    assert text.endswith("<!-- end of table -->\n\nEnd.\n")
    assert with_tables(text, RESULTS, "2.0.0") == text
    return text.split("-->\n", 1)[1].split("<!-- end")[0].splitlines()


def test_figures_stand_in_the_place_of_their_names() -> None:
    lines = written(
        "| packed | {packing.ideal.success} of {packing.ideal.scenes}, {packing.ideal.time.mean:.2f} s |"
    )
    assert lines[:3] == ["| measure | here |", "|---|---|", "| packed | 99 of 100, 3.35 s |"]
    assert lines[4] == "*Measured with version 2.0.0, commit 1a2b3c4d, 2026-01-02.*"


def test_keys_with_spaces_are_written_in_brackets() -> None:
    assert written("| visits | {packing.ideal.states[7 rotate]} |")[2] == "| visits | 2 |"


def test_what_was_not_measured_is_a_dash() -> None:
    lines = written("| packed | {packing.new.time.mean:.2f} | {packing.ideal.auc:.2f} |")
    assert lines[2] == "| packed | – | – |"
    assert lines[4] == (
        "*Not measured yet: packing/new; "
        "measured with version 2.0.0, commit 1a2b3c4d, 2026-01-02: all others.*"
    )


def test_results_of_several_versions_are_told_apart() -> None:
    later = replace(RESULTS["packing/ideal"], date="2026-01-05")
    given = {
        "packing/ideal": RESULTS["packing/ideal"],
        "packing/later": later,
        "packing/old": RESULTS["packing/old"],
    }
    assert measured(given, "2.0.0") == (
        "*Measured with the earlier version 1.0.0, 2026-01-02: packing/old; "
        "measured with version 2.0.0, commit 1a2b3c4d, 2026-01-02 to 2026-01-05: all others.*"
    )


def test_figures_of_an_earlier_version_are_called_so() -> None:
    lines = written("| packed | {packing.old.success} |")
    assert lines[4] == "*Measured with the earlier version 1.0.0, 2026-01-02.*"


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("| {packing.ideal.sucess} |", "no sucess; there are success, scenes"),
        ("| {packing.ideal.time.mean:q} |", "Unknown format code"),
        ("| {packing.ideal.success |", "expected '}'"),
        ("| no result |", "cannot be written"),
    ],
)
def test_a_template_with_a_mistake_is_refused(row: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        with_tables(page(row), RESULTS, "2.0.0")


def test_pages_with_tables_are_found(tmp_path: Path) -> None:
    (tmp_path / "docs" / "cells").mkdir(parents=True)
    (tmp_path / "README.md").write_text(page("| a |"))
    (tmp_path / "docs" / "plain.md").write_text("# Nothing to measure\n")
    (tmp_path / "docs" / "cells" / "results.md").write_text(page("| a |"))
    assert pages(tmp_path) == [tmp_path / "README.md", tmp_path / "docs" / "cells" / "results.md"]
