"""The push in physics, and what the closed rules of tipping and load-bearing say of the same stacks."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.palletizing.orders.load_bearing import carried_loads
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import GRAVITY
from pack_core.palletizing.orders.tipping import pushes_of
from pack_core.rotations import Pose
from pack_lockstep.palletizing.stack_hold import hold_shift_mm, standing

CELL = palletizing_cell()


def on_the_pallet(boxes: Sequence[PlacedBox]) -> dict[BoxBody, Pose]:
    return standing(boxes, CELL)


def box(name: str, lower: tuple[float, ...], size: tuple[float, ...], mass: float = 8.0) -> PlacedBox:
    return PlacedBox(name, np.array(lower), np.array(size), mass)


def tower(width: float) -> list[PlacedBox]:
    """Two boxes of a width on each other, 0.8 m high."""
    return [box(f"b{k}", (0.4, 0.3, 0.4 * k), (width, 0.4, 0.4)) for k in range(2)]


def stair(shift: float) -> list[PlacedBox]:
    """Four flat boxes, each displaced by `shift` against the one under it."""
    return [box(f"s{k}", (0.2 + shift * k, 0.2, 0.2 * k), (0.4, 0.4, 0.2)) for k in range(4)]


def bridge(count: int) -> list[PlacedBox]:
    """A long box over so many short ones, and a load in the middle."""
    piers = [box(f"p{k}", (0.1 + 0.5 / (count - 1) * k, 0.2, 0.0), (0.2, 0.4, 0.2)) for k in range(count)]
    return [
        *piers,
        box("over", (0.1, 0.2, 0.2), (0.7, 0.4, 0.2), 12.0),
        box("load", (0.3, 0.2, 0.4), (0.3, 0.4, 0.1)),
    ]


def test_a_flat_box_holds_less_than_friction_and_slides_at_more() -> None:
    flat = on_the_pallet([box("a", (0.4, 0.25, 0.0), (0.4, 0.3, 0.2))])
    friction = CELL.contact.friction
    assert hold_shift_mm(CELL, flat, 0.5 * friction) < 1.0
    assert hold_shift_mm(CELL, flat, 1.5 * friction) > 10.0


def test_boxes_that_overhang_each_other_do_not_walk_by_themselves() -> None:
    stack = [
        box("low", (0.413, 0.21, 0.0), (0.39, 0.59, 0.22), 7.65),
        box("middle", (0.331, 0.53, 0.22), (0.54, 0.27, 0.26), 10.69),
        box("top", (0.258, 0.49, 0.48), (0.55, 0.31, 0.22), 7.9),
    ]
    # They settle by 0.2 mm; contacts without resistance to rolling let them rock and walk by 0.9 mm.
    assert hold_shift_mm(CELL, on_the_pallet(stack), acceleration=0.0) < 0.3


def test_a_slender_box_falls_though_it_does_not_slide() -> None:
    assert hold_shift_mm(CELL, on_the_pallet([box("a", (0.55, 0.35, 0.0), (0.1, 0.1, 0.9))]), 0.3) > 100.0


@pytest.mark.parametrize("width", [0.12, 0.2, 0.28])
def test_a_tower_tips_soon_after_the_push_that_the_closed_rule_says_and_not_before(width: float) -> None:
    """The push lasts 0.3 s: at the rule's own value a tower only begins to tip, so a third more is tried."""
    push = min(pushes_of(tower(width)).values())
    assert push == pytest.approx(width / 0.8)
    assert hold_shift_mm(CELL, on_the_pallet(tower(width)), 0.9 * push) < 1.0
    assert hold_shift_mm(CELL, on_the_pallet(tower(width)), 1.35 * push) > 10.0


@pytest.mark.parametrize(("shift", "holds"), [(0.0, True), (0.06, True), (0.095, False)])
def test_the_closed_rule_tells_stairs_that_hold_from_those_that_do_not(shift: float, holds: bool) -> None:
    assert (min(pushes_of(stair(shift)).values()) >= 0.25) == holds
    assert (hold_shift_mm(CELL, on_the_pallet(stair(shift)), 0.2) < 10.0) == holds


def contact_loads(boxes: Sequence[PlacedBox]) -> dict[str, float]:
    """What each box carries in physics once the stack is at rest [kg]: what presses on its upper face."""
    stack = on_the_pallet(boxes)
    model = build_model(CELL, list(stack))
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)  # boxes asleep have no contact forces
    data = mujoco.MjData(model)
    for body, X_WB in stack.items():
        q = model.joint(body.name).qposadr[0]
        data.qpos[q : q + 7] = [*X_WB.p, *X_WB.q]
    while data.time < 0.5:
        data.qpos[: len(CELL.arm.home)], data.qvel[: len(CELL.arm.home)] = CELL.arm.home, 0.0
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    loads, names = {body.name: 0.0 for body in stack}, {model.body(body.name).id: body.name for body in stack}
    for k in range(data.ncon):
        contact, force = data.contact[k], np.zeros(6)
        mujoco.mj_contactForce(model, data, k, force)
        lower = min(model.geom_bodyid[contact.geom], key=lambda body: data.xpos[body][2])
        if set(model.geom_bodyid[contact.geom]) <= set(names):
            loads[names[lower]] += float(abs(contact.frame[2]) * force[0]) / GRAVITY
    return loads


@pytest.mark.parametrize(
    ("boxes", "tolerance_kg"),
    [
        (tower(0.3), 0.1),
        (stair(0.06), 0.1),
        (bridge(2), 0.1),
        # On three boxes the shares are statically indeterminate: the middle one may carry more or less.
        (bridge(3), 4.0),
    ],
)  # fmt: skip
def test_what_boxes_carry_is_what_presses_on_them_in_physics(
    boxes: list[PlacedBox], tolerance_kg: float
) -> None:
    pressed, carried = contact_loads(boxes), carried_loads(boxes)
    assert sum(pressed.values()) == pytest.approx(sum(load for load, _ in carried.values()), rel=0.05)
    for name, (load, _) in carried.items():
        assert pressed[name] == pytest.approx(load, abs=tolerance_kg), name
