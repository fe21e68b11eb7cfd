"""Random visitors: people, forklifts and a second robot that cross the space around the arm."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.palletizing.visitors import Visitor, load_visitors

RANDOM = "random"
"""Name of the visitors that are drawn from the seed of a run."""
VISITORS = 13
"""Stream of random numbers of who comes and how."""
TOGETHER = 2
"""Visitors that come in one run, each again and again."""
SHOULDERS, TALL = 0.25, 1.3
"""Radius and length of a person's capsule [m]: 0.5 m wide, 1.8 m tall."""
BREAST = 0.9
"""Height of the middle of a person [m]."""


def visitors_of(name: str, seed: int) -> tuple[Visitor, ...]:
    """The visitors of a file of config/visitors, or random ones; raises ConfigError for an unknown name."""
    return random_visitors(np.random.default_rng([seed, VISITORS])) if name == RANDOM else load_visitors(name)


def random_visitors(rng: np.random.Generator) -> tuple[Visitor, ...]:
    """Two visitors of different kinds, who come again every 8 to 13 s.

    They walk and drive where the furniture lets them, as near to the arm's work as that allows, and none
    looks out for the arm. Speeds go up to 1.6 m/s on foot (ISO 13855) and 2 m/s by forklift.
    """
    kinds = rng.permutation(len(KINDS))[:TOGETHER]
    return tuple(KINDS[int(k)](rng) for k in kinds)


def _walks_in(rng: np.random.Generator) -> Visitor:
    """A person goes in between table B and the pallet, stops there, and comes out again."""
    y, x = rng.uniform(1.45, 1.75), rng.uniform(-0.1, 0.6)
    way = ((3.0, y, BREAST), (x, y, BREAST), (3.0, y, BREAST))
    return _visitor(
        rng,
        "person between",
        way,
        rng.uniform(0.8, 1.6),
        pause=rng.uniform(0.5, 2.5),
        radius=SHOULDERS,
        length=TALL,
    )


def _walks_past(rng: np.random.Generator) -> Visitor:
    """A person goes along the pallet's far end and table B."""
    x = rng.uniform(0.95, 1.25)
    way = ((x, -2.5, BREAST), (x, 3.5, BREAST))
    return _visitor(rng, "person passing", way, rng.uniform(0.8, 1.6), radius=SHOULDERS, length=TALL)


def _drives_up(rng: np.random.Generator) -> Visitor:
    """A forklift's mast comes up to the pallet's long side, stands, and backs off."""
    x, y = rng.uniform(-0.3, 0.4), rng.uniform(-0.8, -0.65)
    way = ((x, -3.5, 1.1), (x, y, 1.1), (x, -3.5, 1.1))
    return _visitor(
        rng, "forklift", way, rng.uniform(1.0, 2.0), radius=0.4, length=1.4, pause=rng.uniform(0.5, 2.0)
    )


def _reaches_in(rng: np.random.Generator) -> Visitor:
    """The forearm of a second robot reaches over the way between table B and the pallet."""
    y, z, length = rng.uniform(1.5, 2.0), rng.uniform(1.1, 1.6), rng.uniform(1.0, 1.4)
    tip = rng.uniform(0.1, 0.4)
    near = tip + 0.5 * length + 0.15
    way = ((near + 1.5, y + 0.2, z), (near, y, z), (near + 1.5, y + 0.2, z))
    return _visitor(
        rng, "second robot", way, rng.uniform(0.6, 1.2), radius=0.15, length=length, axis=(1.0, 0.0, 0.0),
        pause=rng.uniform(0.2, 1.0),
    )  # fmt: skip


def _visitor(
    rng: np.random.Generator, name: str, path: tuple[tuple[float, ...], ...], speed: float, *,
    radius: float, length: float, axis: tuple[float, float, float] = (0.0, 0.0, 1.0), pause: float = 0.0,
) -> Visitor:  # fmt: skip
    return Visitor.model_validate({
        "name": name, "path": path, "speed": speed, "radius": radius, "length": length, "axis": axis,
        "pause": pause, "start": rng.uniform(1.0, 6.0), "period": rng.uniform(8.0, 13.0),
    })  # fmt: skip


KINDS: tuple[Callable[[np.random.Generator], Visitor], ...] = (
    _walks_in, _walks_past, _drives_up, _reaches_in
)  # fmt: skip
