"""What the controller asks of an optimizer, and what it gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pack_core.joints import Setpoints
from pack_core.rotations import Array
from pack_mpc.cost import PackingCost
from pack_mpc.plant import PackingPlant
from pack_mpc.target import PackingTarget
from pack_mpc.weights import Stage


@dataclass(frozen=True)
class Solution:
    """One iteration's result.

    Attributes:
        setpoints: for the driver.
        p_WN: the held object's path `(T + 1, 3)` [m].
        cost: over the horizon.
        step_size: of the line search, 0 when the last plan stands.
        regularisation: in use.
        warning: empty when all is well.
    """

    setpoints: Setpoints
    p_WN: Array
    cost: float
    step_size: float
    regularisation: float
    warning: str = ""


class Optimizer(Protocol):
    """One problem, more than one way to solve it."""

    plant: PackingPlant

    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget) -> Solution:
        """One iteration from state `x0`, warm-started by the last one."""
        ...

    def change_cost(self) -> None:
        """The next iteration has another cost, e.g. in a new stage."""
        ...
