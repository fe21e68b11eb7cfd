"""Poses of objects from motion capture, and from simulated physics where no camera sees them."""
