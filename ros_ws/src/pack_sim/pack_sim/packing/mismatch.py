"""Differences between the simulated cell and the description that its nodes get."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.rotations import Array


def _rising(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] > bounds[1]:
        raise ValueError("two values, the smaller one first")
    return bounds


Range = Annotated[tuple[NonNegativeFloat, NonNegativeFloat], AfterValidator(_rising)]


class MismatchConfig(Config):
    """Bounds of the uniformly distributed differences; by default there are none."""

    friction: Range = Field(
        default=(1.0, 1.0), description="least and most of an object's true friction, as share of described"
    )
    mass: float = Field(
        default=0.0, ge=0, lt=1, description="most that a true mass differs, as share of described"
    )
    size: NonNegativeFloat = Field(
        default=0.0, le=0.004, description="most that a described length or diameter differs [m]"
    )
    container: NonNegativeFloat = Field(
        default=0.0, description="most that the described container is off, in x and in y [m]"
    )
    joint_friction: Range = Field(
        default=(0.0, 0.0), description="least and most of a joint's friction in the true arm [N m]"
    )


def actual(scene: Scene, mismatch: MismatchConfig, rng: np.random.Generator) -> Scene:
    """The scene as it truly is: friction and masses differ from the description, the geometry does not.

    MuJoCo gives a contact the larger friction of both sides. So base and walls get the smallest possible
    friction, and an object on them slides with its own.
    """
    items = [actual_object(item, scene, mismatch, rng) for item in (*scene.objects, scene.new_object)]
    friction = scene.friction * mismatch.friction[0]
    return scene.model_copy(update={"friction": friction, "objects": items[:-1], "new_object": items[-1]})


def believed(scene: Scene, mismatch: MismatchConfig, rng: np.random.Generator) -> Scene:
    """The description that the nodes get: sizes and container position with errors, and no poses."""
    items = [believed_object(item, mismatch, rng) for item in (*scene.objects, scene.new_object)]
    centre = np.array(scene.container.centre) + mismatch.container * rng.uniform(-1.0, 1.0, 2)
    container = scene.container.model_copy(update={"centre": tuple(centre.tolist())})
    update = {"container": container, "objects": items[:-1], "new_object": items[-1]}
    return scene.model_copy(update=update).description()


def joint_friction(mismatch: MismatchConfig, joints: int, rng: np.random.Generator) -> Array:
    """Coulomb friction of each of the arm's joints `(joints,)` [N m]."""
    return rng.uniform(*mismatch.joint_friction, joints)


def actual_object(
    item: ObjectModel, scene: Scene, mismatch: MismatchConfig, rng: np.random.Generator
) -> ObjectModel:
    """One object as it truly is; `scene` is the one that is described."""
    described = scene.friction if item.friction is None else item.friction
    friction = described * rng.uniform(*mismatch.friction)
    mass = item.mass * (1.0 + mismatch.mass * rng.uniform(-1.0, 1.0))
    return item.model_copy(update={"friction": friction, "mass": mass})


def believed_object(item: ObjectModel, mismatch: MismatchConfig, rng: np.random.Generator) -> ObjectModel:
    """One object as the nodes are told of it."""
    return item.resized(mismatch.size * rng.uniform(-1.0, 1.0, 3))
