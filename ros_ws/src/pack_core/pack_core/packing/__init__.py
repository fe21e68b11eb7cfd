"""The packing cell: physical facts, scenes, objects, and its MuJoCo models."""
