"""The blocks cell on the page: arm, blocks with their tags, goals, the plan as steps, jaws and path error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viser import ViserServer

from pack_core.blocks import topics
from pack_core.motion import topics as motion
from pack_core.text.json_text import parse_json
from pack_viewer.blocks.blocks_scene import BlocksScene
from pack_viewer.cell_page import IDLE, CellPage, Headline, preset_from_angles
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import BLUE, GREEN, GREY, ORANGE, boxed, chips, facts, put, signed_list
from pack_viewer.news import News, Topics, seconds
from pack_viewer.rolling_plot import RollingPlot

PHASES = ("PERCEIVE", "PLAN", "PICK", "PLACE", "PUSH", "RETREAT", "DONE")
JAWS = ("moving", "at the opening", "holding", "blocked")
"""JawState's constants in words."""
PUSH = 2
"""BlockAction's kind of a push."""
COUNTS = ("picks", "pushes", "plans", "failed_grasps", "refusals", "deviations", "disturbances")


class BlocksPage(CellPage):
    """The blocks cell's part of the page."""

    topics = Topics(
        states=(
            *BlocksScene.topics.all, motion.MOTION_STATUS, topics.BLOCK_POSES,
        ),
        events=(topics.STATUS, topics.RESULT),
        followed=(motion.MOTION_STATUS, topics.JAW_STATE),
    )  # fmt: skip
    scene_type = BlocksScene
    presets = (
        preset_from_angles("cell", (0.5, 0.0, 0.15), 1.5, 145.0, -30.0),
        preset_from_angles("blocks", (0.7, 0.0, 0.05), 1.1, 145.0, -45.0),
        preset_from_angles("top", (0.7, 0.0, 0.0), 1.2, 180.0, -89.0),
        preset_from_angles("side", (0.6, 0.0, 0.15), 1.8, 90.0, -10.0),
    )

    def __init__(self, server: ViserServer, log: EventLog) -> None:
        super().__init__(server, log)
        self.scene = BlocksScene(server.scene)
        self._status: Any = None
        self._steps: list[tuple[str, str, str]] = []
        self._jaws: Any = None
        self._motion: Any = None
        self._unseen: tuple[str, ...] = ()

    def tabs(self) -> dict[str, Callable[[], None]]:
        """The plan as steps, and plots over time."""
        return {"Plan": self._add_plan, "Plots": self._add_plots}

    def view_options(self) -> None:
        """Choose whether goals are drawn."""
        goals = self.server.gui.add_checkbox("goals", initial_value=True)
        goals.on_update(lambda _: self.scene.show_goals(goals.value))

    def update(self, news: News) -> None:
        """Move the scene and follow the plan."""
        self.scene.update(news)
        self._jaws = news.newest(topics.JAW_STATE) or self._jaws
        self._motion = news.newest(motion.MOTION_STATUS) or self._motion
        if sight := news.newest(topics.BLOCK_POSES):
            self._unseen = (*sight.missing, *sight.doubled)
        for status in news.all(topics.STATUS):
            self._take_status(status)
        for result in news.all(topics.RESULT):
            self._take_result(parse_json(result.data, topics.RESULT), news.time)
        self._plot(news.time)

    def show(self) -> None:
        """Bring plan, values and plots up to date."""
        status = self._status
        put(self._phases, boxed(chips(PHASES, status.phase if status else None)))
        put(self._plan, signed_list(self._steps, "there is no plan yet"))
        rows = []
        if self._jaws is not None:
            opening, force = 1000 * self._jaws.opening, round(self._jaws.force)
            words = JAWS[self._jaws.status] if self._jaws.status < len(JAWS) else "?"
            rows.append(("jaws", f"{words}, {opening:.0f} mm, {force} N"))
        if self._motion is not None:
            rows.append(("motion", self._motion.reason or self._motion.state))
        if self._unseen:
            rows.append(("not seen", ", ".join(self._unseen)))
        if status is not None:
            rows.append(("lower bound", f"{status.lower_bound} actions"))
            rows += [(name.replace("_", " "), str(getattr(status, name))) for name in COUNTS]
        put(self._values, facts(rows))
        for plot in (self._error, self._opening):
            plot.send()

    def forget(self) -> None:
        """Begin anew without a plan."""
        self._status, self._unseen, self._steps = None, (), []
        self._jaws, self._motion = None, None
        self.headline = IDLE
        self.scene.set_goals(())
        for plot in (self._error, self._opening):
            plot.clear()

    def _take_status(self, status: Any) -> None:
        before, now = self._status, seconds(status)
        if status.plan and (before is None or status.plans != before.plans or not before.plan):
            self.log.add(f"plan of {len(status.plan)} actions", time=now)
            self.scene.set_goals(status.plan)
        if before is None or status.phase != before.phase:
            self.log.add(" ".join(filter(None, (status.phase, status.block))), time=now)
        for name in ("failed_grasps", "refusals", "deviations", "disturbances"):
            if before is not None and getattr(status, name) > getattr(before, name):
                self.log.add(f"{name.replace('_', ' ')}: {getattr(status, name)}", "warning", now)
        self._status = status
        if status.plan or not status.plans:
            self._steps = _steps(status)
        elif status.phase == "DONE":  # of the last plan, which was carried out, nothing is left to plan
            self._steps = [("✓", GREEN, text) for _, _, text in self._steps]
        step = f"action {min(status.done + 1, len(status.plan))} of {len(status.plan)}" if status.plan else ""
        self.headline = Headline(
            status.phase, ", ".join(filter(None, (f"block {status.block}" if status.block else "", step)))
        )

    def _take_result(self, result: dict[str, Any], time: float | None) -> None:
        is_success, message = bool(result.get("success")), str(result.get("message", ""))
        self.log.add(f"goal ended: {message}", "info" if is_success else "error", time)
        self.headline = Headline(str(result.get("exit_reason", "ended")), message, is_fault=not is_success)

    def _plot(self, time: float | None) -> None:
        if time is None or (self._status is not None and self._status.phase == "DONE"):
            return  # the curves of a goal that has ended stay
        if self._motion is not None:
            self._error.add(time, 1000.0 * self._motion.path_error)
        if self._jaws is not None:
            self._opening.add(time, 1000.0 * self._jaws.opening, self._jaws.force)

    def _add_plan(self) -> None:
        gui = self.server.gui
        self._phases = gui.add_html("")
        self._plan = gui.add_html("")
        self._values = gui.add_html("")

    def _add_plots(self) -> None:
        gui = self.server.gui
        self._error = RollingPlot(gui, "tool off its path [mm]", ("path error",))
        self._opening = RollingPlot(gui, "jaws", ("opening [mm]", "force [N]"))


def _steps(status: Any) -> list[tuple[str, str, str]]:
    """The plan, a line an action: sign, colour and text."""
    rows = []
    for i, action in enumerate(status.plan):
        sign, colour = ("✓", GREEN) if i < status.done else ("·", GREY)
        if i == status.done and status.phase != "DONE":
            sign, colour = "▶", ORANGE if status.block else BLUE
        verb = "push" if action.kind == PUSH else "carry"
        rows.append((sign, colour, f"{verb} {action.end.id} to {action.end.x:.2f}, {action.end.y:.2f} m"))
    return rows


PAGE = BlocksPage
"""For the register of cells."""
