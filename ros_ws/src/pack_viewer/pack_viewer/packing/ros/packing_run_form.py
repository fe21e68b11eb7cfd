"""What can be chosen for a goal of the packing cell: one object, or a container to be filled."""

from __future__ import annotations

from typing import Any

from pack_interfaces.action import FillContainer, PackObject
from pack_interfaces.srv import ResetScene

from pack_core.packing.cell import packing_cell
from pack_core.packing.method import PackingMethod
from pack_core.packing.packing_list import parse_list, supermarket_list
from pack_core.packing.scene_file import parse_scene
from pack_core.paths import config_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_viewer.ros.run_form import FileChoice, RunForm

ONE, FILL = "pack one object", "fill a container"
GENERATED = "generated from the seed"
DRAWN = "8 objects drawn by the seed"


class PackingRunForm(RunForm):
    """Task and seed; for one object its scene and the method, for a container the list."""

    def add(self) -> None:
        """Add the widgets."""
        self.task = self.gui.add_dropdown("task", (ONE, FILL))
        self._seed = self.gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
        scenes = sorted(config_path("scenarios", "packing").glob("*.yaml"))
        self.scene = FileChoice(
            self, "scene", {GENERATED: None, **{file.stem: file for file in scenes}}, parse_scene
        )
        self._method = self.gui.add_dropdown("method", tuple(method.value for method in PackingMethod))
        lists = sorted(config_path("packing_lists").glob("*.yaml"))
        self.list = FileChoice(
            self, "list", {DRAWN: None, **{file.stem: file for file in lists}},
            lambda text, name: parse_list(text, name, packing_cell()),
        )  # fmt: skip
        self.task.on_update(lambda _: self._show_choices())
        self._show_choices()

    def reset(self) -> tuple[Contract, Any]:
        """The scene, or the seed that one is generated from; for a list an empty container and pump."""
        scene = self.scene.text
        if self._is_fill:
            cell = packing_cell()
            scene = parse_list(self._list_text(), self.list.name, cell).start(cell).to_yaml()
        return contracts.RESET, ResetScene.Request(scene=scene, seed=int(self._seed.value))

    def goal(self) -> tuple[Contract, Any]:
        """The list, or the method; and the seed."""
        seed = int(self._seed.value)
        if self._is_fill:
            return contracts.FILL_CONTAINER, FillContainer.Goal(list=self._list_text(), seed=seed)
        return contracts.PACK_OBJECT, PackObject.Goal(method=self._method.value, seed=seed)

    @property
    def _is_fill(self) -> bool:
        return bool(self.task.value == FILL)

    def _list_text(self) -> str:
        return self.list.text or supermarket_list(int(self._seed.value), packing_cell()).to_yaml()

    def _show_choices(self) -> None:
        """Show what belongs to the task."""
        self.list.set_visible(self._is_fill)
        self.scene.set_visible(not self._is_fill)
        self._method.visible = not self._is_fill


RUN_FORM = PackingRunForm
"""For the register of cells."""
