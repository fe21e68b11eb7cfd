"""What a run of the blocks cell is made of."""

from __future__ import annotations

from pathlib import Path

from pack_bringup.blocks.lockstep import BlocksLockstepConfig
from pack_core.paths import bags_path


def lockstep_config() -> BlocksLockstepConfig:
    """The parts' own configuration."""
    return BlocksLockstepConfig()


def default_output(budget: float, *, with_execution: bool) -> Path:
    """Where a benchmark's results are kept when no file is given."""
    what = "executed" if with_execution else "planned"
    return bags_path() / "benchmarks" / f"blocks_{what}_{budget:g}s.jsonl"
