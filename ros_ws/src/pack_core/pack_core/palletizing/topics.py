"""Names and rates of the palletizing cell's recorded topics (see `pack_core.topics`)."""

from __future__ import annotations

BOXES, GRIPPER_STATE, TRUTH, CONTACTS = "/sim/boxes", "/gripper/state", "/sim/truth", "/sim/contacts"
EXPECTED_BOX, BOX_DETECTION = "/expected_box", "/box_detection"
BOARD_SIGHTING = "/board_sighting"
PALLET_SCAN, TABLE_SCAN = "/pallet_scanner/points", "/reorientation_table_scanner/points"
PICKING_SCAN, SECOND_SCAN = "/picking_table_scanner/points", "/second_pallet_scanner/points"
INFEED_STATE, PALLET_PLACES = "/infeed/state", "/pallets/places"
VISION_OVERLAY, PALLET_STATE, RESULT = "/vision/overlay", "/fsm/state", "/palletize/result"
LAYOUT_EVENTS = "/plan_layout/_service_event"

GRIPPER_RATE = 125.0
"""With every second tick."""
TRUTH_RATE = 50.0
"""With every fifth tick."""
