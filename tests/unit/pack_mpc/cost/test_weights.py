"""Weight sets: what their files say, and what holds at a moment of an attempt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_mpc.cost.residuals import RESIDUALS
from pack_mpc.cost.weights import StageWeights, WeightFactors, load_weights
from pack_mpc.target import Stage

NAMES = [term.name for term in RESIDUALS]


def stage_weights(**running: object) -> StageWeights:
    return validate_config(StageWeights, {"running": running, "terminal": {}}, "weights.yaml")


def test_table_1_is_the_papers() -> None:
    insert = load_weights("table_1").insert
    assert insert.running["position"] == (1, 1, 1)
    assert insert.terminal["position"] == (100, 100, 200)
    assert insert.running["joint_velocity"] == (0.15, 0.02, 0.15, 0.02, 0.02, 0.02, 0.02)
    assert insert.running["obstacle"] == insert.terminal["obstacle"] == 1


@pytest.mark.parametrize("stage", [Stage.PRE_PACK, Stage.INSERT, Stage.FINE_TUNE])
def test_table_1_as_an_integral_has_the_running_weights_times_the_time_step(stage: Stage) -> None:
    printed, integral = (load_weights(name).of(stage) for name in ("table_1", "table_1_integral"))
    assert integral.terminal == printed.terminal
    for name, weight in printed.running.items():
        np.testing.assert_allclose(integral.running[name], 0.006 * np.array(weight), rtol=1e-12)


def test_the_papers_weights_neither_give_way_nor_tighten() -> None:
    table_1 = load_weights("table_1")
    assert table_1.force_relief == table_1.precision == 1.0


def test_a_residual_that_a_file_leaves_out_has_the_default_weight_of_its_class() -> None:
    weights = stage_weights(yaw=0.5).running
    assert weights == {term.name: term.default_weight for term in RESIDUALS} | {"yaw": 0.5}


def test_an_unknown_residual_is_refused_with_those_that_exist() -> None:
    with pytest.raises(ConfigError, match=rf"running\.yav.*'yav'; allowed: {', '.join(NAMES)}"):
        stage_weights(yav=0.5)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"position": [1, 2]}, "one number, or 3 numbers for 'position'; 2 were given"),
        ({"obstacle": [1, 2]}, "one number for 'obstacle'; 2 were given"),
        ({"upright": -1}, "greater than or equal to 0"),
    ],
)
def test_a_weight_is_one_number_or_one_a_row_and_never_negative(weights: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        stage_weights(**weights)


@given(st.floats(0.0, 10.0), st.floats(0.1, 10.0), st.sampled_from(["running", "terminal"]))
def test_the_weight_of_obstacles_decays_by_eq_3(t: float, Z: float, part: str) -> None:
    weights = load_weights("table_1").model_copy(update={"obstacle_decay": Z})
    w_0 = getattr(weights.insert, part)["obstacle"]
    w_t = getattr(weights.in_force(Stage.INSERT, t), part)["obstacle"]
    assert w_t == pytest.approx(max(0.0, w_0 - t * w_0 / Z))


def test_nothing_but_the_weight_of_obstacles_decays() -> None:
    weights = load_weights("table_1")
    for t in (0.0, 1.0, 99.0):
        assert weights.in_force(Stage.INSERT, t).running | {"obstacle": 1} == weights.insert.running


@pytest.mark.parametrize("part", ["running", "terminal"])
def test_force_and_horizontal_position_are_scaled_and_nothing_else(part: str) -> None:
    tuned = load_weights("tuned")
    before = getattr(tuned.of(Stage.INSERT), part)
    after = getattr(tuned.in_force(Stage.INSERT, 0.0, reliefs=1.5, is_rehearsed=True), part)
    assert after["force"] == pytest.approx(before["force"] * tuned.force_relief**1.5)
    np.testing.assert_allclose(after["position"], np.multiply(before["position"], [4, 4, 1]))
    assert {name for name in NAMES if after[name] != before[name]} == {"force", "position"}


@pytest.mark.parametrize("part", ["running", "terminal"])
def test_a_factor_counts_in_every_stage_and_for_its_residual_alone(part: str) -> None:
    tuned = load_weights("tuned")
    changed = tuned.times(WeightFactors(upright=0.5, position=0.0))
    for stage in Stage:
        before, after = (getattr(weights.of(stage), part) for weights in (tuned, changed))
        assert after["upright"] == 0.5 * before["upright"]
        assert not np.any(after["position"])
        assert {name for name in NAMES if after[name] != before[name]} == {"upright", "position"}


def test_every_residual_has_a_factor_and_without_any_the_weights_are_those_of_the_file() -> None:
    assert set(WeightFactors.model_fields) == set(NAMES)
    assert load_weights("tuned").times(WeightFactors()) == load_weights("tuned")
