"""`python -m foreign_driver CELL`: the cell's arm behind a joint trajectory controller, in place of `sim`."""

from __future__ import annotations

import sys

from foreign_driver.driver_nodes import NODES
from pack_sim.ros.physics_node import run_sim_with_camera

if __name__ == "__main__":
    raise SystemExit(run_sim_with_camera(NODES[sys.argv[1]]))
