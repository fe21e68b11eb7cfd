"""scene.yaml: the scene of a recorded run as a file that `pack demo packing --scene` runs again."""

from __future__ import annotations

from pathlib import Path

from rclpy.serialization import deserialize_message

from pack_core.errors import BagError
from pack_core.packing.scene import Scene
from pack_core.ros.contracts.packing import SIM_DESCRIPTION, TRUTH
from pack_core.ros.messages.scene import from_scene

SCENE_FILE = "scene.yaml"


class RunFiles:
    """Writes scene.yaml from the description that the simulator has and the first true poses that follow it.

    Args:
        folder: the run's folder.
    """

    def __init__(self, folder: Path) -> None:
        self._file = folder / SCENE_FILE
        self._description: Scene | None = None

    def on_message(self, topic: str, data: bytes) -> None:
        """Take in a recorded message, in CDR form.

        Raises:
            PackError: the message holds no scene, or the file cannot be written.
        """
        if topic == SIM_DESCRIPTION.name:
            text = deserialize_message(data, SIM_DESCRIPTION.type).data
            self._description = Scene.from_yaml(text, SIM_DESCRIPTION.name)
        elif topic == TRUTH.name and self._description is not None:
            # Only the first poses after a description are those at which the run began.
            description, self._description = self._description, None
            self._write(description.with_poses(from_scene(deserialize_message(data, TRUTH.type)).poses()))

    def _write(self, scene: Scene) -> None:
        part = self._file.with_suffix(".part")
        try:
            # Under its own name the file is whole from the first moment, whoever reads or kills meanwhile.
            part.write_text(scene.to_yaml())
            part.replace(self._file)
        except OSError as error:
            raise BagError(f"cannot write {self._file}: {error}") from error
