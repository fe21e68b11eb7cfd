"""What is given up where a machine is too slow for a goal, in which order, and when it is taken up again.

Each goal begins with nothing given up. Whoever hears of the controller's iterations comes to the same level:
the controller itself, the page, and the evaluation of a recording. Nothing else has to be told.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum

LATE = 0.07
"""An iteration that begins so long after the one before is late [s of simulated time]: the driver, which
waits 0.1 s for setpoints, would not bear much more."""
IN_TIME = 0.062
"""An iteration is in time again below this period [s]: above the 0.06 s between two iterations while a
placement is being planned, below `LATE`, so that the level does not flicker."""
PAUSE = 0.5
"""A longer period tells nothing of the machine [s]: the arm was held, or another goal has begun."""
CALM = 1.0
"""For so long all iterations must be in time before something is taken up again [s]."""


class GivenUp(IntEnum):
    """How much is given up; each level gives up what the levels before it do, too."""

    NOTHING = 0
    FRAMES = 1
    """The page draws few frames a second."""
    SAMPLES = 2
    """The page draws no settled samples of placements."""
    REHEARSALS = 3
    """Placements are planned without rehearsed entries (Algorithm 1 alone)."""
    ROLLOUTS = 4
    """An iteration of the optimizer perturbs fewer parameters."""


@dataclass(frozen=True)
class LoadShedding:
    """What the machine's load makes a goal give up, by the times of the controller's iterations.

    Attributes:
        level: what is given up now.
        time: of the newest iteration [s]; None before the first.
        since: when an iteration was late, or the level last fell [s].
    """

    level: GivenUp = GivenUp.NOTHING
    time: float | None = None
    since: float = 0.0

    def after(self, time: float) -> LoadShedding:
        """The load once another iteration has begun, from the state measured at `time` [s]."""
        period = PAUSE if self.time is None else time - self.time
        if not 0.0 < period < PAUSE:
            return replace(self, time=time, since=time)
        if period > LATE:
            return LoadShedding(GivenUp(min(self.level + 1, max(GivenUp))), time, time)
        since = self.since if period < IN_TIME else time
        if time - since > CALM:
            return LoadShedding(GivenUp(max(self.level - 1, 0)), time, time)
        return replace(self, time=time, since=since)

    def gives_up(self, what: GivenUp) -> bool:
        """Whether this is given up now."""
        return self.level >= what

    @property
    def in_words(self) -> str:
        """What is given up; empty if nothing is."""
        names = ", ".join(what.name.lower() for what in GivenUp if 0 < what <= self.level)
        return f"given up, as the machine is busy: {names}" if names else ""


def given_up(times: Iterable[float]) -> list[GivenUp]:
    """The level after each of a goal's iterations, which began at these times [s]."""
    load, levels = LoadShedding(), []
    for time in times:
        load = load.after(time)
        levels.append(load.level)
    return levels
