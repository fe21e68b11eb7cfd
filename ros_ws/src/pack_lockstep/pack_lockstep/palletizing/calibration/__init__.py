"""The calibration of the palletizing cell, on simulated time: what it does, and what it finds."""
