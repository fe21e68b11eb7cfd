"""What can be chosen for a rearrangement."""

from __future__ import annotations

from typing import Any

from pack_interfaces.action import Rearrange
from pack_interfaces.srv import ResetScene

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.problem_file import parse_problem, problem_text
from pack_core.paths import config_path
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts.contract import Contract
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import METHODS
from pack_viewer.ros.run_form import FileChoice, FileKind, RunForm

GENERATED = "generated from the seed"
DENSITY = 0.2
"""Share of the workspace that the blocks of a generated problem cover, as in the demo."""


class BlocksRunForm(RunForm):
    """Problem, or number of blocks and seed of a generated one, and the planner."""

    def add(self) -> None:
        """Add the widgets."""
        files = sorted(config_path("scenarios", "blocks").glob("*.yaml"))
        self._problem = FileChoice(self, FileKind(
            "problem", {**{file.stem: file for file in files}, GENERATED: None},
            lambda text, name: parse_problem(text, name, blocks_cell()),
        ))  # fmt: skip
        self._blocks = self.gui.add_number("blocks", 4, min=1, max=25, step=1)
        self._seed = self.gui.add_number(
            "seed", 0, min=0, max=2**31 - 1, step=1, hint="of a generated problem, and of the planner"
        )
        self._method = self.gui.add_dropdown("planner", tuple(METHODS))
        self._problem.follow(self._note_problem)

    def _note_problem(self, name: str) -> None:
        """A file has its own blocks: their number counts only for a generated problem."""
        self._blocks.disabled = name != GENERATED

    def reset(self) -> tuple[Contract, Any]:
        """The blocks where the problem has them."""
        return contracts.RESET, ResetScene.Request(scene=self._text(), seed=int(self._seed.value))

    def goal(self) -> tuple[Contract, Any]:
        """The problem, the planner and its seed."""
        seed = int(self._seed.value)
        goal = Rearrange.Goal(problem=self._text(), method=self._method.value, seed=seed)
        return contracts.REARRANGE, goal

    def _text(self) -> str:
        if text := self._problem.text:
            return text
        centre = blocks_cell().workspace.centre
        problem = make_instance(int(self._blocks.value), DENSITY, int(self._seed.value), centre=centre)
        return problem_text(problem)


RUN_FORM = BlocksRunForm
"""For the register of cells."""
