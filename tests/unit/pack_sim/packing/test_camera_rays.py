"""What a camera's rays meet, beside closed forms and beside MuJoCo's single rays."""

import mujoco
import numpy as np
import pytest

from pack_core.camera import PinholeCamera, looking_at
from pack_core.errors import PackError
from pack_core.rotations import POINTING_DOWN, Array, Pose, rotate
from pack_sim.packing.camera_rays import REACH, CameraRays, RayImage

FLOOR = '<geom name="floor" type="plane" size="5 5 1"/>'
SHAPES = {
    "sphere": '<geom type="sphere" size="0.06" {at}/>',
    "capsule": '<geom type="capsule" size="0.04 0.07" {at}/>',
    "cylinder": '<geom type="cylinder" size="0.05 0.06" {at}/>',
    "flat cylinder": '<geom type="cylinder" size="0.08 0.004" {at}/>',
    "box": '<geom type="box" size="0.03 0.05 0.08" {at}/>',
    "mesh": '<geom type="mesh" mesh="solid" {at}/>',
    "bounded plane": '<geom type="plane" size="0.2 0.1 1" {at}/>',
}
SOLID = " ".join(f"{c:.4f}" for c in np.random.default_rng(5).normal(0.0, 0.04, 60))
"""Corners of a convex body [m]."""


def world(*geoms: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A world with these geoms, after a step of its kinematics."""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="solid" vertex="{SOLID}"/><material name="clear" rgba="1 1 1 0"/></asset>'
        f"<worldbody>{''.join(geoms)}</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def somewhere(rng: np.random.Generator) -> str:
    """A place in view, turned any way."""
    p, q = rng.uniform([-0.15, -0.15, 0.0], [0.15, 0.15, 0.3]), rng.normal(size=4)
    return f'pos="{" ".join(map(str, p))}" quat="{" ".join(map(str, q))}"'


def single_rays(model: mujoco.MjModel, data: mujoco.MjData, camera: PinholeCamera) -> RayImage:
    """The same by `mj_ray`, ray by ray."""
    shape = camera.height, camera.width
    depth, cosine, geoms = np.zeros(shape), np.zeros(shape), np.full(shape, -1, dtype=np.int32)
    for v, u in np.ndindex(shape):
        ray = np.array([(u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f, 1.0])
        length = np.linalg.norm(ray)
        ray_W = rotate(camera.X_WC.q, ray / length)
        geom, normal = np.zeros(1, dtype=np.int32), np.zeros(3)
        distance = mujoco.mj_ray(model, data, camera.X_WC.p, ray_W, None, True, -1, geom, normal)
        if 0.0 <= distance <= REACH:
            depth[v, u], geoms[v, u], cosine[v, u] = distance / length, geom[0], -ray_W @ normal
    return RayImage(depth, cosine, geoms)


def small_camera(p: Array, target: Array) -> PinholeCamera:
    return PinholeCamera(looking_at(p, target), 60.0, (23.5, 17.5), 48, 36)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("seed", range(4))
def test_a_shape_is_met_as_by_single_rays(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    model, data = world(SHAPES[name].format(at=somewhere(rng)))
    camera = small_camera(rng.uniform([-0.2, -0.2, 0.5], [0.2, 0.2, 0.9]), np.array([0.0, 0.0, 0.15]))
    assert_alike(CameraRays(camera).cast(model, data), single_rays(model, data, camera))


@pytest.mark.parametrize("seed", range(4))
def test_what_is_nearer_hides_what_is_behind(seed: int) -> None:
    rng = np.random.default_rng([seed, 1])
    shapes = [SHAPES[name].format(at=somewhere(rng)) for name in SHAPES]
    model, data = world(FLOOR, *shapes)
    camera = small_camera(np.array([0.4, -0.3, 0.5]), np.array([0.0, 0.0, 0.1]))
    image = CameraRays(camera).cast(model, data)
    assert_alike(image, single_rays(model, data, camera))
    assert len(np.unique(image.geoms)) > 3


def assert_alike(found: RayImage, expected: RayImage) -> None:
    """Rays that pass an edge within rounding, one in a thousand at most, may meet either side of it."""
    is_same = found.geoms == expected.geoms
    assert np.mean(is_same) >= 0.999
    assert np.any(found.geoms >= 0)
    np.testing.assert_allclose(found.depth[is_same], expected.depth[is_same], atol=1e-9)
    is_edge = np.abs(found.cosine - expected.cosine) > 1e-6
    assert np.mean(is_edge[is_same]) <= 0.001


@pytest.mark.parametrize("transparent", ['rgba="1 1 1 0"', 'material="clear"'])
def test_rays_pass_through_what_is_not_drawn(transparent: str) -> None:
    pane = f'<geom type="box" size="0.2 0.2 0.01" pos="0 0 0.3" {transparent}/>'
    camera = small_camera(np.array([0.0, 0.0, 0.6]), np.array([0.0, 0.001, 0.0]))
    seen, through = (CameraRays(camera).cast(*world(FLOOR, *shapes)) for shapes in ((), (pane,)))
    np.testing.assert_array_equal(seen.depth, through.depth)
    assert_alike(through, single_rays(*world(FLOOR, pane), camera))


def test_nothing_beyond_the_reach_is_met() -> None:
    camera = small_camera(np.array([0.0, 0.0, REACH + 0.01]), np.array([0.0, 0.001, 0.0]))
    image = CameraRays(camera).cast(*world(FLOOR))
    assert not image.depth.any()
    assert np.all(image.geoms == -1)


def test_what_reaches_beside_the_camera_is_seen() -> None:
    """A rod from beside the camera into the image has no bounds in it."""
    rod = '<geom type="capsule" size="0.02" fromto="0.1 0 0.8 0 0 0.1"/>'
    camera = small_camera(np.array([0.0, 0.0, 0.6]), np.array([0.0, 0.001, 0.0]))
    model, data = world(FLOOR, rod)
    image = CameraRays(camera).cast(model, data)
    assert np.any(image.geoms == 1)
    assert_alike(image, single_rays(model, data, camera))


def test_a_shape_of_no_cell_is_named() -> None:
    model, data = world('<geom type="ellipsoid" size="0.1 0.05 0.05"/>')
    camera = small_camera(np.array([0.0, 0.0, 0.6]), np.array([0.0, 0.001, 0.0]))
    with pytest.raises(
        PackError, match="cameras do not see geom 0, a mjGEOM_ELLIPSOID; known: mjGEOM_PLANE, "
    ):
        CameraRays(camera).cast(model, data)


def test_an_oblique_plane_has_the_depths_of_its_equation() -> None:
    camera = PinholeCamera(looking_at([0.9, 0.4, 0.6], [0.5, 0.0, 0.0]), 300.0, (39.5, 29.5), 80, 60)
    image = CameraRays(camera).cast(*world(FLOOR))
    v, u = np.indices(image.depth.shape)
    # where the pixel's ray meets z = 0, and how far that is along the axis
    met = camera.at_height(np.stack([u, v], axis=-1), 0.0)
    assert image.depth == pytest.approx(camera.X_WC.inverse().apply(met)[..., 2])
    ray = (met - camera.X_WC.p) / np.linalg.norm(met - camera.X_WC.p, axis=-1, keepdims=True)
    assert image.cosine == pytest.approx(-ray[..., 2])


def test_a_sphere_has_the_depths_of_its_equation() -> None:
    r, z = 0.1, 0.6
    camera = PinholeCamera(Pose(np.array([0.0, 0.0, z]), POINTING_DOWN), 200.0, (39.5, 29.5), 80, 60)
    image = CameraRays(camera).cast(*world(f'<geom type="sphere" size="{r}"/>'))
    v, u = np.indices(image.depth.shape)
    x, y = (u - 39.5) / 200.0, (v - 29.5) / 200.0
    # (x d)^2 + (y d)^2 + (z - d)^2 = r^2, the nearer root
    a = 1.0 + x**2 + y**2
    discriminant = z**2 - a * (z**2 - r**2)
    expected = np.where(discriminant > 0.0, (z - np.sqrt(np.maximum(discriminant, 0.0))) / a, 0.0)
    assert image.depth == pytest.approx(expected)
