"""The packing cell on the page: arm, container, objects, ghosts of what is planned, stages and plots."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from viser import ViserServer

from pack_core.packing import topics
from pack_core.packing.load_shedding import GivenUp, LoadShedding
from pack_core.packing.seen_deviations import SEEN
from pack_core.text.json_text import parse_json
from pack_viewer.cell_page import IDLE, CellPage, Headline, preset_from_angles
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import GREY, ORANGE, boxed, chips, facts, put, signed_list
from pack_viewer.news import News, Topics, seconds
from pack_viewer.packing.depth_panel import DepthPanel
from pack_viewer.packing.fill_panel import FillPanel
from pack_viewer.packing.packing_scene import BOTH, ESTIMATE, TRUTH, Ghosts, PackingScene
from pack_viewer.rolling_plot import RollingPlot

ENDS = ("placed", "done")
"""Exit reasons of a goal, and of a fill job, that came to its end."""
STAGES = ("LOOK", "PRE-PACK", "INSERT", "FINE-TUNE")


class PackingPage(CellPage):
    """The packing cell's part of the page."""

    topics = Topics(
        states=(
            *PackingScene.topics.all, topics.GRIPPER_STATE, topics.WRENCH, topics.SETTLED_SAMPLES,
            *topics.DEPTH_IMAGES, SEEN,
        ),
        events=(topics.MPC_STATUS, topics.RESULT, topics.FILL_PROGRESS, topics.FILL_RESULT),
        followed=(topics.WRENCH, topics.SETTLED_SAMPLES),
    )  # fmt: skip
    scene_type = PackingScene
    presets = (
        preset_from_angles("cell", (0.4, 0.0, 0.25), 1.4, 150.0, -25.0),
        preset_from_angles("container", (0.42, 0.0, 0.16), 1.0, 150.0, -42.0),
        preset_from_angles("side", (0.45, 0.0, 0.2), 1.3, 90.0, -12.0),
        preset_from_angles("top", (0.5, 0.0, 0.1), 1.3, 180.0, -89.0),
    )

    def __init__(self, server: ViserServer, log: EventLog) -> None:
        super().__init__(server, log)
        self.scene = PackingScene(server.scene)
        self._ghosts = Ghosts(server.scene)
        self._fill, self._depth = FillPanel(), DepthPanel()
        self._stage, self._visited = "", list[str]()
        self._status: Any = None
        self._grip: Any = None
        self._force = float("nan")
        self._load = LoadShedding()

    def tabs(self) -> dict[str, Callable[[], None]]:
        """Stages and what may be pushed, plots over time, the container that is filled, and depth images."""
        add_fill = partial(self._fill.add, self.server.gui)
        add_depth = partial(self._depth.add, self.server.gui)
        return {"Task": self._add_task, "Plots": self._add_plots, "Fill": add_fill, "Cameras": add_depth}

    @property
    def is_sparing(self) -> bool:
        """Whether frames are given up, by the times of the controller's iterations."""
        return self._load.gives_up(GivenUp.FRAMES)

    def view_options(self) -> None:
        """Choose where objects are drawn, and which ghosts are."""
        gui = self.server.gui
        source = gui.add_dropdown("objects", (ESTIMATE, TRUTH, BOTH), hint="shapes and poses")
        source.on_update(lambda _: self.scene.draw_from(source.value))
        target = gui.add_checkbox("target", initial_value=True)
        target.on_update(lambda _: self._ghosts.show_target(target.value))
        samples = gui.add_checkbox("samples of the placement", initial_value=True)
        samples.on_update(lambda _: self._ghosts.show_samples(samples.value))

    def update(self, news: News) -> None:
        """Move the scene and note where the goal stands."""
        if text := news.newest(topics.DESCRIPTION):
            self._ghosts.describe(text.data)
        self.scene.update(news)
        self._depth.update(news, self.scene.perceived)
        self._grip = news.newest(topics.GRIPPER_STATE) or self._grip
        if wrench := news.newest(topics.WRENCH):
            force = wrench.wrench.force
            self._force = float(np.linalg.norm([force.x, force.y, force.z]))
            if self._status is not None:
                self._force_plot.add(seconds(wrench), self._force)
        samples = news.newest(topics.SETTLED_SAMPLES)
        if samples and not self._load.gives_up(GivenUp.SAMPLES):
            self._ghosts.set_samples(samples.samples)
        for progress in news.all(topics.FILL_PROGRESS):
            self._take_progress(parse_json(progress.data, topics.FILL_PROGRESS))
        for status in news.all(topics.MPC_STATUS):
            self._load = self._load.after(seconds(status))
            self._take_status(status)
        for topic in (topics.RESULT, topics.FILL_RESULT):
            for result in news.all(topic):
                self._take_result(parse_json(result.data, topic), news.time)
                self._load = LoadShedding()

    def show(self) -> None:
        """Bring the task and the plots up to date."""
        put(self._stage_chips, boxed(chips(STAGES, self._stage, self._visited)))
        status = self._status
        names = status.collisions if status else ()
        rows = [("→", ORANGE, name) for name in names]
        put(self._collisions, signed_list(rows, "nothing may be pushed aside now"))
        held = self._grip.object if self._grip and self._grip.is_closed else ""
        rest = [("pump", f"holds {held}" if held else "open")]
        if np.isfinite(self._force):
            rest += [("force", f"{self._force:.1f} N")]
        if status:
            rest += [("placements", str(status.placements)), ("cost", f"{status.cost:.3g}")]
            rest += [("iteration", f"{status.iteration_ms:.0f} ms")]
        put(self._values, facts(rest))
        self._fill.show()
        self._depth.show()
        for plot in (self._force_plot, *self._iteration_plots):
            plot.send()

    def forget(self) -> None:
        """Begin anew with an empty task."""
        self._stage, self._visited, self._status = "", [], None
        self._grip, self._force, self._load = None, float("nan"), LoadShedding()
        self.headline = IDLE
        self._ghosts.clear()
        self._fill.clear()
        self._depth.forget()
        self._clear_plots()

    def _take_progress(self, progress: dict[str, Any]) -> None:
        """Take up where a fill job stands; while an object is packed, the controller tells more."""
        for row in self._fill.take(progress):
            kind = "info" if row["packed"] else "warning"
            self.log.add(f"{row['name']}: {row['reason']}", kind, row["start"] + row["duration"])
        stage = str(progress["stage"]).replace("_", " ")
        self.headline = Headline(" ".join(filter(None, (stage, self._fill.object))), self._fill.in_words)
        if not self._fill.is_packing:
            self._stage, self._status = "", None
            self._ghosts.clear()

    def _take_status(self, status: Any) -> None:
        if self._fill.object and not self._fill.is_packing:
            return  # of the iteration that was on its way when the object was packed
        now, stage = seconds(status), status.stage.replace("_", "-")
        if self._status is None or status.elapsed < self._status.elapsed:  # another goal has begun
            self._visited = []
            self._clear_plots()
        if stage != self._stage or not self._visited:
            self.log.add(f"stage {stage}", time=now)
            self._visited.append(stage)
        if status.warning and (self._status is None or status.warning != self._status.warning):
            self.log.add(status.warning, "warning", now)
        self._stage, self._status = stage, status
        held = f"{self._fill.object}: " if self._fill.object else ""
        self.headline = Headline(
            stage,
            status.warning or f"{held}{100 * status.distance:.1f} cm to go, {status.elapsed:.1f} s",
        )
        self._ghosts.set_target(status.target)
        values = (100 * status.distance, status.iteration_ms, status.cost)
        for plot, value in zip(self._iteration_plots, values, strict=True):
            plot.add(now, value)

    def _clear_plots(self) -> None:
        for plot in (self._force_plot, *self._iteration_plots):
            plot.clear()

    def _take_result(self, result: dict[str, Any], time: float | None) -> None:
        reason, message = str(result.get("exit_reason", "")), str(result.get("message", ""))
        is_success = reason in ENDS
        self.log.add(f"goal ended: {message or reason}", "info" if is_success else "error", time)
        self.headline = Headline(reason or "ended", message, is_fault=not is_success)
        if not is_success:
            self._visited = [stage for stage in self._visited if stage != self._stage]  # was not got through
        self._stage, self._status = "", None
        self._fill.end()
        self._ghosts.clear()

    def _add_task(self) -> None:
        gui = self.server.gui
        self._stage_chips = gui.add_html("")
        gui.add_html(boxed(f'<div style="color:{GREY}">may be pushed aside (collision list)</div>'))
        self._collisions = gui.add_html("")
        self._values = gui.add_html("")

    def _add_plots(self) -> None:
        gui = self.server.gui
        # every iteration has its point, late ones above all
        distance = RollingPlot(gui, "distance to the target [cm]", ("distance",), period=0.0)
        self._force_plot = RollingPlot(gui, "force on the cup [N]", ("force",))
        iteration, cost = (RollingPlot(gui, title, (title,), 0.0) for title in ("iteration [ms]", "cost"))
        self._iteration_plots = (distance, iteration, cost)


PAGE = PackingPage
"""For the register of cells."""
