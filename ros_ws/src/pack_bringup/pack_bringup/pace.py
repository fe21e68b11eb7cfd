"""Whether a machine kept up with a run: simulated time with the wall clock, the controller with time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

LATE_MS = 96.0
"""An iteration that takes longer is late: two cycles of the controller, after which the driver nearly has no
setpoints left [ms of simulated time]."""
ENOUGH = 0.95
"""A machine keeps up while it achieves this share of the real-time factor that was asked for."""
BEARABLE = 0.02
"""Share of late iterations that goes without a word."""


@dataclass(frozen=True)
class Pace:
    """How fast a goal ran.

    Attributes:
        wanted: simulated seconds a second of wall clock that were asked for; 0: as fast as the machine can.
        achieved: what the simulator reported during the goal, once a second.
        iterations_ms: what the controller's iterations took [ms of wall clock]; of cells that report it.
    """

    wanted: float
    achieved: Sequence[float] = ()
    iterations_ms: Sequence[float] = ()

    @property
    def factor(self) -> float:
        """Mean real-time factor that was achieved; as wanted while none was reported."""
        return sum(self.achieved) / len(self.achieved) if self.achieved else self.wanted

    @property
    def late_share(self) -> float:
        """Share of iterations that took longer than `LATE_MS` of simulated time, from 0 to 1."""
        late = sum(ms * self.wanted > LATE_MS for ms in self.iterations_ms)
        return late / len(self.iterations_ms) if self.iterations_ms else 0.0

    @property
    def remark(self) -> str:
        """Follows the real-time factor in the line of progress; empty while the machine keeps up."""
        is_slow = bool(self.achieved) and self.achieved[-1] < ENOUGH * self.wanted
        return f" < {self.wanted:.2f}" if is_slow else ""

    @property
    def warning(self) -> str:
        """What to say at the end, and what to do about it; empty if the machine kept up."""
        said = []
        if self.factor < ENOUGH * self.wanted:
            said.append(f"time ran at {self.factor:.2f} of real time instead of {self.wanted:.2f}")
        if self.late_share > BEARABLE:
            said.append(f"{100 * self.late_share:.0f} % of the iterations took over {LATE_MS:.0f} ms")
        if not said:
            return ""
        return (
            f"This machine could not keep up: {', and '.join(said)}. "
            "The arm then moves on old plans or waits: the figures are not the controller's best. "
            f"Run it slower (--real-time-factor {self.wanted / 2:.2g}), end other programs, or use more "
            "cores."
        )
