"""Plots show what they are said to show."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from pack_core.motion.moves import DEPART, DESCEND, RISE, TRANSIT, UP, Line, Retreat, Transfer
from pack_core.motion.target import MotionTarget
from pack_core.rotations import Pose, exp
from pack_evaluation.palletizing.from_bag import slow_intervals
from pack_evaluation.palletizing.plots import (
    PLOTS,
    STRIDE,
    draw_orientation,
    draw_position,
    draw_tracking,
    draw_ways,
    write_plots,
)
from pack_evaluation.palletizing.state_times import slow_states
from unit.pack_evaluation.palletizing.known_run import GOALS, TIMES, a_run


def spans(figure: Figure) -> list[tuple[float, float]]:
    """From when to when the first axes are shaded [s]."""
    shades = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    return [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in shades]


@pytest.mark.parametrize("draw", [draw_position, draw_orientation, draw_tracking])
def test_what_ran_slowly_is_shaded_and_nothing_else(draw: object) -> None:
    figure, slow = Figure(), ((8.0, 10.5), (20.0, 22.0))
    draw(figure, a_run(slow=slow))
    np.testing.assert_allclose(spans(figure), slow)


def test_a_state_counts_as_slow_if_its_moves_ran_slowly_for_most_of_its_time() -> None:
    assert slow_states(a_run(slow=((8.0, 9.5), (10.0, 14.0)))) == set()
    assert slow_states(a_run(slow=((8.0, 10.0), (10.0, 19.0), (20.0, 20.5), (25.0, 40.0)))) == {
        "17 pre deposit", "19 retreat",
    }  # fmt: skip


def test_slow_intervals_of_a_recording_are_those_of_slow_segments() -> None:
    target = MotionTarget(3, Transfer((Line(Pose(np.zeros(3)), label="INSERT"),), Retreat(UP, (0.1, 0.2))))
    labels = [DEPART, DEPART, RISE, TRANSIT, DESCEND, "INSERT", "INSERT", TRANSIT]
    statuses = [SimpleNamespace(id=3, label=label, header=header(0.5 * k)) for k, label in enumerate(labels)]
    modes = [SimpleNamespace(label=line.label, mode=line.mode.value) for line in target.move.lines]
    found = slow_intervals([SimpleNamespace(id=3, segments=modes)], statuses)
    assert found == ((0.0, 1.0), (2.5, 3.5))


def header(time: float) -> SimpleNamespace:
    return SimpleNamespace(stamp=SimpleNamespace(sec=int(time), nanosec=round(1e9 * (time % 1.0))))


def test_the_tracking_errors_are_drawn_in_millimetres_and_degrees() -> None:
    figure = Figure()
    draw_tracking(figure, a_run())
    position, angle = (axes.lines[0].get_ydata() for axes in figure.axes)
    assert position == pytest.approx(np.full(len(TIMES), 0.5))
    assert angle == pytest.approx(np.zeros(len(TIMES)))


def test_an_orientation_is_drawn_without_jumps_through_whole_turns() -> None:
    tool = a_run().tool
    angles = np.linspace(0.0, 4.0 * np.pi, len(TIMES))
    q = np.array([exp([0.0, 0.0, angle]) for angle in angles])
    figure = Figure()
    draw_orientation(figure, a_run(tool=replace(tool, q=q, q_ref=-q)))
    measured, commanded = (np.array([line.get_ydata() for line in lines]) for lines in pairs(figure))
    np.testing.assert_array_equal(measured, commanded)
    assert np.abs(np.diff(measured)).max() < 2.0 * STRIDE * angles[1]


def pairs(figure: Figure) -> tuple[list[Line2D], list[Line2D]]:
    """The solid lines of the first axes and the dashed ones."""
    lines = figure.axes[0].lines
    return lines[::2], lines[1::2]


def test_every_box_has_a_way_from_its_arrival_to_its_place() -> None:
    figure, run = Figure(), a_run()
    draw_ways(figure, run)
    lines = {line.get_label(): np.array(line.get_data_3d()) for line in figure.axes[0].lines}
    assert set(lines) == set(GOALS)
    for name, line in lines.items():
        assert line[:, 0] == pytest.approx(run.tracks[name].p[0])
        assert line[:, -1] == pytest.approx(run.tracks[name].p[-1], abs=0.01)


def test_every_plot_becomes_a_picture(tmp_path: Path) -> None:
    paths = write_plots(a_run(), tmp_path / "plots")
    assert [path.stem for path in paths] == list(PLOTS)
    assert all(path.read_bytes()[:4] == b"\x89PNG" for path in paths)
