"""Algorithm 1 up to line 9: poses are sampled, settled by physics, and rated by what they disturb (Eq. 6).

SamplePose draws upright poses on the base. The new object is teleported to each of them, the scene is
simulated without the arm until overlapping objects part, and what moved is the cost.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import fitting_yaws
from pack_core.packing.model import HeldRole
from pack_core.packing.scene import Container, Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, yaw_of
from pack_core.states import SceneState
from pack_planner.placement.approach import ApproachConfig
from pack_planner.placement.batch_physics import BatchPhysics
from pack_planner.placement.feasibility import FeasibilityConfig, judge
from pack_planner.placement.placement_result import PlacementCandidate, PlacementSamples


class PlacementConfig(Config):
    """Parameters of Algorithm 1, the paper's values by default."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    samples: PositiveInt = Field(300, description="sampled poses S")
    steps: PositiveInt = Field(30, description="steps M in which overlaps must resolve")
    timestep: PositiveFloat = Field(0.006, description="step of the physics [s]")
    weights: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat] = Field(
        (1.0, 1.0, 10.0), description="w_x, w_y, w_z on the objects' displacements"
    )
    beta: NonNegativeFloat = Field(1000.0, description="weight of lasting penetration [1/m]")
    resting_penetration: PositiveFloat = Field(
        0.001, description="depth [m] up to which two objects touch; what is deeper has not resolved"
    )
    threads: NonNegativeInt = Field(0, description="threads of the physics; 0: all cores")
    near_samples: PositiveInt = Field(40, description="poses that are tried about one that is wanted")
    near_deviation: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.004, 0.03), description="standard deviation of these poses: position [m] and yaw [rad]"
    )
    near_weight: NonNegativeFloat = Field(
        3.0, description="cost of a distance from the one that is wanted, beside the displacements of others"
    )
    feasibility: FeasibilityConfig = FeasibilityConfig()
    approach: ApproachConfig = ApproachConfig()


class Settling:
    """The scene without the arm, simulated for many poses of the new object at once.

    Objects are numbered as in the scene, the new object last.
    """

    def __init__(self, scene: Scene, cell: PackingCell, timestep: float, threads: int) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self.names = [*scene.names, scene.new_object.name]
        self._physics = BatchPhysics(scene, cell, timestep=timestep, held=HeldRole.FREE, threads=threads)

    def start(self, poses: dict[str, Pose]) -> Array:
        """The state `(nstate,)` with the objects at rest at X_WO."""
        return self._physics.state(poses)

    def teleport(self, state: Array, poses: Array) -> Array:
        """States `(n, nstate)` equal to `state` except for the new object's pose `(n, 7)`."""
        states = np.tile(state, (len(poses), 1))
        self._object_poses(states)[:, -1] = poses
        return states

    def settle(self, states: Array, steps: int) -> Array:
        """States `(n, nstate)` after `steps` steps without controls."""
        return np.array(self._physics.rest(states, steps)[:, -1])

    def poses(self, states: Array) -> Array:
        """X_WO of every object `(n, objects, 7)`."""
        return self._object_poses(states).copy()

    def penetrations(self, state: Array) -> dict[tuple[str, str], float]:
        """Deepest penetration [m] of every pair of geoms that touch."""
        return self._physics.penetrations(state)

    def _object_poses(self, states: Array) -> Array:
        """A view `(n, objects, 7)` of the free joints' positions."""
        # the objects' free joints are adjacent in the state, in the order of `names`
        first = self._physics.column(self.names[0])
        return states[:, first : first + 7 * len(self.names)].reshape(len(states), -1, 7)


class PlacementEvaluation:
    """Teleports the new object to sampled poses, simulates until overlaps resolve, and rates the result.

    Args:
        scene: container and objects; their poses do not matter.
        cell: the cell's physical facts.
        config: parameters.

    Raises:
        PackError: the new object does not fit into the container.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self.scene, self._config = scene, config
        fitting_yaws(scene.new_object, scene.container, 0.0)
        self._settling = Settling(scene, cell, config.timestep, config.threads)

    def start(self, state: SceneState) -> tuple[dict[str, Pose], Array]:
        """X_WO of every object, and the physics state `(nstate,)` with all of them at rest there.

        Raises:
            PackError: `state` lacks an object, or has one that the scene does not know.
        """
        poses, known = state.poses(), self._settling.names
        wrong = {
            "lacks": [name for name in known if name not in poses],
            "has unknown": [name for name in poses if name not in known],
        }
        for what, names in wrong.items():
            if names:
                raise PackError(f"the scene's state {what} {names}; the cell's description has {known}")
        return poses, self._settling.start(poses)

    def sample(self, poses: Mapping[str, Pose], rng: np.random.Generator, near: Pose | None = None) -> Array:
        """Random poses `(S, 7)` at which the new object stands in the container, whatever it overlaps.

        Args:
            poses: X_WO of every object.
            rng: source of the samples.
            near: X_WN that is wanted: it is the first pose, the others are scattered about it; None: any.
        """
        new, container, config = self.scene.new_object, self.scene.container, self._config
        if near is None:
            return sample_poses(new, container, config.samples, yaw_of(poses[new.name].q), rng)
        about = sample_near(near, new, container, config.near_samples, config.near_deviation, rng)
        return np.vstack([[*near.p, *near.q], about])

    def evaluate(self, now: Array, sampled: Array, near: Pose | None = None) -> tuple[PlacementSamples, str]:
        """Settle poses `(S, 7)` of the new object, and compute their costs and feasibility.

        Args:
            now: the physics state `(nstate,)` before.
            sampled: poses to which the new object is teleported.
            near: the pose X_WN that is wanted, whose distance adds to the cost; None: any.

        Returns:
            The samples, and the reason to give if none of them is feasible.
        """
        teleported = self._settling.teleport(now, sampled)
        states = self._settling.settle(teleported, self._config.steps)
        before, settled = self._settling.poses(teleported), self._settling.poses(states)
        resting = self._config.resting_penetration
        penetration = np.array([self.penetration(row, resting) for row in states])
        costs = self.disturbance(before, settled) + self._config.beta * penetration
        if near is not None:
            aside = settled[:, -1, :2] - near.p[:2]  # the new object is the last
            costs += self._config.near_weight * np.linalg.norm(aside, axis=1)
        verdict = judge(self.scene, settled, penetration, self._config.feasibility)
        names = tuple(self._settling.names)
        return PlacementSamples(names, sampled, settled, costs, verdict.is_feasible), verdict.reason()

    def candidate(self, now: Array, pose: Array, cost: float) -> PlacementCandidate:
        """A pose `(7,)` of the new object with the objects that it overlaps in the state `now`."""
        teleported = self._settling.teleport(now, pose[None])[0]
        depths = self._settling.penetrations(teleported)
        new = self.scene.new_object.name
        overlapped = {n for pair, depth in depths.items() if new in pair and depth > 0.0 for n in pair}
        collisions = tuple(name for name in self.scene.names if name in overlapped)
        return PlacementCandidate(Pose(pose[:3], pose[3:]), collisions, float(cost))

    def disturbance(self, before: Array, settled: Array) -> Array:
        """First term of Eq. 6 `(S,)`: sum of the weighted displacements of all objects `(S, objects, 7)`."""
        displacements = (settled - before)[..., :3] * np.array(self._config.weights)
        return np.asarray(np.linalg.norm(displacements, axis=-1).sum(axis=-1))

    def at_rest(self, scene: Array) -> Array:
        """The physics state `(nstate,)` with all objects at rest at X_WO `(objects, 7)`, the new one last."""
        names = self._settling.names
        return self._settling.start({n: Pose(x[:3], x[3:]) for n, x in zip(names, scene, strict=True)})

    def penetration(self, state: Array, resting: float) -> float:
        """K of Eq. 6 [m]: depth summed over touching pairs, each less `resting` [m].

        The paper takes nothing off. With the depth of a resting contact, as objects that stand sink in a
        little, they count as parted.
        """
        depths = np.array(list(self._settling.penetrations(state).values()))
        return float(np.maximum(depths - resting, 0.0).sum())


def sample_poses(
    item: SceneItem, container: Container, n: int, yaw: float, rng: np.random.Generator
) -> Array:
    """Uniformly random poses at which the object stands on the base between the walls.

    Of yaws at which the object looks the same, only the one nearest to `yaw` is drawn: the range is zero for
    a cylinder, a quarter turn for a square box and half a turn for other boxes.

    Args:
        item: the object.
        container: where it is to stand.
        n: number of poses.
        yaw: the object's present yaw [rad].
        rng: the source of randomness.

    Returns:
        Poses `(n, 7)`: position [m], quaternion wxyz.

    Raises:
        PackError: the object is too large for the container.
    """
    yaws = rng.choice(fitting_yaws(item, container, yaw), n)
    room = 0.5 * np.array(container.size) - item.half_spans(yaws)
    return _standing(item, container, room * rng.uniform(-1.0, 1.0, (n, 2)), yaws)


def sample_near(
    X_WN: Pose,
    item: SceneItem,
    container: Container,
    n: int,
    deviation: tuple[float, float],
    rng: np.random.Generator,
) -> Array:
    """Upright poses `(n, 7)` scattered about X_WN and kept between the walls.

    Args:
        X_WN: where the object stands.
        item: the object.
        container: where it is to stand.
        n: number of poses.
        deviation: standard deviations of the position [m] and of the yaw [rad].
        rng: the source of randomness.
    """
    yaws = yaw_of(X_WN.q) + deviation[1] * rng.normal(size=n)
    room = np.maximum(0.5 * np.array(container.size) - item.half_spans(yaws), 0.0)
    offsets = X_WN.p[:2] - container.centre + deviation[0] * rng.normal(size=(n, 2))
    return _standing(item, container, np.clip(offsets, -room, room), yaws)


def _standing(item: SceneItem, container: Container, offsets: Array, yaws: Array) -> Array:
    """Poses `(n, 7)` on the base, at offsets `(n, 2)` [m] from its middle."""
    poses = np.zeros((len(yaws), 7))
    poses[:, :2] = np.array(container.centre) + offsets
    poses[:, 2] = item.half_extents[2]
    # w and z of the quaternion of a rotation about z
    poses[:, 3], poses[:, 6] = np.cos(yaws / 2), np.sin(yaws / 2)
    return poses
