"""`pack results` from a definition to a valid result, and back to a stale one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pack_bringup.cli.main import app
from pack_lockstep.results import definitions
from pack_lockstep.results.history import read

DEFINITIONS = """
tuning_seeds: {blocks: {first: 1000, last: 1999}}
trends: {plans: {success: verified, of: instances}}
benchmarks:
  blocks/four: {command: blocks --blocks 4 --instances 2 --budget 5, trend: plans, minutes: 1, jobs: 1}
  blocks/refused: {command: blocks --blocks 99, trend: plans, minutes: 0.1}
"""


def pack(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["results", *words], terminal_width=200)
    return done.exit_code, done.output


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of results, with recordings and trials beside it."""
    (tmp_path / "benchmarks.yaml").write_text(DEFINITIONS)
    monkeypatch.setattr(definitions, "results_path", lambda: tmp_path)
    monkeypatch.setattr("pack_core.paths.bags_path", lambda: tmp_path / "bags")
    return tmp_path


@pytest.mark.timeout(300)  # it measures twice, in processes of their own
def test_a_missing_result_is_measured_published_and_valid_until_a_source_changes(folder: Path) -> None:
    code, shown = pack()
    assert code == 0
    assert "2 missing" in shown

    code, shown = pack("run", "blocks/four")
    assert code == 0, shown
    file = folder / "blocks" / "four.json"
    values = json.loads(file.read_text())
    assert values["command"] == "pack benchmark blocks --blocks 4 --instances 2 --budget 5"
    assert values["summary"]["instances"] == values["summary"]["verified"] == 2
    assert values["machine"].endswith("GiB")
    assert "config/cells/blocks.yaml" in values["sources"]
    assert not [path for path in values["sources"] if "pack_viewer" in path or "pallet_fsm" in path]
    assert [(row["name"], row["success"], row["of"]) for row in read(folder)] == [("blocks/four", "2", "2")]
    assert "1 valid, 1 missing" in pack()[1]
    assert "all of these results are valid" in pack("run", "blocks/four")[1]

    measured = file.stat().st_mtime_ns
    values["sources"]["config/cells/blocks.yaml"] = "of another day"
    file.write_text(json.dumps(values))
    code, shown = pack("list", "blocks/four")
    assert "stale because config/cells/blocks.yaml changed: blocks/four" in shown
    assert pack("run", "blocks/four")[0] == 0
    assert file.stat().st_mtime_ns > measured
    assert "1 valid" in pack("list", "blocks/four")[1]


def test_a_benchmark_that_fails_is_named_and_publishes_nothing(folder: Path) -> None:
    code, shown = pack("run", "blocks/refused")
    assert code == 1
    assert "could not be measured: blocks/refused" in shown
    assert not (folder / "blocks").exists()
    assert read(folder) == []
