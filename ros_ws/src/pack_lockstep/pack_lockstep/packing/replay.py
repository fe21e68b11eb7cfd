"""The nodes of the packing cell that can be replayed."""

from __future__ import annotations

from pack_core.errors import BagError
from pack_core.packing.goals import PackingMethod
from pack_evaluation.bag import Bag
from pack_lockstep.packing.lockstep_config import load_preset
from pack_lockstep.packing.perception_replay import replay_perception
from pack_lockstep.packing.planner_replay import replay_planner
from pack_lockstep.replay import Replay, RunConditions

USUAL_PRESET = "ideal"


def _perception(bag: Bag, run: RunConditions) -> Replay:
    return replay_perception(bag, load_preset(run.preset or USUAL_PRESET), run.calibration)


def _planner(bag: Bag, run: RunConditions) -> Replay:
    if run.seed is None:
        raise BagError(f"no run.yaml beside {bag.path} says the goal's seed; give --seed")
    method = PackingMethod.of(run.method) if run.method else PackingMethod.PACK_IT_IN
    return replay_planner(bag, seed=run.seed, method=method, preset=load_preset(run.preset or USUAL_PRESET))


REPLAYS = {"perception": _perception, "planner": _planner}
"""The nodes that can be replayed, by name."""
