"""The register of optimizers: the name of each, and where its class is.

The node, the lockstep, replay and the command line read it. A module is imported when its class is asked
for, so that whoever only lists the names, as `--help` does, loads nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from pack_core.errors import ConfigError

if TYPE_CHECKING:
    from pack_mpc.solution import Optimizer

OPTIMIZERS = {
    "sgn": "pack_mpc.sgn_optimizer:SgnOptimizer",
    "ilqr": "pack_mpc.ilqr_optimizer:IlqrOptimizer",
    "judo": "pack_mpc.judo_optimizer:JudoOptimizer",
}
"""Module and class of every optimizer. A new one is added here."""


def optimizer_class(name: str) -> type[Optimizer]:
    """The optimizer called `name`.

    Raises:
        ConfigError: there is none.
    """
    if name not in OPTIMIZERS:
        raise ConfigError(f"optimizer '{name}'; allowed: {', '.join(OPTIMIZERS)} (pack_mpc/optimizers.py)")
    module, cls = OPTIMIZERS[name].split(":")
    found: type[Optimizer] = getattr(import_module(module), cls)
    return found
