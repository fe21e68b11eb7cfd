"""Time and speed by state, and what visitors meant for a run."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_evaluation.palletizing.drawings import WRONG, draw_order
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.plots import write_plots
from pack_evaluation.palletizing.run import ToolTrack, UnwantedTouch, VisitorTrack, WayPoint
from pack_evaluation.palletizing.state_times import merged, near_contact_peak, state_times
from pack_evaluation.palletizing.summary import OrderTrial, summarize_orders
from unit.pack_evaluation.palletizing.known_run import TIMES, a_run

P = np.zeros((len(TIMES), 3))
Q = np.tile([1.0, 0.0, 0.0, 0.0], (len(TIMES), 1))
P[:, 0] = np.where(TIMES < 8.0, 2.0 * TIMES, 16.0 + 0.2 * (TIMES - 8.0))  # 2 m/s, and 0.2 m/s from 8 s on
RUN = a_run(tool=ToolTrack(TIMES, np.zeros((len(TIMES), 6)), P, Q, P, Q))
NEAR = VisitorTrack(
    TIMES,
    np.select([(TIMES > 10.0) & (TIMES < 15.0), TIMES > 30.0], [0.5, 0.05], 3.0),
)


def test_times_add_up_and_peaks_are_those_of_the_state() -> None:
    states = state_times(RUN)
    assert list(states) == ["0 spawn", "17 pre deposit", "19 retreat"]
    assert sum(item.total_s for item in states.values()) == pytest.approx(TIMES[-1])
    assert states["17 pre deposit"].visits == 2
    assert states["17 pre deposit"].total_s == pytest.approx(4.0)
    assert states["0 spawn"].peak_mps == pytest.approx(2.0)
    assert states["19 retreat"].peak_mps == pytest.approx(0.2)
    assert near_contact_peak(states) < 1.2  # the sample at 8 s stands between both speeds
    assert merged([states, states])["0 spawn"].visits == 2


def test_crossings_are_counted_with_their_least_distance() -> None:
    touch = UnwantedTouch(31.0, ("person", "pad"), 30.0)
    found = measure_order(a_run(visitors={"person": NEAR}, touches=(touch,))).visitors
    assert found is not None
    assert (found.crossings, found.least_m, found.too_near, found.touches) == (2, (0.5, 0.05), 1, 1)
    assert found.near_s == pytest.approx(15.0, abs=0.4)
    assert found.stopped_s == pytest.approx(found.near_s)  # the tool of this run never moves
    assert measure_order(RUN).visitors is None


def test_errors_at_way_points_are_summed_up_and_older_trials_have_none() -> None:
    run = a_run(way_points=(WayPoint("2 above box", 4.0, 0.2), WayPoint("3 grasp", 2.0, 0.4)))
    measures = measure_order(run)
    assert measures.way_point_mm == (3.0, 4.0)
    trial = asdict(measures)
    summary = summarize_orders([OrderTrial("a", 0, trial, None)])
    assert summary["way_point_position_mm"] == {"mean": 3.0, "max": 4.0}
    old = {key: value for key, value in trial.items() if key not in ("states", "visitors", "way_point_mm")}
    assert summarize_orders([OrderTrial("a", 0, old, None)])["way_point_position_mm"] is None


def test_the_bars_of_states_and_the_plot_of_visitors_are_written(tmp_path: Path) -> None:
    names = {path.stem for path in write_plots(a_run(visitors={"person": NEAR}), tmp_path)}
    assert {"states", "visitors"} <= names


def test_an_orders_picture_shows_wrong_boxes_in_red_and_every_reason() -> None:
    order = load_order(config_path("orders", "order_03.json"))
    name = order.boxes[0].id
    figure = draw_order(order, [f"box '{name}': 12% of its base is carried"])
    colours = [patch.get_facecolor() for axes in figure.axes[1:] for patch in axes.patches]
    assert colours.count(to_rgba(WRONG)) == 3  # one in each view
    assert any("12% of its base" in text.get_text() for text in figure.texts)
