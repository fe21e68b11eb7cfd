"""Calls ruckig, again with a slightly smaller jerk where it fails by rounding."""

from __future__ import annotations

import ruckig

SHARES = (1.0, 0.9997, 0.998, 0.99)
"""Shares of the jerk limit that are tried: ruckig may fail for limits at which a phase just vanishes."""


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
