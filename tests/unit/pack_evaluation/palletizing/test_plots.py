"""Plots show what they are said to show."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from pack_core.motion.moves import Mode
from pack_core.rotations import exp
from pack_evaluation.palletizing.plots import (
    PLOTS,
    SLOW,
    STRIDE,
    draw_orientation,
    draw_position,
    draw_tracking,
    draw_ways,
    write_plots,
)
from pallet_fsm.states import STEPS
from unit.pack_evaluation.palletizing.known_run import GOALS, TIMES, a_run


def spans(figure: Figure) -> list[tuple[float, float]]:
    """From when to when the first axes are shaded [s]."""
    shades = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    return [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in shades]


def test_the_shaded_states_are_those_that_the_machine_runs_slowly() -> None:
    assert set(SLOW) == {str(row.state.value) for row in STEPS if row.mode is Mode.SLOW}


@pytest.mark.parametrize("draw", [draw_position, draw_orientation, draw_tracking])
def test_slow_phases_are_shaded_and_nothing_else(draw: object) -> None:
    figure = Figure()
    draw(figure, a_run())
    np.testing.assert_allclose(spans(figure), [(8.0, 10.0), (10.0, 20.0), (20.0, 22.0)])


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
        assert line[:, -1] == pytest.approx(run.tracks[name].at(np.inf).p, abs=0.01)


def test_every_plot_becomes_a_picture(tmp_path: Path) -> None:
    paths = write_plots(a_run(), tmp_path / "plots")
    assert [path.stem for path in paths] == list(PLOTS)
    assert all(path.read_bytes()[:4] == b"\x89PNG" for path in paths)
