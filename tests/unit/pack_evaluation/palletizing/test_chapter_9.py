"""Figures and trajectories of an order, as in chapter 9 of the thesis."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure

from pack_core.rotations import IDENTITY, Pose
from pack_evaluation.palletizing.chapter_9 import STRIDE, chapter_9, trajectories
from pack_evaluation.palletizing.plots import draw_position
from pack_evaluation.palletizing.run import PalletRun, SentTarget
from unit.pack_evaluation.palletizing.known_run import GOALS, TIMES, a_run

FIRST, SECOND = (Pose(np.array([x, 0.5, 2.0]), np.array(IDENTITY)) for x in (1.0, 2.0))


def targeted() -> PalletRun:
    return a_run(targets=(SentTarget(5.0, FIRST), SentTarget(20.0, SECOND)), slow=((8.0, 10.0),))


def test_there_are_the_figures_and_the_trajectories() -> None:
    files = chapter_9(targeted())
    assert set(files) == {
        "fig_9_2_position.png", "fig_9_2_orientation.png", "fig_9_4_ways.png", "trajectories.json",
    }  # fmt: skip
    assert all(files[name].startswith(b"\x89PNG") for name in files if name.endswith(".png"))
    assert json.loads(files["trajectories.json"])["order"] == "test"


def test_robot_targets_and_boxes_are_written_with_their_times() -> None:
    found = trajectories(targeted())
    assert found["robot"]["time"] == pytest.approx(TIMES[::STRIDE])
    assert found["robot"]["position"][0] == pytest.approx([0.0, 0.0003, 0.0004])
    assert [target["time"] for target in found["targets"]] == [5.0, 20.0]
    assert found["targets"][1]["position"] == pytest.approx([2.0, 0.5, 2.0])
    assert found["boxes"]["b"]["position"][-1] == pytest.approx(GOALS["b"] + [0.0, 0.001, 0.0])
    assert found["slow"] == [[8.0, 10.0]]


def dashed(run: PalletRun) -> np.ndarray:
    """The dashed line along x of the profile of positions, at the times that are drawn."""
    figure = Figure()
    draw_position(figure, run)
    lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    return np.asarray(lines[0].get_ydata())


def test_the_dashed_line_steps_from_target_to_target() -> None:
    times, x = TIMES[::5], dashed(targeted())
    assert x[times < 5.0] == pytest.approx(0.0)  # the setpoints, before the first target
    assert x[(times >= 5.0) & (times < 20.0)] == pytest.approx(1.0)
    assert x[times >= 20.0] == pytest.approx(2.0)


def test_without_targets_the_dashed_line_is_that_of_the_setpoints() -> None:
    assert dashed(a_run()) == pytest.approx(0.0)
