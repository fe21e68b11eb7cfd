"""The simulated cell: robot driver, gripper, objects and motion capture."""
