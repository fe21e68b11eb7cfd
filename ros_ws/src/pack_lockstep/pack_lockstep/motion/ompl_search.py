"""OMPL's RRT-Connect and path simplification (PyPI `ompl`) in place of the search of ways around.

It plans in the space of all joints, over the same check of joint positions; lines and timing are the shipped
planner's own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pack_core.errors import ConfigError
from pack_core.extras import install_command
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.detour import RESOLUTION, STEP

TIME_LIMIT = 1.0
"""For a way to be found [s]."""
SEED = 1
"""Of OMPL's generators, which are seeded once in a process: a plan depends on how many came before."""


class OmplSearch:
    """A `WaySearch` by OMPL.

    Coordinates are joint positions divided by velocity limits, so that distances are times [s].

    Args:
        arm: the arm that moves.
        is_clear: says whether joint positions `(T, n)` are clear enough.
    """

    def __init__(self, arm: MotionArm, is_clear: Callable[[Array], bool], _: np.random.Generator) -> None:
        self._arm, self._is_clear = arm, is_clear

    def way(self, q_start: Array, q_end: Array) -> list[Array] | None:
        """See `WaySearch`."""
        base, geometric = require_ompl()
        limits, n = self._arm.limits, self._arm.chain.n
        space, bounds = base.RealVectorStateSpace(n), base.RealVectorBounds(n)
        for i in range(n):
            bounds.setLow(i, float(limits.lower[i] / limits.velocity[i]))
            bounds.setHigh(i, float(limits.upper[i] / limits.velocity[i]))
        space.setBounds(bounds)
        setup = geometric.SimpleSetup(space)
        setup.setStateValidityChecker(lambda state: self._is_clear(self._joints(state)[None]))
        information = setup.getSpaceInformation()
        information.setStateValidityCheckingResolution(RESOLUTION / space.getMaximumExtent())
        setup.setStartAndGoalStates(self._state(space, q_start), self._state(space, q_end))
        planner = geometric.RRTConnect(information)
        planner.setRange(STEP)
        setup.setPlanner(planner)
        if not setup.solve(TIME_LIMIT) or not setup.haveExactSolutionPath():
            return None
        setup.simplifySolution()
        path = setup.getSolutionPath()
        way = [self._joints(path.getState(i)) for i in range(path.getStateCount())]
        return [q_start, *way[1:-1], q_end]

    def _joints(self, state: Any) -> Array:
        return np.array([state[i] for i in range(self._arm.chain.n)]) * self._arm.limits.velocity

    def _state(self, space: Any, q: Array) -> Any:
        state = space.allocState()
        for i, value in enumerate(q / self._arm.limits.velocity):
            state[i] = float(value)
        return state


_seeded: list[bool] = []


def require_ompl() -> tuple[Any, Any]:
    """OMPL's modules `base` and `geometric`, quiet and seeded.

    Raises:
        ConfigError: it is not installed.
    """
    try:
        from ompl import base, geometric, util
    except ImportError as error:
        raise ConfigError(
            f"the planner 'ompl' needs OMPL: {install_command('motion', '--no-deps')}"
        ) from error
    if not _seeded:
        util.setLogLevel(util.LogLevel.LOG_ERROR)
        util.RNG.setSeed(SEED)
        _seeded.append(True)
    return base, geometric
