"""Parameters of a run in lockstep: those of the nodes, changed by a preset, and how long planning takes."""

from __future__ import annotations

from typing import TypeVar

import yaml
from pydantic import BaseModel, Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.presets import Preset, Section, read_preset
from pack_lockstep.node_parameters import load_parameters
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_perception.perception_config import PerceptionConfig
from pack_planner.placement.placement_planner import PlacementPlannerConfig
from pack_sim.packing.simulator import SimulatorConfig

C = TypeVar("C", bound=BaseModel)


class PackingPreset(Preset):
    """Differences from the configuration files of the packing cell.

    Attributes:
        sim: overrides config/nodes/packing/sim.yaml; the other nodes likewise.
    """

    sim: Section = Field(default_factory=dict)
    perception: Section = Field(default_factory=dict)
    planner: Section = Field(default_factory=dict)
    mpc: Section = Field(default_factory=dict)

    def packing_cell(self) -> PackingCell:
        """The packing cell with this preset's changes."""
        return packing_cell(yaml.safe_dump(self.cell), self.layers("cell"))

    def parameters(self, node: str, cls: type[C]) -> C:
        """A core's configuration: its node's parameter file with this preset's changes.

        Raises:
            ConfigError: the preset names a parameter that the core does not have.
        """
        own: Section = getattr(self, node)
        if unknown := sorted(set(own) - set(cls.model_fields)):
            allowed = ", ".join(cls.model_fields)
            place = self.place(node, unknown[0])
            raise ConfigError(f"{place}: '{node}' has no {', '.join(unknown)}; allowed: {allowed}")
        return load_parameters(f"packing/{node}", cls, own, self.layers(node))


def load_preset(name: str) -> PackingPreset:
    """The preset `config/presets/packing/<name>.yaml`; raises ConfigError."""
    return read_preset(PackingPreset, "packing", name)


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
    estimator: PerceptionConfig = PerceptionConfig()
    planner: PlacementPlannerConfig = PlacementPlannerConfig()
    session: FillSessionConfig = FillSessionConfig()


def lockstep_config(preset: PackingPreset | None = None) -> LockstepConfig:
    """The configuration of all nodes from `config/nodes`, with a preset's changes."""
    given = preset or PackingPreset()
    return LockstepConfig(
        simulator=given.parameters("sim", SimulatorConfig),
        estimator=given.parameters("perception", PerceptionConfig),
        planner=given.parameters("planner", PlacementPlannerConfig),
        session=given.parameters("mpc", FillSessionConfig),
    )
