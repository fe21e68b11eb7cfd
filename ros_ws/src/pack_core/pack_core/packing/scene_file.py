"""Reads scene files and refuses what cannot be: overlaps, objects in the air or the arm, too large ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from pack_core.bodies import penetrations, set_object_poses
from pack_core.errors import ConfigError, PackError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.free_space import base_height, fitting_yaws, is_inside, outlines
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.text.reader import read_text

TOLERANCE = 0.005
"""Objects may overlap each other, the walls or the base by this much, as measured poses do [m]."""
LARGEST_GAP = 0.01
"""Between an object and what carries it: more than a motion capture system is wrong by [m]."""
LEAST_UPWARD = 0.1
"""Vertical part of a contact's normal from which the contact carries."""
HAND_OVER_REACH = 0.1
"""Farthest that a scene may have an object from where the cell hands objects over [m]."""
WORLD = "world"


def load_scene(path: Path, cell: PackingCell | None = None) -> Scene:
    """Read a scene file with a pose for every object.

    Args:
        path: the file.
        cell: the cell that shall pack the scene; None: the cell as configured.

    Raises:
        ConfigError: a key, value or pose is missing or not allowed.
    """
    return parse_scene(read_text(path), str(path), cell, path.parent)


def scene_text(path: Path) -> str:
    """A scene file's text as it can be sent: with the corners of meshes in the place of their files."""
    return Scene.from_yaml(read_text(path), str(path), path.parent).to_yaml()


def parse_scene(text: str, source: str, cell: PackingCell | None = None, folder: Path | None = None) -> Scene:
    """Read a scene file's text, as `load_scene` does.

    Args:
        text: the text.
        source: names it in errors.
        cell: the cell that shall pack the scene; None: the cell as configured.
        folder: where the mesh files are that the text names; None: it may name none.
    """
    scene = Scene.from_yaml(text, source, folder)
    check_scene(scene, cell or packing_cell(), source)
    return scene


def check_scene(scene: Scene, cell: PackingCell, source: str) -> None:
    """Refuse a scene that the cell cannot pack, or that cannot stand as it is described.

    Args:
        scene: the scene, with a pose for every object.
        cell: the cell that shall pack it.
        source: names the scene in errors.

    Raises:
        ConfigError: with the key, what was given, and what is allowed.
    """
    try:
        scene.poses()
        _check_container(scene, cell.robot.arm.reach)
        _check_new_object(scene, cell)
        _check_inside(scene)
        _check_contacts(scene, cell)
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
        place = cell.hand_over.centre
        if np.linalg.norm(np.subtract(item.pose.position[:2], place)) > HAND_OVER_REACH:
            raise ConfigError(
                f"key 'new_object.pose' is {list(item.pose.position)}; allowed: none, it hangs from the "
                f"pump, or at most {HAND_OVER_REACH} m from where objects are handed over, "
                f"x {place[0]}, y {place[1]}"
            )
    if item.mass > limit:
        raise ConfigError(
            f"key 'new_object.mass' is {item.mass}; allowed: up to {limit:.1f} kg, the arm's payload"
        )
    if scene.is_handed_over:
        return  # whether it fits is found out when it is its turn
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
        if bottom > scene.container.height:
            raise ConfigError(
                f"key 'objects.{name}.pose' is {X_WO.p.tolist()}: the object begins {bottom:.3f} m up, above "
                f"the rim; allowed: below {scene.container.height:.3f} m"
            )


def _check_contacts(scene: Scene, cell: PackingCell) -> None:
    """Refuse objects that overlap, and those that nothing carries."""
    model = build_model(scene, cell, timestep=0.002, arm=ArmRole.ABSENT, held=HeldRole.ABSENT)
    data = mujoco.MjData(model)
    set_object_poses(model, data, scene.poses())
    for (a, b), depth in penetrations(model, data).items():
        if depth > TOLERANCE and {a, b} <= set(scene.names):
            raise ConfigError(
                f"key 'objects.{a}.pose' makes it overlap '{b}' by {1000 * depth:.1f} mm; allowed: up to "
                f"{1000 * TOLERANCE:.0f} mm, move one of the two"
            )
    for name in floating(model, data, scene.names):
        bottom = base_height(scene.model_of(name), scene.poses()[name])
        raise ConfigError(
            f"key 'objects.{name}.pose' leaves it in the air, {1000 * bottom:.0f} mm over the base; "
            f"allowed: at most {1000 * LARGEST_GAP:.0f} mm over the base or over what carries it"
        )


def floating(model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> list[str]:
    """Bodies that neither the world carries nor another body that is carried; changes the model's margins."""
    model.geom_margin[:] = LARGEST_GAP  # contacts are found from this distance on
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    carriers: dict[str, set[str]] = {name: set() for name in names}
    for k in range(data.ncon):
        contact = data.contact[k]
        if contact.dist > LARGEST_GAP:
            continue
        below, above = (model.body(model.geom_bodyid[geom]).name for geom in contact.geom)
        upward = contact.frame[2]  # z of the normal, which points from the first geom to the second
        if upward < 0.0:
            below, above, upward = above, below, -upward
        # A wall that an object merely touches pushes it sideways.
        if upward > LEAST_UPWARD and above in carriers:
            carriers[above].add(below)
    carried = {WORLD}
    while more := {name for name, under in carriers.items() if name not in carried and under & carried}:
        carried |= more
    return [name for name in names if name not in carried]


def _check_start(scene: Scene, cell: PackingCell) -> None:
    """Refuse a scene in which the held object touches something while the arm is at its home pose."""
    held = HeldRole.ABSENT if scene.is_handed_over else HeldRole.RIGID
    model = build_model(scene, cell, timestep=0.002, arm=ArmRole.DRIVEN, held=held)
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
    for name in scene.names:
        if (depth := _depth_in_arm(model, data, name, {*scene.names, scene.new_object.name})) > TOLERANCE:
            raise ConfigError(
                f"key 'objects.{name}.pose' puts it {1000 * depth:.0f} mm deep into the arm at home; "
                "allowed: clear of the arm"
            )


def _depth_in_arm(model: mujoco.MjModel, data: mujoco.MjData, name: str, objects: set[str]) -> float:
    """How deep an object is inside the arm or the pump [m]; 0 where it is clear of them.

    The arm's links are for pictures and take part in no contact, so distances are asked for one by one.
    """
    world, own = 0, model.geom(name).id
    links = [
        geom
        for geom in range(model.ngeom)
        if model.geom_bodyid[geom] != world and model.geom(geom).name not in objects
    ]
    return max(float(-mujoco.mj_geomDistance(model, data, own, geom, 0.0, None)) for geom in links)
