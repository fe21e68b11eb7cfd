"""Poses of objects from motion capture, and from physics where no camera sees them."""
