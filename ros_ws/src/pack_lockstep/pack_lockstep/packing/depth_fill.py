"""A fill job without markers: the container's content is seen by depth cameras, anew for each object."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import FillMethod
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_lockstep.packing.benchmark import FillSetup, ListJob, PackingFillBenchmark
from pack_lockstep.packing.fill_lockstep import FillLockstep, FillResult
from pack_lockstep.packing.lockstep import LockstepCell
from pack_lockstep.packing.lockstep_config import LockstepConfig, load_preset, lockstep_config
from pack_mpc.filling.requests import FillRequest, Pack, Packed, Present, Presented
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_sim.packing.simulator import Simulator


@dataclass(frozen=True)
class ContentLook:
    """How many objects were in the container, how many a look saw, and how many of them it found."""

    objects: int
    seen: int
    found: int

    @property
    def is_right(self) -> bool:
        """Whether it saw all objects and nothing else."""
        return self.objects == self.seen == self.found


@dataclass(frozen=True)
class DepthFillResult(FillResult):
    """A job's result, and what was seen before each object was packed.

    Attributes:
        looks: into the container, one before each object that was packed.
    """

    looks: tuple[ContentLook, ...]

    def measures(self) -> dict[str, Any]:
        """Plain values for the file of results, as `FillResult` has them, with the number of right looks."""
        right = sum(look.is_right for look in self.looks)
        return {**super().measures(), "looks": len(self.looks), "right_looks": right}


LOOK_PATIENCE = 0.5
"""Longest wait for a look before an object is packed [s]: some images."""
LOOK_STEP = 0.02
"""Time between two questions whether it was made [s]."""


class SeenSimulator:
    """The simulator, whose content is described as perception knows it."""

    def __init__(self, cell: LockstepCell) -> None:
        self._cell = cell

    def __getattr__(self, name: str) -> Any:
        return getattr(self._cell.simulator, name)

    @property
    def description(self) -> Scene:
        """The scene as perception knows it."""
        return self._cell.known_scene


class DepthFillLockstep(FillLockstep):
    """Runs one list by what depth cameras see; see `FillLockstep`.

    An object that is handed over is described and announced, as the cameras see the hand-over place at the
    edge of a picture at most: how it hangs is seen over the container. What is in the container is looked for
    anew while the arm is beside it to grip the next one.

    Attributes:
        looks: into the container so far.
    """

    def __init__(
        self, cell: PackingCell, given: PackingList, config: LockstepConfig, method: FillMethod, seed: int
    ) -> None:
        super().__init__(cell, given, config, method, seed)
        self.simulator = cast(Simulator, SeenSimulator(self.cell))
        self.looks: list[ContentLook] = []

    def _serve(self, request: FillRequest, on_step: Callable[[FillLockstep], None] | None) -> object:
        if not isinstance(request, Present):
            return super()._serve(request, on_step)
        if reason := self.cell.simulator.present(request.item):
            return Presented(None, reason)
        self.cell.estimator.change_scene(self.cell.simulator.description)
        return Presented(self.cell.known_scene)

    def _pack(self, request: Pack, on_step: Callable[[FillLockstep], None] | None) -> Packed:
        """Look into the container, then run a packing goal to its outcome."""
        estimator, start = self.cell.estimator, self.cell.simulator.time
        assert isinstance(estimator, DepthEstimator)
        while not estimator.knows_objects and self.cell.simulator.time - start < LOOK_PATIENCE:
            self.cell.advance(LOOK_STEP)
        self.job.follow(self.cell.known_scene)
        there, seen = self.cell.simulator.scene.objects, self.cell.seen()
        self.looks.append(ContentLook(len(there), len(seen.poses), len(seen.objects)))
        return super()._pack(request, on_step)

    def result(self) -> DepthFillResult:
        """The job's report, what is true, and how right the looks were."""
        return DepthFillResult(**vars(super().result()), looks=tuple(self.looks))


def run_depth_list(setup: FillSetup, job: ListJob) -> tuple[ListJob, FillResult, float]:
    """Pack one list to its end; the result depends on nothing but the arguments."""
    started = time.perf_counter()
    lockstep = DepthFillLockstep(setup.cell, job.given, setup.config, setup.method, job.seed)
    lockstep.run()
    return job, lockstep.result(), time.perf_counter() - started


@dataclass(frozen=True)
class DepthFillBenchmark(PackingFillBenchmark):
    """Fills many containers by what depth cameras see."""

    def settings(self) -> Mapping[str, Any]:
        """Everything that decides the results; threads do not."""
        given = dict(super().settings())
        config = self.setup.config.model_dump(mode="json")
        cell = self.setup.cell.model_dump(mode="json")
        given["config"]["estimator"] = config["estimator"]
        return {**given, "cell": cell}

    @property
    def work(self) -> Callable[[ListJob], tuple[ListJob, FillResult, float]]:
        """The function that packs a list to its end."""
        return partial(run_depth_list, self.setup)


def depth_fill_setup(method: FillMethod, preset: str, threads: int) -> FillSetup:
    """Read what the settings of a benchmark without markers refer to; raises ConfigError."""
    given = load_preset(preset)
    given = given.over("mpc", {"controller": {"threads": threads}}).over("planner", {"threads": threads})
    return FillSetup(method, preset, given.packing_cell(), lockstep_config(given))
