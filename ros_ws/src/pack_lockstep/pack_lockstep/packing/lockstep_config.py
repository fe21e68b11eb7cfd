"""Parameters of a run in lockstep: those of the nodes, and how long planning takes on the simulated clock."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_lockstep.packing.presets import PackingPreset
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_perception.mocap.physics_estimator import EstimatorConfig
from pack_planner.placement.placement_planner import PlacementPlannerConfig
from pack_sim.packing.simulator_config import SimulatorConfig


class LockstepConfig(Config):
    """Parameters of a run; those of the parts are the nodes' own parameters."""

    latency: PositiveFloat = Field(
        default=0.048, description="an optimizer iteration takes [s of simulated time]"
    )
    placement_latency: NonNegativeFloat = Field(
        default=0.3, description="Algorithm 1 takes [s of simulated time]"
    )
    rehearsal_latency: NonNegativeFloat = Field(
        default=0.003, description="and so much each rehearsal of an entry [s of simulated time]"
    )
    settle: PositiveFloat = Field(
        default=0.3, description="before the goal, so that everything has been seen [s]"
    )
    simulator: SimulatorConfig = SimulatorConfig()
    estimator: EstimatorConfig = EstimatorConfig()
    planner: PlacementPlannerConfig = PlacementPlannerConfig()
    session: FillSessionConfig = FillSessionConfig()


def lockstep_config(preset: PackingPreset | None = None) -> LockstepConfig:
    """The configuration of all nodes from `config/nodes`, with a preset's changes."""
    given = preset or PackingPreset()
    return LockstepConfig(
        simulator=given.parameters("sim", SimulatorConfig),
        estimator=given.parameters("perception", EstimatorConfig),
        planner=given.parameters("planner", PlacementPlannerConfig),
        session=given.parameters("mpc", FillSessionConfig),
    )
