"""A calibration of the palletizing cell: where everything is, how sure that is, and its file."""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import Field, NonNegativeFloat

from pack_core.camera import LensDistortion
from pack_core.config import Config, load_config
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.displacement import Displacement
from pack_core.robots.gears import GearCompensation

Pair = tuple[float, float]


class CalibratedCamera(Config):
    """The overhead camera as it was found."""

    displacement: Displacement
    focal_scale: float
    centre_shift: Pair
    lens: LensDistortion


class Estimate(Config):
    """One estimated number."""

    name: str
    value: float
    sigma: NonNegativeFloat
    """Standard deviation."""
    unit: str


class Residuals(Config):
    """How well one kind of measurement fits the estimate."""

    name: str
    count: int
    rms: NonNegativeFloat
    expected: NonNegativeFloat
    """Standard deviation that the measurement is known to have."""
    worst: NonNegativeFloat
    unit: str

    @property
    def ratio(self) -> float:
        """The rms as a multiple of what was expected."""
        return self.rms / self.expected


class PlacingError(Config):
    """Distance of boxes from their places [mm]."""

    mean: NonNegativeFloat
    p95: NonNegativeFloat


class CellCalibration(Config):
    """Everything that a calibration found; the arm's base defines the world."""

    preset: str
    """The preset under which the cell was calibrated."""
    camera: CalibratedCamera
    picking_table: Displacement
    reorientation_table: Displacement
    pallet: Displacement
    gears: GearCompensation
    predicted: PlacingError = Field(
        description="what boxes placed with this calibration are expected to have"
    )
    simulated_s: NonNegativeFloat
    """Time that the calibration took [s]."""
    estimates: tuple[Estimate, ...]
    covariance: tuple[tuple[float, ...], ...]
    """Of the estimates, in their sequence."""
    residuals: tuple[Residuals, ...]

    def applied(self, cell: PalletizingCell) -> PalletizingCell:
        """The cell as it is known by this calibration."""
        places = {
            name: getattr(cell, name).model_copy(update={"displacement": getattr(self, name)})
            for name in ("picking_table", "reorientation_table", "pallet")
        }
        found = {name: getattr(self.camera, name) for name in CalibratedCamera.model_fields}
        return cell.model_copy(update={**places, "camera": cell.camera.model_copy(update=found)})

    def write(self, path: Path) -> None:
        """Write it as YAML."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml.safe_dump(self.model_dump(mode="json"), sort_keys=False))


def load_calibration(path: Path) -> CellCalibration:
    """Read a calibration file; raises ConfigError."""
    return load_config(CellCalibration, path)
