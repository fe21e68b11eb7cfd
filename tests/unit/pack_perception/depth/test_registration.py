"""Cameras that hang elsewhere than described are noticed by the container that they see."""

import mujoco
import numpy as np
import pytest

from pack_core.camera import PinholeCamera
from pack_core.packing.cell import packing_cell
from pack_core.packing.depth import points_of
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.rotations import Array, exp, multiply
from pack_perception.depth.registration import Registration, register
from pack_perception.perception_config import RegistrationConfig
from pack_sim.packing.depth_cameras import DepthCameraSystem

CELL = packing_cell()
CONFIG = RegistrationConfig()
CONTAINER = CELL.scene.container
MIDDLE = np.array([*CONTAINER.centre, 0.5 * CONTAINER.height])


def empty_cell() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The container, and the objects beside it."""
    model = build_model(CELL.scene, CELL, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.FREE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


PHYSICS = empty_cell()


def seen_by(mount_position: float, mount_deg: float, seed: int) -> tuple[list[Array], list[PinholeCamera]]:
    """Points by the described cameras, and the cameras as they truly hang."""
    noise = CELL.depth.noise.model_copy(update={"mount_position": mount_position, "mount_deg": mount_deg})
    system = DepthCameraSystem(CELL.depth.model_copy(update={"noise": noise}), np.random.default_rng(seed))
    images = system.capture(*PHYSICS, 0.0).images
    described = CELL.depth.cameras()
    return [points_of(*pair, 3) for pair in zip(described, images, strict=True)], system.cameras


def found_in(points: Array, described: PinholeCamera) -> Registration:
    found = register(points, described.X_WC.p, CONTAINER, CONFIG)
    assert found is not None
    return found


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_camera_is_found_where_it_truly_hangs(seed: int) -> None:
    seen, true = seen_by(0.002, 0.1, seed)
    for points, described, camera in zip(seen, CELL.depth.cameras(), true, strict=True):
        found = found_in(points, described)
        corrected = found.applied_to(described).X_WC
        # what counts is where it puts the container
        assert (corrected @ camera.X_WC.inverse()).apply(MIDDLE) == pytest.approx(MIDDLE, abs=0.0005)
        off = (described.X_WC @ camera.X_WC.inverse()).apply(MIDDLE) - MIDDLE
        assert found.is_within(CONFIG) == (np.linalg.norm(off) < CONFIG.shift)


@pytest.mark.parametrize("seed", [4, 5, 6])
def test_a_camera_that_was_knocked_is_noticed(seed: int) -> None:
    seen, true = seen_by(0.02, 0.7, seed)
    for points, described, camera in zip(seen, CELL.depth.cameras(), true, strict=True):
        off = (camera.X_WC @ described.X_WC.inverse()).apply(MIDDLE) - MIDDLE
        assert np.linalg.norm(off) > CONFIG.shift
        assert not found_in(points, described).is_within(CONFIG)


@pytest.mark.parametrize("camera", [0, 1])
def test_a_container_that_stands_elsewhere_is_noticed_however_far_that_is(camera: int) -> None:
    seen, _ = seen_by(0.0, 0.0, 0)
    for way in range(0, 360, 45):
        along = np.array([np.cos(np.deg2rad(way)), np.sin(np.deg2rad(way))])
        for far in (0.01, 0.03, 0.05, 0.08, 0.12):
            elsewhere = CONTAINER.model_copy(update={"centre": tuple(CONTAINER.centre + far * along)})
            found = register(seen[camera], CELL.depth.cameras()[camera].X_WC.p, elsewhere, CONFIG)
            assert found is not None
            assert not found.is_within(CONFIG), (way, far, found)


def test_what_is_seen_through_is_no_container() -> None:
    through = Registration(MIDDLE, np.zeros(3), np.zeros(3), 0.5)
    assert not through.is_within(CONFIG)
    assert "more than the container can tell" in through.in_words()


def test_its_correction_is_a_turn_about_the_containers_middle_and_a_shift() -> None:
    camera, turn = CELL.depth.cameras()[0], np.array([0.0, 0.0, 0.01])
    moved = Registration(MIDDLE, np.array([0.001, 0.0, 0.002]), turn).applied_to(camera).X_WC
    assert moved.q == pytest.approx(multiply(exp(turn), camera.X_WC.q))
    seen = camera.X_WC.inverse().apply(MIDDLE)
    assert moved.apply(seen) == pytest.approx(np.add(MIDDLE, [0.001, 0.0, 0.002]))


def test_who_sees_nothing_of_the_container_cannot_say() -> None:
    table = np.random.default_rng(0).uniform([-1.0, -1.0, 0.0], [0.2, 1.0, 0.0], (5000, 3))
    assert register(table, CELL.depth.cameras()[0].X_WC.p, CONTAINER, CONFIG) is None


def test_limits_of_another_camera_class_may_be_wider() -> None:
    wide = RegistrationConfig(shift=0.02, turn_deg=2.0)
    off = Registration(MIDDLE, np.array([0.01, 0.0, 0.0]), np.zeros(3))
    assert off.is_within(wide)
    assert not off.is_within(CONFIG)
    assert off.in_words() == "10 mm and 0.0 degrees"
