"""`pack results` from a definition and a stale result to a valid one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pack_bringup.cli.main import app
from pack_evaluation.provenance import installed_versions
from pack_lockstep.results import definitions
from pack_lockstep.results.history import read
from pack_lockstep.results.published import PublishedResult

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


@pytest.mark.timeout(300)  # it measures in processes of their own
def test_a_result_that_is_stale_as_a_source_changed_is_measured_published_and_valid(folder: Path) -> None:
    command = "pack benchmark blocks --blocks 4 --instances 2 --budget 5"
    file = folder / "blocks" / "four.json"
    PublishedResult(
        command, "2025-01-01", "0.1", "1a2b", "a machine", installed_versions(), {},
        {"config/cells/blocks.yaml": "of another day"},
    ).save(file)  # fmt: skip
    code, shown = pack()
    assert code == 0
    assert "1 stale, 1 missing" in shown
    assert "stale because config/cells/blocks.yaml changed: blocks/four" in shown

    code, shown = pack("run", "blocks/four")
    assert code == 0, shown
    values = json.loads(file.read_text())
    assert values["command"] == command
    assert values["summary"]["instances"] == values["summary"]["verified"] == 2
    assert values["machine"].endswith("GiB")
    assert "config/cells/blocks.yaml" in values["sources"]
    assert not [path for path in values["sources"] if "pack_viewer" in path or "pallet_fsm" in path]
    assert [(row["name"], row["success"], row["of"]) for row in read(folder)] == [("blocks/four", "2", "2")]
    assert "1 valid, 1 missing" in pack()[1]
    assert "all of these results are valid" in pack("run", "blocks/four")[1]


def test_a_benchmark_that_fails_is_named_and_publishes_nothing(folder: Path) -> None:
    code, shown = pack("run", "blocks/refused")
    assert code == 1
    assert "could not be measured: blocks/refused" in shown
    assert not (folder / "blocks").exists()
    assert read(folder) == []
