"""Visitors: their ways, and who is known."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.palletizing.visitors import Visitor, load_visitors
from pack_core.rotations import to_matrix

WALK = Visitor(
    name="person", radius=0.25, length=1.3, path=((2.0, 1.5, 0.9), (0.0, 1.5, 0.9), (2.0, 1.5, 0.9)),
    speed=1.0, acceleration=2.0, pause=1.0, start=3.0,
)  # fmt: skip


def test_velocity_is_the_rate_of_the_position_and_keeps_its_limits() -> None:
    times = np.arange(0.0, 12.0, 0.001)
    p = np.array([WALK.at(time).X_WV.p for time in times])
    v = np.array([WALK.at(time).v_WV_W for time in times])
    np.testing.assert_allclose(np.gradient(p, times, axis=0)[1:-1], v[1:-1], atol=0.003)
    assert np.linalg.norm(v, axis=1).max() == pytest.approx(1.0)
    assert np.abs(np.diff(v, axis=0)).max() <= 2.0 * 0.001 + 1e-9


def test_it_starts_late_waits_at_way_points_and_comes_back() -> None:
    assert WALK.duration == pytest.approx(2 * (2.0 / 1.0 + 1.0 / 2.0) + 1.0)
    np.testing.assert_allclose(WALK.at(2.9).X_WV.p, WALK.path[0])
    np.testing.assert_allclose(WALK.at(3.0 + 2.5 + 0.5).X_WV.p, WALK.path[1])
    assert not WALK.at(3.0 + 2.5 + 0.5).v_WV_W.any()
    np.testing.assert_allclose(WALK.at(3.0 + WALK.duration).X_WV.p, WALK.path[2])
    again = WALK.model_copy(update={"period": 10.0})
    np.testing.assert_allclose(again.at(14.2).X_WV.p, WALK.at(4.2).X_WV.p)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (1.0, 1.0, -1.0), (0.0, 0.0, -1.0)])
def test_the_capsule_lies_along_its_axis(axis: tuple[float, float, float]) -> None:
    q = WALK.model_copy(update={"axis": axis}).at(0.0).X_WV.q
    np.testing.assert_allclose(to_matrix(q)[:, 2], np.array(axis) / np.linalg.norm(axis), atol=1e-12)


def test_in_the_model_it_is_a_capsule_that_adds_no_coordinates() -> None:
    cell = palletizing_cell()
    model = build_model(cell, visitors=[WALK])
    assert (model.nq, model.nmocap) == (build_model(cell).nq, 1)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.geom("person").xpos, WALK.path[0])
    np.testing.assert_allclose(model.geom("person").size[:2], [0.25, 0.65])


@pytest.mark.parametrize("name", ["person", "robot", "forklift", "worker"])
def test_shipped_visitors_can_be_read(name: str) -> None:
    assert load_visitors(name)[0].duration > 1.0


def test_unknown_visitors_are_refused_with_those_that_there_are() -> None:
    assert load_visitors("") == ()
    with pytest.raises(ConfigError, match="'ghost'; there are: forklift, person, robot, worker"):
        load_visitors("ghost")
