"""Where a box can stand on a stack, and what each place costs: candidate places, their rank, and what holds.

A box is let down from above at candidate places: the corners that boxes, which stand already, leave (the
extreme points of Crainic, Perboli, Tadei, "Extreme point-based heuristics for three-dimensional bin
packing", INFORMS J. on Computing 20(3), 2008, seen from above, from both sides).
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from pack_core.palletizing.orders.placed_box import TOUCH
from pack_core.palletizing.orders.stack import (
    DECK,
    Numbers,
    Stack,
    add_load,
    contacts_of,
    load_of,
    margin_in,
    polygon_of,
    pressure_under,
    push_of,
    shares_of,
)
from pack_core.rotations import Array

TOUCHING = 0.003
"""Sides that are nearer than the gap and this much touch, by the rule of the most touching area [m]."""

STEP = 1e-4
"""Places are on a grid of this step, so that those that differ by rounding are one [m]."""
SAME = 1e-3
"""A place that is off the grid by less than this share of a step is on it."""


class Room(NamedTuple):
    """Where boxes may stand.

    Attributes:
        length: of the area that may be covered, along x [m].
        width: along y [m].
        highest: of the stack over the deck [m].
        gap: free distance between neighbours [m].
    """

    length: float
    width: float
    highest: float
    gap: float


class PlaceCosts(NamedTuple):
    """What a place costs: a weighted sum, of which the lowest is taken.

    Attributes:
        untouched: of the share of the box's base and sides that touches nothing; the deck's edge counts as
            touched (the touching perimeter of Lodi, Martello, Vigo, INFORMS J. on Computing 11(4), 1999).
        top: of the height of the box's top [1/m].
        base: of the height of its base [1/m].
        surface: of the surface of the block around the stack [1/m^2] (the least-surface-area heuristic of Hu
            et al., "Solving a new 3D bin packing problem with deep reinforcement learning method", 2017).
        near: of the sum of x and y of its corner [1/m].
        dead: of the room over a box on which nothing may stand [1/m^3].
    """

    untouched: float = 0.0
    top: float = 0.0
    base: float = 0.0
    surface: float = 0.0
    near: float = 0.0
    dead: float = 0.0


class Needs(NamedTuple):
    """What a place must give.

    Attributes:
        share: of the box's base that must be carried, 0 to 1.
        margin: distance of the box's centre of mass from the edge of its support polygon [m].
        push: horizontal acceleration that the box, and each box under it with all that it then carries,
            withstands by the closed tipping rule, as a share of gravity; negative: any.
    """

    share: float
    margin: float
    push: float


@numba.njit(cache=True)
def places_of(stack: Stack, size: Array, room: Room) -> Array:
    """Lower corners `(m, 3)` [m] at which a box of `size` `(3,)` comes to rest when it is let down."""
    xs = _coordinates(stack.lower[:, 0], stack.upper[:, 0], size[0], room.length, room.gap)
    ys = _coordinates(stack.lower[:, 1], stack.upper[:, 1], size[1], room.width, room.gap)
    places, count = np.empty((len(xs) * len(ys), 3)), 0
    grown = room.gap - TOUCH  # a box is in the way if, seen from above, it is nearer than the gap
    for x in xs:
        for y in ys:
            z = 0.0
            for k in range(len(stack.lower)):
                is_under = (
                    stack.upper[k, 2] > z
                    and x < stack.upper[k, 0] + grown and x + size[0] > stack.lower[k, 0] - grown
                    and y < stack.upper[k, 1] + grown and y + size[1] > stack.lower[k, 1] - grown
                )  # fmt: skip
                if is_under:
                    z = stack.upper[k, 2]
            if z + size[2] <= room.highest + TOUCH:
                places[count, 0], places[count, 1], places[count, 2] = x, y, z
                count += 1
    return places[:count]


@numba.njit(cache=True)
def _coordinates(lower: Array, upper: Array, edge: float, length: float, gap: float) -> Array:
    """Where a box may begin along one axis: at a border, flush with a box, or a gap beside one."""
    # A place beside a box is rounded away from it, as nearer than the gap it is one on top; one at the far
    # border inwards.
    after = STEP * np.ceil((upper + gap) / STEP - SAME)
    before = np.append(lower - gap, length) - edge
    before = STEP * np.floor(before / STEP + SAME)
    wished = np.concatenate((np.zeros(1), lower, upper - edge, after, before))
    rounded = np.unique(np.round(wished, 4))
    return rounded[(rounded >= -TOUCH) & (rounded + edge <= length + TOUCH)]


@numba.njit(cache=True)
def costs_of(
    stack: Stack, size: Array, bears: bool, places: Array, room: Room, costs: PlaceCosts
) -> Array:  # fmt: skip
    """What each of the places `(m, 3)` costs a box of `size` `(3,)` that `bears` others or not, `(m,)`."""
    found, low, high = np.empty(len(places)), np.full(3, np.inf), np.zeros(3)
    for k in range(len(stack.lower)):
        low, high = np.minimum(low, stack.lower[k]), np.maximum(high, stack.upper[k])
    for m in range(len(places)):
        p = places[m]
        top = p[2] + size[2]
        cost = costs.top * top + costs.base * p[2] + costs.near * (p[0] + p[1])
        if costs.surface > 0.0:
            length = max(high[0], p[0] + size[0]) - min(low[0], p[0])
            width = max(high[1], p[1] + size[1]) - min(low[1], p[1])
            cost += 2.0 * costs.surface * (length * width + (length + width) * max(high[2], top))
        if costs.untouched > 0.0:
            cost += costs.untouched * (1.0 - _touched_share(stack, size, p, room))
        if not bears:
            cost += costs.dead * size[0] * size[1] * (room.highest - top)
        found[m] = cost
    return found


@numba.njit(cache=True)
def _touched_share(stack: Stack, size: Array, p: Array, room: Room) -> float:
    """Share of a box's base and sides that touches boxes, the deck, or the deck's edge."""
    near, touched = room.gap + TOUCHING, 0.0
    base = size[0] * size[1]
    for k in range(2):
        side = size[1 - k] * size[2]
        length = room.length if k == 0 else room.width
        touched += side * ((p[k] < near) + (p[k] + size[k] > length - near))
    if p[2] < TOUCH:
        touched += base
    for k in range(len(stack.lower)):
        shared = np.empty(3)
        for j in range(3):
            ends = min(p[j] + size[j], stack.upper[k, j]), max(p[j], stack.lower[k, j])
            shared[j] = ends[0] - ends[1]  # negative: the distance between both
        if abs(p[2] - stack.upper[k, 2]) < TOUCH and shared[0] > 0.0 and shared[1] > 0.0:
            touched += shared[0] * shared[1]
        elif shared[2] > 0.0:
            if shared[0] > 0.0 and -near < shared[1] <= TOUCH:
                touched += shared[0] * shared[2]
            elif shared[1] > 0.0 and -near < shared[0] <= TOUCH:
                touched += shared[1] * shared[2]
    return float(touched / (base + 2.0 * (size[0] + size[1]) * size[2]))


@numba.njit(cache=True)
def first_standing(
    stack: Stack, sizes: Array, places: Array, order: Numbers, start: int, mass: float, needs: Needs
) -> int:
    """Where in `order` `(m,)` from `start` on the first place is at which a box stands; m: there is none.

    Args:
        stack: what stands already.
        sizes: the box's extents at each place `(m, 3)` [m].
        places: its lower corner at each place `(m, 3)` [m].
        order: numbers of the places, the cheapest first `(m,)`.
        start: where in `order` to begin.
        mass: of the box [kg].
        needs: what the place must give.
    """
    for position in range(start, len(order)):
        m = order[position]
        if stands(stack, places[m], places[m] + sizes[m], mass, needs):
            return position
    return len(order)


@numba.njit(cache=True)
def stands(stack: Stack, lower: Array, upper: Array, mass: float, needs: Needs) -> bool:
    """Whether a box would stand, nothing under it would tip, and nothing would carry more than it may."""
    under, rectangles = contacts_of(stack, lower, upper)
    if len(under) == 0:
        return False
    shares, arms, area = shares_of(rectangles)
    if area < needs.share * (upper[0] - lower[0]) * (upper[1] - lower[1]) - 1e-9:
        return False
    centre = 0.5 * (lower + upper)
    margin = margin_in(polygon_of(rectangles), centre[0], centre[1])
    if margin < max(needs.margin, needs.push * 0.5 * (upper[2] - lower[2])):
        return False
    if under[0] == DECK:
        return True
    load, added = load_of(lower, upper, mass), np.zeros_like(stack.loads)
    for k in under:
        if pressure_under(mass, area) > stack.max_pressures[k]:
            return False
    add_load(stack, added, load, under, shares, arms)
    for i in range(len(stack.lower)):
        if added[i, 0] > 0.0 and not _bears(stack, i, stack.loads[i] + added[i], needs.push):
            return False
    return True


@numba.njit(cache=True)
def _bears(stack: Stack, i: int, load: Array, push: float) -> bool:
    """Whether box i, with a `load` `(4,)` of its own and all it carries, neither tips nor overloads a box."""
    if load[0] - stack.masses[i] > stack.max_loads[i] or push_of(stack, i, load) < push:
        return False
    for k in range(stack.first[i], stack.first[i + 1]):
        if pressure_under(load[0], stack.areas[i]) > stack.max_pressures[stack.under[k]]:
            return False
    return True
