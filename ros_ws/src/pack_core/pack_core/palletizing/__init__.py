"""The palletizing cell: physical facts, grips, and its MuJoCo models."""
