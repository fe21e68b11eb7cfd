"""The surface gripper: taking hold, measuring, letting go."""

import re

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.rotations import Pose
from unit.pack_sim.palletizing.rig import Rig, above

BOX = BoxBody("box", (0.4, 0.3, 0.25), 16.6)
WEIGHT = 16.6 * 9.81


def weaker(**limits: float) -> PalletizingCell:
    cell = palletizing_cell()
    return cell.model_copy(update={"grip": cell.grip.model_copy(update=limits)})


@pytest.fixture(scope="module")
def carrying() -> Rig:
    """A box in the gripper, held still over the table."""
    rig = Rig()
    rig.simulator.spawn(BOX)
    rig.pick("box")
    rig.wait(0.3)
    return rig


def over_box(height: float, cell: PalletizingCell | None = None, aside: float = 0.0) -> Rig:
    """The pad over a box on the pallet."""
    rig = Rig(cell)
    top = np.array([0.0, 0.5 + aside, 0.144 + 0.25])
    rig.simulator.spawn(BOX, Pose(np.array([0.0, 0.5, 0.144 + 0.125])))
    rig.go_over_pallet(above(top, 0.05))
    rig.line(above(top, height))
    return rig


def test_at_rest_the_pull_is_the_weight(carrying: Rig) -> None:
    load = carrying.simulator.gripper.state.load
    assert load.coaxial == pytest.approx(WEIGHT, abs=0.05)
    assert load.shear < 0.1
    assert load.moment < 0.05


def test_the_box_hangs_where_it_was_gripped_without_a_yank(carrying: Rig) -> None:
    """A gap of 1 mm stays; the compliance of the grip lets a box of 16.6 kg sag by less than 0.1 mm."""
    X_TB = carrying.simulator.tool_pose().inverse() @ carrying.simulator.truth().objects["box"].X_WO
    assert 1e3 * (X_TB.p[2] - BOX.half_extents[2]) == pytest.approx(1.0, abs=0.1)
    assert carrying.simulator.gripper.state.peak.coaxial < 1.4 * WEIGHT


def test_gripping_off_centre_bends_the_pad_by_weight_times_offset() -> None:
    rig = Rig()
    rig.simulator.spawn(BOX, Pose(np.array([0.0, 0.5, 0.144 + 0.125])))
    top = np.array([0.0, 0.55, 0.144 + 0.25])
    rig.go_over_pallet(above(top, 0.05))
    rig.line(above(top, 0.001))
    rig.simulator.gripper.close()
    rig.wait(0.1)
    rig.line(above(top, 0.06))
    rig.wait(0.4)
    load = rig.simulator.gripper.state.load
    assert load.coaxial == pytest.approx(WEIGHT, abs=0.5)
    assert load.moment == pytest.approx(0.05 * WEIGHT, rel=0.02)


def test_a_pad_too_far_away_goes_on_trying_and_gives_up_with_the_reason() -> None:
    rig = over_box(height=0.015)
    gripper = rig.simulator.gripper
    gripper.close()
    rig.wait(0.9)
    assert gripper.state.is_closing
    assert not gripper.is_open
    rig.wait(0.2)
    assert gripper.is_open
    assert gripper.state.reason == "no box within 10 mm of the pad"


def test_a_closing_pad_takes_hold_as_soon_as_it_is_near_enough() -> None:
    rig = over_box(height=0.0103, cell=weaker(retry_interval=0.0))
    rig.simulator.gripper.close()
    rig.wait(0.1)
    assert rig.simulator.gripper.state.is_closing
    rig.line(np.array([0.0, 0.5, 0.144 + 0.25 + 0.0098]))
    assert rig.simulator.gripper.is_closed


def test_what_is_not_held_cannot_slip() -> None:
    rig = over_box(height=0.0005)
    gripper = rig.simulator.gripper
    gripper.slip()
    rig.wait(0.02)
    assert gripper.is_open
    gripper.close()
    rig.wait(0.1)
    assert gripper.is_closed
    assert gripper.state.load.coaxial > -1e3  # the weld still bears a load, so that it can be measured


def test_a_pad_over_an_edge_does_not_seal() -> None:
    rig = over_box(height=0.002, aside=0.13)
    rig.simulator.gripper.close()
    rig.wait(1.1)
    assert "reaches beyond the face of box" in rig.simulator.gripper.state.reason


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"coaxial_force": 100.0}, "coaxial force .* N above 100.0 N"),
        ({"coaxial_force": 1e6, "shear_force": 1e6, "moment": 0.01}, "moment .* N m above 0.0 N m"),
    ],
)
def test_a_limit_that_is_passed_lets_go_and_says_which(limits: dict[str, float], reason: str) -> None:
    rig = over_box(height=0.001, cell=weaker(**limits))
    gripper = rig.simulator.gripper
    gripper.close()
    rig.wait(0.02)
    rig.line(np.array([0.0, 0.5, 0.144 + 0.25 + 0.05]))
    assert gripper.is_open
    assert re.match(reason, gripper.state.reason)


def test_a_load_above_a_limit_is_borne_for_two_steps_only() -> None:
    rig = over_box(height=0.001, cell=weaker(coaxial_force=150.0))
    gripper, over = rig.simulator.gripper, []
    gripper.close()
    rig.wait(0.1)
    step = rig.simulator.step
    rig.simulator.step = lambda: (step(), over.append(gripper.state.load.coaxial > 150.0))[0]
    rig.line(np.array([0.0, 0.5, 0.144 + 0.25 + 0.05]))
    assert gripper.is_open
    assert sum(over) >= 2
    assert "".join("x" if o else "." for o in over).rstrip(".").endswith("xx")


def test_a_released_box_falls_at_once_even_after_hanging_still() -> None:
    rig = over_box(height=0.001)
    gripper = rig.simulator.gripper
    gripper.close()
    rig.wait(0.02)
    rig.line(np.array([0.0, 0.5, 0.144 + 0.25 + 0.1]))
    rig.wait(0.5)
    height = rig.simulator.truth().objects["box"].X_WO.p[2]
    gripper.open()
    rig.simulator.step()
    rig.wait(0.1)
    fallen = height - rig.simulator.truth().objects["box"].X_WO.p[2]
    assert fallen == pytest.approx(0.5 * 9.81 * 0.1**2, rel=0.05)
    assert gripper.state.reason == "asked to open"


def test_why_it_let_go_is_kept_until_it_closes_again() -> None:
    rig = over_box(height=0.001, cell=weaker(coaxial_force=100.0))
    gripper = rig.simulator.gripper
    gripper.close()
    rig.wait(0.02)
    rig.line(np.array([0.0, 0.5, 0.144 + 0.25 + 0.05]))
    gripper.open()
    rig.simulator.step()
    assert gripper.state.reason.startswith("coaxial force")
    gripper.close()
    assert gripper.state.reason == ""


def test_a_removed_box_leaves_the_gripper() -> None:
    rig = over_box(height=0.001)
    rig.simulator.gripper.close()
    rig.wait(0.02)
    rig.simulator.remove("box")
    assert rig.simulator.gripper.is_open
    rig.wait(0.1)


def test_tries_to_close_have_their_interval_and_end_after_their_time() -> None:
    """A box that comes into reach between two tries is gripped at the next one."""
    cell = weaker(retry_interval=0.2, retry_time=0.5)
    rig = over_box(0.05, cell)
    simulator = rig.simulator
    simulator.gripper.close()
    begun = simulator.time
    while simulator.gripper.state.is_closing:
        rig.wait(0.004)
    assert simulator.gripper.state.reason
    assert 0.35 < simulator.time - begun < 0.55
