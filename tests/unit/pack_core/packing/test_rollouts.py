"""Rollouts in a pool of threads: what a goal made is given back after it."""

from __future__ import annotations

import threading

import mujoco
import numpy as np

from pack_core.packing.rollouts import SleepingRollouts

FALLING = """
<mujoco><worldbody><body><freejoint/><geom size="0.1" mass="1"/></body></worldbody></mujoco>
"""
THREADS = 3


def test_the_threads_end_when_nobody_holds_the_rollouts_any_more() -> None:
    model = mujoco.MjModel.from_xml_string(FALLING)
    start = np.concatenate([[0.0], model.qpos0, np.zeros(model.nv)])
    before = set(threading.enumerate())
    for _ in range(5):
        rollouts = SleepingRollouts(model, THREADS)
        states, _ = rollouts.run(np.tile(start, (4, 1)), np.zeros((4, 10, 0)))
        assert np.all(states[:, -1, 3] < 0.0), "what nothing carries falls"
    of_the_last = set(threading.enumerate()) - before
    assert of_the_last
    del rollouts
    for thread in of_the_last:
        thread.join(30.0)
    assert not [thread.name for thread in of_the_last if thread.is_alive()]
