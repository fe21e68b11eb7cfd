import re
from pathlib import Path

import numpy as np
import pytest

from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.seen_deviations import SEEN, SeenDeviations, SeenObjects, in_words
from pack_evaluation.packing.evaluator import EVALUATOR
from pack_evaluation.packing.from_bag import load_run
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


def test_a_report_says_how_sure_the_look_was_of_each_object(tmp_path: Path) -> None:
    scene = packing_cell().scene
    box = scene.model_of("tea_box")
    known = SeenDeviations(position=(0.001, 0.001, 0.001), size=(0.002, 0.004, 0.001), yaw=0.01)
    writer = GoalWriter(tmp_path)
    writer.write(0.0, topics.SIM_DESCRIPTION, data=scene.description().to_yaml())
    intrinsics = {"k": np.zeros(9), "r": np.zeros(9), "p": np.zeros(12)}
    writer.write(0.0, topics.DEPTH_INFOS[0], **intrinsics)
    writer.write(0.0, SEEN, data=SeenObjects(time=0.0, objects={box.name: known}).to_yaml())
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    run = load_run(tmp_path)
    assert run.seen is not None
    assert run.seen.deviations == {box.name: known}
    report = EVALUATOR.evaluate(tmp_path, tmp_path / "out", with_video=False).report.read_text()
    assert f"<td>{in_words(box, known)}</td>" in report
