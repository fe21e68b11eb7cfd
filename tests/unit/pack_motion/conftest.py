from __future__ import annotations

import pytest

from pack_motion.arm.arm import Arm
from pack_motion.arm.arms import load_arm


@pytest.fixture(scope="session")
def arm() -> Arm:
    return load_arm("palletizing")


@pytest.fixture(scope="session")
def small_arm() -> Arm:
    return load_arm("blocks")
