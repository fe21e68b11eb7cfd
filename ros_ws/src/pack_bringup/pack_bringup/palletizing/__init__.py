"""The palletizing cell brought up: its job and its order."""
