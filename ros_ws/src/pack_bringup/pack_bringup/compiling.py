"""Has numba compile what takes longest: `python -m pack_bringup.compiling`.

That is what moves arms, rearranges and packs, and what is compiled as it is imported. It is kept beside its
source. `make test` does it first, so that no test's time is spent on it and no two workers compile the same.

The parts share hardly any function, so each has a process, which imports only what its part needs.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context

ARMS = ("palletizing", "blocks")
"""Cells whose arms follow moves."""
AT_IMPORT = (
    "pack_baselines.ilqr.riccati",
    "pack_perception.depth.registration",
    "pack_perception.mocap.physics_estimator",
)
"""Modules that state the types of their functions, which are compiled when they are imported."""


def compile_motion() -> None:
    """What moves arms, and what the palletizing machine looks at in every step."""
    from pack_motion.arm.arm import load_arm
    from pack_motion.controller import warm_up
    from pack_motion.tracking.config import motion_set
    from pallet_fsm.palletizer import warm_up as warm_up_palletizer

    for cell in ARMS:
        warm_up(load_arm(cell), motion_set("shipped"))
    warm_up_palletizer()


def compile_plans() -> None:
    """What rearranges blocks and finds places for boxes."""
    from pack_planner.layout.online_packer import warm_up as warm_up_packer
    from pack_planner.rearrangement.planning import warm_up as warm_up_rearrangement

    warm_up_rearrangement()
    warm_up_packer()


def compile_imports() -> None:
    """What is compiled when it is imported."""
    for module in AT_IMPORT:
        import_module(module)


PARTS = (compile_motion, compile_plans, compile_imports)
"""What takes longest comes first."""


def main() -> None:
    """Compile it, or load what was compiled before."""
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        for part in [pool.submit(part) for part in PARTS]:
            part.result()


if __name__ == "__main__":
    main()
