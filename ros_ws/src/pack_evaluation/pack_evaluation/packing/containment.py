"""Whether the held object ends inside the container (section II)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import to_matrix
from pack_evaluation.packing.run import Run

TOLERANCE = 0.003
"""An object contained may stick out by this [m]: contact gives way by fractions of a millimetre, and under
`hardware` the true sizes of object and container differ from the described ones by 2 and 3 mm."""


@dataclass(frozen=True)
class Containment:
    """Where the object is at the end, from its true pose and the described sizes.

    Attributes:
        protrusion: how far the object reaches beyond the inner faces of the walls, horizontally and at any
            height, so a part that leans over the rim counts, too [m]; 0: nowhere.
        top_over_rim: height of its highest point above the walls [m]; negative: below.
        centre_over_rim: height of its centre above the walls [m].
        tilt: angle between its z axis and the vertical [rad].
    """

    protrusion: float
    top_over_rim: float
    centre_over_rim: float
    tilt: float

    @property
    def is_contained(self) -> bool:
        """Whether it stands between the walls and its centre is below their rim.

        The paper's condition (section II) with its height threshold h_max at the rim. An object taller than
        the container, as the paper's own, may look out at the top.
        """
        return self.protrusion <= TOLERANCE and self.centre_over_rim < 0.0


def containment(run: Run) -> Containment:
    """Where the held object truly is when the goal ends."""
    X_WO = run.truth[run.held].at(np.array([run.end])).pose(0)
    hull = X_WO.apply(run.scene.new_object.hull())
    container = run.scene.container
    beyond = np.maximum(container.lower - hull[:, :2], hull[:, :2] - container.upper)
    # R[2, 2] is the cosine of the tilt; rounding may take it over 1
    cosine = float(np.clip(to_matrix(X_WO.q)[2, 2], -1.0, 1.0))
    return Containment(
        protrusion=max(0.0, float(beyond.max())),
        top_over_rim=float(hull[:, 2].max()) - container.height,
        centre_over_rim=float(X_WO.p[2]) - container.height,
        tilt=math.acos(cosine),
    )
