"""The watch over the held object names what the wrench shows while the arm swings freely."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingExitReason
from pack_core.packing.scene import Scene
from pack_core.states import SceneState
from pack_mpc.held_watch import HeldWatch, LoadFault, arm_chain
from pack_mpc.load_estimate import GRAVITY, LoadConfig
from pack_mpc.observation import PackingObservation

PERIOD = 0.048


def faults(scene: Scene, start: JointSample, config: LoadConfig, share: float) -> Iterator[LoadFault | None]:
    """What is told in each cycle of an arm that swings for 1.5 s with so many times the described mass."""
    watch = HeldWatch(arm_chain(packing_cell()), scene, config)
    described, before = scene.new_object.mass, None
    for time in np.arange(0.0, 1.5, PERIOD):
        w, sway = 6.0, np.array([0.1, 0.04, 0.0, 0.04, 0.0, 0.0, 0.0])
        sample = JointSample(time, start.q + sway * np.sin(w * time), w * sway * np.cos(w * time), start.tau)
        R, v = watch.motion(sample)
        a = np.zeros(3) if before is None else (v - before) / PERIOD
        before = v
        force = R.T @ (described * GRAVITY - share * described * (a + GRAVITY))
        yield watch.observe(PackingObservation(sample, SceneState(time, {}), force[None]))


def first(scene: Scene, start: JointSample, config: LoadConfig, share: float) -> LoadFault | None:
    return next((fault for fault in faults(scene, start, config, share) if fault is not None), None)


@pytest.mark.parametrize(
    ("share", "reason"),
    [(1.0, None), (0.0, PackingExitReason.DETACHED), (2.0, PackingExitReason.FAULT)],
)
def test_a_wrong_mass_is_named(
    scene: Scene, joints: JointSample, share: float, reason: PackingExitReason | None
) -> None:
    fault = first(scene, joints, LoadConfig(), share)
    assert (fault and fault.reason) is reason


def test_it_is_named_once(scene: Scene, joints: JointSample) -> None:
    assert sum(fault is not None for fault in faults(scene, joints, LoadConfig(), 0.0)) == 1


def test_nothing_is_named_where_nobody_can_be_sure_enough(scene: Scene, joints: JointSample) -> None:
    assert first(scene, joints, LoadConfig(certainty=1.0), 0.0) is None
