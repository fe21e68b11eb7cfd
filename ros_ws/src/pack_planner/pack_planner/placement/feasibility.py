"""Decides which settled samples are feasible: new object packed, others still contained (section II)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, rotate

UP = np.array([0.0, 0.0, 1.0])
FORWARD = np.array([1.0, 0.0, 0.0])


class FeasibilityConfig(Config):
    """What counts as packed, and how far it may be from that."""

    max_tilt_deg: PositiveFloat = Field(10.0, description="tilt up to which the new object counts as upright")
    max_lift: PositiveFloat = Field(
        0.015, description="height up to which it counts as standing on the base, the paper's tolerance [m]"
    )
    max_wall_depth: NonNegativeFloat = Field(
        0.003, description="how far its outline may reach into a wall, by soft contact and its tilt [m]"
    )


@dataclass(frozen=True)
class FeasibilityVerdict:
    """Why samples are infeasible; `faults` has a mask `(S,)` for every reason."""

    faults: dict[str, npt.NDArray[np.bool_]]

    @property
    def is_feasible(self) -> npt.NDArray[np.bool_]:
        """Samples without a fault `(S,)`."""
        return np.asarray(~np.any(list(self.faults.values()), axis=0))

    def reason(self) -> str:
        """The numbers of samples with each fault in words, the most frequent fault first."""
        counts = sorted(((int(mask.sum()), fault) for fault, mask in self.faults.items()), reverse=True)
        total = len(self.is_feasible)
        return f"none of {total} samples: " + ", ".join(f"{fault} in {n}" for n, fault in counts if n)


def judge(scene: Scene, settled: Array, penetration: Array, config: FeasibilityConfig) -> FeasibilityVerdict:
    """Decide which settled samples are feasible, and why the others are not.

    Args:
        scene: container and objects.
        settled: X_WO `(S, objects, 7)` of all objects, the new one last.
        penetration: lasting penetration K `(S,)` [m].
        config: limits.
    """
    new, others = settled[:, -1], settled[:, :-1]
    return FeasibilityVerdict(
        {
            "objects still overlap": penetration > 0.0,
            "an object is pushed out of the container": ~np.all(_is_contained(scene, others), axis=1),
            "the new object tips": rotate(new[:, 3:], UP)[:, 2] < np.cos(np.deg2rad(config.max_tilt_deg)),
            "the new object is lifted off the base": _clearance(scene, new) > config.max_lift,
            "the new object is not between the walls": ~(wall_clearance(scene, new) > -config.max_wall_depth),
        }
    )


def _is_contained(scene: Scene, poses: Array) -> npt.NDArray[np.bool_]:
    """Whether each object's centre is between the walls and below their rim `(S, objects)`."""
    container = scene.container
    p = poses[..., :3]
    is_between = np.all((p[..., :2] > container.lower) & (p[..., :2] < container.upper), axis=-1)
    return np.asarray(is_between & (p[..., 2] < container.height))


def _clearance(scene: Scene, poses: Array) -> Array:
    """How much higher the new object's centre is than when it stands on the base `(S,)` [m]."""
    return np.asarray(poses[:, 2] - scene.new_object.half_extents[2])


def wall_clearance(scene: Scene, poses: Array) -> Array:
    """Distance `(S,)` [m] from the new object's outline, taken as upright, to the nearest wall."""
    x_axes = rotate(poses[:, 3:], FORWARD)
    spans = scene.new_object.half_spans(np.arctan2(x_axes[:, 1], x_axes[:, 0]))
    offsets = np.abs(poses[:, :2] - np.array(scene.container.centre))
    return np.asarray((0.5 * np.array(scene.container.size) - offsets - spans).min(axis=1))
