"""What the evaluation makes of recorded setpoints, joint states and motion states."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.motion.topics import JOINT_STATES, MOTION_SEPARATION, SETPOINTS
from pack_core.palletizing import topics
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
    load_pallet_run,
    standing_cell,
    tool_of,
    true_of_known,
)
from pack_evaluation.palletizing.measures import measure_order
from unit.pack_evaluation.packing.messages import header, make, pose, write_bag

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


def an_order(start: float = 2.0) -> list[tuple[float, str, Any]]:
    """One box, gripped and set down 1 mm beside its place within a second; the arm stands at home."""
    found: list[tuple[float, str, Any]] = []
    for k in range(51):
        time = start + 0.02 * k
        place = pose(0.0, 0.0, 0.5) if k < 25 else pose(0.301, 0.2, 0.1)
        joint_state = make("sensor_msgs/msg/JointState", header=header(time), name=["a"] * 6, position=HOME)
        point = make("trajectory_msgs/msg/JointTrajectoryPoint", positions=HOME)
        box = make("pack_interfaces/msg/ObjectState", name="a", pose=place)
        found += [
            (time, JOINT_STATES, joint_state),
            (
                time,
                SETPOINTS,
                make("trajectory_msgs/msg/JointTrajectory", header=header(time), points=[point]),
            ),
            (time, topics.TRUTH, make("pack_interfaces/msg/SceneState", header=header(time), objects=[box])),
        ]
    load = {"object": "a", "coaxial_force": 50.0, "shear_force": 20.0, "moment": 5.0}
    touch = make("pack_interfaces/msg/UnwantedContact", header=header(start), bodies=["a", "b"], force=30.0)
    states = [("3 grasp", 0.1), ("17 pre deposit", 0.4), ("19 retreat", 0.6)]
    found += [
        (start + 0.2, topics.GRIPPER_STATE, make("pack_interfaces/msg/GripperState", **load)),
        (start + 0.3, topics.CONTACTS, touch),
        *((start + at, topics.PALLET_STATE, make(
            "pack_interfaces/msg/PalletState", header=header(start + at), state=state, box="a"
        )) for state, at in states),
    ]  # fmt: skip
    box = {
        "name": "a", "dims": [0.4, 0.3, 0.2], "mass": 5.0, "handling": "none", "outcome": "placed",
        "reason": "", "direction": "Center", "pose": [0.3, 0.2, 0.1, 1.0, 0.0, 0.0, 0.0], "cycle_s": 8.0,
    }  # fmt: skip
    result = make("std_msgs/msg/String", data=json.dumps({"order": "o1", "reason": "", "boxes": [box]}))
    return sorted([*found, (start + 1.0, topics.RESULT, result)], key=lambda row: row[0])


def test_a_recorded_order_becomes_arrays_and_measures(tmp_path: Path) -> None:
    write_bag(tmp_path, an_order())
    run = load_pallet_run(tmp_path)
    assert (run.order, run.grip_peaks, run.cycles) == ("o1", {"a": (50.0, 20.0, 5.0)}, {"a": 8.0})
    assert [visit.state for visit in run.visits] == ["3 grasp", "17 pre deposit", "19 retreat"]
    assert run.tool.times[0] == pytest.approx(2.1)
    measures = measure_order(run)
    assert measures.is_complete
    assert measures.boxes[0].error_mm == pytest.approx(1.0)
    assert measures.position_mm == pytest.approx((0.0, 0.0), abs=1e-9)
    assert (measures.touches, measures.drops, measures.interruptions) == (1, 0, 0)


def test_margins_to_people_are_those_that_were_told_while_the_arm_was_under_way(tmp_path: Path) -> None:
    told = [
        (2.2 + 0.1 * k, MOTION_SEPARATION, make(
            "pack_interfaces/msg/Separation", header=header(2.2 + 0.1 * k), margin=margin,
            distance=margin + 0.4, who="person", is_under_way=is_under_way,
        )) for k, (margin, is_under_way) in enumerate([(0.5, True), (0.2, True), (-0.1, False)])
    ]  # fmt: skip
    write_bag(tmp_path, sorted([*an_order(), *told], key=lambda row: row[0]))
    run = load_pallet_run(tmp_path)
    track = run.separation
    assert track is not None
    np.testing.assert_allclose(track.times, [2.2, 2.3, 2.4])
    np.testing.assert_allclose(track.margin, [0.5, 0.2, -0.1])
    assert track.is_under_way.tolist() == [True, True, False]
    visitors = measure_order(run).visitors
    assert visitors is not None
    assert (visitors.crossings, visitors.margin_m) == (1, 0.2)
    assert visitors.least_m == pytest.approx((0.3,))


def test_a_topic_that_nobody_sent_is_named(tmp_path: Path) -> None:
    write_bag(tmp_path, [row for row in an_order() if row[1] != topics.TRUTH])
    with pytest.raises(BagError, match=rf"goal 1 of 1 has no message on {topics.TRUTH}: was the node"):
        load_pallet_run(tmp_path)
