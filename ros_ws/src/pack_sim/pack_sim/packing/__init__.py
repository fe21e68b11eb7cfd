"""Simulation of the packing cell: Panda, suction pump, container, motion capture."""
