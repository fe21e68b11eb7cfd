from __future__ import annotations

import pytest

from pack_motion.arm.arm import MotionArm, load_arm


@pytest.fixture(scope="session")
def arm() -> MotionArm:
    return load_arm("palletizing")


@pytest.fixture(scope="session")
def small_arm() -> MotionArm:
    return load_arm("blocks")
