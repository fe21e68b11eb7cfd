import re

import pytest

from pack_evaluation.packing.evaluator import EVALUATOR
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("run")
    writer = GoalWriter(folder)
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    (folder / "run.yaml").write_text(
        "cell: packing\nseed: 7\nconfiguration: {nodes/packing/sim.yaml: {rate: 42}}\n"
    )
    return EVALUATOR.evaluate(folder, folder / "out", with_video=False).report.read_text()


def test_a_report_needs_nothing_beside_it(text: str) -> None:
    assert all(source.startswith("data:image/png;base64,") for source in re.findall(r'src="([^"]*)"', text))
    assert "http" not in text


def test_a_report_shows_every_plot_and_the_measures(text: str) -> None:
    assert re.findall(r'<img alt="(\w+)"', text) == [
        "distance",
        "force",
        "iterations",
        "displacement",
        "estimate",
    ]
    assert "10.00 cm" in text
    assert "placed: within 15 mm" in text


def test_a_report_says_how_the_run_was_made(text: str) -> None:
    assert "<td>seed</td><td>7</td>" in text
    assert "rate: 42" in text
    assert "passata" in text
