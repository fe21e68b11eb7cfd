"""Translucent shapes of the new object: where it is to go, and where samples of the placement left it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
from viser import GlbHandle, SceneApi

from pack_core.packing.scene import Scene
from pack_viewer.geom_meshes import body_glb

TARGET = (0.0, 0.62, 0.45, 0.40)
SAMPLE = (0.34, 0.71, 0.91, 0.14)
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
