"""Has numba compile what moves arms, rearranges and packs: `python -m pack_bringup.compiling`.

It takes longest of all that is compiled, and is kept beside its source. `make test` does it first, so that no
test's time is spent on it.
"""

from __future__ import annotations

from pack_motion.arm.arm import load_arm
from pack_motion.controller import warm_up as warm_up_motion
from pack_motion.tracking.config import motion_set
from pack_planner.layout.online_packer import warm_up as warm_up_packer
from pack_planner.rearrangement.planning import warm_up as warm_up_rearrangement
from pallet_fsm.goals import warm_up as warm_up_joint_times

ARMS = ("palletizing", "blocks")
"""Cells whose arms follow moves."""


def main() -> None:
    """Compile it, or load what was compiled before."""
    for cell in ARMS:
        warm_up_motion(load_arm(cell), motion_set("shipped"))
    warm_up_joint_times()
    warm_up_rearrangement()
    warm_up_packer()


if __name__ == "__main__":
    main()
