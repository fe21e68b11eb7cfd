"""The goal of the blocks cell, one rearrangement carried out, and its nodes' parameters."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.graph.graph import conditions
from pack_bringup.job import Progress, recorder_parameters
from pack_core.errors import ConfigError

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class BlocksGoal:
    """What to rearrange, and how.

    Attributes:
        problem: a problem file's text.
        seed: of the problem, where it was generated, and of the planner.
        method: name of the planner; empty: that of config/nodes/blocks/rearrangement.yaml.
    """

    problem: str
    seed: int = 0
    method: str = ""
    cell: str = "blocks"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Rearrange

        from pack_core.ros.contracts.blocks import REARRANGE

        return REARRANGE, Rearrange.Goal(problem=self.problem, method=self.method, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts the blocks where the problem has them, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.ros.contracts.blocks import RESET

        return RESET, ResetScene.Request(scene=self.problem)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        action = f"action {feedback.done + 1:2} of {feedback.actions:2}" if feedback.actions else ""
        return Progress(
            f"{feedback.phase} {feedback.block}",
            f"{feedback.phase:9} {feedback.block:4} {action:18} {feedback.elapsed:6.1f} s  "
            f"real-time factor {real_time_factor:4.2f}",
        )


def seeded_goal(seed: int) -> BlocksGoal:
    """The goal of a run without choices: four blocks, generated."""
    return BlocksGoal(problem_of(None, blocks=4, density=0.2, seed=seed), seed=seed)


def given_goal(text: str, seed: int) -> BlocksGoal:
    """The goal of a problem's text.

    Raises:
        ConfigError: it is no problem, or contradicts itself.
    """
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import parse_problem

    parse_problem(text, "the problem", blocks_cell(), goals_only=True)
    return BlocksGoal(text, seed=seed)


def problem_of(file: Path | None, blocks: int, density: float, seed: int, mixed: bool = False) -> str:
    """The text of a problem file, or of a generated problem where there is no file.

    Raises:
        ConfigError: there is no such file, it is no problem file, or the problem contradicts itself.
    """
    return _generated(blocks, density, seed, mixed) if file is None else _text_of(file)


def _text_of(path: Path) -> str:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import parse_problem
    from pack_core.text.reader import read_text
    from pack_planner.rearrangement.validation import find_fault

    text = read_text(path)
    # Now, because the planner would find it only after all nodes have started.
    if contradiction := find_fault(parse_problem(text, str(path), blocks_cell())):
        raise ConfigError(f"{path}: {contradiction.text}")
    return text


def _generated(blocks: int, density: float, seed: int, mixed: bool) -> str:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import problem_text
    from pack_planner.rearrangement.instances import make_instance

    centre = blocks_cell().workspace.centre
    return problem_text(make_instance(blocks, density, seed, centre=centre, mixed=mixed))


@dataclass(frozen=True)
class BlocksJob(BlocksGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and problem.yaml go there.
        real_time_factor: None: that of config/nodes/blocks/sim.yaml.
        command: the command line, for run.yaml.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text; the problem is written for the simulator to read."""
        from pack_evaluation.blocks.from_bag import PROBLEM_FILE

        self.folder.mkdir(parents=True, exist_ok=True)
        file = self.folder / PROBLEM_FILE
        file.write_text(self.problem)
        sim = {"problem": json.dumps(str(file.resolve()))}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        return {"sim": sim, "recorder": recorder_parameters(self, self.seed, self.command)}


def seeded_job(
    seed: int, folder: Path, *, real_time_factor: float | None, preset: str, command: str
) -> BlocksJob:
    """The job of a seed, as `pack_bringup.job.SeededJob` has it; this cell has no presets."""
    conditions("blocks", preset, None)
    return BlocksJob(
        seeded_goal(seed).problem, seed, folder=folder, real_time_factor=real_time_factor, command=command
    )
