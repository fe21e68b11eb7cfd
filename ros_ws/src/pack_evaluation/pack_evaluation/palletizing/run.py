"""A run of the palletizing cell as arrays, whether it comes from a recording or from lockstep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.rotations import Array, Pose
from pack_evaluation.goals import RecordedRun
from pack_evaluation.track import Track


@dataclass(frozen=True)
class StandingCell:
    """The cell as it truly stands.

    Attributes:
        cell: with tables and pallet where they are.
        X_WB: pose of the arm's base; None: where it should be.
    """

    cell: PalletizingCell = field(default_factory=palletizing_cell)
    X_WB: Pose | None = None


@dataclass(frozen=True)
class ToolTrack:
    """The tool at n moments.

    Attributes:
        times: the moments `(n,)` [s].
        joints: measured joint positions `(n, 6)` [rad].
        p_ref: commanded positions `(n, 3)` [m].
        q_ref: commanded orientations wxyz `(n, 4)`.
        p: positions by the measured joints `(n, 3)` [m].
        q: orientations by the measured joints, wxyz `(n, 4)`.
        p_true: positions by the true angles of the links `(n, 3)` [m], the arm's base being where it is taken
            to be; None where they are not known, as in a recording.
    """

    times: Array
    joints: Array
    p_ref: Array
    q_ref: Array
    p: Array
    q: Array
    p_true: Array | None = None


def tool_track(times: Array, q_ref: Array, q: Array, q_true: Array | None = None) -> ToolTrack:
    """The commanded and the measured tool poses at `times` `(n,)` from joint positions `(n, 6)` [rad].

    Args:
        times: the moments [s].
        q_ref: commanded.
        q: measured.
        q_true: true angles of the links, where they are known.
    """
    p_true = None if q_true is None else _poses(q_true)[0]
    return ToolTrack(times, q, *_poses(q_ref), *_poses(q), p_true)


def _poses(rows: Array) -> tuple[Array, Array]:
    """Positions `(n, 3)` and quaternions wxyz `(n, 4)`."""
    chain = arm_kinematics().chain
    poses = [chain.forward_matrix(row) for row in rows]
    rotations = Rotation.from_matrix(np.array([R for R, _ in poses]))
    return np.array([p for _, p in poses]), rotations.as_quat(scalar_first=True)


@dataclass(frozen=True)
class WayPoint:
    """A target at which the machine stopped: the measured tool's errors when its checker confirmed it.

    Attributes:
        state: label of the state.
        position_mm: distance of the tool from the target [mm].
        orientation_deg: angle to it [deg].
    """

    state: str
    position_mm: float
    orientation_deg: float


@dataclass(frozen=True)
class SentTarget:
    """A target that the machine sent: when [s], and the pose of the tool at the end of its move."""

    time: float
    X_WT: Pose


@dataclass(frozen=True)
class VisitorTrack:
    """A visitor at n moments.

    Attributes:
        times: the moments `(n,)` [s].
        distance: from the arm and what it carries `(n,)` [m]: the true one, or in a recording the one that
            the arm's controller went by.
    """

    times: Array
    distance: Array


@dataclass(frozen=True)
class SeparationTrack:
    """The margin of speed and separation monitoring at n moments, as the arm's controller computed it.

    Attributes:
        times: the moments `(n,)` [s].
        margin: distance less protective separation distance of the body with the least `(n,)` [m]; infinite
            while nobody is seen.
        is_under_way: whether the arm's reference moved `(n,)`; it does not while the arm only makes room.
    """

    times: Array
    margin: Array
    is_under_way: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class StateVisit:
    """The machine entered a state: its label, when [s], for which box, and why if it is a fault."""

    state: str
    time: float
    box: str
    reason: str = ""


@dataclass(frozen=True)
class BoxRecord:
    """The outcome of a box.

    Attributes:
        name: name of the box.
        dims: edge lengths as it arrives [m].
        mass: mass of the box [kg].
        handling: none, flip or table.
        outcome: placed, skipped, lost or pending.
        reason: why it was skipped or lost; empty otherwise.
        direction: direction from which it was inserted.
        X_WB: its planned pose.
        weighed: its mass by the arm's torques after the last grip [kg]; None where it was not weighed.
    """

    name: str
    dims: tuple[float, float, float]
    mass: float
    handling: str
    outcome: str
    reason: str
    direction: str
    X_WB: Pose
    weighed: float | None = None


@dataclass(frozen=True)
class UnwantedTouch:
    """Two bodies touched that should not have: when [s], which, and the largest force [N]."""

    time: float
    bodies: tuple[str, str]
    force: float


@dataclass(frozen=True)
class PalletRun(RecordedRun):
    """Everything that is measured of a run.

    Attributes:
        order: id of the order.
        seed: seed of the run.
        reason: why it stopped before its end; empty if it did not.
        boxes: in the sequence of the plan.
        visits: states in the order in which they were entered.
        tool: commanded and measured tool poses.
        tracks: true poses of the boxes by name.
        touches: contacts that should not have been.
        cycles: cycle time of each box, by name [s].
        grip_peaks: largest coaxial force, shear force [N] and moment [N m] of each box's grips, by name.
        interruptions: how often setpoints came too late and the driver held the arm in a move.
        way_points: errors at the targets of the machine, in order; empty where they were not recorded.
        visitors: who came near the arm, by name; empty where nobody did or it was not recorded.
        separation: the margin kept from them; None where it was not recorded.
        stands: where everything truly was.
        slow: from when to when the motion was in the mode SLOW [s], in order.
        targets: what the machine sent the motion, in order; empty where it was not recorded.
    """

    order: str
    seed: int
    reason: str
    boxes: tuple[BoxRecord, ...]
    visits: tuple[StateVisit, ...]
    tool: ToolTrack
    tracks: Mapping[str, Track]
    touches: tuple[UnwantedTouch, ...]
    cycles: Mapping[str, float]
    grip_peaks: Mapping[str, tuple[float, float, float]]
    interruptions: int = 0
    visitors: Mapping[str, VisitorTrack] = field(default_factory=dict)
    separation: SeparationTrack | None = None
    way_points: tuple[WayPoint, ...] = ()
    stands: StandingCell = field(default_factory=StandingCell)
    slow: tuple[tuple[float, float], ...] = ()
    targets: tuple[SentTarget, ...] = ()


def intervals(times: Sequence[float], holds: Sequence[bool]) -> tuple[tuple[float, float], ...]:
    """From when to when something held that held, or not, from each of some times to the next one [s]."""
    found: list[tuple[float, float]] = []
    for (start, end), does_hold in zip(pairwise(times), holds, strict=False):
        if does_hold and found and found[-1][1] == start:
            found[-1] = found[-1][0], end
        elif does_hold:
            found.append((start, end))
    return tuple(found)
