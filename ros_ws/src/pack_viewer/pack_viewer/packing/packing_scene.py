"""Arm, container and objects of the packing cell in the 3D scene."""

from __future__ import annotations

import numpy as np
from viser import SceneApi

from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.robots.packing_arms import arm_of
from pack_core.robots.seven_axis_arm import SevenAxisArm
from pack_core.rotations import Array, Pose
from pack_viewer.cell_scene import CellScene
from pack_viewer.model_scene import ModelScene
from pack_viewer.news import News, Topics

ESTIMATE, TRUTH = "as perceived", "as simulated"
WALL_OPACITY = 0.45
"""The container's walls are seen through, as in the videos."""


class PackingScene(CellScene):
    """Is built as soon as the scene and the arm are known, and anew with every other scene.

    Attributes:
        drawn: what is drawn; None until both are known.
    """

    topics = Topics(states=(topics.DESCRIPTION, topics.JOINT_STATES, topics.SCENE, topics.TRUTH))

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._text = ""
        self._arm: SevenAxisArm | None = None
        self.drawn: ModelScene | None = None
        self._source = ESTIMATE
        self._poses: dict[str, dict[str, Pose]] = {ESTIMATE: {}, TRUTH: {}}

    def _describe(self, text: str) -> None:
        """Take up a scene file's text; the same text again changes nothing."""
        if text != self._text:
            self._text = text
            self._rebuild()

    def _set_arm(self, arm: SevenAxisArm, q: Array) -> None:
        """Put the arm at joint positions `(7,)` [rad]."""
        if arm != self._arm:
            self._arm = arm
            self._rebuild()
        if self.drawn is not None:
            self.drawn.set_joints(arm.joints, q)

    def draw_from(self, source: str) -> None:
        """Draw objects as perceived or as simulated."""
        self._source = source

    def update(self, news: News) -> None:
        """Build what has become known, and move what has moved."""
        if text := news.newest(topics.DESCRIPTION):
            self._describe(text.data)
        if joints := news.newest(topics.JOINT_STATES):
            self._set_arm(arm_of(joints.name), np.asarray(joints.position))
        for source, topic in ((ESTIMATE, topics.SCENE), (TRUTH, topics.TRUTH)):
            if message := news.newest(topic):
                self._poses[source] = {item.name: _pose(item.pose) for item in message.objects}
        if self.drawn is None:
            return
        # What is not perceived yet is drawn where the simulator has it, rather than in the middle of the arm.
        for name, X_WO in {**self._poses[TRUTH], **self._poses[self._source]}.items():
            if name in self._names:
                self.drawn.set_body(name, X_WO)
        self.drawn.send()

    def _rebuild(self) -> None:
        if not self._text or self._arm is None:
            return
        if self.drawn is not None:
            self.drawn.remove()
        scene = Scene.from_yaml(self._text)
        self._names = {*scene.names, scene.new_object.name}
        model = build_model(
            scene, packing_cell().with_arm(self._arm.name), timestep=0.002, arm=ArmRole.DRIVEN,
            held=HeldRole.FREE, surroundings=True,
        )  # fmt: skip
        for wall in WALLS:
            model.geom(wall).rgba[3] = WALL_OPACITY
        self.drawn = ModelScene(self._scene, model)


def _pose(message: object) -> Pose:
    p, q = message.position, message.orientation  # type: ignore[attr-defined]
    return Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))
