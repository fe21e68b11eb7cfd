"""Random scenes: the cell's objects, or some of a set, dropped into the container and shaken together.

Objects are dropped upright where there is room, with random yaws. They are then shaken by a gravity that
keeps changing its direction, while friction is low. A scene is kept if everything stands upright on the base,
at rest. A `blocked` scene has no place where the new object would stand without contact.
"""

from __future__ import annotations

import itertools

import mujoco
import numpy as np
import shapely

from pack_core.bodies import body_pose, set_object_poses
from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import base_height, footprint, free_places, is_blocked, is_inside
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.object_set import draw_new_object, draw_scene
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, from_yaw, rotate

MAX_ATTEMPTS = 2000
"""Scenes that are drawn for a seed before it is given up: blocked ones may be rare."""
MAX_ATTEMPTS_DRAWN = 500
"""Scenes that are drawn for a new object before another takes its place, where objects are drawn, too."""
MAX_ROUNDS = 5
"""New objects that are drawn for a seed, one after the other, if none is blocked in `MAX_ATTEMPTS_DRAWN`."""
TIMESTEP = 0.004
"""Step of the physics in which objects are shaken [s]; only where they come to rest counts."""
DROP_HEIGHT = 0.01
"""Height over the base from which objects are dropped [m]."""
SMALLEST_GAP = 1e-6
"""No object is dropped if less area than this is free for its centre [m^2]."""
MAX_TILT = np.deg2rad(20.0)
"""Largest angle between the shaking gravity and the vertical [rad]."""
TILT_PERIOD = 0.12
"""Time after which the shaking gravity changes its direction [s]."""
SHAKES = 6
"""Number of directions that the shaking gravity takes."""
SETTLE_TIME = 0.8
"""Time for objects to come to rest under vertical gravity [s]."""
SHAKING_FRICTION = 0.12
"""While objects are shaken, instead of the scene's, so that they slide together instead of sticking."""
UPRIGHT = np.cos(np.deg2rad(5.0))
"""Cosine of the largest tilt of an object that counts as upright."""
CLEARANCE = 0.002
"""An object may overlap a wall by this much, or be this far off the base [m]."""
REST_SPEED = 0.005
"""An object slower than this is at rest [m/s]; the bound of its angular velocity is 10 times it [rad/s]."""


def generate_scene(seed: int, cell: PackingCell, *, blocked: bool = True) -> Scene:
    """A random scene of the cell; the same seed gives the same scene, bit for bit.

    Args:
        seed: number of the scene.
        cell: the cell with container and objects.
        blocked: keep only scenes without a collision-free placement of the new object.

    Raises:
        PackError: no such scene was found; the objects are too few, or too many, for the container.
    """
    description = cell.scene.description()
    model = _slippery_model(description, cell)
    rounds, attempts = (1, MAX_ATTEMPTS) if cell.drawn is None else (MAX_ROUNDS, MAX_ATTEMPTS_DRAWN)
    for k, attempt in itertools.product(range(rounds), range(attempts)):
        # numpy gives [seed, attempt, 0] the stream of [seed, attempt]
        rng = np.random.default_rng([seed, attempt, k])
        if cell.drawn is not None:
            # the new object stays for a round, or objects that are rarely blocked would be rare
            new = draw_new_object(cell.drawn, cell, np.random.default_rng([seed, attempts, k]))
            description = draw_scene(cell.drawn, cell, new, rng)
            model = _slippery_model(description, cell)
        dropped = _drop(description, rng)
        if dropped is None:
            continue
        scene = _shake(description, model, dropped, rng)
        if scene is not None and (not blocked or is_blocked(scene)):
            return scene
    raise PackError(
        f"seed {seed}: no {'blocked ' * blocked}scene in {rounds * attempts} attempts; change the "
        "container or the objects under `scene` in config/cells/packing.yaml"
    )


def _slippery_model(scene: Scene, cell: PackingCell) -> mujoco.MjModel:
    slippery = scene.model_copy(update={"friction": SHAKING_FRICTION})
    return build_model(slippery, cell, timestep=TIMESTEP, arm=ArmRole.ABSENT, held=HeldRole.ABSENT)


def _drop(scene: Scene, rng: np.random.Generator) -> dict[str, Pose] | None:
    """Upright poses over the base that overlap neither each other nor a wall; None if there is no room."""
    poses: dict[str, Pose] = {}
    taken: list[shapely.Polygon] = []
    for i in rng.permutation(len(scene.objects)):
        item = scene.objects[i]
        yaw = rng.uniform(-np.pi, np.pi)
        free = free_places(item, yaw, scene.container, taken)
        if free.area < SMALLEST_GAP:
            return None
        p_WO = np.array([*_point_within(free, rng), item.half_extents[2] + DROP_HEIGHT])
        poses[item.name] = Pose(p_WO, from_yaw(yaw))
        taken.append(footprint(item, poses[item.name]))
    return poses


def _point_within(area: shapely.Geometry, rng: np.random.Generator) -> Array:
    """A uniformly random point `(2,)` of an area."""
    lower, upper = np.array(area.bounds).reshape(2, 2)
    while True:
        points = rng.uniform(lower, upper, (256, 2))
        if np.any(inside := shapely.contains_xy(area, points)):
            return np.asarray(points[inside][0])


def _shake(
    scene: Scene, model: mujoco.MjModel, poses: dict[str, Pose], rng: np.random.Generator
) -> Scene | None:
    """The scene after shaking and settling; None if an object moves, leans or is not inside."""
    data = mujoco.MjData(model)
    set_object_poses(model, data, poses)
    for _ in range(SHAKES):
        model.opt.gravity = _tilted_gravity(rng)
        mujoco.mj_step(model, data, round(TILT_PERIOD / TIMESTEP))
    model.opt.gravity = (0.0, 0.0, -9.81)
    mujoco.mj_step(model, data, round(SETTLE_TIME / TIMESTEP))
    mujoco.mj_forward(model, data)
    settled = {name: scene.model_of(name).standing(body_pose(data, name)) for name in scene.names}
    at_rest = np.all(np.abs(data.qvel.reshape(-1, 6)) < REST_SPEED * np.array([1, 1, 1, 10, 10, 10]))
    return scene.with_poses(settled) if at_rest and _is_orderly(scene, settled) else None


def _tilted_gravity(rng: np.random.Generator) -> Array:
    tilt, heading = rng.uniform(0.0, MAX_TILT), rng.uniform(-np.pi, np.pi)
    sideways = np.sin(tilt) * np.array([np.cos(heading), np.sin(heading)])
    return 9.81 * np.array([*sideways, -np.cos(tilt)])


def _is_orderly(scene: Scene, poses: dict[str, Pose]) -> bool:
    """Every object stands upright within 5 degrees, on the base and between the walls."""
    return all(
        rotate(X_WO.q, np.array([0.0, 0.0, 1.0]))[2] > UPRIGHT
        and abs(base_height(scene.model_of(name), X_WO)) < CLEARANCE
        and is_inside(footprint(scene.model_of(name), X_WO), scene.container, CLEARANCE)
        for name, X_WO in poses.items()
    )
