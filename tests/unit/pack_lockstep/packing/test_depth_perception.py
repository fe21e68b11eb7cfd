"""Perception by depth images in lockstep: what is known before a goal, and what is recorded of it."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.packing.depth import DepthFrame
from pack_core.packing.goals import FillMethod
from pack_core.packing.objects import Box, Capsule
from pack_core.packing.packing_list import handed_over
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, exp, from_yaw, multiply
from pack_core.states import Source
from pack_evaluation.packing.plots import draw_seen
from pack_evaluation.packing.run import Iterations, Run, SeenObject, SeenScene
from pack_evaluation.packing.run_file import load_saved_run, save_run
from pack_evaluation.packing.seen_objects import figures, perception_errors, with_true_names
from pack_evaluation.track import Track
from pack_lockstep.packing.benchmark import fill_setup
from pack_lockstep.packing.depth_fill import ContentLook, DepthFillBenchmark, depth_fill_setup
from pack_lockstep.packing.lockstep import LockstepCell
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_lockstep.packing.settings import BenchmarkSettings, set_up
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.depth.registration import Registration
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.simulator import Simulator

CELL = packing_cell()
SPOTS = {
    "soup_can": (0.42, 0.06), "coffee_tin": (0.58, 0.06), "tea_box": (0.50, 0.06),
    "cracker_box": (0.43, -0.06), "sugar_box": (0.57, -0.06),
}  # fmt: skip


def scene() -> Scene:
    poses = {
        item.name: Pose(np.array([*SPOTS[item.name], item.half_extents[2]]), from_yaw(np.pi / 2))
        for item in CELL.scene.objects
    }
    return CELL.scene.with_poses(poses)


def fresh(preset: str) -> LockstepCell:
    """The cell under a preset, after the time in which perception looks."""
    given = load_preset(preset)
    cell = LockstepCell(given.packing_cell(), scene(), lockstep_config(given), 0, lambda *_: None)
    cell.settle()
    return cell


settled = cache(fresh)


@pytest.mark.parametrize("preset", ["depth", "unknown"])
def test_all_objects_are_known_before_the_goal(preset: str) -> None:
    cell = settled(preset)
    seen = cell.seen()
    assert len(seen.poses) == len(seen.objects) == len(SPOTS)
    estimate, truth = cell.estimator.state(cell.estimator.time), cell.simulator.truth()
    for name, item in seen.objects.items():
        assert estimate.objects[item.name].X_WO.p == pytest.approx(truth.objects[name].X_WO.p, abs=0.004)
        assert item.has_heading


def test_described_objects_keep_their_names_and_unknown_ones_get_some() -> None:
    assert settled("depth").known_scene == settled("depth").simulator.description
    unknown = settled("unknown").known_scene
    assert sorted(unknown.names) == [f"seen_{i}" for i in range(1, 6)]


def test_the_held_object_is_measured_where_nobody_measured_it() -> None:
    given = load_preset("unknown").over("sim", {"mismatch": {"size": 0.004}})
    cell = LockstepCell(given.packing_cell(), scene(), lockstep_config(given), 0, lambda *_: None)
    true, told = CELL.scene.new_object, cell.simulator.description.new_object
    cell.settle()
    known, held = cell.known_scene.new_object, cell.seen().held
    assert np.abs(told.half_extents - true.half_extents).max() > 0.0005
    assert known.half_extents == pytest.approx(true.half_extents, abs=0.0003)
    assert (known.name, known.mass) == (told.name, told.mass)
    assert held is not None
    assert np.abs(held.sizes).max() < 0.0006
    estimator = cell.estimator
    assert isinstance(estimator, DepthEstimator)
    assert known.name in estimator.deviations
    assert settled("depth").known_scene.new_object == settled("depth").simulator.description.new_object


def test_sizes_of_unknown_objects_are_seen() -> None:
    cell = settled("unknown")
    seen = cell.seen()
    sizes = np.abs([item.sizes for item in seen.objects.values()])
    assert np.median(sizes) < 0.002
    assert sizes.max() < 0.01


def test_an_object_that_is_shifted_is_followed() -> None:
    cell = fresh("depth")
    simulator, estimator = cell.simulator, cell.estimator
    simulator.data.qpos[simulator.model.joint("sugar_box").qposadr[0]] -= 0.008
    cell.advance(0.4)
    estimate, truth = (
        state.objects["sugar_box"].X_WO for state in (estimator.state(estimator.time), simulator.truth())
    )
    assert truth.p[0] == pytest.approx(SPOTS["sugar_box"][0] - 0.008, abs=0.001)
    assert estimate.p == pytest.approx(truth.p, abs=0.002)


def test_the_cup_is_no_part_of_an_object_whose_top_is_hardly_wider() -> None:
    given = load_preset("unknown")
    narrow = Box(name="brick", mass=0.03, shape="box", size=(0.05, 0.05, 0.075))
    held = scene().model_copy(update={"new_object": narrow})
    cell = LockstepCell(given.packing_cell(), held, lockstep_config(given), 0, lambda *_: None)
    cell.settle()
    assert cell.known_scene.new_object.half_extents == pytest.approx(narrow.half_extents, abs=0.0005)
    cell.advance(1.0)
    estimate, truth = cell.estimator.state(cell.estimator.time), cell.simulator.truth()
    assert estimate.objects["brick"].X_WO.p == pytest.approx(truth.objects["brick"].X_WO.p, abs=0.001)


def test_what_comes_into_sight_while_others_are_pushed_is_one_more_object() -> None:
    given = load_preset("unknown")
    hidden = scene().poses() | {"sugar_box": Pose(np.array([0.5, 0.35, 0.055]))}  # where no look looks
    cell = LockstepCell(
        given.packing_cell(), scene().with_poses(hidden), lockstep_config(given), 0, lambda *_: None
    )
    cell.settle()
    simulator, before = cell.simulator, cell.known_scene
    assert len(before.names) == len(SPOTS) - 1
    cell.advance(0.6)
    assert cell.known_scene is before  # nothing has moved
    q, at = simulator.data.qpos, {name: simulator.model.joint(name).qposadr[0] for name in SPOTS}
    q[at["tea_box"]] -= 0.008
    q[at["sugar_box"] : at["sugar_box"] + 2] = SPOTS["sugar_box"]
    cell.advance(1.3)
    seen = cell.seen()
    assert len(seen.poses) == len(seen.objects) == len(SPOTS)
    assert cell.known_scene.names[:-1] == before.names
    assert cell.known_scene.objects[:-1] == before.objects
    estimate, truth = cell.estimator.state(cell.estimator.time), simulator.truth()
    new = estimate.objects[seen.objects["sugar_box"].name].X_WO.p
    assert new == pytest.approx(truth.objects["sugar_box"].X_WO.p, abs=0.003)


def test_an_object_that_somebody_put_elsewhere_is_found_again() -> None:
    given = load_preset("unknown")
    free = scene().poses() | {"sugar_box": Pose(np.array([0.5, 0.35, 0.055]))}  # where no look looks
    cell = LockstepCell(
        given.packing_cell(), scene().with_poses(free), lockstep_config(given), 0, lambda *_: None
    )
    cell.settle()
    simulator, estimator, before = cell.simulator, cell.estimator, cell.known_scene
    lost = cell.seen().objects["tea_box"].name
    at = simulator.model.joint("tea_box").qposadr[0]
    simulator.data.qpos[at : at + 2] = SPOTS["sugar_box"]
    simulator.data.qpos[simulator.model.joint("soup_can").qposadr[0] + 1] -= 0.008  # has it look again
    cell.advance(1.9)
    estimate, truth = estimator.state(estimator.time), simulator.truth()
    assert cell.known_scene.names == before.names
    assert estimate.objects[lost].X_WO.p == pytest.approx(truth.objects["tea_box"].X_WO.p, abs=0.003)


def test_a_cell_may_have_two_cameras() -> None:
    two = {"mounts": [mount.model_dump() for mount in CELL.depth.mounts[:2]]}
    given = load_preset("unknown").over("cell", {"depth": two})
    cell = LockstepCell(given.packing_cell(), scene(), lockstep_config(given), 0, lambda *_: None)
    cell.settle()
    assert len(cell.seen().poses) == len(SPOTS)
    assert cell.simulator.cell.depth.names == ("depth_1", "depth_2")


def test_with_a_camera_that_was_knocked_nothing_is_looked_for() -> None:
    given = load_preset("unknown").over("cell", {"depth": {"noise": {"mount_position": 0.02}}})
    cell = LockstepCell(given.packing_cell(), scene(), lockstep_config(given), 0, lambda *_: None)
    cell.settle()
    estimator = cell.estimator
    assert isinstance(estimator, DepthEstimator)
    assert set(estimator.misplaced) == {0, 1, 2}
    assert not estimator.knows_objects
    assert cell.seen().poses == {}


def test_one_camera_alone_does_not_see_what_hangs_on_the_cup_all_around_and_says_so() -> None:
    given = load_preset("unknown")
    cell = LockstepCell(given.packing_cell(), scene(), lockstep_config(given), 0, lambda *_: None)
    estimator = cell.estimator
    assert isinstance(estimator, DepthEstimator)
    see, first_alone = estimator.see, np.array([1.0, 0.0, 0.0])[:, None, None]
    with patch.object(estimator, "see", lambda frame: see(replace(frame, images=frame.images * first_alone))):
        cell.settle()
    assert not estimator.knows_objects
    assert "is not seen all around by the cameras" in estimator.hindrance
    cell.settle()
    assert (estimator.knows_objects, estimator.hindrance) == (True, "")


def test_while_the_cameras_are_covered_physics_carries_all_objects() -> None:
    cell = fresh("depth")
    estimator, camera = cell.estimator, CELL.depth
    assert isinstance(estimator, DepthEstimator)
    before = estimator.state(estimator.time)
    time = estimator.time - camera.latency
    correction = estimator.see(DepthFrame(time, np.zeros((len(camera.mounts), camera.height, camera.width))))
    assert correction.seen == ()
    later = estimator.state(estimator.time + 1.0)
    for name in SPOTS:
        assert later.objects[name].source is Source.PHYSICS
        assert later.objects[name].age > 1.0
        assert later.objects[name].X_WO.p == pytest.approx(before.objects[name].X_WO.p, abs=0.001)


def still(name: str, p: tuple[float, float, float], yaw: float) -> Track:
    """An object that stays where it is for a second."""
    times = np.array([0.0, 1.0])
    return Track(times, np.tile(p, (2, 1)), np.tile(from_yaw(yaw), (2, 1)), np.zeros(2, dtype=np.uint8))


def run_of(estimate: dict[str, Track], truth: dict[str, Track]) -> Run:
    nothing = np.empty(0)
    return Run(CELL.scene, 0.0, 1.0, Iterations(), truth, estimate, nothing, nothing, nothing, nothing)


def what_was_seen(count: int) -> SeenScene:
    """Some boxes beside each other, of which the second is the tea box."""
    box = CELL.scene.model_of("tea_box")
    names = [f"seen_{i}" for i in range(1, count + 1)]
    scene = CELL.scene.model_copy(
        update={"objects": [box.model_copy(update={"name": name}) for name in names]}
    )
    poses = {name: Pose(np.array([0.5, 0.05 * i, 0.065])) for i, name in enumerate(names)}
    return SeenScene(scene, poses, {"tea_box": SeenObject("seen_2", True, 0.9, (0.001, -0.002, 0.0))})


def test_what_was_seen_is_recorded_under_the_true_objects_name() -> None:
    true = settled("unknown").simulator.scene
    track = still("tea_box", (0.5, 0.0, 0.065), 0.0)
    seen = what_was_seen(2)
    named = with_true_names(run_of({"seen_1": track, "seen_2": track}, {}), seen, true)
    assert named.estimate.keys() == {"seen_1", "tea_box"}
    assert named.scene.names == true.names
    assert named.seen == seen


def a_run() -> Run:
    """One of five objects was found, 5 mm and 0.05 rad off."""
    truth = {"tea_box": still("tea_box", (0.5, 0.0, 0.065), 0.2)}
    estimate = {"tea_box": still("tea_box", (0.503, 0.004, 0.065), 0.25 + np.pi / 2)}
    seen = what_was_seen(4)
    return replace(run_of(estimate, truth), seen=seen)


def test_errors_are_those_of_found_objects_less_their_symmetries() -> None:
    errors = perception_errors(a_run())
    assert errors is not None
    assert (errors.objects, errors.seen, errors.found) == (5, 4, 1)
    assert errors.positions == pytest.approx([0.005, 0.005])
    # nobody says which side of a box that was seen is its x axis
    assert errors.angles == pytest.approx([0.05, 0.05])
    assert errors.sizes == pytest.approx([0.001, -0.002, 0.0])
    assert perception_errors(run_of({}, {})) is None


def test_how_far_a_lying_capsule_has_rolled_is_no_error() -> None:
    kiwi = Capsule(name="kiwi", shape="capsule", mass=0.07, radius=0.022, length=0.06, axis="x")
    scene = CELL.scene.model_copy(update={"objects": [kiwi]})
    true, seen = still("kiwi", (0.5, 0.0, 0.022), 0.2), still("kiwi", (0.5, 0.0, 0.022), 0.25)
    rolled = multiply(from_yaw(0.2), exp(np.array([1.3, 0.0, 0.0])))
    run = replace(
        run_of({"kiwi": seen}, {"kiwi": replace(true, q=np.tile(rolled, (len(true.times), 1)))}),
        scene=scene, seen=SeenScene(scene, {}, {"kiwi": SeenObject("kiwi", True, 1.0, (0.0, 0.0, 0.0))}),
    )  # fmt: skip
    errors = perception_errors(run)
    assert errors is not None
    assert errors.angles == pytest.approx(0.05)


def test_figures_of_many_runs_are_those_of_all_their_errors() -> None:
    errors = perception_errors(a_run())
    assert errors is not None
    exact = replace(errors, seen=5, found=5, positions=np.zeros(2), angles=np.zeros(2), sizes=np.zeros(3))
    found = figures([errors, exact])
    assert {name: found[name] for name in ("objects", "seen", "found", "right_number")} == {
        "objects": 10, "seen": 9, "found": 6, "right_number": 1,
    }  # fmt: skip
    assert found["position_mm"]["median"] == pytest.approx(2.5)
    assert found["size_mm"]["max"] == pytest.approx(2.0)
    nothing = replace(errors, found=0, positions=np.empty(0), angles=np.empty(0), sizes=np.empty(0))
    assert figures([nothing])["angle_deg"] == {"median": None, "p95": None, "max": None}


def test_what_was_seen_comes_back_from_the_file_of_a_run(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    save_run(a_run(), path)
    again, seen = load_saved_run(path).seen, a_run().seen
    assert again is not None
    assert seen is not None
    assert (again.scene, again.objects) == (seen.scene, seen.objects)
    for name, X_WO in seen.poses.items():
        assert again.poses[name].p == pytest.approx(X_WO.p)


def test_a_picture_has_the_outlines_of_what_was_seen_and_of_what_was_there() -> None:
    run = a_run()
    run = replace(run, truth={name: still(name, (0.5, 0.0, 0.065), 0.0) for name in run.scene.names})
    assert run.seen is not None
    axes = draw_seen(run, run.seen).axes[0]
    assert "1 of 5 objects found, 4 seen" in axes.get_title()
    assert len(axes.patches) == 5
    # four objects and the container; a box of 9 cm by 6 cm is seen with its middle at x = 50 cm
    assert len(axes.lines) == 5
    x, _ = axes.lines[0].get_data()
    assert (min(x), max(x)) == pytest.approx((45.5, 54.5))


def test_depth_cameras_decide_no_result_with_markers() -> None:
    with_markers, by_depth = (
        set_up(BenchmarkSettings(preset=name), 1).record() for name in ("ideal", "depth")
    )
    assert "depth" not in with_markers["cell"] | with_markers["config"]["estimator"]
    assert by_depth["config"]["estimator"]["depth"]["objects"] == "described"
    assert by_depth["cell"]["depth"]["rate"] == CELL.depth.rate


def test_calibrated_cameras_tell_where_the_container_is() -> None:
    given = load_preset("hardware_unknown")
    cell, config = given.packing_cell(), lockstep_config(given)
    simulator = Simulator(cell, scene(), config.simulator, np.random.default_rng(302))
    system = DepthCameraSystem(cell.depth, np.random.default_rng(2))
    told, true = simulator.description, simulator.scene.container.centre
    assert np.linalg.norm(np.subtract(told.container.centre, true)) > 0.001
    estimator = DepthEstimator(told, cell, config.estimator, system.cameras)
    for _ in range(20):
        simulator.step()
        estimator.advance(simulator.joints())
    frame = system.capture(simulator.model, simulator.data, simulator.time)
    first, second, third = system.cameras
    knocked = Pose(np.add(second.X_WC.p, [0.0, 0.0, 0.002]), second.X_WC.q)
    doubtful = DepthEstimator(told, cell, config.estimator, [first, replace(second, X_WC=knocked), third])
    doubtful.advance(simulator.joints())
    doubtful.see(frame)
    assert set(doubtful.misplaced.values()) == {"2 mm between the cameras"}
    estimator.see(frame)
    assert len(estimator.scene.objects) == len(SPOTS)
    np.testing.assert_allclose(estimator.scene.container.centre, true, atol=3e-4)
    # each look places it anew
    nearer = Registration(np.zeros(3), np.array([0.001, 0.0, 0.0]), np.zeros(3), 0.0)
    estimator._needs_look = True
    with patch("pack_perception.depth.extrinsics.register", return_value=nearer):
        estimator.see(frame)
    expected = np.subtract(told.container.centre, [0.001, 0.0])
    np.testing.assert_allclose(estimator.scene.container.centre, expected, atol=1e-9)
    estimator._needs_look = True
    estimator.see(frame)
    np.testing.assert_allclose(estimator.scene.container.centre, true, atol=3e-4)
    # with what is handed over next the container is told as it was described, and is known better
    estimator.change_scene(told.with_next(handed_over(CELL.scene.new_object, CELL), keep=False))
    np.testing.assert_allclose(estimator.scene.container.centre, true, atol=3e-4)


def test_what_is_handed_over_stands_where_announced_and_what_was_seen_stays() -> None:
    cell = fresh("unknown")
    estimator, before = cell.estimator, cell.known_scene
    assert isinstance(estimator, DepthEstimator)
    told = handed_over(CELL.scene.new_object.model_copy(update={"name": "next"}), CELL)
    estimator.change_scene(CELL.scene.with_next(told, keep=False))
    assert estimator.scene.names == before.names  # the object before hangs over the container
    assert told.pose is not None
    np.testing.assert_allclose(estimator.state(estimator.time).objects["next"].X_WO.p, told.pose.position)

    # the next look, with the arm's object beside the container, goes on with what is known
    assert estimator.take_hold() is not None
    assert not estimator.knows_objects
    cell.advance(0.15)
    assert estimator.knows_objects
    assert estimator.scene.names == before.names


def test_a_list_without_markers_has_a_benchmark_of_its_own() -> None:
    with pytest.raises(ConfigError, match="'unknown' with --fill; allowed: presets with motion capture"):
        fill_setup(FillMethod.CONTACT, "unknown", 1)
    setup = depth_fill_setup(FillMethod.CONTACT, "unknown", 1)
    settings = DepthFillBenchmark(setup, ()).settings()
    assert ContentLook(3, 3, 3).is_right
    assert not ContentLook(3, 4, 3).is_right
    assert settings["config"]["estimator"]["depth"]["objects"] == "unknown"
    assert settings["cell"]["depth"]["rate"] == CELL.depth.rate
