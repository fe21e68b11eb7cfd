"""The simulated cell with a cup that gives way, a driver told the wrong mass, and joints that rub."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.joints import Setpoints
from pack_core.packing.cell import PackingCell, Suction, Tip, packing_cell
from pack_core.packing.model import TIP_JOINTS, HeldRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, angle_between
from pack_sim.packing.mismatch import MismatchConfig
from pack_sim.packing.simulator import Simulator, SimulatorConfig

TIP = Tip(lateral=6000.0, axial=8000.0, bending=15.0, twist=20.0, damping_time=0.006)
CELL = packing_cell().model_copy(update={"tip": TIP})
HELD = CELL.scene.new_object
SCENE = CELL.scene.model_copy(update={"objects": []})
WEIGHT = 9.81 * HELD.mass


def build(
    cell: PackingCell = CELL,
    scene: Scene = SCENE,
    mismatch: MismatchConfig | None = None,
) -> Simulator:
    config = SimulatorConfig(mismatch=mismatch or MismatchConfig())
    return Simulator(cell, scene, config, np.random.default_rng(0))


def run(simulator: Simulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


def held_pose_of(simulator: Simulator) -> Pose:
    return simulator.truth().objects[HELD.name].X_WO


def push(simulator: Simulator, force_W: Array) -> None:
    """Push at the middle of the held object's top, without moment about the cup."""
    p_W = held_pose_of(simulator)
    arm = p_W.apply([0.0, 0.0, HELD.half_extents[2]]) - p_W.p
    simulator.data.body(HELD.name).xfrc_applied[:] = [*force_W, *np.cross(arm, force_W)]


def test_the_driver_carries_the_payload_and_the_cup_stretches_by_its_weight() -> None:
    simulator = build()
    run(simulator, 1.0)
    np.testing.assert_allclose(simulator.joints().q, CELL.robot.home, atol=5e-4)
    stretch = simulator.data.joint(TIP_JOINTS[2]).qpos[0]
    assert stretch == pytest.approx(-WEIGHT / TIP.axial, rel=0.01)
    force, torque = simulator.external_wrench()
    np.testing.assert_allclose([*force, *torque], 0.0, atol=0.05)


@pytest.mark.parametrize("force", np.vstack([8.0 * np.eye(3), -8.0 * np.eye(3)]).tolist())
def test_the_driver_feels_which_way_the_held_object_is_pushed(
    force: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    simulator, felt = build(), []
    monkeypatch.setattr(
        simulator.controller, "update_contact", lambda time, force, *rest, **state: felt.append(force)
    )
    push(simulator, np.array(force))
    run(simulator, 0.5)
    np.testing.assert_allclose(felt[-1], force, atol=0.5)


def test_a_run_that_is_observed_takes_the_same_course() -> None:
    runs = []
    for is_observed in (False, True):
        simulator = build()
        push(simulator, np.array([8.0, 3.0, -5.0]))
        for _ in range(300):
            simulator.step()
            if is_observed:
                simulator.truth()
        runs.append(simulator.data.qpos.copy())
    np.testing.assert_array_equal(*runs)


def test_the_planners_model_has_no_springs() -> None:
    assert build(packing_cell())._held is HeldRole.RIGID


def test_a_payload_heavier_than_described_pulls_at_the_sensor() -> None:
    for cell in (packing_cell(), CELL):
        simulator = build(cell, mismatch=MismatchConfig(mass=0.25))
        excess = simulator.scene.new_object.mass - HELD.mass
        run(simulator, 1.0)
        force, _ = simulator.external_wrench()
        np.testing.assert_allclose(force, [0.0, 0.0, -9.81 * excess], atol=0.05)
        assert abs(excess) > 0.01


def test_letting_go_and_taking_hold_again_leaves_the_object_where_it_is() -> None:
    simulator = build()
    push(simulator, np.array([10.0, 0.0, 0.0]))
    run(simulator, 0.5)
    simulator.data.xfrc_applied[:] = 0.0
    before, joints = held_pose_of(simulator), simulator.joints()
    assert abs(simulator.data.joint(TIP_JOINTS[0]).qpos[0]) > 1e-3
    simulator.release()
    freed = held_pose_of(simulator)
    assert simulator.grip() == ""
    after = held_pose_of(simulator)
    for pose in (freed, after):
        np.testing.assert_allclose(pose.p, before.p, atol=1e-9)
        assert angle_between(pose.q, before.q) < 1e-7
    np.testing.assert_array_equal(simulator.joints().q, joints.q)
    np.testing.assert_array_equal(simulator.joints().v, joints.v)


def test_an_object_that_is_let_go_falls() -> None:
    simulator = build()
    run(simulator, 0.3)
    z = held_pose_of(simulator).p[2]
    simulator.release()
    run(simulator, 0.1)
    assert held_pose_of(simulator).p[2] == pytest.approx(z - 0.5 * 9.81 * 0.1**2, abs=0.002)


@pytest.mark.parametrize(
    ("direction", "limit", "what"), [((1.0, 0.0, 0.0), 25.0, "shear"), ((0.0, 0.0, -1.0), 60.0, "pull")]
)
def test_the_cup_lets_go_at_its_limit_and_not_below(
    direction: tuple[float, float, float], limit: float, what: str
) -> None:
    suction = Suction(pull=60.0, shear=25.0, moment=1e3)
    already = WEIGHT if what == "pull" else 0.0
    for share, holds in ((0.97, True), (1.05, False)):
        simulator = build(CELL.model_copy(update={"suction": suction}))
        for step in range(600):
            rise = min(1.0, step / 300)
            push(simulator, rise * (share * limit - already) * np.array(direction))
            simulator.step()
            if not simulator.pump.state.is_closed:
                break
        assert simulator.pump.state.is_closed is holds
        assert holds or what in simulator.pump.state.release_reason


def test_joints_that_rub_stay_where_small_torques_would_move_them() -> None:
    moved = []
    for friction in (0.0, 0.5):
        simulator = build(mismatch=MismatchConfig(joint_friction=(friction, friction)))
        goal = simulator.joints().q + 0.4 / np.array(CELL.robot.stiffness)
        for _ in range(20):
            rows = (np.tile(goal, (2, 1)), np.zeros((2, 7)), np.zeros((2, 7)))
            simulator.accept(Setpoints(simulator.time, np.array([0.0, 1.0]), *rows))
            run(simulator, 0.05)
        moved.append(np.abs(simulator.joints().q - CELL.robot.home).max())
    assert moved[1] < 0.2 * moved[0]
