"""Arm, container and objects of the packing cell in the 3D scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from viser import GlbHandle, SceneApi

from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.robots.packing_arms import arm_of
from pack_core.robots.seven_axis_arm import SevenAxisArm
from pack_core.rotations import Array, Pose
from pack_viewer.cell_page import CellScene
from pack_viewer.geom_meshes import body_glb
from pack_viewer.model_scene import ModelScene
from pack_viewer.news import News, Topics

ESTIMATE, TRUTH, BOTH = "as perceived", "as simulated", "both"
WALL_OPACITY = 0.45
"""The container's walls are seen through, as in the videos."""
TRUE_OPACITY = 0.35
"""Of the objects as simulated where they are drawn beside those that are perceived."""


class PackingScene(CellScene):
    """Is built as soon as the scene and the arm are known, and anew with every other scene.

    Attributes:
        drawn: what is drawn; None until both are known.
        true: the objects as simulated, where they are drawn beside those that are perceived.
    """

    topics = Topics(
        states=(
            topics.DESCRIPTION, topics.SIM_DESCRIPTION, topics.JOINT_STATES, topics.SCENE, topics.TRUTH,
        )
    )  # fmt: skip

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._texts = {ESTIMATE: "", TRUTH: ""}
        self._arm: SevenAxisArm | None = None
        self.drawn: ModelScene | None = None
        self.true: ModelScene | None = None
        self._source, self._is_stale = ESTIMATE, False
        self._poses: dict[str, dict[str, Pose]] = {ESTIMATE: {}, TRUTH: {}}

    @property
    def perceived(self) -> Mapping[str, Pose]:
        """X_WO of the objects by name, as perceived."""
        return self._poses[ESTIMATE]

    def _describe(self, source: str, text: str) -> None:
        """Take up a scene file's text; the same text again changes nothing."""
        if text != self._texts[source]:
            self._texts[source] = text
            self._rebuild()

    def _set_arm(self, arm: SevenAxisArm, q: Array) -> None:
        """Put the arm at joint positions `(7,)` [rad]."""
        if arm != self._arm:
            self._arm = arm
            self._rebuild()
        if self.drawn is not None:
            self.drawn.set_joints(arm.joints, q)

    def draw_from(self, source: str) -> None:
        """Draw objects as perceived, as simulated, or both: unknown ones differ in their shapes, too."""
        self._source, self._is_stale = source, True  # told by another thread than the one that draws

    def update(self, news: News) -> None:
        """Build what has become known, and move what has moved."""
        if self._is_stale:
            self._rebuild()
        for source, topic in ((ESTIMATE, topics.DESCRIPTION), (TRUTH, topics.SIM_DESCRIPTION)):
            if text := news.newest(topic):
                self._describe(source, text.data)
        if joints := news.newest(topics.JOINT_STATES):
            self._set_arm(arm_of(joints.name), np.asarray(joints.position))
        for source, topic in ((ESTIMATE, topics.SCENE), (TRUTH, topics.TRUTH)):
            if message := news.newest(topic):
                self._poses[source] = {item.name: _pose(item.pose) for item in message.objects}
        if self.drawn is None:
            return
        # What is not perceived yet is drawn where the simulator has it, rather than in the middle of the arm.
        _place_bodies(self.drawn, {**self._poses[TRUTH], **self._poses[self._first]})
        if self.true is not None:
            _place_bodies(self.true, self._poses[TRUTH])

    @property
    def _first(self) -> str:
        """Where the objects that are drawn solid come from."""
        return TRUTH if self._source == TRUTH else ESTIMATE

    def _rebuild(self) -> None:
        self._is_stale = False
        # recordings from before there was a description of the simulator's have the other one alone
        text = self._texts[self._first] or self._texts[ESTIMATE]
        if not text or self._arm is None:
            return
        for drawn in (self.drawn, self.true):
            if drawn is not None:
                drawn.remove()
        model = build_model(
            Scene.from_yaml(text), packing_cell().with_arm(self._arm.name), timestep=0.002,
            arm=ArmRole.DRIVEN, held=HeldRole.FREE, surroundings=True,
        )  # fmt: skip
        for wall in WALLS:
            model.geom(wall).rgba[3] = WALL_OPACITY
        self.drawn, self.true = ModelScene(self._scene, model), None
        if self._source == BOTH and (true := self._texts[TRUTH]):
            self.true = ModelScene(self._scene, _objects_of(Scene.from_yaml(true)), "/true")


def _objects_of(scene: Scene) -> mujoco.MjModel:
    """A model of a scene's objects alone, to be seen through."""
    spec = mujoco.MjSpec()
    for item in (*scene.objects, scene.new_object):
        body = spec.worldbody.add_body(name=item.name)
        body.add_freejoint(name=item.name)
        body.add_geom(**{**item.geometry(spec), "rgba": [*item.colour, TRUE_OPACITY]})
    return spec.compile()


def _place_bodies(drawn: ModelScene, poses: Mapping[str, Pose]) -> None:
    """Put the bodies that there are at X_WO, by name."""
    names = {drawn.model.joint(i).name for i in range(drawn.model.njnt)}
    for name, X_WO in poses.items():
        if name in names:
            drawn.set_body(name, X_WO)
    drawn.send()


def _pose(message: object) -> Pose:
    p, q = message.position, message.orientation  # type: ignore[attr-defined]
    return Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))


TARGET = (0.0, 0.62, 0.45, 0.40)
SAMPLE = (0.34, 0.71, 0.91, 0.14)
"""Colours of the packing pose and of each sampled placement: red, green, blue, opacity."""
SHOWN = 8
"""The cheapest samples that are drawn; more would hide the objects."""


class Ghosts:
    """Shown while there is something to show and the page's options let them."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene, self._text = scene, ""
        self._target: GlbHandle | None = None
        self._samples: list[GlbHandle] = []
        self._has_target, self._count = False, 0
        self._target_wanted = self._samples_wanted = True

    def describe(self, text: str) -> None:
        """Take up a scene file's text: its new object is what the ghosts look like."""
        if text == self._text:
            return
        self._text = text
        for handle in (*self._samples, *([self._target] if self._target else [])):
            handle.remove()
        model = _model_of(Scene.from_yaml(text))
        target, sample = (body_glb(model, [0], rgba=rgba) for rgba in (TARGET, SAMPLE))
        options: dict[str, Any] = {"visible": False, "cast_shadow": False, "receive_shadow": False}
        self._target = self._scene.add_glb("/ghosts/target", target, **options)
        self._samples = [self._scene.add_glb(f"/ghosts/sample {i}", sample, **options) for i in range(SHOWN)]
        self.clear()

    def set_target(self, pose: Any) -> None:
        """Show the packing pose."""
        self._has_target = True
        if self._target is not None:
            _place(self._target, pose)
        self._show()

    def set_samples(self, samples: Sequence[Any]) -> None:
        """Show where the cheapest samples left the new object, which is the last of their objects."""
        cheapest = sorted(samples, key=lambda sample: float(sample.cost))[: len(self._samples)]
        self._count = len(cheapest)
        for handle, sample in zip(self._samples, cheapest, strict=False):
            _place(handle, sample.poses[-1])
        self._show()

    def show_target(self, wanted: bool) -> None:
        """Show or hide the packing pose."""
        self._target_wanted = wanted
        self._show()

    def show_samples(self, wanted: bool) -> None:
        """Show or hide the samples."""
        self._samples_wanted = wanted
        self._show()

    def clear(self) -> None:
        """There is nothing planned."""
        self._has_target, self._count = False, 0
        self._show()

    def _show(self) -> None:
        if self._target is not None:
            _set_visible(self._target, self._has_target and self._target_wanted)
        for i, handle in enumerate(self._samples):
            _set_visible(handle, self._samples_wanted and i < self._count)


def _set_visible(handle: GlbHandle, visible: bool) -> None:
    if handle.visible != visible:
        handle.visible = visible


def _place(handle: GlbHandle, pose: Any) -> None:
    p, q = pose.position, pose.orientation
    handle.position, handle.wxyz = (p.x, p.y, p.z), (q.w, q.x, q.y, q.z)


def _model_of(scene: Scene) -> mujoco.MjModel:
    """A model of the new object alone."""
    spec, item = mujoco.MjSpec(), scene.new_object
    spec.worldbody.add_geom(**item.geometry(spec))
    return spec.compile()
