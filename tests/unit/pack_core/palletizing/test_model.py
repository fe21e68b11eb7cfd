"""The model of the palletizing cell."""

import mujoco
import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import LIMITS

A, B = BoxBody("a", (0.4, 0.3, 0.2), 8.0), BoxBody("b", (0.6, 0.4, 0.25), 12.0)


def test_one_more_box_leaves_the_first_coordinates_as_they_were() -> None:
    cell = palletizing_cell()
    one, two = build_model(cell, [A]), build_model(cell, [A, B])
    assert (two.nq - one.nq, two.nv - one.nv, two.neq - one.neq) == (7, 6, 1)
    for name in (*LIMITS.names, "a"):
        assert one.joint(name).qposadr[0] == two.joint(name).qposadr[0]
    assert one.equality("a").id == two.equality("a").id


@pytest.mark.parametrize("box", [A, B], ids=lambda box: box.name)
def test_a_box_has_the_mass_and_inertia_of_an_even_filling(box: BoxBody) -> None:
    body = build_model(palletizing_cell(), [box]).body(box.name)
    assert float(body.mass[0]) == pytest.approx(box.mass)
    np.testing.assert_allclose(np.sort(body.inertia), np.sort(box.inertia))


def test_nothing_that_is_only_drawn_weighs_or_touches() -> None:
    cell = palletizing_cell()
    plain, drawn = build_model(cell, [A]), build_model(cell, [A], visuals=True)
    assert float(drawn.body_mass.sum()) == pytest.approx(float(plain.body_mass.sum()))
    assert np.count_nonzero(drawn.geom_contype) == np.count_nonzero(plain.geom_contype)


def test_a_home_pose_touches_nothing() -> None:
    cell = palletizing_cell()
    model = build_model(cell)
    data = mujoco.MjData(model)
    data.qpos[:6] = cell.arm.home
    mujoco.mj_forward(model, data)
    assert data.ncon == 0


@pytest.mark.parametrize(
    ("name", "size", "mass"),
    [("", (0.1, 0.1, 0.1), 1.0), ("x", (0.1, -0.1, 0.1), 1.0), ("x", (0.1, 0.1, 0.1), float("nan"))],
)
def test_an_impossible_box_is_refused_by_name(name: str, size: tuple[float, ...], mass: float) -> None:
    with pytest.raises(PackError, match=f"box '{name}'"):
        BoxBody(name, size, mass)
