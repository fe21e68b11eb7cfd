"""A stack as arrays, and how weight flows down it: what each box carries, and where that acts.

A box hands its weight, and that of all it carries, to the boxes under it by the shares of its contact area
that lie on each (Junqueira, Morabito, Yamashita, "Three-dimensional container loading models with cargo
stability and load bearing constraints", Computers & Operations Research 39(1), 2012). Where a stack is
statically indeterminate that is a model: real shares depend on tenths of a millimetre.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from pack_core.palletizing.orders.placed_box import TOUCH, PlacedBox
from pack_core.rotations import Array

Numbers = npt.NDArray[np.int64]
DECK = -1
"""In place of a box's number: the pallet's deck."""
SAME = 1e-6
"""Corners of contacts that are nearer than this are one [m]."""
GRAVITY = 9.81
"""Acceleration of free fall [m/s^2]."""


class Stack(NamedTuple):
    """A stack of n boxes, each after those that it rests on, with e contacts between boxes.

    Lengths and positions are in the pallet's frame P.

    Attributes:
        lower: corner of each box with the smallest coordinates `(n, 3)` [m].
        upper: the opposite corner `(n, 3)` [m].
        loads: mass of each box with all that it carries, and that times the position of the common centre
            of mass `(n, 4)` [kg, kg m].
        masses: of the boxes alone `(n,)` [kg].
        max_loads: what each may carry `(n,)` [kg]; infinite: anything.
        max_pressures: largest pressure on its top `(n,)` [kPa].
        first: the contacts of box i with boxes under it are those from `first[i]` up to `first[i + 1]`.
        under: number of the box under each contact `(e,)`.
        shares: share of the upper box's contact area that each contact has `(e,)`.
        arms: from the middle of all contacts of the upper box to the middle of each `(e, 2)` [m].
        areas: contact area under each box `(n,)` [m^2]; 0 where it floats.
        first_side: the sides of box i's support polygon are those from here up to the next.
        sides: outward unit normals of these sides, and the sides' distances from P's origin `(s, 3)` [m].
    """

    lower: Array
    upper: Array
    loads: Array
    masses: Array
    max_loads: Array
    max_pressures: Array
    first: Numbers
    under: Numbers
    shares: Array
    arms: Array
    areas: Array
    first_side: Numbers
    sides: Array


def empty_stack() -> Stack:
    """A deck without boxes."""
    none, zero = np.zeros(0), np.zeros(1, dtype=np.int64)
    return Stack(
        np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4)), none, none, none,
        zero, np.zeros(0, dtype=np.int64), none, np.zeros((0, 2)), none, zero, np.zeros((0, 3)),
    )  # fmt: skip


def with_box(stack: Stack, box: PlacedBox) -> Stack:
    """The stack with one box more; the given one stays as it is."""
    return _grown(stack, box.lower, box.upper, box.mass, box.max_load, box.max_pressure)


def stack_of(boxes: Sequence[PlacedBox]) -> tuple[Stack, tuple[PlacedBox, ...]]:
    """The stack of boxes in any sequence, and the boxes in the sequence in which it has them: from below."""
    stack, from_below = empty_stack(), tuple(sorted(boxes, key=lambda box: float(box.lower[2])))
    for box in from_below:
        stack = with_box(stack, box)
    return stack, from_below


@numba.njit(cache=True)
def contacts_of(stack: Stack, lower: Array, upper: Array) -> tuple[Numbers, Array]:
    """What a box with these corners `(3,)` [m] rests on: boxes `(k,)`, and the rectangles of contact.

    Returns:
        The numbers of the boxes, or `DECK`, and of each contact x and y of its lower and of its upper corner
        `(k, 4)` [m].
    """
    n = len(stack.lower)
    under, rectangles, count = np.empty(n + 1, dtype=np.int64), np.empty((n + 1, 4)), 0
    if lower[2] < TOUCH:
        under[0] = DECK
        rectangles[0, :2], rectangles[0, 2:] = lower[:2], upper[:2]
        return under[:1], rectangles[:1]
    for k in range(n):
        if abs(lower[2] - stack.upper[k, 2]) >= TOUCH:
            continue
        x, y = max(lower[0], stack.lower[k, 0]), max(lower[1], stack.lower[k, 1])
        x_end, y_end = min(upper[0], stack.upper[k, 0]), min(upper[1], stack.upper[k, 1])
        if x_end - x > TOUCH and y_end - y > TOUCH:
            under[count] = k
            rectangles[count, 0], rectangles[count, 1] = x, y
            rectangles[count, 2], rectangles[count, 3] = x_end, y_end
            count += 1
    return under[:count], rectangles[:count]


@numba.njit(cache=True)
def polygon_of(rectangles: Array) -> Array:
    """Sides `(s, 3)` of the convex hull of rectangles `(k, 4)`, by gift wrapping.

    A point p is inside if `sides[:, :2] @ p <= sides[:, 2]`, whose normals are outward unit vectors.
    """
    count = 4 * len(rectangles)
    p, sides, found = np.empty((count, 2)), np.empty((count, 3)), 0
    for k in range(count):
        p[k, 0], p[k, 1] = rectangles[k // 4, 2 * (k % 2)], rectangles[k // 4, 1 + 2 * (k // 2 % 2)]
    start = 0
    for k in range(count):
        if p[k, 0] < p[start, 0] or (p[k, 0] == p[start, 0] and p[k, 1] < p[start, 1]):
            start = k
    corner = start
    while found < count:
        following = _next_corner(p, corner)
        side = p[following] - p[corner]
        length = np.sqrt(side[0] ** 2 + side[1] ** 2)
        if length == 0.0:
            break
        normal = np.array([side[1], -side[0]]) / length
        sides[found, :2], sides[found, 2] = normal, normal[0] * p[corner, 0] + normal[1] * p[corner, 1]
        found, corner = found + 1, following
        if abs(p[corner, 0] - p[start, 0]) + abs(p[corner, 1] - p[start, 1]) < SAME:
            break
    return sides[:found]


@numba.njit(cache=True)
def _next_corner(p: Array, corner: int) -> int:
    """The corner of the hull of points `(n, 2)` that follows on one, counter-clockwise."""
    following, longest = corner, 0.0
    for k in range(len(p)):
        x, y = p[k, 0] - p[corner, 0], p[k, 1] - p[corner, 1]
        length = x * x + y * y
        if length < SAME**2:
            continue
        turn = (p[following, 0] - p[corner, 0]) * y - (p[following, 1] - p[corner, 1]) * x
        # All points lie left of a side; of points in one line the farthest ends it.
        if longest == 0.0 or turn < -(SAME**2) or (turn <= SAME**2 and length > longest):
            following, longest = k, length
    return following


@numba.njit(cache=True)
def margin_in(sides: Array, x: float, y: float) -> float:
    """Distance of a point from the edge of a convex polygon with these sides [m]; negative outside."""
    least = np.inf if len(sides) else -np.inf
    for k in range(len(sides)):
        least = min(least, sides[k, 2] - sides[k, 0] * x - sides[k, 1] * y)
    return float(least)


@numba.njit(cache=True)
def shares_of(rectangles: Array) -> tuple[Array, Array, float]:
    """Of each contact the share of the area `(k,)` and its arm `(k, 2)` [m]; and the area [m^2]."""
    count = len(rectangles)
    shares, arms, middle = np.empty(count), np.empty((count, 2)), np.zeros(2)
    for k in range(count):
        shares[k] = (rectangles[k, 2] - rectangles[k, 0]) * (rectangles[k, 3] - rectangles[k, 1])
        arms[k] = 0.5 * (rectangles[k, :2] + rectangles[k, 2:])
        middle += shares[k] * arms[k]
    area = shares.sum()
    return shares / max(area, 1e-12), arms - middle / max(area, 1e-12), area


@numba.njit(cache=True)
def add_load(
    stack: Stack, loads: Array, load: Array, under: Numbers, shares: Array, arms: Array
) -> None:  # fmt: skip
    """Let a box's `load` `(4,)` flow down over its contacts with boxes `under` it, into `loads` `(n, 4)`.

    The forces of a box act in the middles of its contacts, all displaced alike so that they are in balance
    with its weight: with a single box under it, right below its centre of mass.
    """
    for k in range(len(under)):
        if under[k] != DECK:
            _hand_over(loads[under[k]], load, shares[k], arms[k])
    for i in range(len(stack.lower) - 1, -1, -1):
        if loads[i, 0] > 0.0:
            for k in range(stack.first[i], stack.first[i + 1]):
                _hand_over(loads[stack.under[k]], loads[i], stack.shares[k], stack.arms[k])


@numba.njit(cache=True)
def _hand_over(to: Array, load: Array, share: float, arm: Array) -> None:
    to[0] += share * load[0]
    to[1] += share * (load[1] + load[0] * arm[0])
    to[2] += share * (load[2] + load[0] * arm[1])
    to[3] += share * load[3]


@numba.njit(cache=True)
def load_of(lower: Array, upper: Array, mass: float) -> Array:
    """Mass of a box, and that times its centre `(4,)` [kg, kg m]."""
    load = np.empty(4)
    load[0], load[1:] = mass, mass * 0.5 * (lower + upper)
    return load


@numba.njit(cache=True)
def _grown(
    stack: Stack, lower: Array, upper: Array, mass: float, max_load: float, max_pressure: float
) -> Stack:
    under, rectangles = contacts_of(stack, lower, upper)
    shares, arms, area = shares_of(rectangles)
    load, added = load_of(lower, upper, mass), np.zeros_like(stack.loads)
    add_load(stack, added, load, under, shares, arms)
    if len(under) and under[0] == DECK:
        under, shares, arms = under[:0], shares[:0], arms[:0]
    sides, n = polygon_of(rectangles), len(stack.lower)
    return Stack(
        np.concatenate((stack.lower, lower.reshape(1, 3))),
        np.concatenate((stack.upper, upper.reshape(1, 3))),
        np.concatenate((stack.loads + added, load.reshape(1, 4))),
        np.append(stack.masses, mass),
        np.append(stack.max_loads, max_load),
        np.append(stack.max_pressures, max_pressure),
        np.append(stack.first, stack.first[n] + len(under)),
        np.concatenate((stack.under, under)),
        np.concatenate((stack.shares, shares)),
        np.concatenate((stack.arms, arms)),
        np.append(stack.areas, area),
        np.append(stack.first_side, stack.first_side[n] + len(sides)),
        np.concatenate((stack.sides, sides)),
    )


@numba.njit(cache=True)
def push_of(stack: Stack, i: int, load: Array) -> float:
    """The horizontal acceleration that box i withstands, with a `load` `(4,)` of its own and all it carries.

    As a share of gravity: the distance of the common centre of mass from the edge of the support polygon,
    over the centre's height above the box's base. Negative where it topples by itself.
    """
    sides = stack.sides[stack.first_side[i] : stack.first_side[i + 1]]
    margin = margin_in(sides, load[1] / load[0], load[2] / load[0])
    return float(margin / max(load[3] / load[0] - stack.lower[i, 2], TOUCH))


@numba.njit(cache=True)
def pressure_under(load: float, area: float) -> float:
    """Pressure of a mass [kg] on a contact area [m^2], in [kPa]."""
    return 1e-3 * GRAVITY * load / max(area, 1e-12)
