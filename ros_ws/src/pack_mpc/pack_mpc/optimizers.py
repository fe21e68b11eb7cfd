"""The register of optimizers: node, lockstep, replay and the command line find an optimizer by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pack_core.register import Register

if TYPE_CHECKING:
    from pack_mpc.solution import Optimizer

OPTIMIZERS: Register[type[Optimizer]] = Register(
    "optimizer",
    "pack_mpc.optimizers",
    {
        "sgn": "pack_mpc.sgn_optimizer:SgnOptimizer",
        "ilqr": "pack_mpc.ilqr_optimizer:IlqrOptimizer",
    },
)
