"""Poses as files have them."""

from __future__ import annotations

import numpy as np
from pydantic import model_validator

from pack_core.config import Config
from pack_core.rotations import Pose, from_yaw
from pack_core.text.limits import AngleDeg, Coordinate, UnitPart


class PoseConfig(Config):
    """A pose as files have it: `position` of the object's centre [m], `quaternion` (wxyz) or `yaw_deg`."""

    position: tuple[Coordinate, Coordinate, Coordinate]
    yaw_deg: AngleDeg = 0.0
    quaternion: tuple[UnitPart, UnitPart, UnitPart, UnitPart] | None = None

    @model_validator(mode="after")
    def _is_one_rotation(self) -> PoseConfig:
        if self.quaternion and self.yaw_deg:
            raise ValueError("either `quaternion` or `yaw_deg`, not both")
        if self.quaternion and abs(np.linalg.norm(self.quaternion) - 1.0) > 0.01:
            raise ValueError("a `quaternion` (w, x, y, z) of length 1")
        return self

    def to_pose(self) -> Pose:
        """X_WO."""
        q = np.array(self.quaternion) if self.quaternion else from_yaw(np.deg2rad(self.yaw_deg))
        return Pose(np.array(self.position), q)

    @classmethod
    def from_pose(cls, X_WO: Pose) -> PoseConfig:
        """The file's form of X_WO."""
        p, q = X_WO.p.tolist(), X_WO.q.tolist()
        return cls(position=(p[0], p[1], p[2]), quaternion=(q[0], q[1], q[2], q[3]))
