"""Which objects are in the state: those that something reaches within the horizon.

The cost of a rollout grows with every object in the model, and that of finite differences with every
component of the state, but an object that nothing reaches within the horizon changes nothing. As in online
state vector reduction (Russell and others, arXiv 2408.11665, 2024) what takes part is decided anew in every
iteration: here object by object, from the rollouts of the iteration before, whatever optimizer they are of.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveInt

from pack_core.config import Config
from pack_core.packing.model import HELD_POSITION, HELD_X_AXIS, HELD_Z_AXIS
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, to_matrix
from pack_mpc.plant import Layout, PackingPlant

MOVED = 0.002
"""An object that goes further aside than this in the median of rollouts moves, and may reach others [m]."""

SAMPLES = 10
"""Samples of a rollout that are looked at: from one to the next, 0.06 s, nothing goes far."""


class StateReductionConfig(Config):
    """When objects enter the model of the optimizer, and when they leave it."""

    margin: NonNegativeFloat = Field(
        default=0.02,
        description="an object is in the state if the rollouts bring something nearer to it than this, in "
        "their median; .inf: every object always [m]",
    )
    linger: PositiveInt = Field(
        default=5, description="iterations out of reach after which an object leaves the state"
    )


@dataclass(frozen=True)
class SweptBox:
    """A box along the axes of the world, from its corner `lower` to its corner `upper`, each `(3,)` [m]."""

    lower: Array
    upper: Array

    @classmethod
    def of(cls, p: Array, R: Array, item: SceneItem) -> SweptBox:
        """What an item sweeps in the median of rollouts.

        Args:
            p: its positions in B rollouts at T times `(B, T, 3)` [m].
            R: its orientations `(B, T, 3, 3)`.
            item: its shape and size.
        """
        # |R| h is the half span along the world's axes of a box with half extents h
        spans = np.abs(R) @ item.half_extents
        lower, upper = (p - spans).min(axis=1), (p + spans).max(axis=1)
        return cls(np.median(lower, axis=0), np.median(upper, axis=0))

    def joined(self, other: SweptBox) -> SweptBox:
        """The smallest box that holds both."""
        return SweptBox(np.minimum(self.lower, other.lower), np.maximum(self.upper, other.upper))

    def is_within(self, margin: float, other: SweptBox) -> bool:
        """Whether the two are nearer to each other than `margin` [m] along every axis."""
        gaps = np.maximum(self.lower - other.upper, other.lower - self.upper)
        return bool(np.all(gaps < margin))


class StateReduction:
    """Chooses the objects of a plant's model before each iteration.

    The first iteration has all of them. An object enters at once when it comes within reach, and leaves when
    it has been out of reach for some iterations, so that it does not come and go.

    Args:
        plant: the model of the optimizer, with all objects.
        config: parameters.
    """

    def __init__(self, plant: PackingPlant, config: StateReductionConfig) -> None:
        self._plant, self._config = plant, config
        self._items = {item.name: item for item in plant.scene.objects}
        self._whole = plant.layout
        # The first iteration decides, as every object has been out of reach for all but one already.
        self._out_of_reach = dict.fromkeys(self._items, config.linger - 1)
        self._swept: dict[str, SweptBox] = {}
        if self.is_active:
            plant.watch = self._note

    @property
    def is_active(self) -> bool:
        """Whether there is anything to choose."""
        return bool(self._items) and np.isfinite(self._config.margin)

    def reduce(self, x: Array) -> Array:
        """The state `(nx,)` to plan from, of the state `x` with all objects.

        The plant has the chosen objects from now on, until the next call.
        """
        if movers := self._movers():
            self._choose(x, movers)
            self._plant.include(self.names)
        self._swept.clear()
        return self._plant.part(x)

    @property
    def names(self) -> list[str]:
        """Names of the objects in the state."""
        return [name for name, count in self._out_of_reach.items() if count < self._config.linger]

    def _choose(self, x: Array, movers: list[SweptBox]) -> None:
        """Count for how long each object has been out of reach of what the last rollouts moved."""
        for name, item in self._items.items():
            p, q = _poses(self._whole, name, x)
            here = SweptBox.of(p[None, None], to_matrix(q)[None, None], item)
            is_reached = any(box.is_within(self._config.margin, here) for box in movers)
            self._out_of_reach[name] = 0 if is_reached else self._out_of_reach[name] + 1

    def _movers(self) -> list[SweptBox]:
        """What the held object sweeps, and what is swept by objects that it moves, or that these move."""
        others, held = dict(self._swept), self._plant.scene.new_object.name
        found = [others.pop(held)] if held in others else []
        # The list grows while it is gone through, until nothing more is near to what is in it.
        for mover in found:
            near = [name for name, box in others.items() if mover.is_within(self._config.margin, box)]
            found += [others.pop(name) for name in near]
        return found

    def _note(self, xs: Array, ys: Array) -> None:
        """Note what moves in rollouts with states `(B, T + 1, nx)` and outputs `(B, T + 1, ny)`."""
        plant, every = self._plant, max(1, xs.shape[1] // SAMPLES)
        # what diverged ends without numbers
        is_sane = np.isfinite(xs[:, -1]).all(axis=1) & np.isfinite(ys[:, -1]).all(axis=1)
        xs, ys = xs[is_sane, ::every], ys[is_sane, ::every]
        if not len(xs):
            return
        p, x, z = (ys[..., plant.sensor(name)] for name in (HELD_POSITION, HELD_X_AXIS, HELD_Z_AXIS))
        self._add(plant.scene.new_object, p, np.stack([x, np.cross(z, x), z], axis=-1))
        for item in plant.scene.objects:
            p, q = _poses(plant.layout, item.name, xs)
            # only aside, as in a model with soft contacts all objects sink a little under their own weight
            ways = np.linalg.norm((p - p[:, :1])[..., :2], axis=2).max(axis=1)
            if np.median(ways) > MOVED:
                self._add(item, p, to_matrix(q))

    def _add(self, item: SceneItem, p: Array, R: Array) -> None:
        box, last = SweptBox.of(p, R, item), self._swept.get(item.name)
        self._swept[item.name] = box if last is None else last.joined(box)


def _poses(layout: Layout, name: str, xs: Array) -> tuple[Array, Array]:
    """Positions `(..., 3)` and quaternions `(..., 4)` of an object in states `(..., nx)`."""
    first = int(layout.object_p[name][0])
    return xs[..., first : first + 3], xs[..., first + 3 : first + 7]
