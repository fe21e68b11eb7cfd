"""A calibration of the palletizing cell: where everything is, how sure that is, and its file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import yaml
from pydantic import NonNegativeFloat

from pack_core.calibration_file import load_calibration_of, parse_calibration_of
from pack_core.camera import LensDistortion, PinholeCamera
from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.robots.joint_properties import GearCompensation

Pair = tuple[float, float]


class CalibratedCamera(Config):
    """The overhead camera as it was found."""

    displacement: Displacement
    focal_scale: float
    centre_shift: Pair
    lens: LensDistortion


class EstimatedNumber(Config):
    """One estimated number."""

    name: str
    value: float
    sigma: NonNegativeFloat
    """Standard deviation."""
    unit: str


class FitResiduals(Config):
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
    predicted: PlacingError
    """What boxes that are placed with this calibration are expected to have."""
    simulated_s: NonNegativeFloat
    """Time that the calibration took [s]."""
    estimates: tuple[EstimatedNumber, ...]
    covariance: tuple[tuple[float, ...], ...]
    """Of the estimates, in their sequence."""
    residuals: tuple[FitResiduals, ...]

    def applied(self, cell: PalletizingCell) -> PalletizingCell:
        """The cell as it is known by this calibration."""
        places = {
            name: getattr(cell, name).model_copy(update={"displacement": getattr(self, name)})
            for name in ("picking_table", "reorientation_table", "pallet")
        }
        found = {name: getattr(self.camera, name) for name in CalibratedCamera.model_fields}
        return cell.model_copy(update={**places, "camera": cell.camera.model_copy(update=found)})

    def to_yaml(self) -> str:
        """The text of its file."""
        return yaml.safe_dump(self.model_dump(mode="json"), sort_keys=False)

    def write(self, path: Path) -> None:
        """Write its file."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(self.to_yaml())


def parse_calibration(text: str, source: str) -> CellCalibration:
    """Read the text of a calibration file, which `source` names in errors; raises ConfigError."""
    return parse_calibration_of("palletizing", CellCalibration, text, source)


def load_calibration(path: Path) -> CellCalibration:
    """Read a calibration file; raises ConfigError."""
    return load_calibration_of("palletizing", CellCalibration, path)


@dataclass(frozen=True)
class KnownCell:
    """The cell as its nodes know it, and the calibration that they know it by, if there is one."""

    cell: PalletizingCell
    calibration: CellCalibration | None

    def camera(self, told: PinholeCamera) -> PinholeCamera:
        """The overhead camera with the intrinsics that it tells, or that a calibration has found."""
        if self.calibration is None:
            return told
        return self.cell.overhead_camera.scaled(told.width)

    def check_gap(self, gap: float) -> None:
        """Refuse gaps between boxes that are too narrow for how well the cell is known [m].

        Raises:
            ConfigError: the preset asks for a calibration, there is none, and the gap is too narrow.
        """
        needed = self.cell.imperfections.uncalibrated_gap
        if self.calibration is None and gap < needed:
            raise ConfigError(
                f"the cell is not calibrated: under preset '{self.cell.preset}' boxes may stand centimetres "
                "from their places. Calibrate it (pack calibrate palletizing) and give the file, or leave "
                f"gaps of {1e3 * needed:.0f} mm between boxes (layout.separator.gap is {1e3 * gap:.1f} mm)"
            )


def known_cell(preset: str, calibration: str) -> KnownCell:
    """The cell under a preset, by a calibration file; an empty name stands for none.

    Raises:
        ConfigError: there is no such preset, the file cannot be read, or it is of another preset.
    """
    cell = palletizing_cell(preset)
    if not calibration:
        return KnownCell(cell, None)
    found = load_calibration(Path(calibration))
    if found.preset != preset:
        raise ConfigError(f"{calibration}: made under preset '{found.preset}', and this cell has '{preset}'")
    return KnownCell(found.applied(cell), found)
