"""What the blocks cell asks its arm for: requests for `pack benchmark motion`."""

from __future__ import annotations

from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.motion.target import MotionTarget
from pack_lockstep.blocks.benchmark_instances import ScatteredInstance
from pack_lockstep.blocks.lockstep import BlocksLockstep, CountedPlanner, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config
from pack_lockstep.motion.requests import MotionRequest
from pack_motion.reference.trajectory import JointState

CELL = "blocks"
BLOCKS, DENSITY = 4, 0.2
SEEDS = range(10)
"""Of the problems that are solved; each is also the planner's."""


def record() -> list[MotionRequest]:
    """Every target of the arm while the problems are solved in lockstep."""
    found: list[MotionRequest] = []
    cell, config = blocks_cell(), lockstep_config()
    for seed in SEEDS:
        instance = ScatteredInstance(BLOCKS, DENSITY, seed)
        problem = instance.problem(cell)

        def on_target(start: JointState, target: MotionTarget, name: str = instance.name) -> None:
            found.append(MotionRequest(f"{name}_{target.id}", CELL, start, target))

        planner = CountedPlanner(CountedPlannerConfig(seed=seed), config.planner)
        lockstep = BlocksLockstep(cell, RearrangeTask.of(problem), problem.starts, planner, config)
        lockstep.run(on_target=on_target)
    return found
