"""What the packing cell's benchmarks share: one controller, set up once for all trials."""

from __future__ import annotations

from typing import ClassVar, Protocol

from pack_lockstep.benchmarking.benchmark import Benchmark, JobT, ResultT
from pack_lockstep.packing.lockstep_config import LockstepConfig


class ControlledSetup(Protocol):
    """Settings with everything that they refer to."""

    @property
    def name(self) -> str:
        """Short name for tables: method and conditions."""

    @property
    def config(self) -> LockstepConfig:
        """Parameters of all nodes."""


class ControlledBenchmark(Benchmark[JobT, ResultT]):
    """A benchmark of the packing cell.

    Attributes:
        setup: the same for all trials.
    """

    cell: ClassVar[str] = "packing"
    setup: ControlledSetup

    @property
    def threads(self) -> int:
        """Number of threads that the controller of each trial plans with."""
        return self.setup.config.session.controller.threads

    @property
    def folder_name(self) -> str:
        """The setup's name: method and conditions."""
        return self.setup.name.replace(" ", "_")
