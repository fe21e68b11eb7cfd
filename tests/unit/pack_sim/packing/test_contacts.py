"""The force of a contact grows from nothing, and contacts are firm nevertheless."""

import mujoco
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_sim.packing.scene_physics import soften_contacts

BALL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast" cone="pyramidal" solver="Newton"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.05"><freejoint/><geom type="sphere" size="0.05" mass="0.5"/></body>
  </worldbody>
</mujoco>
"""
WEIGHT = 0.5 * 9.81


def load(depth: float, width: float) -> float:
    """Force of the plane on a ball at rest that is `depth` [m] in it, as a share of its weight."""
    model = mujoco.MjModel.from_xml_string(BALL)
    soften_contacts(model, width)
    data = mujoco.MjData(model)
    data.qpos[2] -= depth
    mujoco.mj_forward(model, data)
    return float(data.qacc[2] / 9.81 + 1.0)


def test_by_default_first_touch_carries_nearly_all_the_weight() -> None:
    assert load(1e-6, 0.0) > 0.85


def test_softened_it_carries_next_to_nothing_at_first_touch() -> None:
    assert load(1e-6, 0.0005) < 0.01


@given(depth=st.floats(0.0, 0.0006), further=st.floats(1e-6, 1e-5))
def test_the_force_rises_steadily_with_the_penetration(depth: float, further: float) -> None:
    lower, upper = load(depth, 0.0005), load(depth + further, 0.0005)
    assert lower <= upper + 1e-9
    # ten micrometres never make a tenth of the object's weight in newtons
    assert upper - lower < 0.15


def sinking(width: float) -> float:
    """How deep 10 N and its weight press the ball in [m]."""
    model = mujoco.MjModel.from_xml_string(BALL)
    soften_contacts(model, width)
    data = mujoco.MjData(model)
    data.xfrc_applied[1, 2] = -10.0
    mujoco.mj_step(model, data, 1000)
    assert np.abs(data.qvel).max() < 1e-4
    return float(0.05 - data.qpos[2])


def test_under_load_it_is_no_softer_than_by_default() -> None:
    assert 0.0005 < sinking(0.0005) < sinking(0.0)
