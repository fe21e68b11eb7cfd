"""Arm, furniture and boxes of the palletizing cell in the 3D scene; boxes come and go."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
from pydantic import Field, PositiveFloat
from viser import GlbHandle, SceneApi

from pack_core.config import Config, validate_config
from pack_core.motion import topics as motion
from pack_core.palletizing import topics
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.furniture import CARDBOARDS
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import JOINTS
from pack_core.rotations import Array
from pack_core.text.limits import MOST_BOXES
from pack_core.text.yaml_text import parse_yaml
from pack_viewer.cell_page import CellScene
from pack_viewer.geom_meshes import box_glb
from pack_viewer.model_scene import STILL, ModelScene, scene_name
from pack_viewer.news import News, Topics


class PalletScene(CellScene):
    """The cell is drawn at once, boxes as soon as the simulator names them."""

    topics = Topics(states=(topics.BOXES, motion.JOINT_STATES, topics.TRUTH))

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._cell = ModelScene(scene, build_model(palletizing_cell(), visuals=True))
        self._cell.send()
        self._boxes: dict[str, tuple[BoxBody, GlbHandle]] = {}
        self._sent: dict[str, Array] = {}

    def update(self, news: News) -> None:
        """Move what has moved."""
        if boxes := news.newest(topics.BOXES):
            self._set_boxes(boxes_in(boxes.data))
        if joints := news.newest(motion.JOINT_STATES):
            self._cell.set_joints(JOINTS, np.asarray(joints.position))
            self._cell.send()
        if truth := news.newest(topics.TRUTH):
            for item in truth.objects:
                p, q = item.pose.position, item.pose.orientation
                self._move(item.name, np.array([p.x, p.y, p.z, q.w, q.x, q.y, q.z]))

    def _set_boxes(self, boxes: Mapping[str, BoxBody]) -> None:
        for name, (body, handle) in list(self._boxes.items()):
            if boxes.get(name) != body:
                handle.remove()
                del self._boxes[name]
                self._sent.pop(name, None)
        for name, body in boxes.items():
            if name not in self._boxes:
                material = f"cardboard_{body.appearance % CARDBOARDS}"
                glb = box_glb(self._cell.model, body.half_extents, material=material)
                # Out of sight until the first pose comes.
                handle = self._scene.add_glb(f"/boxes/{scene_name(name)}", glb, visible=False)
                self._boxes[name] = (body, handle)

    def _move(self, name: str, pose: Array) -> None:
        if name not in self._boxes:
            return
        if name in self._sent and np.abs(pose - self._sent[name]).max() <= STILL:
            return
        handle = self._boxes[name][1]
        handle.position, handle.wxyz = pose[:3], pose[3:]
        if not handle.visible:
            handle.visible = True
        self._sent[name] = pose


class _BoxRow(Config):
    name: str
    size: tuple[PositiveFloat, PositiveFloat, PositiveFloat]
    mass: PositiveFloat


class _Boxes(Config):
    boxes: Annotated[list[_BoxRow], Field(max_length=MOST_BOXES)]


def boxes_in(text: str) -> dict[str, BoxBody]:
    """The boxes that the simulator's YAML text lists, by name.

    Raises:
        ConfigError: the text is no such list.
    """
    rows = parse_yaml(text, topics.BOXES) or []
    if isinstance(rows, dict):  # as recordings of earlier versions have it
        rows = [{"name": name, **row} for name, row in rows.items() if isinstance(row, dict)]
    boxes = validate_config(_Boxes, {"boxes": rows}, topics.BOXES).boxes
    return {row.name: BoxBody(row.name, row.size, row.mass) for row in boxes}
