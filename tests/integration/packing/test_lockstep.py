"""The cell without ROS: repeats bit for bit, and does what the nodes do."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

from integration.harness import Graph
from integration.packing.cell_rig import EASY, Cell
from integration.packing.sim_rig import EXAMPLE
from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_pose
from pack_core.rotations import Array, Pose, angle_between
from pack_lockstep.packing.disturbances import hide_all
from pack_lockstep.packing.lockstep import HELD, Lockstep, Step
from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_mpc.task.task import PackingOutcome

SEED = 0
FACTOR = 0.3


@dataclass(frozen=True)
class Record:
    """What a run in lockstep did."""

    outcome: PackingOutcome
    placement: Pose
    setpoints: list[Setpoints]
    joints: Array


def run(scene: Path, seed: int = SEED, timeout: float = 20.0) -> Record:
    steps: list[Step] = []
    config = lockstep_config()
    task = config.session.task.model_copy(update={"timeout": timeout})
    config = config.model_copy(update={"session": config.session.model_copy(update={"task": task})})
    lockstep = Lockstep(packing_cell(), load_scene(scene), config, PackingMethod.PACK_IT_IN, seed)
    outcome = lockstep.run(steps.append)
    plans = [step.plan.setpoints for step in steps if step.plan is not None]
    joints = np.array([step.seen.joints.q for step in steps])
    return Record(outcome, lockstep.session.task.tried[0], plans, joints)


@pytest.fixture(scope="module")
def record() -> Record:
    return run(EASY)


def test_the_same_seed_gives_the_same_outcome_and_setpoints_bit_for_bit(record: Record) -> None:
    again = run(EASY)
    assert again.outcome == record.outcome
    assert (record.outcome.exit_reason, record.outcome.placements) == (PackingExitReason.PLACED, 1)
    np.testing.assert_array_equal(again.joints, record.joints)
    assert len(again.setpoints) == len(record.setpoints)
    for ours, theirs in zip(again.setpoints, record.setpoints, strict=True):
        assert ours.time == theirs.time
        for name in ("offsets", "q", "v", "tau"):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))


def test_a_scene_of_every_shape_is_packed_with_a_mesh_on_the_cup() -> None:
    packed = run(config_path("scenarios", "packing", "shapes.yaml"))
    assert packed.outcome.success


def test_another_seed_gives_other_setpoints(record: Record) -> None:
    other = run(EASY, SEED + 1, timeout=0.5).setpoints
    assert other
    assert not np.array_equal(other[-1].q, record.setpoints[len(other) - 1].q)


def test_the_nodes_choose_the_same_placement_where_there_is_a_best_one(graph: Graph) -> None:
    expected = run(EXAMPLE, timeout=0.5).placement
    cell = Cell(graph, FACTOR, EXAMPLE)
    cell.pack(SEED)
    last = partial(graph.probe.last, contracts.MPC_STATUS)
    graph.wait_until(lambda: last() and last().placements, timeout=30.0)
    chosen = from_pose(last().target)
    np.testing.assert_allclose(chosen.p, expected.p, atol=0.005)
    assert angle_between(chosen.q, expected.q) < np.deg2rad(3.0)


def test_the_arm_holds_while_the_cameras_see_nothing() -> None:
    config = lockstep_config()
    task = config.session.task.model_copy(update={"timeout": 2.5})
    config = config.model_copy(update={"session": config.session.model_copy(update={"task": task})})
    lockstep = Lockstep(packing_cell(), load_scene(EASY), config, PackingMethod.PACK_IT_IN, SEED)
    lockstep.deceive(lambda frame: hide_all(frame, ""))
    steps: list[Step] = []
    assert lockstep.run(steps.append).exit_reason is PackingExitReason.TIMEOUT
    held = [step for step in steps if step.stage == HELD]
    assert held[0].time - steps[0].time == pytest.approx(config.session.blind_time, abs=2 * config.latency)
    speeds = np.array([np.abs(step.seen.joints.v).max() for step in held])
    assert speeds[-1] < 1e-3
    assert held[-1].seen.scene.objects[lockstep.session.scene.new_object.name].age > config.session.blind_time


def test_late_iterations_are_bridged_by_the_plan_before_them_and_the_arm_is_not_braked() -> None:
    """Of every eight plans two are never finished: the driver's setpoints get up to 0.144 s old."""
    lockstep = Lockstep(packing_cell(), load_scene(EASY), lockstep_config(), PackingMethod.PACK_IT_IN, SEED)
    accept, follower = lockstep.simulator.accept, lockstep.simulator.follower
    plans, held, oldest = count(), [], [0.0, 0.0]

    def accept_some(setpoints: Setpoints) -> None:
        if next(plans) % 8 >= 2:
            accept(setpoints)
            oldest[0] = lockstep.simulator.time

    def note(step: Step) -> None:
        if step.stage in ("PRE_PACK", "INSERT") and oldest[0]:
            held.append(follower.is_holding)
            oldest[1] = max(oldest[1], step.time - oldest[0])

    with patch.object(lockstep.simulator, "accept", accept_some):
        outcome = lockstep.run(note)
    assert outcome.success
    assert oldest[1] == pytest.approx(2 * lockstep_config().latency, abs=0.002)
    assert len(held) > 10
    assert not any(held[1:]), "the first is from before the first plan"


def test_setpoints_that_the_driver_refuses_end_no_run() -> None:
    lockstep = Lockstep(packing_cell(), load_scene(EASY), lockstep_config(), PackingMethod.PACK_IT_IN, SEED)
    accept, refused = lockstep.simulator.accept, [3, 4, 5]

    def refusing(setpoints: Setpoints) -> None:
        refused[:] = [k - 1 for k in refused]
        if 0 in refused:
            raise MessageError("q of joint 3 is out of range")
        accept(setpoints)

    with patch.object(lockstep.simulator, "accept", refusing):
        assert lockstep.run().success
