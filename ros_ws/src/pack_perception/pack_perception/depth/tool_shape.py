"""The surface of the pump on the arm's flange: cylinders about the cup's axis."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.packing.cell import PackingCell
from pack_core.robots.pump import add_pump
from pack_core.rotations import Array


@dataclass(frozen=True)
class ToolShape:
    """An arm, and the shape of its tool T, of which each cylinder's axis is that of the cup.

    Attributes:
        chain: the arm, up to the cup.
        radii: of the cylinders `(m,)` [m].
        middles: of the cylinders along the axis, from the cup `(m,)` [m].
        halves: half lengths of the cylinders `(m,)` [m].
    """

    chain: SerialChain
    radii: Array
    middles: Array
    halves: Array

    @classmethod
    def of(cls, cell: PackingCell) -> ToolShape:
        """The arm and the pump of a cell."""
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        arm = cell.robot.arm
        add_pump(arm.add_to(spec), cell.pump, arm.flange)
        model = spec.compile()
        tool = model.body("tool")
        geoms = range(int(tool.geomadr[0]), int(tool.geomadr[0] + tool.geomnum[0]))
        return cls(
            chain_from_model(model, arm.joints, "tool"), model.geom_size[geoms, 0],
            model.geom_pos[geoms, 2], model.geom_size[geoms, 1],
        )  # fmt: skip

    @property
    def flange(self) -> float:
        """Where the tool ends at the arm's flange, along the cup's axis [m]; it is behind the cup."""
        return float((self.middles - self.halves).min())

    def distances(self, p_T: Array) -> tuple[Array, Array]:
        """Signed distances `(n,)` [m] of points `(n, 3)` and their gradients `(n, 3)`, in the tool's frame.

        The tool is the union of its cylinders, so that its distance is the least of theirs; within it that
        is too large at most.
        """
        rho = np.linalg.norm(p_T[:, :2], axis=1)
        along = p_T[:, 2, None] - self.middles
        out, beyond = rho[:, None] - self.radii, np.abs(along) - self.halves
        outside = np.hypot(np.maximum(out, 0.0), np.maximum(beyond, 0.0))
        signed = outside + np.minimum(np.maximum(out, beyond), 0.0)
        best = np.argmin(signed, axis=1)
        rows = np.arange(len(p_T))
        d, out, beyond, along = signed[rows, best], out[rows, best], beyond[rows, best], along[rows, best]
        # towards an edge where both are outside, else across the nearer of barrel and end
        is_barrel = out > beyond
        across = np.where(d > 0.0, np.maximum(out, 0.0), is_barrel * 1.0)
        ahead = np.where(d > 0.0, np.maximum(beyond, 0.0), ~is_barrel * 1.0)
        radial = p_T[:, :2] / np.maximum(rho, 1e-9)[:, None]
        gradient = np.column_stack([across[:, None] * radial, ahead * np.sign(along)])
        lengths = np.linalg.norm(gradient, axis=1, keepdims=True)
        return d, gradient / np.maximum(lengths, 1e-12)
