"""What goes through the tree of policies, as named tuples of arrays: compiled code takes them as they are."""

from __future__ import annotations

from typing import NamedTuple

from pack_core.rotations import Array


class ArmArrays(NamedTuple):
    """An arm of n joints.

    Attributes:
        axes: of the joints where all of them are zero `(n, 3)`.
        points: on these axes `(n, 3)` [m].
        R_WT: orientation of the tool there `(3, 3)`.
        p_WT: point of the tool there `(3,)` [m].
        lower: ends of the joints' ranges `(n,)` [rad].
        upper: likewise.
        velocity: limits of the joints' speeds `(n,)` [rad/s].
    """

    axes: Array
    points: Array
    R_WT: Array
    p_WT: Array
    lower: Array
    upper: Array
    velocity: Array


class JointMotion(NamedTuple):
    """Positions [rad] and velocities [rad/s] of the joints, each `(n,)`."""

    q: Array
    v: Array


class JointGoal(NamedTuple):
    """The reference that the policies are drawn to.

    Attributes:
        q: of the reference `(n,)` [rad]; the tool's targets are where it puts the tool.
        v: likewise [rad/s].
        a: likewise [rad/s^2].
        posture: that the joints are drawn to `(n,)` [rad]: mostly `q`.
    """

    q: Array
    v: Array
    a: Array
    posture: Array


class ToolMotion(NamedTuple):
    """The tool, as it moves or as it should.

    Attributes:
        p: its point `(3,)` [m].
        R: its orientation `(3, 3)`.
        rate: linear and angular velocity `(6,)` [m/s, rad/s].
        acceleration: likewise `(6,)`; of the tool as it moves only what its speed makes, `Jdot v`.
    """

    p: Array
    R: Array
    rate: Array
    acceleration: Array


class LinkMotion(NamedTuple):
    """The links of an arm that moves.

    Attributes:
        R: displacements of the links from where all joints are zero, turn `(n, 3, 3)`.
        d: and shift `(n, 3)` [m].
        axes: of the joints in the world now `(n, 3)`.
        points: on these axes `(n, 3)` [m].
        v: velocities of the joints `(n,)` [rad/s].
    """

    R: Array
    d: Array
    axes: Array
    points: Array
    v: Array


class ObstacleBoxes(NamedTuple):
    """Boxes that the collision policy feels.

    Attributes:
        R: orientations `(k, 3, 3)`.
        p: centres `(k, 3)` [m].
        half: half edge lengths `(k, 3)` [m].
        v: velocities `(k, 3)` [m/s].
        radius: distance at which each is felt `(k,)` [m].
        counts: 1 where the distance to it is reported, 0 where not `(k,)`.
    """

    R: Array
    p: Array
    half: Array
    v: Array
    radius: Array
    counts: Array


class JointPull(NamedTuple):
    """The sum of the policies in joint space, which each adds its part to: metric `(n, n)`, force `(n,)`."""

    M: Array
    f: Array
