"""What is described differs from what is, by as much as was asked for."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_sim.packing.mismatch import MismatchConfig, actual, believed, joint_friction

SCENE = packing_cell().scene
MISMATCH = MismatchConfig(
    friction=(0.75, 1.5), mass=0.25, size=0.002, container=0.003, joint_friction=(0.5, 1.0)
)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def items_of(scene: Scene) -> list:
    return [*scene.objects, scene.new_object]


def many(make, take) -> np.ndarray:
    return np.array([[take(item) for item in items_of(make(SCENE, MISMATCH, rng(n)))] for n in range(200)])


def test_without_mismatch_nodes_are_told_the_truth() -> None:
    none = MismatchConfig()
    assert believed(SCENE, none, rng()) == SCENE.description()
    true = actual(SCENE, none, rng())
    assert [item.mass for item in items_of(true)] == [item.mass for item in items_of(SCENE)]
    assert {item.friction for item in items_of(true)} == {SCENE.friction} == {true.friction}
    assert not joint_friction(none, 7, rng()).any()


def test_true_frictions_and_masses_fill_their_ranges() -> None:
    frictions = many(actual, lambda item: item.friction)
    assert frictions.min() == pytest.approx(0.3, abs=0.01)
    assert frictions.max() == pytest.approx(0.6, abs=0.01)
    shares = many(actual, lambda item: item.mass) / [item.mass for item in items_of(SCENE)]
    assert shares.min() == pytest.approx(0.75, abs=0.01)
    assert shares.max() == pytest.approx(1.25, abs=0.01)
    assert shares[:, -1].std() > 0.1


def test_the_true_geometry_is_the_generators() -> None:
    true = actual(SCENE, MISMATCH, rng())
    assert true.container == SCENE.container
    for item, given in zip(items_of(true), items_of(SCENE), strict=True):
        np.testing.assert_array_equal(item.half_extents, given.half_extents)


def test_described_sizes_and_container_are_off_within_their_bounds() -> None:
    nominal = np.array([item.half_extents for item in items_of(SCENE)])
    errors = 2 * (many(believed, lambda item: item.half_extents) - nominal)
    assert np.abs(errors).max() == pytest.approx(MISMATCH.size, rel=0.02)
    assert np.abs(errors).mean() == pytest.approx(MISMATCH.size / 2, rel=0.1)
    centres = np.array([believed(SCENE, MISMATCH, rng(n)).container.centre for n in range(200)])
    offsets = np.abs(centres - SCENE.container.centre)
    assert offsets.max() == pytest.approx(MISMATCH.container, rel=0.05)


def test_the_description_keeps_nominal_frictions_and_masses_and_has_no_poses() -> None:
    told = believed(SCENE, MISMATCH, rng())
    assert told.friction == SCENE.friction
    for item, given in zip(items_of(told), items_of(SCENE), strict=True):
        assert (item.mass, item.friction, item.pose) == (given.mass, None, None)
    assert Scene.from_yaml(told.to_yaml()) == told


def test_an_object_slides_on_the_base_with_its_own_friction() -> None:
    true = actual(SCENE, MISMATCH, rng())
    model = build_model(true, packing_cell(), timestep=0.002, arm=ArmRole.ABSENT, held=HeldRole.FREE)
    data = mujoco.MjData(model)
    for i, item in enumerate(items_of(true)):
        data.joint(item.name).qpos[:3] = [0.2 * i - 2.0, 0.0, item.half_extents[2] - 1e-4]
    mujoco.mj_forward(model, data)
    table = model.geom("table").id
    found = {
        model.geom(int(contact.geom[contact.geom != table][0])).name: contact.friction[0]
        for contact in data.contact
        if table in contact.geom and len(set(contact.geom)) == 2
    }
    for item in items_of(true):
        assert found[item.name] == pytest.approx(item.friction)


def test_the_same_seed_gives_the_same_mismatch() -> None:
    assert actual(SCENE, MISMATCH, rng(3)) == actual(SCENE, MISMATCH, rng(3))
    assert believed(SCENE, MISMATCH, rng(3)) == believed(SCENE, MISMATCH, rng(3))
    assert believed(SCENE, MISMATCH, rng(3)) != believed(SCENE, MISMATCH, rng(4))


def test_a_range_the_wrong_way_round_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"'friction' is \[1\.5, 0\.5\]; allowed: .*smaller one first"):
        validate_config(MismatchConfig, {"friction": [1.5, 0.5]}, "test")
