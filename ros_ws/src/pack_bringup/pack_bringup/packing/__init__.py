"""The packing cell brought up: its job, its goal, its presets as parameters."""
