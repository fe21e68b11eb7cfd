"""Which contacts are noticed, and which are not."""

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody
from pack_core.rotations import Pose
from unit.pack_sim.palletizing.rig import Rig, above

BOX = BoxBody("box", (0.4, 0.3, 0.25), 8.0)
TOP = np.array([0.0, 0.5, 0.144 + 0.25])


def rig_with_box_on_pallet() -> Rig:
    rig = Rig()
    rig.simulator.spawn(BOX, Pose(np.array([0.0, 0.5, 0.144 + 0.125])))
    rig.go_over_pallet(above(TOP, 0.03))
    return rig


def lifted() -> Rig:
    rig = rig_with_box_on_pallet()
    rig.line(above(TOP, 0.001))
    rig.simulator.gripper.close()
    rig.wait(0.1)
    rig.line(above(TOP, 0.101))
    return rig


def test_gripping_lifting_and_putting_down_are_no_collisions() -> None:
    rig = lifted()
    rig.line(above(TOP, 0.002))
    rig.simulator.gripper.open()
    rig.wait(0.1)
    rig.line(above(TOP, 0.1))
    assert rig.simulator.contacts.events == []


def test_a_pad_that_is_pressed_on_a_box_is_noticed_once_with_its_force() -> None:
    rig = rig_with_box_on_pallet()
    rig.line(above(TOP, -0.0005))
    rig.wait(0.2)
    (event,) = rig.simulator.contacts.events
    assert event.bodies == ("box", "tool")
    assert event.force > 20.0
    assert event.duration > 0.15


def test_a_carried_box_that_rubs_a_neighbour_is_noticed() -> None:
    rig = lifted()
    neighbour = BoxBody("neighbour", (0.3, 0.3, 0.4), 20.0)
    rig.simulator.spawn(neighbour, Pose(np.array([0.0, 0.5 + 0.15 + 0.15 + 0.005, 0.144 + 0.2])))
    rig.wait(0.05)
    rig.line(TOP + np.array([0.0, 0.02, 0.101]))
    assert [event.bodies for event in rig.simulator.contacts.events] == [("box", "neighbour")]


def test_a_carried_box_that_comes_down_fast_is_noticed() -> None:
    rig = lifted()
    rig.line(above(TOP, -0.15), speed=1.0)
    assert ("box", "pallet") in [event.bodies for event in rig.simulator.contacts.events]


@pytest.mark.parametrize("order", [1, -1])
def test_boxes_that_stand_on_each_other_are_nobodys_business(order: int) -> None:
    rig = Rig()
    boxes = [BoxBody(f"b{i}", (0.4, 0.3, 0.2), 10.0) for i in range(3)][::order]
    for i, box in enumerate(boxes):
        rig.simulator.spawn(box, Pose(np.array([0.0, 0.5, 0.144 + 0.1 + 0.2 * i])))
    rig.wait(0.2)
    assert rig.simulator.contacts.events == []
