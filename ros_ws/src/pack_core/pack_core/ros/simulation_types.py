"""Types with which a simulator is paused: those of simulation_interfaces where it is installed, else our own.

Both have the same fields (tests/architecture/test_simulation_interfaces.py). The distribution's package goes
first since the middleware matches types by name: so clients of the standard reach the cell.
"""

from __future__ import annotations

__all__ = ["GetSimulationState", "Result", "SetSimulationState", "SimulationState"]

try:
    from simulation_interfaces.msg import Result, SimulationState
    from simulation_interfaces.srv import GetSimulationState, SetSimulationState
except ImportError:  # there is no wheel of it
    from pack_interfaces.msg import SimulationResult as Result
    from pack_interfaces.msg import SimulationState
    from pack_interfaces.srv import GetSimulationState, SetSimulationState
