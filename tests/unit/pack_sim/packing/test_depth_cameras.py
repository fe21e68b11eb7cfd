import mujoco
import numpy as np
import pytest

from pack_core.camera import PinholeCamera
from pack_core.packing.cell import packing_cell
from pack_core.packing.depth import DepthCameras, DepthNoise
from pack_sim.packing.camera_rays import CameraRays, RayImage
from pack_sim.packing.depth_cameras import DepthCameraSystem

CELL = packing_cell()
PERFECT = {
    "disparity": 0.0, "lateral": 0.0, "edge_loss": 0.0, "flying": 0.0, "grazing_deg": [89.0, 89.5],
    "surface_loss": 0.0, "loss": 0.0, "step": 0.0, "mount_position": 0.0, "mount_deg": 0.0,
}  # fmt: skip


def world(geom: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A world with one body, after a step of its kinematics."""
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{geom}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def cast(model: mujoco.MjModel, data: mujoco.MjData, camera: PinholeCamera) -> RayImage:
    """What a camera's pixels meet."""
    return CameraRays(camera).cast(model, data)


def system(seed: int = 0, **noise: object) -> DepthCameraSystem:
    """The cell's cameras with other errors."""
    changed = DepthNoise.model_validate({**CELL.depth.noise.model_dump(), **noise})
    described = DepthCameras.model_validate({**CELL.depth.model_dump(), "noise": changed.model_dump()})
    return DepthCameraSystem(described, np.random.default_rng(seed))


PLANE = world('<geom name="floor" type="plane" size="5 5 1"/>')


def test_without_errors_a_frame_is_what_the_rays_meet() -> None:
    cameras = system(**PERFECT)
    frame = cameras.capture(*PLANE, 0.0)
    for camera, image in zip(CELL.depth.cameras(), frame.images, strict=True):
        assert image == pytest.approx(cast(*PLANE, camera).depth)


def test_the_noise_of_a_plane_is_as_large_as_stated_and_half_of_it_stays() -> None:
    quiet = {**PERFECT, "disparity": CELL.depth.noise.disparity, "static": 0.5}
    cameras = system(**quiet)
    true = np.stack([cast(*PLANE, camera).depth for camera in cameras.cameras])
    one, two = (cameras.capture(*PLANE, t).images for t in (0.0, 0.1))
    sigma = CELL.depth.noise.axial(true)
    first, second = (one - true) / sigma, (two - true) / sigma
    assert np.std(first) == pytest.approx(1.0, abs=0.05)
    assert np.mean(first * second) == pytest.approx(0.5, abs=0.05)
    # neighbours are alike: exp(-1 / (4 correlation^2)) for noise behind a Gaussian of that width
    expected = np.exp(-0.25 / CELL.depth.noise.correlation**2)
    assert np.mean(first[..., 1:] * first[..., :-1]) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("last", [51.0, 50.0])
def test_grazing_surfaces_are_lost_and_steep_ones_are_not(last: float) -> None:
    cameras = system(**{**PERFECT, "grazing_deg": [50.0, last]})
    frame = cameras.capture(*PLANE, 0.0)
    for camera, image in zip(cameras.cameras, frame.images, strict=True):
        cosine = cast(*PLANE, camera).cosine
        assert not image[cosine < np.cos(np.deg2rad(51.0))].any()
        assert image[cosine > np.cos(np.deg2rad(50.0))].all()


def test_pixels_fly_at_edges_alone_between_both_surfaces() -> None:
    scene = world('<geom type="plane" size="5 5 1"/><geom type="box" size=".05 .05 .1" pos=".5 0 .1"/>')
    cameras = system(**{**PERFECT, "flying": 0.5})
    camera, image = cameras.cameras[0], cameras.capture(*scene, 0.0).images[0]
    true = cast(*scene, camera).depth
    rows, columns = np.nonzero(np.abs(image - true) > 1e-9)
    assert len(rows) > 50
    padded = np.pad(true, 1, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, (3, 3))[rows, columns].reshape(-1, 9)
    flying = image[rows, columns]
    assert np.all((around.min(axis=1) <= flying) & (flying <= around.max(axis=1)))
    assert np.all(np.ptp(around, axis=1) > CELL.depth.noise.edge)


def test_depths_are_whole_steps() -> None:
    images = system(**{**PERFECT, "step": 0.004}).capture(*PLANE, 0.0).images
    assert images == pytest.approx(0.004 * np.rint(images / 0.004))
    true = system(**PERFECT).capture(*PLANE, 0.0).images
    assert np.abs(images - true).max() == pytest.approx(0.002, rel=0.01)


def test_each_surface_loses_pixels_of_its_own_share() -> None:
    cameras = system(**{**PERFECT, "surface_loss": 0.5})
    lost = [np.mean(cameras.capture(*PLANE, t).images == 0.0) for t in (0.0, 0.1)]
    assert 0.0 < lost[0] < 0.5
    assert lost[1] == pytest.approx(lost[0], abs=0.01)


def test_the_same_seed_sees_the_same() -> None:
    one, same, other = (system(seed).capture(*PLANE, 0.0).images for seed in (3, 3, 4))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_frames_come_at_the_rate_and_after_the_latency() -> None:
    cameras, rate, latency = system(), CELL.depth.rate, CELL.depth.latency
    exposed = []
    for time in 0.001 * np.arange(301):
        cameras.update(*PLANE, time)
        for frame in cameras.due(time):
            assert time - frame.time == pytest.approx(latency, abs=0.0011)
            exposed.append(frame.time)
    assert np.diff(exposed) == pytest.approx(1.0 / rate, abs=0.0011)
    assert len(exposed) == 4
