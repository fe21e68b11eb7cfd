"""The stage machine and the stall detector."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pack_core.packing.entry import Entry
from pack_core.packing.objects import Box
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, exp, from_yaw, rotate
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.target import Stage
from pack_mpc.task.stages import ChosenPlacement, PressConfig, StageConfig, StageMachine, nearest_heading

PLACE = np.array([0.5, 0.0, 0.09])
START = Pose(PLACE + np.array([0.0, 0.0, 0.27]))


@pytest.fixture
def machine(scene: Scene) -> StageMachine:
    return StageMachine(scene, StageConfig(), ChosenPlacement(Pose(PLACE), ("tea_box",)), 0.0, START)


def test_stages_follow_one_another_down_to_the_place(machine: StageMachine) -> None:
    above = machine.target.p_WN
    assert above[2] > PLACE[2] + 0.15
    assert machine.target.collisions == ()
    assert machine.update(1.0, Pose(above))
    assert machine.stage is Stage.INSERT
    assert machine.target.collisions == ("tea_box",)
    assert machine.update(2.0, Pose(PLACE + np.array([0.03, 0.0, 0.01])))
    assert machine.stage is Stage.FINE_TUNE
    assert not machine.is_placed(PLACE + np.array([0.03, 0.0, 0.01]))
    assert machine.is_placed(PLACE + np.array([0.01, 0.0, 0.0]))


def test_in_a_fill_job_a_broad_object_passes_over_the_tallest_one_though_it_is_tilted(scene: Scene) -> None:
    broad = Box(name="broad", shape="box", size=(0.158, 0.06, 0.21), mass=0.4)
    scene = scene.model_copy(update={"new_object": broad})
    placement = ChosenPlacement(Pose(np.array([0.5, 0.0, 0.105])))
    machine = StageMachine(scene, FillSessionConfig().of_goals().task.stages, placement, 0.0, START)
    p_WN, tilt = machine.target.p_WN, np.deg2rad(10.0)
    lowest = p_WN[2] - 0.105 * np.cos(tilt) - 0.079 * np.sin(tilt)
    assert lowest > scene.rim + 0.01


def test_the_base_is_not_reached_outside_the_container(machine: StageMachine) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    machine.update(2.0, Pose(PLACE + np.array([0.3, 0.0, 0.0])))
    assert machine.stage is Stage.INSERT


def test_an_object_that_comes_down_beside_the_container_has_no_way_in(
    machine: StageMachine, scene: Scene
) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    beside = PLACE + np.array([0.3, 0.0, scene.container.height])
    machine.update(1.1, Pose(beside + np.array([0.0, 0.0, 0.01])))
    assert not machine.is_stalled
    machine.update(1.2, Pose(beside - np.array([0.0, 0.0, 0.01])))
    assert machine.is_stalled


def test_one_that_leans_over_a_wall_with_its_lower_end_inside_is_not_outside(
    machine: StageMachine, scene: Scene
) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    over_wall = np.array([0.5, scene.container.upper[1] + 0.01, PLACE[2] + scene.container.height - 0.01])
    machine.update(1.1, Pose(over_wall, exp([-0.5, 0.0, 0.0])))
    assert not machine.is_stalled
    machine.update(1.2, Pose(over_wall))
    assert machine.is_stalled


def test_one_that_leans_with_its_lower_end_above_the_wall_is_not_outside(
    machine: StageMachine, scene: Scene
) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    half_height, tilt, wall = 0.09, 0.6, scene.container.upper[1]
    # Tilted, the lower end is 5 mm above the wall and 5 mm beside it; upright it would be below the top.
    lower_end = np.array([0.5, wall + 0.005, scene.container.height + 0.005])
    middle = lower_end + half_height * np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    machine.update(1.1, Pose(middle, exp([tilt, 0.0, 0.0])))
    assert not machine.is_stalled
    machine.update(1.2, Pose(middle - np.array([0.0, 0.0, 0.01]), exp([tilt, 0.0, 0.0])))
    assert machine.is_stalled


def test_insert_without_progress_stalls(machine: StageMachine) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    stuck = PLACE + np.array([0.0, 0.0, 0.11])
    machine.update(1.1, Pose(stuck))
    machine.update(1.0 + StageConfig().stall_time, Pose(stuck))
    assert not machine.is_stalled
    machine.update(1.2 + StageConfig().stall_time, Pose(stuck))
    assert machine.is_stalled


def test_insert_that_moves_down_does_not_stall(machine: StageMachine) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    for i in range(20):
        machine.update(1.0 + i, Pose(PLACE + np.array([0.0, 0.0, 0.15 - 0.005 * i])))
        assert not machine.is_stalled


def test_fine_tune_that_comes_no_nearer_stalls(machine: StageMachine) -> None:
    blocked = PLACE + np.array([0.025, 0.0, 0.005])
    machine.update(1.0, Pose(machine.target.p_WN))
    machine.update(2.0, Pose(blocked))
    assert machine.stage is Stage.FINE_TUNE
    machine.update(2.1, Pose(blocked))
    machine.update(2.2 + StageConfig().stall_time, Pose(blocked - np.array([0.005, 0.0, 0.0])))
    assert not machine.is_stalled
    machine.update(2.3 + 2 * StageConfig().stall_time, Pose(blocked))
    assert machine.is_stalled


def test_a_low_object_that_slides_to_its_place_does_not_stall(scene: Scene) -> None:
    """Its distance from there is larger than its height over the table, where INSERT ends."""
    low = PLACE - np.array([0.0, 0.0, 0.05])
    item = Box(name="low", mass=0.3, shape="box", size=(0.06, 0.06, 0.08))
    scene = scene.model_copy(update={"new_object": item})
    machine = StageMachine(scene, StageConfig(), ChosenPlacement(Pose(low), ()), 0.0, START)
    machine.update(1.0, Pose(machine.target.p_WN))
    for i in range(10):
        machine.update(2.0 + 0.5 * i, Pose(low + np.array([0.06 - 0.0025 * i, 0.0, 0.005])))
        assert machine.stage is Stage.FINE_TUNE
        assert not machine.is_stalled


@pytest.mark.parametrize("is_rehearsed", [True, False])
def test_a_rehearsed_entry_that_halts_is_led_on(scene: Scene, is_rehearsed: bool) -> None:
    entry = Entry(np.array([1.0, 0.0]), 0.4, np.array([-0.02, 0.0]), (0.13,))
    placement = ChosenPlacement(Pose(PLACE), (), entry, is_rehearsed)
    machine = StageMachine(scene, StageConfig(lead_speed=0.1), placement, 0.0, START)
    machine.update(1.0, Pose(machine.target.p_WN))
    stuck = Pose(PLACE + np.array([0.0, 0.0, 0.1]))
    for waited in (0.0, 0.5):
        machine.update(1.1 + waited, stuck)
        axis, aside = entry.at(0.1 - 0.1 * waited * is_rehearsed)
        np.testing.assert_allclose(machine.target.axis, axis)
        np.testing.assert_allclose(machine.target.p_WN[:2], PLACE[:2] + 0.09 * axis + aside)
        assert machine.target.is_rehearsed is is_rehearsed
        assert machine.target.press == is_rehearsed * StageConfig().press.after(waited)


def test_the_way_back_is_straight_up_until_it_is_out(scene: Scene) -> None:
    lean = Rotation.from_euler("zx", [0.3, 0.2]).as_quat(scalar_first=True)
    wedged, out = (Pose(np.array([0.53, 0.02, z]), lean) for z in (0.18, 0.26))
    machine = StageMachine(scene, StageConfig(), ChosenPlacement(Pose(PLACE), ("tea_box",)), 0.0, wedged)
    target = machine.target
    np.testing.assert_allclose(target.p_WN[:2], wedged.p[:2])
    np.testing.assert_allclose(target.axis, rotate(lean, np.array([0.0, 0.0, 1.0]))[:2])
    assert target.p_WN[2] > out.p[2] - 0.01
    machine.update(0.1, out)
    np.testing.assert_allclose(machine.target.axis, 0.0, atol=1e-9)
    np.testing.assert_allclose(machine.target.p_WN[:2], PLACE[:2], atol=1e-9)


@pytest.mark.parametrize(("yaw", "heading"), [(0.0, 1.5), (3.0, 0.2), (-2.0, 2.9)])
def test_a_square_box_takes_the_nearest_of_four_headings(scene: Scene, yaw: float, heading: float) -> None:
    found = nearest_heading(scene.new_object, yaw, heading)
    assert abs(found - heading) <= np.pi / 4 + 1e-9
    quarter_turns = (found - yaw) / (np.pi / 2)
    assert quarter_turns == pytest.approx(round(quarter_turns))


def test_a_cylinder_keeps_its_heading(scene: Scene) -> None:
    assert nearest_heading(scene.model_of("soup_can"), 1.0, 0.3) == 0.3


def test_the_placement_heading_is_kept_through_the_stages(scene: Scene) -> None:
    placement = ChosenPlacement(Pose(PLACE, from_yaw(0.4)), ())
    machine = StageMachine(scene, StageConfig(), placement, 0.0, Pose(START.p, from_yaw(0.1)))
    assert machine.target.yaw == pytest.approx(0.4)


def lifted(height: float, at: np.ndarray = PLACE) -> Pose:
    """The pose with the lower end at this height [m] over the place."""
    return Pose(at + np.array([0.0, 0.0, height]))


def test_the_force_of_a_press_grows_from_a_delay_on_up_to_a_bound() -> None:
    press = PressConfig(force=22.0, rate=40.0, delay=0.15)
    halts = np.array([0.0, 0.1, 0.15, 0.25, 0.4, 0.7, 0.71, 100.0])
    np.testing.assert_allclose(
        [press.after(halt) for halt in halts], [0.0, 0.0, 0.0, 4.0, 10.0, 22.0, 22.0, 22.0]
    )


def test_pre_pack_leads_to_the_clearance_over_the_rim(machine: StageMachine, scene: Scene) -> None:
    target, half_height = machine.target, scene.new_object.half_extents[2]
    lower_end = target.p_WN[2] - half_height
    assert lower_end == pytest.approx(scene.rim + StageConfig().clearance)
    np.testing.assert_allclose(target.p_WN[:2], PLACE[:2])
    assert not target.is_rehearsed
    assert target.press == 0.0


def test_pre_pack_is_done_near_its_target_unless_another_placement_is_being_planned(
    machine: StageMachine,
) -> None:
    above, reach = machine.target.p_WN, StageConfig().pre_pack_distance
    for axis in np.eye(3):
        assert not machine.update(1.0, Pose(above + 1.01 * reach * axis))
    assert not machine.update(1.5, Pose(above + 0.99 * reach * np.eye(3)[0]), may_insert=False)
    assert machine.stage is Stage.PRE_PACK
    assert machine.update(2.0, Pose(above + 0.99 * reach * np.eye(3)[0]))
    assert machine.stage is Stage.INSERT
    assert machine.stage_start == 2.0


def test_an_object_that_is_near_but_below_the_rim_is_not_inserted(scene: Scene) -> None:
    config = StageConfig(clearance=0.005)
    machine = StageMachine(scene, config, ChosenPlacement(Pose(PLACE)), 0.0, START)
    at_rim = np.array([*PLACE[:2], scene.rim + scene.new_object.half_extents[2]])
    assert not machine.update(1.0, Pose(at_rim - np.array([0.0, 0.0, 0.001])))
    assert not machine.is_out
    assert machine.update(2.0, Pose(at_rim + np.array([0.0, 0.0, 0.001])))
    assert machine.is_out


@pytest.mark.parametrize(("height", "is_done"), [(0.0149, True), (0.0151, False)])
def test_insert_is_done_low_over_the_place(machine: StageMachine, height: float, is_done: bool) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    assert machine.update(2.0, lifted(height)) is is_done
    assert machine.stage is (Stage.FINE_TUNE if is_done else Stage.INSERT)


@pytest.mark.parametrize("side", [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_the_base_ends_at_every_wall(scene: Scene, side: tuple[int, int]) -> None:
    container, outward = scene.container, np.array(side)
    wall = np.where(outward > 0, container.upper, np.where(outward < 0, container.lower, PLACE[:2]))
    for beyond, stage in ((0.001, Stage.INSERT), (-0.001, Stage.FINE_TUNE)):
        machine = StageMachine(scene, StageConfig(), ChosenPlacement(Pose(PLACE)), 0.0, START)
        machine.update(1.0, Pose(machine.target.p_WN))
        machine.update(2.0, Pose(np.array([*(wall + beyond * outward), PLACE[2]])))
        assert machine.stage is stage


def test_fine_tune_leads_to_the_place_itself(machine: StageMachine) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    machine.update(2.0, lifted(0.01))
    np.testing.assert_array_equal(machine.target.p_WN, PLACE)
    reach = StageConfig().placed_distance
    for axis in np.eye(3):
        assert machine.is_placed(PLACE + 0.99 * reach * axis)
        assert not machine.is_placed(PLACE - 1.01 * reach * axis)
    assert machine.distance(PLACE + np.array([0.003, -0.004, 0.012])) == pytest.approx(0.013)


def test_to_begin_with_nothing_is_placed_or_stalled(machine: StageMachine) -> None:
    assert not machine.is_placed(PLACE)
    assert not machine.is_stalled


def test_a_halt_is_the_time_since_the_last_progress_that_counts(machine: StageMachine) -> None:
    progress = StageConfig().stall_progress
    machine.update(0.5, Pose(machine.target.p_WN + 1.0))
    assert machine.halt == 0.0
    machine.update(1.0, Pose(machine.target.p_WN))
    assert machine.halt == 0.0
    for time, height, halt in (
        (1.5, 0.15, 0.0),
        (2.0, 0.15 - 0.9 * progress, 0.5),
        (2.25, 0.15 - 1.1 * progress, 0.0),
        (3.25, 0.15, 1.0),
        (3.5, 0.15 - 1.9 * progress, 1.25),
        (4.5, 0.15 - 2.2 * progress, 0.0),
    ):
        machine.update(time, lifted(height))
        assert machine.halt == pytest.approx(halt)


def test_a_stall_ends_with_the_next_progress(machine: StageMachine) -> None:
    machine.update(1.0, Pose(machine.target.p_WN))
    machine.update(2.0, lifted(0.15))
    machine.update(2.0 + StageConfig().stall_time, lifted(0.15))
    assert not machine.is_stalled
    machine.update(2.01 + StageConfig().stall_time, lifted(0.15))
    assert machine.is_stalled
    machine.update(5.0, lifted(0.10))
    assert not machine.is_stalled


def test_a_lead_ends_at_the_place(scene: Scene) -> None:
    entry = Entry(np.array([1.0, 0.0]), 0.4, np.array([-0.02, 0.0]), (0.13,))
    placement = ChosenPlacement(Pose(PLACE), (), entry, is_rehearsed=True)
    machine = StageMachine(scene, StageConfig(lead_speed=0.1), placement, 0.0, START)
    machine.update(1.0, Pose(machine.target.p_WN))
    machine.update(1.1, lifted(0.05))
    machine.update(2.1, lifted(0.05))
    axis, aside = entry.at(0.0)
    np.testing.assert_allclose(machine.target.axis, axis)
    np.testing.assert_allclose(machine.target.p_WN, PLACE + np.append(0.09 * axis + aside, 0.0))
    np.testing.assert_array_equal(machine.target.over, entry.over)
