"""The parts whose tests are checked by mutation: which modules are mutated, and which tests must notice."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Part:
    """Modules and the unit tests that exercise them.

    Attributes:
        modules: below `ros_ws/src`.
        tests: below `tests/unit`, the quickest first, since the first failure ends a run.
    """

    modules: tuple[str, ...]
    tests: tuple[str, ...]


PARTS = {
    "norms": Part(("pack_mpc/pack_mpc/cost/norms.py",), ("pack_mpc/cost/test_norms.py",)),
    "direction": Part(
        ("pack_planner/pack_planner/layout/insertion_direction.py",),
        ("pack_planner/layout/test_insertion_direction.py",),
    ),
    "verifier": Part(
        ("pack_evaluation/pack_evaluation/blocks/plan_verifier.py",),
        ("pack_evaluation/blocks/test_plan_verifier.py",),
    ),
    "stages": Part(("pack_mpc/pack_mpc/task/stages.py",), ("pack_mpc/task/test_stages.py",)),
    "transitions": Part(
        ("pallet_fsm/pallet_fsm/transitions.py", "pallet_fsm/pallet_fsm/machine.py"),
        ("pallet_fsm/test_transitions.py",),
    ),
    "follower": Part(
        ("pack_sim/pack_sim/setpoint_follower.py", "pack_core/pack_core/joints.py"),
        ("pack_core/test_joints.py", "pack_sim/test_setpoint_follower.py"),
    ),
    "separator": Part(
        (
            "pack_planner/pack_planner/layout/pallet_separator.py",
            "pack_planner/pack_planner/layout/axis_program.py",
        ),
        (
            "pack_planner/layout/test_least_distance.py",
            "pack_planner/layout/test_pallet_separator.py",
            "pack_planner/layout/test_adaptive_gap.py",
        ),
    ),
    "fit": Part(
        ("pack_perception/pack_perception/mocap/rigid_body_fit.py",),
        ("pack_perception/mocap/test_rigid_body_fit.py", "pack_perception/mocap/test_axis_fit.py"),
    ),
    "estimator": Part(
        ("pack_perception/pack_perception/mocap/physics_estimator.py",),
        (
            "pack_perception/mocap/test_correction_law.py",
            "pack_perception/mocap/test_estimator_times.py",
            "pack_perception/mocap/test_physics_estimator.py",
        ),
    ),
}
