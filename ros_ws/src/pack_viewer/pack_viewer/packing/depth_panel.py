"""The depth cameras' images on the page, with the outlines of what is perceived, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
from viser import GuiApi, GuiHtmlHandle, GuiImageHandle

from pack_core.camera import Picture, PinholeCamera
from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SEEN, SeenDeviations, SeenObjects, in_words
from pack_core.rotations import Array, Pose
from pack_viewer.fragments import facts, put
from pack_viewer.news import News

NEAR, FAR = 0.4, 0.9
"""Depths that are drawn white and, but for what was not measured, darkest [m]."""
DARKEST = 40
"""Grey of the farthest; what was not measured is black."""
NOTHING = np.zeros((4, 4, 3), np.uint8)
NONE = "this cell has motion capture, or no image has come yet"


def depths_of(message: Any) -> Array | None:
    """The depths `(height, width)` [m] of a message; None where it is none of 16UC1."""
    data = np.asarray(message.data, dtype=np.uint8)
    if message.encoding != "16UC1" or data.size != 2 * message.height * message.width:
        return None
    return np.asarray(1e-3 * data.view("<u2").reshape(message.height, message.width))


def picture_of(depth: Array, camera: PinholeCamera, scene: Scene, poses: Mapping[str, Pose]) -> Picture:
    """Near is bright, and around every object is the outline of where it is perceived.

    Args:
        depth: what the camera measured `(height, width)` [m]; 0 where nothing.
        camera: the camera; outlines are left out of images of another size.
        scene: the objects, as described or as seen.
        poses: X_WO by name.
    """
    grey = np.clip((FAR - depth) / (FAR - NEAR), 0.0, 1.0) * (255 - DARKEST) + DARKEST
    picture = np.repeat(np.where(depth > 0.0, grey, 0.0).astype(np.uint8)[..., None], 3, axis=-1)
    if depth.shape == (camera.height, camera.width):
        for item in (*scene.objects, scene.new_object):
            if (X_WO := poses.get(item.name)) is not None:
                corners = camera.project(X_WO.apply(item.hull())).round().astype(np.int32)
                colour = tuple(round(255 * share) for share in item.colour)
                cv2.polylines(picture, [cv2.convexHull(corners)], isClosed=True, color=colour)
    return picture


def sizes_of(scene: Scene, deviations: Mapping[str, SeenDeviations]) -> str:
    """A row for each object that a look saw: its size, and how sure that and its place are."""
    items = (*scene.objects, scene.new_object)
    seen = [(item, deviations[item.name]) for item in items if item.name in deviations]
    return facts([(item.name, in_words(item, known)) for item, known in seen]) if seen else ""


class DepthPanel:
    """All images, as soon as they come, and what a look saw; on cells with motion capture a note."""

    def __init__(self) -> None:
        self._cameras = packing_cell().depth.cameras()
        self._newest: dict[int, Array] = {}
        self._scene: Scene | None = None
        self._poses: Mapping[str, Pose] = {}
        self._deviations: Mapping[str, SeenDeviations] = {}
        self._handles: list[GuiImageHandle] = []
        self._sizes: GuiHtmlHandle | None = None

    def add(self, gui: GuiApi) -> None:
        """Add the widgets."""
        self._note = gui.add_markdown(NONE)
        self._handles = [
            gui.add_image(NOTHING, label=f"{name}, and what is perceived", format="jpeg", visible=False)
            for name in topics.DEPTH_CAMERAS
        ]
        self._sizes = gui.add_html("")

    def update(self, news: News, perceived: Mapping[str, Pose]) -> None:
        """Take the newest images, and X_WO of what is perceived."""
        if text := news.newest(topics.DESCRIPTION):
            self._scene = Scene.from_yaml(text.data)
        if text := news.newest(SEEN):
            self._deviations = SeenObjects.from_yaml(text.data).objects
        self._poses = perceived
        for camera, topic in enumerate(topics.DEPTH_IMAGES):
            if (message := news.newest(topic)) and (depth := depths_of(message)) is not None:
                self._newest[camera] = depth

    def show(self) -> None:
        """Draw the images that have come since the last call."""
        for i, depth in self._newest.items():
            if self._scene is not None and self._handles:
                handle = self._handles[i]
                handle.image = picture_of(depth, self._cameras[i], self._scene, self._poses)
                handle.visible, self._note.visible = True, False
        self._newest = {}
        if self._scene is not None and self._sizes is not None:
            put(self._sizes, sizes_of(self._scene, self._deviations))

    def forget(self) -> None:
        """There are no images any more."""
        self._newest, self._poses, self._deviations = {}, {}, {}
        for handle in self._handles:
            handle.visible, self._note.visible = False, True
