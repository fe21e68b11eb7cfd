"""A held object is put aside upright, whatever the tilt at which packing it has ended."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.free_space import base_height
from pack_core.packing.objects import Box
from pack_core.packing.packing_list import PackingList
from pack_core.rotations import POINTING_DOWN, Pose, angle_between, exp, multiply, rotate
from pack_core.states import ObjectState, SceneState
from pack_core.tasks.steps import TaskRun
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.object_handling import ObjectHandling
from pack_mpc.filling.requests import FillCommand, FillObservation, FillPort
from pack_mpc.filling.tool_motion import CupPace, lines

CELL, CONFIG = packing_cell(), FillConfig()
BROAD = Box(name="broad", shape="box", size=(0.158, 0.06, 0.21), mass=0.4)
SCENE = PackingList(objects=[BROAD]).start(CELL)
HOME = np.array(CELL.robot.home)
GRIP = Pose(np.array([0.0, 0.0, 0.105]), POINTING_DOWN)
"""Pose X_TN of the held object in the cup."""


def follow(handling: ObjectHandling, moves: CupMoves, q: np.ndarray) -> tuple[list[Pose], bool]:
    """Put aside with an arm that is where it shall be: the object's poses X_WN, and whether it was let go."""

    def seen(answer: object | None) -> FillObservation:
        X_WN = moves.arm.cup(q) @ GRIP
        poses.append(X_WN)
        scene = SceneState(time, {BROAD.name: ObjectState(X_WN)})
        joints = JointSample(time, q, np.zeros(7), np.zeros(7))
        return FillObservation(joints, scene, np.zeros(3), not is_released, answer)

    time, is_released, poses = 0.0, False, []
    run, answer = TaskRun(handling.put_aside()), None
    while True:
        moves.port.seen, moves.port.command = seen(answer), FillCommand()
        run.go_on()
        if run.is_over:
            return poses, is_released
        command, answer = moves.port.command, None
        if command.request is not None:
            answer, is_released = "", True
        elif command.setpoints is not None:
            rows = command.setpoints
            q = rows.q[min(np.searchsorted(rows.time + rows.offsets, time + 0.02), len(rows.q) - 1)]
        time += 0.02


def leaning(tilt_deg: float, heading: float) -> np.ndarray:
    """Orientation q_WT of the cup with an object that leans about the horizontal axis at a heading [rad]."""
    axis = np.array([np.cos(heading), np.sin(heading), 0.0])
    return multiply(exp(np.deg2rad(tilt_deg) * axis), POINTING_DOWN)


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 50.0])
@pytest.mark.parametrize("heading", [-1.0, 0.5, 2.0])
def test_a_tilted_object_is_stood_upright_at_the_hand_over_place(tilt_deg: float, heading: float) -> None:
    moves = CupMoves(FillPort(), CELL, CONFIG, SCENE, 0.21)
    q_WT = leaning(tilt_deg, heading)
    there = np.array([0.5, 0.0, 0.25]) - moves.arm.cup(HOME).p
    path = lines(moves.arm.cup(HOME), [there], CupPace(0.2, 4.0), CONFIG, q_WT)
    q = moves.arm.plan(HOME, 0.0, path).q[-1]
    assert angle_between(moves.arm.cup(q).q, q_WT) < 0.01
    poses, is_released = follow(ObjectHandling(moves, CELL, CONFIG), moves, q)
    assert is_released
    let_go = min(poses[-40:], key=lambda X_WN: X_WN.p[2])
    assert rotate(let_go.q, np.array([0.0, 0.0, 1.0]))[2] > 0.999
    assert np.linalg.norm(let_go.p[:2] - np.array(CELL.hand_over.centre)) < 0.01
    assert base_height(BROAD, let_go) < 0.01
    over = [X_WN for X_WN in poses if SCENE.container.lower[1] < X_WN.p[1] < SCENE.container.upper[1]]
    turned = [X_WN for X_WN in over if np.linalg.norm(X_WN.p[:2] - poses[0].p[:2]) > 0.03]
    assert min(base_height(BROAD, X_WN) for X_WN in turned) > SCENE.rim


@pytest.mark.parametrize(
    ("place", "tilt_deg", "heading"),
    [
        ((0.65, 0.08), 30.0, 2.2),
        ((0.6, 0.08), 30.0, 2.2),
        ((0.7, 0.08), 30.0, 2.2),
        ((0.7, -0.05), 10.0, 1.57),
    ],
)
def test_an_object_that_the_arm_cannot_raise_is_drawn_nearer_first(
    place: tuple[float, float], tilt_deg: float, heading: float
) -> None:
    moves = CupMoves(FillPort(), CELL, CONFIG, SCENE, 0.21)
    q_WT, over = leaning(tilt_deg, heading), np.array([0.5, 0.0, 0.35])
    cup = np.array([*place, 0.12]) - rotate(q_WT, GRIP.p)
    ways, pace = [over - moves.arm.cup(HOME).p, cup - over], CupPace(0.2, 4.0)
    q = moves.arm.plan(HOME, 0.0, lines(moves.arm.cup(HOME), ways, pace, CONFIG, q_WT)).q[-1]
    low = moves.arm.cup(q)
    up = moves.arm.plan(q, 0.0, lines(low, [np.array([0.0, 0.0, SCENE.rim])], pace, CONFIG)).q[-1]
    assert moves.arm.cup(up).p[2] - low.p[2] < 0.1  # less than it would have to rise
    poses, is_released = follow(ObjectHandling(moves, CELL, CONFIG), moves, q)
    assert is_released
    let_go = min(poses[-40:], key=lambda X_WN: X_WN.p[2])
    assert np.linalg.norm(let_go.p[:2] - np.array(CELL.hand_over.centre)) < 0.01
    over_the_wall = next(X_WN for X_WN in poses if X_WN.p[1] < SCENE.container.lower[1])
    assert base_height(BROAD, over_the_wall) > SCENE.rim
