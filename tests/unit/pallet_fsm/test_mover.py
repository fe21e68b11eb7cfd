"""When the machine takes a move for done."""

import numpy as np
import pytest

from pack_core.motion.moves import Path
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.rotations import POINTING_DOWN, Pose
from pallet_fsm.goals import Leg
from pallet_fsm.leg_runner import Mover
from pallet_fsm.palletizer_config import MoverConfig
from pallet_fsm.states import State, profile_of
from pallet_fsm.transitions import Event

PERIOD = 0.004
CONFIG = MoverConfig()
UP = np.array([0.0, 0.0, 1.0])


def approach(
    end: State, speed: float, duration: float = 1.0, config: MoverConfig = CONFIG
) -> tuple[float, Event | None]:
    """Time until a move to `end` counts as done, with a tool that comes down at `speed` [m/s], and how."""
    mover = Mover(profile_of("blended"), config)
    goal = Pose(np.array([1.0, 2.0, 0.5]), POINTING_DOWN)
    idle = MotionStatus(0.0, 0, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", goal)
    mover.begin([(Leg(Path(()), goal, end), frozenset())], None, (), idle, 0.0)
    for time in np.arange(PERIOD, duration, PERIOD):
        tool = Pose(goal.p + (0.001 - speed * time) * UP, goal.q)
        status = MotionStatus(time, 1, MotionState.REACHED, 0, "FINAL", 0.0, 0.0, 0.0, 0.0, 3, "", tool)
        if event := mover.follow(status, end):
            assert isinstance(event, Event)
            return time, event
    return duration, None


@pytest.mark.parametrize("end", [State.GRASP, State.DEPOSIT])
def test_the_gripper_waits_until_the_tool_is_slow(end: State) -> None:
    slow, fast = 0.9 * CONFIG.rest_speed, 1.1 * CONFIG.rest_speed
    assert approach(end, slow) == (pytest.approx(0.024), Event.REACHED)
    assert approach(end, fast, duration=0.4) == (0.4, None)


def test_the_gripper_does_not_wait_for_ever() -> None:
    time, event = approach(State.GRASP, 1.1 * CONFIG.rest_speed)
    assert event is Event.REACHED
    assert time == pytest.approx(CONFIG.rest_time + PERIOD, abs=1.5 * PERIOD)


def test_a_tool_at_its_target_is_not_stuck_however_long_the_gripper_may_wait() -> None:
    config = MoverConfig(rest_time=0.5, settling_time=0.2)
    time, event = approach(State.GRASP, 1.1 * config.rest_speed, config=config)
    assert event is Event.REACHED
    assert time == pytest.approx(config.rest_time + PERIOD, abs=1.5 * PERIOD)


def test_where_the_gripper_does_not_act_the_tool_may_still_move() -> None:
    assert approach(State.ABOVE_BOX, 0.05) == (pytest.approx(0.012), Event.REACHED)
