"""The packing cell: Panda, suction pump, container, motion capture."""
