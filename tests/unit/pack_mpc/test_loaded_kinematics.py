"""A controller that is ready has loaded all that the first iteration of a goal needs of numba."""

import subprocess
import sys

WATCHED = """
import numpy as np

from pack_core.joints import JointSample
from pack_core.kinematics import screws
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.states import SceneState
from pack_mpc.held_watch import HeldWatch, arm_chain
from pack_mpc.load_estimate import LoadConfig
from pack_mpc.mpc_node import load_kinematics
from pack_mpc.observation import PackingObservation


def loaded():
    return {name: len(item.signatures) for name, item in vars(screws).items() if hasattr(item, "signatures")}


cell = packing_cell()
load_kinematics(cell)
before = loaded()
scene = load_scene(config_path("scenarios", "packing", "example.yaml"))
watch = HeldWatch(arm_chain(cell), scene, LoadConfig())
for time in (0.0, 0.05):
    sample = JointSample(time, np.array(cell.robot.home), np.zeros(7), np.zeros(7))
    watch.observe(PackingObservation(sample, SceneState(time, {}), np.zeros((1, 3))))
print(sum(before.values()), sorted(name for name, number in loaded().items() if number > before[name]))
"""


def test_the_watch_over_the_held_object_loads_nothing_more() -> None:
    """In a process of its own: here other tests may have loaded it already."""
    done = subprocess.run([sys.executable, "-c", WATCHED], capture_output=True, text=True, check=True)
    number, _, later = done.stdout.strip().partition(" ")
    assert int(number) > 0
    assert later == "[]"
