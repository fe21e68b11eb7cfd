"""A run of two boxes whose errors are known."""

import numpy as np

from pack_core.rotations import IDENTITY, Pose, exp
from pack_core.states import Source
from pack_evaluation.palletizing.run import BoxRecord, PalletRun, StateVisit, ToolTrack
from pack_evaluation.track import Track

TIMES = np.arange(0.0, 40.0, 0.1)
GOALS = {"a": np.array([0.1, 0.2, 0.3]), "b": np.array([0.5, 0.2, 0.3])}


def track(name: str, offsets: dict[float, list[float]], angle_deg: float = 0.0) -> Track:
    """A box at its goal, displaced by the offset [m] of the last time that has passed."""
    p = np.array([GOALS[name] + offsets[max(t for t in offsets if t <= time)] for time in TIMES])
    q = np.tile(exp([0.0, 0.0, np.radians(angle_deg)]), (len(TIMES), 1))
    return Track(TIMES, p, q, np.full(len(TIMES), Source.TRUTH, dtype=np.uint8))


def a_run(**changes: object) -> PalletRun:
    p = np.zeros((len(TIMES), 3))
    q = np.tile(IDENTITY, (len(TIMES), 1))
    tool = ToolTrack(TIMES, np.zeros((len(TIMES), 6)), p, q, p + np.array([0.0, 0.0003, 0.0004]), q)
    visits = [
        StateVisit("0 spawn", 0.0, "a"),
        StateVisit("17 pre deposit", 8.0, "a"),
        StateVisit("19 retreat", 10.0, "a"),
        StateVisit("17 pre deposit", 20.0, "b"),
        StateVisit("19 retreat", 22.0, "b"),
    ]
    boxes = [
        BoxRecord(name, (0.4, 0.3, 0.2), 5.0, "none", "placed", "", "Center", Pose(p))
        for name, p in GOALS.items()
    ]
    tracks = {
        "a": track("a", {0.0: [-2.0, 2.0, 0.5], 10.0: [0.0, 0.0, 0.002], 10.5: [0.0, 0.0, 0.0]}),
        "b": track("b", {0.0: [-2.0, 2.0, 0.5], 22.0: [0.0, 0.001, 0.0]}),
    }
    values = {
        "order": "test", "seed": 0, "reason": "", "boxes": tuple(boxes), "visits": tuple(visits),
        "tool": tool, "tracks": tracks, "touches": (), "cycles": {"a": 10.0, "b": 12.0},
        "grip_peaks": {"a": (50.0, 20.0, 5.0)},
    }  # fmt: skip
    return PalletRun(**(values | changes))
