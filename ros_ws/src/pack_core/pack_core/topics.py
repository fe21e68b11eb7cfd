"""Names and rates of the topics that every cell has.

This module and its sisters (`pack_core.motion.topics` and `topics` of each cell) need no ROS: the wiring
tables, the simulators, the runs in lockstep and the evaluation of recordings all read the same names and
rates from them. A topic that only nodes use is named in its wiring table alone.
Rates are in hertz of simulated time.
"""

from __future__ import annotations

CLOCK, REAL_TIME_FACTOR, DIAGNOSTICS = "/clock", "/sim/real_time_factor", "/diagnostics"
SIMULATION_STATE, ARM_STATE = "/simulation_state", "/arm/state"

TICK_RATE = 250.0
"""Of the simulators' ticks, 4 ms of simulated time each, in which physics advances and data are sent."""
CLOCK_RATE = 50.0
"""With every fifth tick: all nodes hear it, and none needs to know the time more closely by it alone."""


def steps_between(rate: float, timestep: float) -> int:
    """How many steps of the physics lie between two messages of a topic, at least one.

    Args:
        rate: of the topic [Hz].
        timestep: of the physics [s].
    """
    return max(1, round(1.0 / (rate * timestep)))
