"""Names and rates [Hz] of the packing cell's recorded topics (see `pack_core.topics`)."""

from __future__ import annotations

DESCRIPTION, SCENE, TRUTH, MARKERS = "/cell_description", "/scene", "/sim/truth", "/mocap/markers"
JOINT_STATES, SETPOINTS = "/joint_states", "/joint_torque_setpoints"
WRENCH, WRENCH_ZEROED = "/wrench", "/wrench/zeroed"
GRIPPER_STATE, MPC_STATUS, RESULT = "/gripper/state", "/mpc/status", "/pack_object/result"
FILL_PROGRESS, FILL_RESULT = "/fill_container/progress", "/fill_container/result"
SETTLED_SAMPLES = "/placement/settled_samples"
SIM_DESCRIPTION = "/sim/description"
DEPTH_CAMERAS = ("depth_1", "depth_2", "depth_3")
"""Frames of the depth cameras, as config/cells/packing.yaml lists them; a cell may have two only."""
DEPTH_IMAGES = tuple(f"/{name}/image_rect" for name in DEPTH_CAMERAS)
DEPTH_POINTS = tuple(f"/{name}/points" for name in DEPTH_CAMERAS)
DEPTH_INFOS = tuple(f"/{name}/camera_info" for name in DEPTH_CAMERAS)

JOINT_RATE = 500.0
"""Two messages for each tick."""
WRENCH_RATE = 250.0
"""With every tick."""
MARKER_RATE = 120.0
"""Default rate of motion capture frames, and rate of the scene estimated from them [Hz]."""
TRUTH_RATE = 125.0
"""With every second tick."""
GRIPPER_RATE = 50.0
"""With every fifth tick."""
DEPTH_RATE = 15.0
"""Default rate of the depth cameras' images."""
