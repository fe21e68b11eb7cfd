"""The norms of Eq. 2: closed forms, derivatives of their roots, and the iLQR expansion with them."""

import numpy as np
import pytest
from pydantic import TypeAdapter

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.norms import L2, AnyNorm, Cosh, Linear, Norm, Quadratic, SmoothAbs
from pack_mpc.cost.weights import WeightSet, load_weights
from pack_mpc.plant import Linearization
from pack_mpc.target import PackingTarget, Stage

TARGET = PackingTarget(np.array([0.48, 0.02, 0.09]), 0.3, collisions=("tea_box", "soup_can"))
R = np.array([[0.3, -1.2, 2.0], [1e-4, -1e-3, 0.5], [-4.0, 0.0, 3.0]])
NORMS = {
    "quadratic": (Quadratic(), lambda r: (r**2).sum(-1)),
    "linear": (Linear(norm="linear"), lambda r: r.sum(-1)),
    "smooth_abs": (SmoothAbs(norm="smooth_abs", p=0.1), lambda r: (np.sqrt(r**2 + 0.01) - 0.1).sum(-1)),
    "l2": (L2(norm="l2", p=0.1), lambda r: np.sqrt((r**2).sum(-1) + 0.01) - 0.1),
    "cosh": (Cosh(norm="cosh", p=2.0), lambda r: (4.0 * (np.cosh(r / 2.0) - 1.0)).sum(-1)),
}
NAMED = pytest.mark.parametrize("name", NORMS)


def values_for(name: str) -> np.ndarray:
    return np.abs(R) if name == "linear" else R


@NAMED
def test_the_square_of_the_root_is_the_norm(name: str) -> None:
    norm, closed_form = NORMS[name]
    r = values_for(name)
    np.testing.assert_allclose((norm.root(r) ** 2).sum(-1), closed_form(r), atol=1e-8)


@NAMED
def test_the_roots_derivatives_agree_with_finite_differences(name: str) -> None:
    norm, _ = NORMS[name]
    r, h = values_for(name) + (0.01 if name == "linear" else 0.0), 1e-7
    jacobian = np.random.default_rng(0).normal(size=(3, 3, 2))
    expected = np.stack(
        [
            (norm.root(r + h * column) - norm.root(r - h * column)) / (2.0 * h)
            for column in np.moveaxis(jacobian, -1, 0)
        ],
        axis=-1,
    )
    np.testing.assert_allclose(norm.chain(r, jacobian), expected, atol=1e-5)


@pytest.mark.parametrize("name", ["smooth_abs", "l2"])
def test_far_out_they_grow_with_the_length_and_near_zero_with_its_square(name: str) -> None:
    norm: Norm = NORMS[name][0]
    costs = (norm.root(np.array([[1e-3], [2e-3], [50.0], [100.0]])) ** 2).sum(-1)
    assert costs[1] / costs[0] == pytest.approx(4.0, rel=1e-3)
    assert costs[3] / costs[2] == pytest.approx(2.0, rel=1e-2)


def test_every_norm_is_tried_here() -> None:
    schema = TypeAdapter(AnyNorm).json_schema()
    assert set(schema["discriminator"]["mapping"]) == set(NORMS)


def with_norms(**norms: object) -> WeightSet:
    changes = {
        name: {"norm": norm, "p": 0.2} if norm != "linear" else {"norm": norm} for name, norm in norms.items()
    }
    given = load_weights("table_1").model_dump(mode="json") | {"norms": changes}
    return validate_config(WeightSet, given, "weights.yaml")


MIXED = {
    "position": "l2",
    "force": "smooth_abs",
    "joint_limit": "linear",
    "obstacle": "linear",
    "yaw": "cosh",
}


def test_the_cost_weighs_the_norms(plant, joints, state) -> None:
    rng, T = np.random.default_rng(0), 4
    xs = plant.state(joints, state) + rng.normal(0.0, 0.02, (2, T + 1, plant.nx))
    ys, us = rng.normal(0.0, 0.3, (2, T + 1, plant.model.nsensordata)), rng.normal(0.0, 5.0, (2, T, 7))
    squared, mixed = load_weights("table_1"), with_norms(force="smooth_abs")
    insert = squared.of(Stage.INSERT)
    costs = [
        PackingCost(Residuals(plant, w, TARGET), insert, w.torque).value(xs, ys, us) for w in (squared, mixed)
    ]
    force = plant.sensor("tip_force")
    r = -ys[..., force] + np.array([0.0, 0.0, 9.81 * plant.scene.new_object.mass])
    changed = (np.sqrt(r**2 + 0.04) - 0.2 - r**2).sum(axis=(1, 2))
    np.testing.assert_allclose(costs[1] - costs[0], changed, rtol=1e-6)


def test_ilqrs_gradient_is_that_of_the_cost_under_any_norms(plant, joints, state) -> None:
    weights, rng, T, h = with_norms(**MIXED), np.random.default_rng(1), 2, 1e-6
    columns, ny = plant.columns(["tea_box", "soup_can"]), plant.model.nsensordata
    n = len(columns)
    xs = plant.state(joints, state) + rng.normal(0.0, 0.02, (T + 1, plant.nx))
    ys, us = rng.normal(0.0, 0.3, (T + 1, ny)), rng.normal(0.0, 5.0, (T, 7))
    C = rng.normal(0.0, 0.5, (T + 1, ny, n))
    lin = Linearization(np.zeros((T, n, n)), np.zeros((T, n, 7)), C, np.zeros((T, ny, 7)))
    cost = PackingCost(Residuals(plant, weights, TARGET), weights.of(Stage.INSERT), weights.torque)
    gradient = cost.expand(xs, ys, us, lin, columns).lx
    for t in range(T + 1):
        for j, column in enumerate(columns):
            ends = []
            for sign in (-1.0, 1.0):
                x, y = xs.copy(), ys.copy()
                x[t, column] += sign * h
                y[t] += sign * h * C[t, :, j]
                ends.append(cost.value(x[None], y[None], us[None])[0])
            assert gradient[t, j] == pytest.approx((ends[1] - ends[0]) / (2.0 * h), abs=2e-3, rel=1e-4)


@pytest.mark.parametrize(
    ("norms", "message"),
    [
        ({"position": {"norm": "cubic"}}, "cubic"),
        ({"pos": {"norm": "quadratic"}}, "'pos'; allowed: position"),
        (
            {"position": {"norm": "linear"}},
            "linear for joint_limit, obstacle only; 'position' can be negative",
        ),
        ({"position": {"norm": "l2", "p": 0.0}}, "greater than 0"),
    ],
)
def test_a_norm_that_does_not_exist_or_fit_is_refused(norms: dict, message: str) -> None:
    given = load_weights("table_1").model_dump(mode="json") | {"norms": norms}
    with pytest.raises(ConfigError, match=message):
        validate_config(WeightSet, given, "weights.yaml")
