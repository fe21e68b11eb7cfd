"""Ways to lower the cost, and their register: whoever needs an optimizer finds it here by its name.

`sgn` ships. Other packages add theirs by entry points of the group `pack_mpc.optimizers`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pack_core.register import Register

if TYPE_CHECKING:
    from pack_mpc.optimizers.optimizer import Optimizer

OPTIMIZERS: Register[type[Optimizer]] = Register(
    "optimizer",
    "pack_mpc.optimizers",
    {
        "sgn": "pack_mpc.optimizers.sgn:SgnOptimizer",
    },
)
