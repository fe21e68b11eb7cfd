"""`pack benchmark blocks` as it is typed: tables, summary, report, what is kept."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from pack_bringup.cli.main import app
from pack_core.paths import config_path

EXAMPLE = config_path("scenarios", "blocks", "example.yaml")
KEYS = {
    "instances", "solved", "verified", "first_plan_ms", "actions", "lower_bound", "executed", "executed_ok",
}  # fmt: skip
STUCK = """
workspace: [[300, -300], [900, -300], [900, 300], [300, 300]]
blocks:
- {id: a, start: [600, 0, 0], goal: [800, 200, 0]}
- {id: b, start: [650.8, 0, 0], goal: [800, 100, 0]}
- {id: c, start: [600, 50.8, 0], goal: [800, 0, 0]}
- {id: d, start: [650.8, 50.8, 0], goal: [800, -100, 0]}
"""

pytestmark = pytest.mark.timeout(300)


def benchmark(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["benchmark", "blocks", *map(str, arguments)])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of one run with both methods, an example and a problem that has no plan."""
    folder = tmp_path_factory.mktemp("benchmark")
    (folder / "stuck.yaml").write_text(STUCK)
    outcome = benchmark(
        "--problem", EXAMPLE, "--problem", folder / "stuck.yaml", "--method", "beam", "--method", "pirs",
        "--budget", 0.5, "--pictures", 1, "-o", folder / "own", "--json", folder / "sums" / "own.json",
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    (folder / "stdout").write_text(outcome.output)
    return folder


def test_the_summary_has_its_keys_for_each_method(folder: Path) -> None:
    summaries = json.loads((folder / "sums" / "own.json").read_text())
    assert set(summaries) == {"beam", "pirs"}
    for summary in summaries.values():
        assert summary.keys() >= KEYS
        assert (summary["instances"], summary["solved"], summary["verified"]) == (2, 1, 1)
        assert summary["statuses"]["INFEASIBLE"] == 1
        assert summary["actions"]["max"] >= summary["lower_bound"]["max"] == 5


def test_methods_stand_side_by_side_and_proofs_in_words(folder: Path) -> None:
    text = (folder / "stdout").read_text()
    assert "INFEASIBLE: stuck: none of a, b, c, d can be grasped or pushed" in text
    assert all(part in text for part in ("beam", "pirs", "1 of 2"))


def test_the_report_has_the_tables_and_the_drawn_plans(folder: Path) -> None:
    report = (folder / "own" / "report.html").read_text()
    assert report.count("data:image/png;base64,") == 4  # of either method a plan, and what is within reach
    for part in ("<th>beam</th><th>pirs</th>", "OPTIMAL, 5 (5)", "stuck: none of"):
        assert part in report


def test_the_folder_has_the_summary_too(folder: Path) -> None:
    kept = (folder / "own" / "summary.json").read_text()
    assert kept == (folder / "sums" / "own.json").read_text()


def test_what_was_measured_is_not_measured_again(folder: Path) -> None:
    before = (folder / "own" / "trials.jsonl").read_text()
    outcome = benchmark(
        "--problem", EXAMPLE, "--budget", 0.5, "--pictures", 0, "-o", folder / "own",
        "--json", folder / "one.json",
    )  # fmt: skip
    assert "1 of 1 trials are there already" in outcome.output
    assert (folder / "own" / "trials.jsonl").read_text() == before
    assert json.loads((folder / "one.json").read_text())["instances"] == 1
