"""The palletizing cell on the page: arm, boxes, the machine's states, vision, gripper and path error."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image
from viser import ViserServer

from pack_core.motion import topics as motion
from pack_core.palletizing import topics
from pack_core.palletizing.cell import PALLET
from pack_core.text.json_text import parse_json
from pack_viewer.cell_page import IDLE, CellPage, Headline, preset_from_angles
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import facts, put
from pack_viewer.news import News, Topics, seconds
from pack_viewer.palletizing.order_progress import OrderPlaces, OrderProgress
from pack_viewer.palletizing.pallet_scene import PalletScene
from pack_viewer.rolling_plot import RollingPlot

DETECTED = 1
"""BoxDetection's status of a box that was found."""
NO_PICTURE = np.full((120, 160, 3), 40, dtype=np.uint8)
"""Shown before the camera has seen a box."""


class PalletizingPage(CellPage):
    """The palletizing cell's part of the page."""

    topics = Topics(
        states=(
            *PalletScene.topics.all, motion.MOTION_STATUS, topics.GRIPPER_STATE, topics.VISION_OVERLAY,
            motion.GOAL_MARKERS,
        ),
        events=(topics.PALLET_STATE, topics.BOX_DETECTION, topics.CONTACTS, topics.RESULT),
        followed=(motion.MOTION_STATUS, topics.GRIPPER_STATE, motion.GOAL_MARKERS),
    )  # fmt: skip
    scene_type = PalletScene
    presets = (
        preset_from_angles("cell", (-0.9, 1.4, 0.8), 6.2, 125.0, -28.0),
        preset_from_angles("pallet", (-0.6, 2.4, 0.6), 3.4, 125.0, -30.0),
        preset_from_angles("picking table", (-2.3, 1.9, 0.9), 3.0, 150.0, -35.0),
        preset_from_angles("top", (-1.0, 1.5, 0.5), 7.5, 90.0, -89.0),
    )

    def __init__(self, server: ViserServer, log: EventLog) -> None:
        super().__init__(server, log)
        self.scene = PalletScene(server.scene)
        self._places = OrderPlaces(server.scene)
        self._progress = OrderProgress()
        self._grip: Any = None
        self._motion: Any = None
        self._detection: Any = None
        self._contacts = 0

    def tabs(self) -> dict[str, Callable[[], None]]:
        """The machine's states, what the camera sees, and plots over time."""
        return {"States": self._add_states, "Camera": self._add_camera, "Plots": self._add_plots}

    def update(self, news: News) -> None:
        """Move the scene and follow the machine."""
        self.scene.update(news)
        self._grip = news.newest(topics.GRIPPER_STATE) or self._grip
        self._motion = news.newest(motion.MOTION_STATUS) or self._motion
        if markers := news.newest(motion.GOAL_MARKERS):  # an order, or a shift, begins
            self._places.set(markers.markers)
            self._progress = OrderProgress()
        for state in news.all(topics.PALLET_STATE):
            self._take_state(state)
        self._places.take(self._progress.placed)
        for detection in news.all(topics.BOX_DETECTION):
            self._detection = detection
            if detection.status != DETECTED:
                self.log.add(f"camera: {detection.reason}", "warning", seconds(detection))
        for contact in news.all(topics.CONTACTS):
            self._contacts += 1
            touching = " and ".join(str(body) for body in contact.bodies)
            self.log.add(f"{touching} touched with {contact.force:.0f} N", "warning", seconds(contact))
        for result in news.all(topics.RESULT):
            self._take_result(parse_json(result.data, topics.RESULT), news.time)
        if overlay := news.newest(topics.VISION_OVERLAY):
            self._picture.image = np.asarray(Image.open(BytesIO(bytes(overlay.data))).convert("RGB"))
        self._plot(news.time)

    def show(self) -> None:
        """Bring states, values and plots up to date."""
        put(self._states, self._progress.states_html())
        rows = [("placed", self._progress.placed_text(self._places.count)), ("contacts", str(self._contacts))]
        if self._grip is not None:
            rows.insert(0, ("gripper", _grip_text(self._grip)))
        if self._motion is not None:
            rows.append(("motion", " ".join(filter(None, (self._motion.state, self._motion.label)))))
            if self._motion.reason:
                rows.append(("because", self._motion.reason))
        put(self._values, facts(rows))
        put(self._cycles, self._progress.cycles_html())
        put(self._found, facts(_detection_rows(self._detection)) if self._detection else "")
        for plot in (self._error, self._load):
            plot.send()

    def forget(self) -> None:
        """Begin anew with no box placed."""
        self._progress = OrderProgress()
        self._places.clear()
        self._contacts, self._grip, self._motion, self._detection = 0, None, None, None
        self._picture.image = NO_PICTURE
        self.headline = IDLE
        for plot in (self._error, self._load):
            plot.clear()

    def _take_state(self, state: Any) -> None:
        place = getattr(state, "place", PALLET)  # recordings of 0.1.0 have none
        self._progress.enter(state.state, state.box, place, state.reason, seconds(state))
        is_fault = self._progress.is_fault
        text = f"{state.state}, box {state.box}" + (f": {state.reason}" if state.reason else "")
        self.log.add(text, "error" if is_fault else "info", seconds(state))
        self.headline = Headline(state.state, self._progress.note, is_fault=is_fault)

    def _take_result(self, result: dict[str, Any], time: float | None) -> None:
        placed = sum(box["outcome"] == "placed" for box in result["boxes"])
        text = f"order ended: {placed} of {len(result['boxes'])} boxes placed"
        reason = str(result.get("reason") or "")
        is_fault = bool(reason) or placed < len(result["boxes"])
        self.log.add(f"{text}{', ' if reason else ''}{reason}", "error" if is_fault else "info", time)
        self.headline = Headline(
            "order ended", reason or f"{placed} of {len(result['boxes'])} placed", is_fault
        )

    def _plot(self, time: float | None) -> None:
        if time is None or not self._progress.is_under_way:
            return  # the curves of an order that has ended stay
        if self._motion is not None:
            self._error.add(time, 1000.0 * self._motion.path_error)
        if self._grip is not None:
            self._load.add(time, self._grip.coaxial_force, self._grip.shear_force, self._grip.moment)

    def _add_states(self) -> None:
        gui = self.server.gui
        self._states = gui.add_html("")
        self._values = gui.add_html("")
        self._cycles = gui.add_html("")

    def _add_camera(self) -> None:
        gui = self.server.gui
        self._picture = gui.add_image(NO_PICTURE, label="what box vision found", format="jpeg")
        self._found = gui.add_html("")

    def _add_plots(self) -> None:
        gui = self.server.gui
        self._error = RollingPlot(gui, "tool off its path [mm]", ("path error",))
        self._load = RollingPlot(gui, "load on the gripper", ("coaxial [N]", "shear [N]", "moment [N m]"))


def _grip_text(grip: Any) -> str:
    if grip.object:
        return f"holds {grip.object}"
    return str(grip.release_reason or ("closed on nothing" if grip.is_closed else "open"))


def _detection_rows(detection: Any) -> list[tuple[str, str]]:
    """What box vision says of the last picture."""
    if detection.status != DETECTED:
        return [("box", detection.box_id), ("not found", detection.reason)]
    p, q, (length, width) = detection.pose.position, detection.pose.orientation, detection.size
    yaw = 2.0 * np.rad2deg(np.arctan2(q.z, q.w))
    return [
        ("box", detection.box_id), ("top face", f"{1000 * length:.0f} x {1000 * width:.0f} mm"),
        ("centre", f"{p.x:.3f}, {p.y:.3f}, {p.z:.3f} m"), ("heading", f"{yaw:.1f} degrees"),
    ]  # fmt: skip


PAGE = PalletizingPage
"""For the register of cells."""
