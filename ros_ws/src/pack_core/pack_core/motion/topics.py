"""Names and rates of the topics of cells that move through motion targets (see `pack_core.topics`)."""

from __future__ import annotations

JOINT_STATES, SETPOINTS = "/joint_states", "/joint_setpoints"
GOAL_MARKERS = "/markers"
IMAGE, CAMERA_INFO = "/camera/image_raw", "/camera/camera_info"
MOTION_TARGET, MOTION_STATUS, MOTION_OBSTACLES = "/motion/target", "/motion/status", "/motion/obstacles"
MOTION_SEPARATION = "/motion/separation"
CONTROLLER = "/joint_trajectory_controller"
"""Where the wiring tables have the action and the state of a driver's joint trajectory controller; the node
`motion` finds them where its parameter `follow_joint_trajectory` says."""

JOINT_RATE = 250.0
"""Of measurements, and of setpoints and status, which follow them one to one."""
