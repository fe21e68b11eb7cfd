"""Beam search over the number of actions: layer by layer, the most promising states of each."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.rotations import Array
from pack_planner.rearrangement.beam.estimates import cycles, standing_on_goals
from pack_planner.rearrangement.beam.expansion import expand
from pack_planner.rearrangement.beam.spots import GOAL, NO_GO, Ints
from pack_planner.rearrangement.beam.states import (
    NO_STAGE,
    BlockMove,
    Children,
    History,
    States,
    follow,
    occupy,
)
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.footprints import Words

TRAVEL_WEIGHT = 1e-3
"""Of a metre of travel against an action: travel decides between plans of one length."""

Indices = npt.NDArray[np.int64]
Pending = list[tuple[States, Children, Indices]]


@dataclass(frozen=True)
class Beam:
    """The limits of one round of the search.

    Attributes:
        width: states kept of a layer.
        longest: actions that a plan may have.
        cheapest: a plan must cost less than this, in pick-and-place actions, see PushPrice.
        breadth: buffer poses tried for a block in a state.
        is_anyone: blocks may make way though they are in nobody's way.
        noise: of the states' ranks, in actions.
    """

    width: int
    longest: int
    cheapest: float = np.inf
    breadth: int = 4
    is_anyone: bool = False
    noise: float = 0.0


@dataclass(frozen=True)
class Round:
    """How a round went: the moves of the cheapest plan found, and how many states were expanded."""

    moves: list[BlockMove] | None
    expanded: int


def root_state(tables: Tables, spots: npt.NDArray[np.int16]) -> States:
    """The layer of one state with blocks at spots `(n,)`."""
    occupied = np.zeros((1, tables.pick.shape[2]), dtype=np.uint64)
    occupy(occupied[0], NO_GO)
    for spot in spots.tolist():
        occupy(occupied[0], spot)
    circles = cycles(standing_on_goals(spots, tables.crowds), np.uint64(2 ** len(spots) - 1))
    return States(
        occupied, spots[None], np.zeros(1, np.int32), np.zeros(1), np.zeros(1), tables.poses[spots[:1], :2],
        np.array([circles], np.int32), np.zeros(1, np.uint64),
    )  # fmt: skip


def run_round(
    root: States,
    tables: Tables,
    order: Ints,
    beam: Beam,
    is_over: Callable[[], bool],
    rng: np.random.Generator,
) -> Round:
    """Search one round, layer after layer, and return the cheapest plan found.

    The first plan found has the fewest actions, and where a push costs no more than another action it is the
    cheapest, so the search ends with it. Where a push costs more, a longer plan with fewer or shorter pushes
    may be cheaper: the search goes on through the layers that can still hold one.
    """
    n = root.spot.shape[1]
    history, expanded = History(), 0
    moves, cheapest = None, beam.cheapest
    # A power of two at least twice the states that can be kept, so that the hash table stays half empty.
    seen = np.zeros(1 << int(np.ceil(np.log2(2 * beam.width * (beam.longest + 1)))), dtype=np.uint64)
    pending: defaultdict[int, Pending] = defaultdict(list)
    layer: States | None = root
    for depth in range(beam.longest + 1):
        if depth:
            coming = _affordable(pending.pop(depth, []), cheapest - depth)
            layer = _next_layer(coming, beam, tables, history, seen, rng)
        if is_over():
            break
        if layer is None:
            continue
        done = np.flatnonzero((layer.spot == GOAL + np.arange(n)).all(axis=1))
        if len(done):
            best = done[np.lexsort((layer.travel[done], layer.premium[done]))[0]]
            moves, cheapest = history.moves(int(layer.node[best])), depth + float(layer.premium[best])
        # A plan of k actions costs at least k, so a cheaper one has at most ceil(cheapest) - 1 of them.
        limit = int(min(beam.longest, np.ceil(cheapest) - 1)) - depth
        if limit < 0:
            break
        children = expand(layer, tables, order, beam.breadth, limit, beam.is_anyone)
        expanded += len(layer.node)
        # Putting down at a staging pose and pushing are two actions, so such children skip a layer.
        is_staged = children.moves[:, 3] != NO_STAGE
        pending[depth + 1].append((layer, children, np.flatnonzero(~is_staged)))
        pending[depth + 2].append((layer, children, np.flatnonzero(is_staged)))
    return Round(moves, expanded)


def _next_layer(
    pending: Pending, beam: Beam, tables: Tables, history: History, seen: Words, rng: np.random.Generator
) -> States | None:
    """The best children of earlier layers that take as many actions, of states not met before."""
    if not sum(len(indices) for _, _, indices in pending):
        return None
    keys = np.concatenate([_rank(children, indices) for _, children, indices in pending])
    if beam.noise:
        keys += rng.uniform(0.0, beam.noise, len(keys))
    hashes = np.concatenate([children.hash[indices] for _, children, indices in pending])
    kept = select(keys, hashes, beam.width, seen)
    if not len(kept):
        return None
    layers, first = [], 0
    for states, children, indices in pending:
        own = indices[kept[(kept >= first) & (kept < first + len(indices))] - first]
        first += len(indices)
        nodes = history.add(states.node, children, own)
        layers.append(follow(states, children, own, nodes, tables.poses))
    return (
        layers[0]
        if len(layers) == 1
        else States(*(np.concatenate(part) for part in zip(*layers, strict=True)))
    )


def _affordable(pending: Pending, budget: float) -> Pending:
    """The children from which a plan can still end for less than `budget`, in pick-and-place actions."""
    if np.isinf(budget):
        return pending
    return [(s, children, i[_least(children, i) < budget]) for s, children, i in pending]


def _least(children: Children, indices: Indices) -> Array:
    """Price of the actions left, at least, with the premium of the pushes so far `(len(indices),)`."""
    premium = children.premium[indices] + children.premium_left[indices]
    return np.asarray(children.bound[indices] + premium)


def _rank(children: Children, indices: Indices) -> Array:
    """Estimated price of the actions left, with the premium so far; travel decides between equals."""
    left = _least(children, indices) + children.detours[indices]
    return np.asarray(left + TRAVEL_WEIGHT * children.travel[indices])


def select(keys: Array, hashes: Words, width: int, seen: Words) -> Indices:
    """Indices of up to `width` of the smallest keys with different hashes, none of them in `seen`."""
    # Sorting all keys is dear; among four times as many as wanted there are enough with different hashes.
    room = 4 * width
    if len(keys) > 2 * room:
        nearest = np.argpartition(keys, room)[:room]
        return np.asarray(nearest[_first_new(keys[nearest], hashes[nearest], width, seen)])
    return np.asarray(_first_new(keys, hashes, width, seen))


@njit(cache=True)
def _first_new(keys: Array, hashes: Words, width: int, seen: Words) -> Indices:
    """As `select`; what it takes is added to `seen`, a hash table whose size is a power of two."""
    last = np.uint64(seen.shape[0] - 1)
    kept = np.empty(min(width, len(keys)), np.int64)
    count = 0
    for index in np.argsort(keys):
        slot = hashes[index] & last
        # Open addressing: on to the next slot until the hash is found or a slot is empty, which is 0.
        while seen[slot] != 0 and seen[slot] != hashes[index]:
            slot = (slot + np.uint64(1)) & last
        if seen[slot] == 0:
            seen[slot] = hashes[index]
            kept[count] = index
            count += 1
            if count == len(kept):
                break
    return kept[:count]
