"""`python -m foreign_driver CELL`: the cell's arm behind a joint trajectory controller, in place of `sim`.

In packing the node `relay` is started beside it.
"""

from __future__ import annotations

import subprocess
import sys

from foreign_driver.driver_nodes import NODES
from pack_sim.ros.physics_node import run_sim_with_camera

END_TIME = 10.0
"""For which the relay may take to end [s]."""

if __name__ == "__main__":
    cell = sys.argv[1]
    relay = (
        subprocess.Popen([sys.executable, "-m", "pack_sim.packing.effort_relay_node"])
        if cell == "packing"
        else None
    )
    code = run_sim_with_camera(NODES[cell])
    if relay is not None:
        relay.terminate()
        relay.wait(END_TIME)
    raise SystemExit(code)
