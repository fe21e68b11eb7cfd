"""Ruckig, asked again where rounding stands in its way."""

from __future__ import annotations

import ruckig

SHARES = (1.0, 0.9997, 0.998, 0.99)
"""Of the jerk: where a phase is just about to vanish, ruckig may find nothing for the very limits given."""


def fastest(request: ruckig.InputParameter) -> ruckig.Trajectory | None:
    """The fastest trajectory for a request, or None where there is none."""
    jerk = list(request.max_jerk)
    for share in SHARES:
        request.max_jerk = [share * limit for limit in jerk]
        found = ruckig.Trajectory(len(jerk))
        try:
            outcome = ruckig.Ruckig(len(jerk)).calculate(request, found)
        except ruckig.RuckigError:
            continue
        if outcome in (ruckig.Result.Working, ruckig.Result.Finished):
            return found
    return None
