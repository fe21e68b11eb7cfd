"""The palletizing cell in lockstep, and its benchmark."""
