"""Parameters of the physics estimator."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_perception.mocap.axis_fit import AxisFitConfig
from pack_perception.mocap.correction_law import CorrectionConfig
from pack_perception.mocap.grip_tracker import GripConfig
from pack_perception.mocap.rigid_body_fit import FitConfig


class EstimatorConfig(Config):
    """Parameters of the physics estimator and of its parts."""

    step: float = Field(default=0.004, gt=0, le=0.008, description="longest step of the physics [s]")
    max_gap: PositiveFloat = Field(
        default=0.5, description="longest gap between joint samples; after a longer one it starts over [s]"
    )
    mocap_age: PositiveFloat = Field(
        default=0.03, description="age of a fit without physics up to which a pose counts as MOCAP [s]"
    )
    correction: CorrectionConfig = CorrectionConfig()
    fit: FitConfig = FitConfig()
    axis_fit: AxisFitConfig = AxisFitConfig()
    grip: GripConfig = GripConfig()
