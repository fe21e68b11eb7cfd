"""The file that names the published benchmarks."""

from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_lockstep.results.definitions import Definitions, load_definitions

TEXT = """
tuning_seeds: {packing: {first: 0, last: 9}}
trends:
  scenes: {success: success, of: scenes, time_s: time.mean}
benchmarks:
  packing/quick: {command: packing --scenes 2, trend: scenes, minutes: 1}
  packing/long: {command: packing --scenes 100, trend: scenes, minutes: 50}
  blocks/plans: {command: blocks, trend: scenes, minutes: 2, jobs: 1}
  blocks/live: {command: live blocks --seeds 3, trend: scenes, minutes: 0.5}
"""


def definitions(text: str, folder: Path) -> Definitions:
    (folder / "benchmarks.yaml").write_text(text)
    return load_definitions(folder)


def test_the_longest_comes_first(tmp_path: Path) -> None:
    found = definitions(TEXT, tmp_path)
    assert list(found.chosen([])) == ["packing/long", "blocks/plans", "packing/quick", "blocks/live"]
    assert list(found.chosen(["packing"])) == ["packing/long", "packing/quick"]
    assert list(found.chosen(["packing/quick", "blocks"])) == ["blocks/plans", "packing/quick", "blocks/live"]
    assert [name for name, definition in found.benchmarks.items() if definition.is_live] == ["blocks/live"]
    assert found.benchmarks["packing/long"].arguments == ["packing", "--scenes", "100"]


def test_an_unknown_name_is_refused_with_those_that_exist(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"no benchmark packing/slow; allowed: .*packing/quick"):
        definitions(TEXT, tmp_path).chosen(["packing/slow"])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("blocks/plans:", "cubes/plans:", "cubes/plans; allowed: one of packing, palletizing, blocks"),
        ("command: blocks", "command: packing", "allowed: a command that begins with blocks"),
        ("live blocks", "live packing", "allowed: a command that begins with blocks or live blocks"),
        ("live blocks", "live", "allowed: a command that begins with blocks or live blocks"),
        ("trend: scenes, minutes: 2", "trend: orders, minutes: 2", "trend orders; allowed: scenes"),
        ("minutes: 50", "minutes: 0", "greater than 0"),
    ],
)
def test_a_wrong_definition_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        definitions(TEXT.replace(old, new), tmp_path)


def test_the_history_has_what_the_summary_has(tmp_path: Path) -> None:
    found = definitions(TEXT, tmp_path)
    summary = {"success": 2, "scenes": 2, "time": {"mean": 3.5}}
    assert found.trend_of("packing/quick", summary) == {"success": 2, "of": 2, "time_s": 3.5}
    assert found.trend_of("packing/quick", {"success": 2}) == {"success": 2, "of": None, "time_s": None}
