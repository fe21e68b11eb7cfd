"""Objects enter the optimizer's model when something comes within reach of them, and leave it afterwards."""

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_mpc.controller import ControllerConfig, PackingController, Predictor
from pack_mpc.cost.weights import load_weights
from pack_mpc.plant import PackingPlant
from pack_mpc.state_reduction import MOVED, StateReduction, StateReductionConfig, SweptBox
from pack_mpc.target import PackingTarget, Stage

ABOVE = PackingTarget(np.array([0.45, 0.05, 0.40]), 0.2)
INSIDE = PackingTarget(np.array([0.50, 0.04, 0.09]), 0.0, collisions=("tea_box", "soup_can", "sugar_box"))
CYCLE = 0.048
"""Time of an iteration [s]."""


def controller_of(scene: Scene, optimizer: str, **reduction: float) -> PackingController:
    config = ControllerConfig.model_validate(
        {"optimizer": optimizer, "threads": 2, optimizer: {"reduction": {"margin": 0.02, **reduction}}}
    )
    return PackingController(scene.description(), packing_cell(), load_weights("tuned"), config)


def objects_of(controller: PackingController) -> list[str]:
    """Names of the objects in the optimizer's model."""
    return controller._optimizer.plant.scene.names


@pytest.fixture
def own_plant(scene: Scene) -> PackingPlant:
    """A plant of this test alone, as a reduction changes it."""
    return PackingPlant(scene.description(), packing_cell(), timestep=0.006, threads=1)


def still(x: Array) -> Array:
    """States `(1, 2, nx)` of a rollout in which nothing moves."""
    return np.stack([x, x])[None]


def held_at(plant: PackingPlant, *positions: tuple[float, float, float]) -> Array:
    """Outputs `(1, n, ny)` of a rollout with the held object upright at positions [m]."""
    ys = np.zeros((1, len(positions), plant.model.nsensordata))
    ys[0, :, plant.sensor("held_position")] = positions
    ys[..., plant.sensor("held_x_axis")] = (1.0, 0.0, 0.0)
    ys[..., plant.sensor("held_z_axis")] = (0.0, 0.0, 1.0)
    return ys


HIGH = (0.5, 0.06, 0.4)
ON_THE_TEA_BOX = (0.5, 0.06, 0.222)
"""The lower end of the held object is 2 mm over the top of the tea box, and 1 cm aside of the coffee tin."""
NARROW = 0.005
"""A margin that is smaller than the gaps between the objects [m]."""


@pytest.mark.parametrize("optimizer", ["ilqr", "sgn"])
def test_nothing_is_in_the_state_while_the_object_is_carried_high_above(
    scene, joints, state, optimizer
) -> None:
    controller = controller_of(scene, optimizer)
    for _ in range(2):
        controller.plan(joints, state, Stage.PRE_PACK, ABOVE, 0.0, 0.0)
    assert objects_of(controller) == []


@pytest.mark.parametrize("optimizer", ["ilqr", "sgn"])
def test_with_everything_within_reach_plans_are_those_of_the_full_state(
    scene, joints, state, optimizer
) -> None:
    plans = []
    for margin in (1e3, np.inf):
        controller = controller_of(scene, optimizer, margin=margin)
        for _ in range(3):
            plan = controller.plan(joints, state, Stage.INSERT, INSIDE, 0.0, 0.0)
        assert objects_of(controller) == scene.names
        plans.append(plan)
    np.testing.assert_array_equal(plans[0].setpoints.q, plans[1].setpoints.q)
    np.testing.assert_array_equal(plans[0].setpoints.tau, plans[1].setpoints.tau)
    assert plans[0].solution.cost == plans[1].solution.cost


@pytest.mark.parametrize("optimizer", ["ilqr", "sgn"])
def test_an_object_is_in_the_state_before_it_is_pushed(scene, joints, state, optimizer) -> None:
    controller, simulator = controller_of(scene, optimizer), Predictor(scene.description(), packing_cell())
    plant, x = simulator.plant, simulator.plant.state(joints, state)
    begin, moved = x.copy(), set()
    for _ in range(25):
        plan = controller.plan(*measured(plant, x), Stage.INSERT, INSIDE, 0.0, 0.0)
        known = objects_of(controller)
        x = simulator.predict(x, (plan.setpoints,), CYCLE)
        moved |= {name for name, p in plant.layout.object_p.items() if np.abs(x - begin)[p].max() > MOVED}
        assert moved <= set(known)
    assert moved


def measured(plant: PackingPlant, x: Array) -> tuple[JointSample, SceneState]:
    """What would be measured in a state of all objects."""
    layout, objects = plant.layout, {}
    for name, p in layout.object_p.items():
        pose = Pose(x[p], x[p[0] + 3 : p[0] + 7])
        objects[name] = ObjectState(pose, x[layout.object_v[name]])
    return JointSample(x[0], x[layout.q], x[layout.v], np.zeros(7)), SceneState(x[0], objects)


def test_the_first_iteration_decides_and_what_was_reached_lingers(own_plant, joints, state) -> None:
    reduction = StateReduction(own_plant, StateReductionConfig(margin=NARROW, linger=3))
    x = own_plant.state(joints, state)
    assert len(reduction.names) == 5
    steps = []
    for position in (ON_THE_TEA_BOX, HIGH, HIGH, HIGH):
        own_plant.watch(still(own_plant.part(x)), held_at(own_plant, position, HIGH))
        reduction.reduce(x)
        steps.append(own_plant.scene.names)
    assert steps == [["tea_box"], ["tea_box"], ["tea_box"], []]


def test_an_object_that_a_moving_one_comes_near_enters(own_plant, joints, state) -> None:
    reduction = StateReduction(own_plant, StateReductionConfig(margin=NARROW))
    x = own_plant.state(joints, state)
    xs = still(x).copy()
    # the tea box slides along x until it is 2.5 mm from the coffee tin
    xs[0, 1, own_plant.layout.object_p["tea_box"][0]] += 0.01
    own_plant.watch(xs, held_at(own_plant, ON_THE_TEA_BOX, ON_THE_TEA_BOX))
    reduction.reduce(x)
    assert own_plant.scene.names == ["coffee_tin", "tea_box"]


def test_the_order_of_objects_does_not_matter(scene, joints, state) -> None:
    chosen = []
    for objects in (scene.objects, scene.objects[::-1]):
        part = scene.description().model_copy(update={"objects": list(objects)})
        plant = PackingPlant(part, packing_cell(), timestep=0.006, threads=1)
        reduction, x = StateReduction(plant, StateReductionConfig(margin=NARROW)), plant.state(joints, state)
        plant.watch(still(x), held_at(plant, ON_THE_TEA_BOX, HIGH))
        x0 = reduction.reduce(x)
        np.testing.assert_array_equal(x0[plant.layout.object_p["tea_box"]], x[_place(part, "tea_box", plant)])
        chosen.append(set(plant.scene.names))
    assert chosen[0] == chosen[1] == {"tea_box"}


def _place(scene: Scene, name: str, plant: PackingPlant) -> np.ndarray:
    """Where an object's position is in the state with all objects, each of which takes seven in qpos."""
    own = plant.layout.object_p[name][0]
    before = scene.names.index(name)
    return own + 7 * before + np.arange(3)


def test_a_rollout_that_diverged_brings_nothing_within_reach(own_plant, joints, state) -> None:
    reduction = StateReduction(own_plant, StateReductionConfig(margin=NARROW))
    x = own_plant.state(joints, state)
    own_plant.watch(still(x), held_at(own_plant, HIGH, HIGH))
    own_plant.watch(np.full_like(still(x), np.nan), np.full_like(held_at(own_plant, HIGH, HIGH), np.nan))
    reduction.reduce(x)
    assert own_plant.scene.names == []


def test_a_swept_box_holds_a_turned_object(scene) -> None:
    item = scene.model_of("tea_box")  # 90 x 60 x 130 mm
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    box = SweptBox.of(
        np.array([[[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]]), np.stack([quarter, np.eye(3)])[None], item
    )
    np.testing.assert_allclose(box.lower, [-0.03, -0.045, -0.065])
    np.testing.assert_allclose(box.upper, [0.145, 0.045, 0.065])
    away = SweptBox(np.array([0.185, 0.0, 0.0]), np.ones(3))
    assert box.is_within(0.041, away)
    assert not box.is_within(0.039, away)
