"""What can be chosen for a goal of the packing cell: one object, or a container to be filled."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pack_interfaces.action import FillContainer, PackObject
from pack_interfaces.srv import ResetScene

from pack_core.packing.goals import PackingMethod
from pack_core.packing.packing_list import parse_list, supermarket_list
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import scene_text
from pack_core.paths import config_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_viewer.ros.run_form import FileChoice, FileKind, RunForm, TunedParameters

ONE, FILL = "pack one object", "fill a container"


def _files(none: str, *folder: str) -> dict[str, Path | None]:
    """What stands for no file, and the files of a folder of config/, by name."""
    return {none: None, **{file.stem: file for file in sorted(config_path(*folder).glob("*.yaml"))}}


SCENES = FileKind(
    "scene", _files("generated from the seed", "scenarios", "packing"), Scene.from_yaml, scene_text
)
LISTS = FileKind("list", _files("8 objects drawn by the seed", "packing_lists"), parse_list)


class PackingRunForm(RunForm):
    """Task and seed; for one object its scene and the method, for a container the list."""

    tuned = TunedParameters("mpc", "weight_factors", "weights of the cost")

    def add(self) -> None:
        """Add the widgets."""
        self.task = self.gui.add_dropdown("task", (ONE, FILL))
        self._seed = self.gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
        self.file = FileChoice(self, SCENES)
        self._method = self.gui.add_dropdown("method", tuple(method.value for method in PackingMethod))
        self.task.on_update(lambda _: self._offer_choices())

    def reset(self) -> tuple[Contract, Any]:
        """The scene, or the seed that one is generated from; for a list an empty container and pump."""
        scene = self._list_text() if self._is_fill else self.file.text
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
        return self.file.text or supermarket_list(int(self._seed.value)).to_yaml()

    def _offer_choices(self) -> None:
        """Show what belongs to the task."""
        self.file.offer(LISTS if self._is_fill else SCENES)
        self._method.visible = not self._is_fill


RUN_FORM = PackingRunForm
"""For the register of cells."""
