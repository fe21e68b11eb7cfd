"""Arm, gripper, blocks and their goals in the 3D scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from viser import GlbHandle, SceneApi

from pack_core.blocks import topics
from pack_core.blocks.block_sighting import parse_tags
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import block_name, build_model
from pack_core.blocks.problem import CUBES, BlockSizes
from pack_core.motion import topics as motion
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS
from pack_core.robots.ur10e import JOINTS
from pack_core.rotations import Pose
from pack_viewer.cell_page import CellScene
from pack_viewer.geom_meshes import box_glb
from pack_viewer.model_scene import ModelScene, scene_name
from pack_viewer.news import News, Topics

GOAL = (0.0, 0.62, 0.45, 0.45)
"""Colour of a goal: red, green, blue, opacity. What is behind it stays visible."""
GOAL_THICKNESS = 0.002
"""Goals lie on the table as thin rectangles [m]."""


class BlocksScene(CellScene):
    """Is built as soon as the blocks are known, and anew when there are others."""

    topics = Topics(states=(topics.TAGS, motion.JOINT_STATES, topics.JAW_STATE, topics.TRUTH))

    def __init__(self, scene: SceneApi) -> None:
        self._scene, self._cell = scene, blocks_cell()
        self._tags = ""
        self._names: set[str] = set()
        self._sizes: BlockSizes = CUBES
        self._drawn = ModelScene(scene, build_model(self._cell, {}, timestep=0.001, visuals=True))
        self._goals: list[GlbHandle] = []
        self._goals_wanted = True

    def update(self, news: News) -> None:
        """Move what has moved."""
        if (tags := news.newest(topics.TAGS)) and tags.data != self._tags:
            self._rebuild(tags.data)
        if joints := news.newest(motion.JOINT_STATES):
            self._drawn.set_joints(JOINTS, np.asarray(joints.position))
        if jaws := news.newest(topics.JAW_STATE):
            # The opening is between the pads; a finger's joint is its distance from the closing plane.
            self._drawn.set_joints(FINGER_JOINTS, np.full(2, 0.5 * jaws.opening))
        if truth := news.newest(topics.TRUTH):
            for item in truth.objects:
                p, q = item.pose.position, item.pose.orientation
                if item.name in self._names:
                    X_WB = Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))
                    self._drawn.set_body(block_name(item.name), X_WB)
        self._drawn.send()

    def set_goals(self, plan: Sequence[Any]) -> None:
        """Mark where the plan's last action on each block leaves it."""
        for handle in self._goals:
            handle.remove()
        self._goals = []
        for block, end in {action.end.id: action.end for action in plan}.items():
            size = self._sizes.get(block, self._cell.block.cube)
            half = 0.5 * np.array([size.x, size.y, GOAL_THICKNESS])
            glb = box_glb(self._drawn.model, half, rgba=GOAL)
            handle = self._scene.add_glb(
                f"/goals/{scene_name(block)}", glb, position=(end.x, end.y, GOAL_THICKNESS),
                wxyz=(np.cos(0.5 * end.yaw), 0.0, 0.0, np.sin(0.5 * end.yaw)), visible=self._goals_wanted,
                cast_shadow=False,
            )  # fmt: skip
            self._goals.append(handle)

    def show_goals(self, wanted: bool) -> None:
        """Show or hide the goals."""
        self._goals_wanted = wanted
        for handle in self._goals:
            handle.visible = wanted

    def _rebuild(self, text: str) -> None:
        self._tags = text
        tags, self._sizes = parse_tags(text)
        self._names = set(tags)
        self._drawn.remove()
        self._drawn = ModelScene(
            self._scene, build_model(self._cell, tags, self._sizes, timestep=0.001, visuals=True)
        )
