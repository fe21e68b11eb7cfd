"""The benchmark's command: its results are kept, gone on with, refused to other settings, measured anew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from pack_bringup.cli.main import app
from pack_core.paths import config_path

pytestmark = pytest.mark.timeout(300)


@pytest.fixture
def orders(tmp_path: Path) -> Path:
    """A folder of one order."""
    folder = tmp_path / "orders"
    folder.mkdir()
    (folder / "order_03.json").write_text(config_path("orders", "order_03.json").read_text())
    return folder


def benchmark(orders: Path, *options: str) -> Result:
    """Run the command with gains that the driver refuses at once, so that an order takes no time."""
    fixed = ["--no-vision", "--motion", "table_4_1", "--output", str(orders.parent / "results")]
    return CliRunner().invoke(app, ["benchmark", "palletizing", "--orders", str(orders), *fixed, *options])


def test_orders_that_cannot_be_built_are_all_named_before_anything_runs(tmp_path: Path) -> None:
    outcome = benchmark(config_path("orders", "stress"), "--output", str(tmp_path / "results"))
    named = {line.split("'")[1] for line in str(outcome.exception).splitlines()}
    assert len(named) == 9
    assert not (tmp_path / "results").exists()


def test_results_are_kept_and_measured_anew_only_where_asked_for(orders: Path) -> None:
    results, summary = orders.parent / "results" / "trials.jsonl", orders.parent / "new" / "summary.json"
    first = benchmark(orders, "--json", str(summary))
    assert first.exit_code == 0, first.output
    assert json.loads(summary.read_text())["orders"] == 1
    kept = results.read_text()
    report = (results.parent / "report.html").read_text()
    assert "order_03" in report
    assert "<td>command</td>" in report

    again = benchmark(orders)
    assert "1 of 1 trials are there already" in again.output
    assert results.read_text() == kept

    other = benchmark(orders, "--profile", "thesis")
    assert "blended in the file, thesis now" in str(other.exception)
    assert "--fresh to measure anew" in str(other.exception)
    assert results.read_text() == kept

    fresh = benchmark(orders, "--profile", "thesis", "--fresh")
    assert fresh.exit_code == 0, fresh.output
    settings = json.loads(results.read_text().splitlines()[0])["settings"]
    assert settings["config"]["palletizer"]["profile"] == "thesis"
