"""MuJoCo models of the palletizing cell."""
