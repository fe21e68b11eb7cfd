"""Reads scene files and refuses those that describe an impossible scene."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from pack_core.bodies import penetrations, set_object_poses
from pack_core.config import load_config
from pack_core.errors import ConfigError, PackError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.fit import fitting_yaws
from pack_core.packing.free_space import base_height, is_inside, outlines
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene

TOLERANCE = 0.005
"""Objects may overlap each other, the walls or the base by this much, as measured poses do [m]."""


def load_scene(path: Path, cell: PackingCell | None = None) -> Scene:
    """Read a scene file with a pose for every object.

    Args:
        path: the file.
        cell: the cell that shall pack the scene; None: the cell as configured.

    Raises:
        ConfigError: a key, value or pose is missing or not allowed.
    """
    scene = load_config(Scene, path)
    _check(scene, cell or packing_cell(), str(path))
    return scene


def parse_scene(text: str, source: str, cell: PackingCell | None = None) -> Scene:
    """Read a scene file's text, as `load_scene` does; `source` names it in errors."""
    scene = Scene.from_yaml(text, source)
    _check(scene, cell or packing_cell(), source)
    return scene


def _check(scene: Scene, cell: PackingCell, source: str) -> None:
    try:
        scene.poses()
        _check_container(scene, cell.robot.arm.reach)
        _check_new_object(scene, cell)
        _check_inside(scene)
        _check_overlaps(scene, cell)
        _check_start(scene, cell)
    except PackError as error:
        raise ConfigError(f"{source}: {error}") from error


def _check_container(scene: Scene, reach: tuple[float, float]) -> None:
    """Refuse a container with a corner that the arm cannot reach, or with a wall too near to its base."""
    near, far = reach
    (x0, y0), (x1, y1) = scene.container.lower.tolist(), scene.container.upper.tolist()
    farthest = np.hypot(x1, max(abs(y0), abs(y1)))
    if x0 < near or farthest > far:
        raise ConfigError(
            f"key 'container' reaches from x {x0:.3f} to a corner {farthest:.3f} m from the robot's base; "
            f"allowed: from x {near} m on, at most {far} m off; change its centre or size"
        )


def _check_new_object(scene: Scene, cell: PackingCell) -> None:
    item, limit = scene.new_object, cell.robot.arm.payload - cell.pump.mass
    if item.pose is not None:
        raise ConfigError("key 'new_object.pose' is given; allowed: none, the new object hangs from the pump")
    if item.mass > limit:
        raise ConfigError(
            f"key 'new_object.mass' is {item.mass}; allowed: up to {limit:.1f} kg, the arm's payload"
        )
    try:
        fitting_yaws(item, scene.container, 0.0)
    except PackError as error:
        raise ConfigError(f"key 'new_object': {error}") from error


def _check_inside(scene: Scene) -> None:
    """Refuse an object that is not between the walls or that reaches below the base."""
    lower, upper = scene.container.lower, scene.container.upper
    for (name, X_WO), outline in zip(scene.poses().items(), outlines(scene), strict=True):
        bottom = base_height(scene.model_of(name), X_WO)
        if bottom < -TOLERANCE or not is_inside(outline, scene.container, TOLERANCE):
            x0, y0, x1, y1 = outline.bounds
            raise ConfigError(
                f"key 'objects.{name}.pose' is {X_WO.p.tolist()}: the object reaches from x {x0:.3f} "
                f"to {x1:.3f}, y {y0:.3f} to {y1:.3f}, down to z {bottom:.3f}; allowed: inside the "
                f"container, x {lower[0]:.3f} to {upper[0]:.3f}, y {lower[1]:.3f} to {upper[1]:.3f}, z from 0"
            )


def _check_overlaps(scene: Scene, cell: PackingCell) -> None:
    model = build_model(scene, cell, timestep=0.002, arm=ArmRole.ABSENT, held=HeldRole.ABSENT)
    data = mujoco.MjData(model)
    set_object_poses(model, data, scene.poses())
    for (a, b), depth in penetrations(model, data).items():
        if depth > TOLERANCE and {a, b} <= set(scene.names):
            raise ConfigError(
                f"key 'objects.{a}.pose' makes it overlap '{b}' by {1000 * depth:.1f} mm; allowed: up to "
                f"{1000 * TOLERANCE:.0f} mm, move one of the two"
            )


def _check_start(scene: Scene, cell: PackingCell) -> None:
    """Refuse a scene in which the held object touches something while the arm is at its home pose."""
    model = build_model(scene, cell, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.RIGID)
    data = mujoco.MjData(model)
    set_object_poses(model, data, scene.poses())
    for name, position in zip(cell.robot.arm.joints, cell.robot.home, strict=True):
        data.joint(name).qpos = position
    for pair in penetrations(model, data):
        if scene.new_object.name in pair:
            raise ConfigError(
                f"key 'new_object' makes {' and '.join(pair)} touch before the arm has moved; allowed: "
                "container, objects and new object low enough to leave a gap"
            )
