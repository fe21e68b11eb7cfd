"""Physical facts of the packing cell: `config/cells/packing.yaml`."""

from __future__ import annotations

from functools import cache
from typing import Annotated

from pydantic import Field, PositiveFloat

from pack_core.config import Config, load_values, merged, parse_values, validate_config
from pack_core.packing.scene import Scene
from pack_core.paths import config_path
from pack_core.robots.arm_drive import ArmDrive
from pack_core.robots.pump import Pump

Point = tuple[float, float, float]


class Suction(Config):
    """Load at which the cup lets go: pull [N], shear [N] and bending moment [N m]; .inf never."""

    pull: PositiveFloat
    shear: PositiveFloat
    moment: PositiveFloat


class Tip(Config):
    """Compliance of the cup, between the pump's stem and what it holds.

    Attributes:
        lateral: stiffness across the cup's axis [N/m].
        axial: along it [N/m].
        bending: about the axes across it [N m/rad].
        twist: about it [N m/rad].
        damping_time: damping over stiffness, the same in every direction [s].
    """

    lateral: PositiveFloat
    axial: PositiveFloat
    bending: PositiveFloat
    twist: PositiveFloat
    damping_time: PositiveFloat


class MocapCameras(Config):
    """The motion capture system.

    Attributes:
        cameras: where they are [m].
        target: where they all look [m].
        half_angle_deg: half their field of view.
        has_side_markers: whether objects have markers on two sides too, not only on the top.
    """

    cameras: Annotated[list[Point], Field(min_length=2)]
    target: Point
    half_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    has_side_markers: bool


class PackingCell(Config):
    """The packing cell."""

    robot: ArmDrive
    pump: Pump
    suction: Suction
    tip: Tip | None
    """None: what is held is fixed to the cup."""
    mocap: MocapCameras
    scene: Scene
    """The five objects, the container and the new object, without poses."""

    def with_arm(self, model: str) -> PackingCell:
        """The same cell with another arm, for pictures: start and gains stay those of the arm before."""
        return self.model_copy(update={"robot": self.robot.model_copy(update={"model": model})})


@cache
def packing_cell(over: str = "{}") -> PackingCell:
    """The packing cell as configured.

    Args:
        over: YAML that lies over config/cells/packing.yaml, with the keys that differ.

    Raises:
        ConfigError: a key or value is not allowed.
    """
    path, source = config_path("cells", "packing.yaml"), "what lies over the packing cell"
    facts = merged(load_values(path), parse_values(over, source))
    return validate_config(PackingCell, facts, str(path) if over == "{}" else f"{path} and {source}")
