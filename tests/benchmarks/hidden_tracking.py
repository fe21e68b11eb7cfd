"""How far off objects are that depth cameras do not see, and goals whose cameras are covered for 5 s.

    PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.hidden_tracking --seeds 240 241 242

Two lines for each scene: errors of the poses that physics alone predicts during the goal, as nothing of the
object was seen for a while; and the same of a goal during which all cameras are covered from the start of
INSERT on. At last those of all goals of each kind together.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from unittest.mock import patch

import numpy as np

from pack_core.packing.depth import DepthFrame
from pack_core.packing.goals import PackingMethod
from pack_core.rotations import Array
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.seen_objects import perception_errors
from pack_evaluation.track import Track
from pack_lockstep.packing.lockstep import Lockstep, Step
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_mpc.task.task import PackingOutcome
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.mocap.physics_estimator import Correction
from pack_sim.packing.scene_generator import generate_scene

LASTS = 5.0
"""How long the cameras are covered [s]."""
FROM = "INSERT"
"""Stage at whose start that begins."""


@dataclass(frozen=True)
class HiddenErrors:
    """Errors of poses that physics predicted: positions `(n,)` [mm], and angles `(n,)` [deg]."""

    positions: Array
    angles: Array

    @classmethod
    def of(cls, run: Run) -> HiddenErrors:
        """Those of all objects that were found."""
        estimate = {name: hidden(track.between(run.start, run.end)) for name, track in run.estimate.items()}
        errors = perception_errors(replace(run, estimate=estimate))
        assert errors is not None
        held = errors.held[:2]
        positions, angles = (
            np.concatenate(pair) for pair in zip((errors.positions, errors.angles), held, strict=True)
        )
        return cls(1e3 * positions, np.rad2deg(angles))

    def line(self) -> str:
        """In words."""
        if not self.positions.size:
            return "nothing was hidden"
        (mm, most_mm), (deg, most_deg) = (
            np.quantile(errors, [0.95, 1.0]) for errors in (self.positions, self.angles)
        )
        return (
            f"hidden in {self.positions.size} samples: 95 % within {mm:.1f} mm and {deg:.1f} deg, "
            f"all within {most_mm:.1f} mm and {most_deg:.1f} deg"
        )


def main() -> None:
    """Run each scene twice."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--preset", default="unknown")
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    options = parser.parse_args()
    found: dict[str, list[HiddenErrors]] = {"open": [], "covered": []}
    for seed in options.seeds:
        for kind, errors in found.items():
            lockstep = lockstep_of(options.preset, seed)
            outcome = lockstep.run() if kind == "open" else run_covered(lockstep)
            errors.append(HiddenErrors.of(lockstep.recorded()))
            end = f"{outcome.exit_reason.value} after {outcome.execution_time:.1f} s"
            say(f"{seed}, {kind}: {end}, {errors[-1].line()}")
    for kind, errors in found.items():
        say(f"all, {kind}: {together(errors).line()}")


def together(found: Sequence[HiddenErrors]) -> HiddenErrors:
    """The errors of several goals."""
    return HiddenErrors(*(np.concatenate([getattr(f, n) for f in found]) for n in ("positions", "angles")))


def hidden(track: Track) -> Track:
    """The samples of a track that physics predicted."""
    at = track.is_predicted
    return Track(track.times[at], track.p[at], track.q[at], track.sources[at])


def lockstep_of(preset: str, seed: int) -> Lockstep:
    """The cell of a preset with the scene of a seed."""
    given = load_preset(preset)
    cell, scene = given.packing_cell(), generate_scene(seed, given.packing_cell())
    return Lockstep(cell, scene, lockstep_config(given), PackingMethod.PACK_IT_IN, seed)


def run_covered(lockstep: Lockstep) -> PackingOutcome:
    """Run a goal during which the cameras are covered."""
    since, see = list[float](), DepthEstimator.see

    def see_or_not(estimator: DepthEstimator, frame: DepthFrame) -> Correction:
        is_covered = bool(since) and since[0] <= frame.time < since[0] + LASTS
        return see(estimator, replace(frame, images=np.zeros_like(frame.images)) if is_covered else frame)

    def note(step: Step) -> None:
        if not since and step.stage == FROM:
            since.append(step.time)

    with patch.object(DepthEstimator, "see", see_or_not):
        return lockstep.run(note)


def say(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
