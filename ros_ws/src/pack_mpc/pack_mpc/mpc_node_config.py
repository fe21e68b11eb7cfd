"""Parameters of the node `mpc`."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from pack_mpc.session import SessionConfig
from pack_mpc.worker import WorkerConfig


class MpcNodeConfig(SessionConfig):
    """Parameters of the node `mpc`."""

    worker: WorkerConfig = WorkerConfig()
    watched: tuple[str, ...] = Field(
        default=("sim", "perception", "planner", "recorder"), description="the arm holds while one is silent"
    )
    fault_time: PositiveFloat = Field(default=1.0, description="silence that ends a goal [s of wall clock]")
