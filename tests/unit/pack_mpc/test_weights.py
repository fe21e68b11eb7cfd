"""Weight sets: how they are scaled for an attempt."""

import pytest

from pack_mpc.weights import Stage, Weights, load_weights


def parts(weights: Weights) -> tuple[float, ...]:
    return (*weights.position, weights.force, weights.upright, weights.obstacle)


@pytest.mark.parametrize("part", ["running", "terminal"])
def test_force_and_horizontal_position_are_scaled_and_nothing_else(part: str) -> None:
    stage = load_weights("tuned").of(Stage.INSERT)
    x, y, z, force, *others = parts(getattr(stage, part))
    scaled = getattr(stage.scaled(force=0.25, sideways=4.0), part)
    assert parts(scaled) == (4.0 * x, 4.0 * y, z, 0.25 * force, *others)


def test_the_papers_weights_neither_give_way_nor_tighten() -> None:
    table_1 = load_weights("table_1")
    assert table_1.force_relief == table_1.precision == 1.0
