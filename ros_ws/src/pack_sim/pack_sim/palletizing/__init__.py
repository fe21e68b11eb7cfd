"""The palletizing cell in MuJoCo: arm, surface gripper, boxes, overhead camera."""
