"""What can be chosen for a packing goal."""

from __future__ import annotations

from typing import Any

from pack_interfaces.action import PackObject
from pack_interfaces.srv import ResetScene

from pack_core.packing.method import PackingMethod
from pack_core.packing.scene_file import parse_scene
from pack_core.paths import config_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_viewer.ros.run_form import FileChoice, RunForm

GENERATED = "generated from the seed"


class PackingRunForm(RunForm):
    """Seed, scene and method."""

    def add(self) -> None:
        """Add the widgets."""
        files = sorted(config_path("scenarios", "packing").glob("*.yaml"))
        self._seed = self.gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
        self.scene = FileChoice(
            self, "scene", {GENERATED: None, **{file.stem: file for file in files}}, parse_scene
        )
        self._method = self.gui.add_dropdown("method", tuple(method.value for method in PackingMethod))

    def reset(self) -> tuple[Contract, Any]:
        """The scene, or the seed that one is generated from."""
        return contracts.RESET, ResetScene.Request(scene=self.scene.text, seed=int(self._seed.value))

    def goal(self) -> tuple[Contract, Any]:
        """The method and its seed."""
        goal = PackObject.Goal(method=self._method.value, seed=int(self._seed.value))
        return contracts.PACK_OBJECT, goal


RUN_FORM = PackingRunForm
"""For the register of cells."""
