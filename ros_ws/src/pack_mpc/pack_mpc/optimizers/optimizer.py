"""What the controller asks of an optimizer, and what it gets."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

from pack_core.config import Config
from pack_core.joints import Setpoints
from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_mpc.cost.cost import PackingCost
from pack_mpc.plant import PackingPlant
from pack_mpc.target import PackingTarget, Stage


@dataclass(frozen=True)
class Solution:
    """One iteration's result.

    Attributes:
        setpoints: for the driver, over the horizon.
        p_WN: the held object's path `(T + 1, 3)` [m].
        cost: cost of the plan over the horizon.
        step_size: step size of the line search; 0 when the last plan stands.
        regularisation: regularisation in use; 0 for optimizers that have none.
        warning: what went wrong; empty when all is well.
    """

    setpoints: Setpoints
    p_WN: Array
    cost: float
    step_size: float
    regularisation: float
    warning: str = ""


class Optimizer(ABC):
    """One problem, more than one way to solve it; the register `OPTIMIZERS` has the classes.

    Args:
        scene: shapes, sizes and masses of the objects that are taken into account.
        cell: the cell's physical facts.
        config: the optimizer's own parameters, an instance of its `parameters`.
        threads: threads of the rollouts.

    Attributes:
        parameters: class of its parameters, which the node `mpc` has as `controller.<name>`. It has a field
            `reduction` (a `StateReductionConfig`): which objects are in the state.
        plant: the model that it plans with.
        is_sparing: whether an iteration shall do with fewer rollouts, as the machine is busy.
    """

    parameters: ClassVar[type[Config]] = Config
    plant: PackingPlant
    is_sparing = False

    @abstractmethod
    def __init__(self, scene: Scene, cell: PackingCell, config: Any, threads: int) -> None: ...

    @abstractmethod
    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget) -> Solution:
        """One iteration from the state `x0` `(nx,)`, warm-started by the last one."""

    def go_on_from(self, last: Optimizer) -> None:  # noqa: B027 - one that starts cold plans anew
        """Begin where another one of the same class has stopped, which had other objects in its model."""

    def change_cost(self) -> None:  # noqa: B027 - most optimizers keep nothing that belongs to one cost
        """The next iteration has another cost, e.g. in a new stage."""

    @classmethod  # noqa: B027 - most optimizers need nothing else
    def require(cls) -> None:
        """Load what only this optimizer needs; raises PackError if it is not installed."""
