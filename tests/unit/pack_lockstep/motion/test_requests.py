from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.motion.moves import UP, JointMove, Line, Mode, PoseMove, Retreat, Transfer
from pack_core.motion.moves import Path as MovePath
from pack_core.motion.target import MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Pose
from pack_lockstep.motion.benchmark import REQUESTS_PER_CELL, SETS
from pack_lockstep.motion.requests import MotionRequest, load_requests, request_file, save_requests
from pack_motion.reference.trajectory import JointState

X = Pose(np.array([0.1, 1.0 / 3.0, np.pi]))
START = JointState(np.arange(6) / 7.0, np.full(6, 1e-17), np.zeros(6))
TRANSFER = Transfer((Line(X, 0.3, mode=Mode.FAST),), Retreat(UP, (0.1, 0.9)), None, 0.9, 0.8)
TARGETS = (
    MotionTarget(
        3, TRANSFER, CarriedBox(X, np.full(3, 0.1)), (Obstacle("a", X, np.ones(3), is_moving=True),)
    ),
    MotionTarget(4, MovePath((PoseMove(X, stop=True), JointMove(START.q))), contacts=frozenset({"b", "a"})),
    MotionTarget(5, MovePath((Line(X),)), tolerance=ReachTolerance(0.001), is_checked=False, opening=0.05),
)


def requests() -> list[MotionRequest]:
    return [MotionRequest(f"request {target.id}", "blocks", START, target) for target in TARGETS]


def written(request: MotionRequest) -> str:
    """All of a request as text; a set's sequence is none of its properties."""
    target = request.target
    return f"{replace(request, target=replace(target, contacts=frozenset()))} {sorted(target.contacts)}"


def test_requests_come_back_from_a_file_to_the_last_bit(tmp_path: Path) -> None:
    first, second = tmp_path / "first.jsonl.gz", tmp_path / "second.jsonl.gz"
    save_requests(first, requests())
    back = load_requests(first)
    save_requests(second, back)
    assert first.read_bytes() == second.read_bytes()
    for found, given in zip(back, requests(), strict=True):
        np.testing.assert_array_equal(found.start.v, given.start.v)
        assert written(found) == written(given)


def test_a_file_that_is_none_of_requests_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "broken.jsonl.gz"
    path.write_text("no requests")
    for missing in (path, tmp_path / "missing.jsonl.gz"):
        with pytest.raises(ConfigError, match="is no file of motion requests"):
            load_requests(missing)


def test_the_published_sets_have_unique_names_and_a_hundred_of_each_kind() -> None:
    for name in SETS:
        found = load_requests(request_file(name))
        assert len({request.name for request in found}) == len(found)
        cells = [request.cell for request in found]
        assert all(cells.count(cell) == REQUESTS_PER_CELL for cell in set(cells))
