"""Names and rates of the blocks cell's recorded topics (see `pack_core.topics`)."""

from __future__ import annotations

TAGS, JAW_STATE, TRUTH = "/block_tags", "/gripper/state", "/sim/truth"
BLOCK_POSES, STATUS, RESULT = "/block_poses", "/rearrange/status", "/rearrange/result"
REARRANGEMENT_EVENTS = "/plan_rearrangement/_service_event"

JAW_RATE = 250.0 / 3.0
"""With every third tick."""
TRUTH_RATE = 50.0
"""With every fifth tick."""
