"""What the evaluation makes of recorded setpoints, joint states and motion states."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from pack_core.motion.topics import JOINT_STATES, SETPOINTS
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import BASE
from pack_core.rotations import Array, Pose, from_yaw
from pack_evaluation.bag import Bag, Recorded
from pack_evaluation.palletizing.from_bag import (
    DECK,
    TF_STATIC,
    frames_in,
    interruptions_of,
    standing_cell,
    tool_of,
    true_of_known,
)

PERIOD_NS = 4_000_000
HOME = np.array(palletizing_cell().arm.home)


def stamp(time_ns: int) -> Any:
    return SimpleNamespace(sec=time_ns // 10**9, nanosec=time_ns % 10**9)


def joints(k: int, q: Array) -> Any:
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp(k * PERIOD_NS)), position=q)


def setpoints(k: int, q: Array, rows: int = 6) -> Any:
    points = [SimpleNamespace(time_from_start=stamp(i * PERIOD_NS), positions=q) for i in range(rows)]
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp(k * PERIOD_NS)), points=points)


def bag(measured: list[Any], wanted: list[Any]) -> Bag:
    messages = [Recorded(JOINT_STATES, 0, item) for item in measured] + [
        Recorded(SETPOINTS, 0, item) for item in wanted
    ]
    return Bag(Path("run"), tuple(messages), False)


def frames(poses: Mapping[str, Pose]) -> Any:
    transforms = []
    for name, X_WF in poses.items():
        (x, y, z), (w, i, j, k) = X_WF.p, X_WF.q
        transform = SimpleNamespace(
            translation=SimpleNamespace(x=x, y=y, z=z), rotation=SimpleNamespace(w=w, x=i, y=j, z=k)
        )
        header = SimpleNamespace(frame_id="world")
        transforms.append(SimpleNamespace(header=header, child_frame_id=name, transform=transform))
    return SimpleNamespace(transforms=transforms)


def test_measurements_are_compared_with_the_setpoints_for_their_moments() -> None:
    turned = HOME + np.array([1e-3, 0, 0, 0, 0, 0])
    tool = tool_of(
        bag([joints(k, turned) for k in range(100)], [setpoints(k, HOME) for k in range(100)]), 0.2
    )
    np.testing.assert_allclose(tool.times[0], 0.2)
    reach = np.linalg.norm(tool.p_ref[0, :2] - np.array(palletizing_cell().arm.base[:2]))
    np.testing.assert_allclose(np.linalg.norm(tool.p - tool.p_ref, axis=1), 1e-3 * reach, rtol=1e-3)


def test_moments_for_which_there_were_no_setpoints_are_left_out() -> None:
    """The driver holds the arm from 80 ms, when 24 ms of setpoints have run out, to 200 ms."""
    wanted = [setpoints(k, HOME) for k in range(100) if not 15 <= k < 50]
    tool = tool_of(bag([joints(k, HOME) for k in range(100)], wanted), 0.0)
    held = (tool.times > 0.0765) & (tool.times < 0.199)
    assert not held.any()
    assert len(tool.times) == 100 - 30


def test_each_time_that_the_driver_held_the_arm_counts_once() -> None:
    states = ["MOVING", "HELD", "HELD", "MOVING", "REACHED", "HELD", "IDLE"]
    assert interruptions_of([SimpleNamespace(state=state) for state in states]) == 2
    assert interruptions_of([]) == 0


def test_boxes_belong_where_the_pallet_truly_lies() -> None:
    known, box = Pose(np.array([1.0, 2.0, 0.1])), Pose(np.array([0.3, 0.2, 0.1]))
    true = Pose(known.p + np.array([0.003, 0.0, 0.0]), from_yaw(0.01))
    recorded = Bag(Path("run"), (Recorded(TF_STATIC, 0, frames({DECK: true})),), False)
    moved = true_of_known(frames_in(recorded), {"pallet": [*known.p, *known.q]}) @ known @ box
    np.testing.assert_allclose(moved.p, true.apply(box.p), atol=1e-12)


def test_a_recorded_cell_is_drawn_where_it_truly_stood() -> None:
    """Tables and pallet as the simulator publishes their frames; the arm's base, too."""
    cell = palletizing_cell()
    moved = {
        name: getattr(cell, name).model_copy(update={"displacement": Displacement.of(vector)})
        for name, vector in {
            "picking_table": [0.003, 0.0, 0.0, 0.001, 0.0, 0.002],
            "reorientation_table": [0.0, -0.003, 0.001, 0.0, 0.0, 0.003],
            "pallet": [0.001, 0.002, -0.002, 0.003, -0.001, 0.002],
        }.items()
    }
    true, X_WB = cell.model_copy(update=moved), Pose(np.array([-1.499, 1.2, 0.3]), from_yaw(0.001))
    model = build_model(true, X_WB=X_WB)
    published = {name: Pose(model.body(name).pos, model.body(name).quat) for name in (BASE, *moved)} | {
        DECK: true.pallet.X_WP
    }
    recorded = Bag(Path("run"), (Recorded(TF_STATIC, 0, frames(published)),), False)
    stands = standing_cell(frames_in(recorded))
    drawn = build_model(stands.cell, X_WB=stands.X_WB)
    np.testing.assert_allclose(drawn.body_pos, model.body_pos, atol=1e-12)
    np.testing.assert_allclose(drawn.body_quat, model.body_quat, atol=1e-12)
