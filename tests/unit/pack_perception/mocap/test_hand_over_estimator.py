"""The estimate while objects come into the cell, are gripped and are let go."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.bodies import body_pose
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import held_pose
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.packing_list import PackingList, handed_over
from pack_core.rotations import Pose
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.physics_estimator import EstimatorConfig
from pack_sim.packing.simulator import Simulator, SimulatorConfig

CELL = packing_cell()
CAN = Cylinder(name="can", shape="cylinder", radius=0.034, height=0.08, mass=0.3)
CARTON = Box(name="carton", shape="box", size=(0.09, 0.06, 0.1), mass=0.3)
LIST = PackingList(objects=[CARTON, CAN])


class Rig:
    """A simulator and the estimator that watches it."""

    def __init__(self) -> None:
        self.simulator = Simulator(CELL, LIST.start(CELL), SimulatorConfig(), np.random.default_rng(2))
        self.estimator = HandOverEstimator(self.simulator.description, CELL, EstimatorConfig())
        self.pass_time(0.2)

    def pass_time(self, duration: float) -> None:
        for i in range(round(duration / 0.001)):
            self.simulator.step()
            if i % 2:
                self.estimator.advance(self.simulator.joints())
            for frame in self.simulator.mocap.due(self.simulator.time):
                self.estimator.correct(frame)

    def put(self, X_WN: Pose) -> None:
        """Put the new object somewhere at rest."""
        model, data = self.simulator.model, self.simulator.data
        first = model.joint(self.simulator.scene.new_object.name).qposadr[0]
        data.qpos[first : first + 7] = [*X_WN.p, *X_WN.q]

    def error(self, name: str) -> float:
        """Distance of an object's estimate from the truth [m]."""
        seen = self.estimator.state(self.estimator.time).objects[name].X_WO
        return float(np.linalg.norm(seen.p - self.simulator.truth().objects[name].X_WO.p))


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_an_object_that_is_handed_over_is_seen_where_it_truly_stands(rig: Rig) -> None:
    assert not rig.estimator.is_held
    assert rig.error("carton") < 0.001
    announced = CELL.hand_over.pose_of(CARTON)
    assert np.linalg.norm(rig.simulator.truth().objects["carton"].X_WO.p - announced.p) > 0.001


def test_what_was_packed_is_remembered_and_what_comes_next_is_new(rig: Rig) -> None:
    rig.put(Pose(np.array([*CELL.scene.container.centre, CARTON.half_extents[2]])))
    rig.pass_time(0.3)
    assert rig.simulator.present(handed_over(CAN, CELL)) == ""
    rig.estimator.change_scene(rig.simulator.description)
    state = rig.estimator.state(rig.estimator.time)
    assert set(state.objects) == {"carton"}
    assert rig.error("carton") < 0.001
    rig.pass_time(0.1)
    assert set(rig.estimator.state(rig.estimator.time).objects) == {"carton", "can"}
    assert rig.error("can") < 0.001


def test_a_gripped_object_hangs_as_it_was_seen_until_it_is_let_go(rig: Rig) -> None:
    rig.simulator.data.qvel[:] = 0.0
    off = Pose(np.array([0.005, 0.003, 0.0]))
    rig.put(body_pose(rig.simulator.data, "tool") @ held_pose(rig.simulator.scene) @ off)
    rig.simulator.step()
    assert rig.simulator.grip() == ""
    rig.pass_time(0.03)  # until it was seen there; the estimate believes that it falls meanwhile
    X_TN = rig.estimator.take_hold()
    assert X_TN is not None
    assert rig.estimator.is_held
    assert np.linalg.norm(X_TN.p[:2]) == pytest.approx(np.hypot(0.005, 0.003), abs=0.0015)
    assert rig.estimator.take_hold() is None
    rig.pass_time(0.6)
    assert rig.estimator.is_held
    assert rig.error("carton") < 0.001
    rig.simulator.release()
    rig.estimator.let_go()
    assert not rig.estimator.is_held
    rig.pass_time(0.1)
    assert rig.error("carton") < 0.01
