"""Parameters of a run in lockstep: those of the nodes, changed by a preset, and how long planning takes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config, load_config, merged, validate_config
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.paths import config_path
from pack_lockstep.node_parameters import parameters_of
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_perception.mocap.physics_estimator import EstimatorConfig
from pack_planner.placement.placement_planner import PlacementPlannerConfig
from pack_sim.packing.simulator import SimulatorConfig

C = TypeVar("C", bound=BaseModel)
Section = dict[str, Any]
SECTIONS = ("cell", "sim", "perception", "planner", "mpc")


class PackingPreset(Config):
    """Differences from the configuration files, by the keys of these files.

    Attributes:
        base: the preset that this one changes; empty: none.
        cell: overrides config/cells/packing.yaml.
        sim: overrides config/nodes/packing/sim.yaml; the other nodes likewise.
    """

    base: str = ""
    cell: Section = Field(default_factory=dict)
    sim: Section = Field(default_factory=dict)
    perception: Section = Field(default_factory=dict)
    planner: Section = Field(default_factory=dict)
    mpc: Section = Field(default_factory=dict)

    def over(self, section: str, values: Mapping[str, Any]) -> PackingPreset:
        """A copy of the preset in which `values` override one of its sections."""
        return self.model_copy(update={section: merged(getattr(self, section), values)})

    def packing_cell(self) -> PackingCell:
        """The packing cell with this preset's changes."""
        return packing_cell(yaml.safe_dump(self.cell))

    def parameters(self, node: str, cls: type[C]) -> C:
        """A core's configuration: its node's parameter file with this preset's changes.

        Raises:
            ConfigError: the preset names a parameter that the core does not have.
        """
        own: Section = getattr(self, node)
        if unknown := sorted(set(own) - set(cls.model_fields)):
            allowed = ", ".join(cls.model_fields)
            raise ConfigError(f"preset: '{node}' has no {', '.join(unknown)}; allowed: {allowed}")
        given, source = parameters_of(f"packing/{node}")
        known = {key: value for key, value in given.items() if key in cls.model_fields}
        return validate_config(cls, merged(known, own), f"{source} with a preset")


def load_preset(name: str, above: tuple[str, ...] = ()) -> PackingPreset:
    """The preset `config/presets/<name>.yaml`, over the one that it names as its base.

    Args:
        name: of the file.
        above: presets that lie over this one, the uppermost first.

    Raises:
        ConfigError: there is none, it has a section that is not allowed, or it is its own base.
    """
    if name in above:
        raise ConfigError(f"presets are based on each other in a ring: {' on '.join((*above, name))}")
    path = config_path("presets", f"{name}.yaml")
    if not path.is_file():
        known = ", ".join(sorted(item.stem for item in path.parent.glob("*.yaml")))
        wanted = f", the base of '{above[-1]}'" if above else ""
        raise ConfigError(f"no preset '{name}'{wanted}; allowed: {known} (files in {path.parent})")
    preset = load_config(PackingPreset, path)
    if not preset.base:
        return preset
    base = load_preset(preset.base, (*above, name))
    return preset.model_copy(update={s: merged(getattr(base, s), getattr(preset, s)) for s in SECTIONS})


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
