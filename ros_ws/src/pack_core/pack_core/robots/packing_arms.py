"""The arms that a packing cell can name as its `robot.model`: a further one is one more entry here."""

from __future__ import annotations

from collections.abc import Sequence

from pack_core.errors import MessageError
from pack_core.robots.iiwa14 import IIWA14
from pack_core.robots.panda import PANDA
from pack_core.robots.seven_axis_arm import SevenAxisArm

PACKING_ARMS: dict[str, SevenAxisArm] = {arm.name: arm for arm in (PANDA, IIWA14)}
"""By the name that configuration files give."""


def arm_of(joints: Sequence[str]) -> SevenAxisArm:
    """The arm whose joints have these names.

    Raises:
        MessageError: no arm has them.
    """
    for arm in PACKING_ARMS.values():
        if arm.joints == tuple(joints):
            return arm
    raise MessageError(f"joints {list(joints)} are of no known arm; known: {', '.join(PACKING_ARMS)}")
