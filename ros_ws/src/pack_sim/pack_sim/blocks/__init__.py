"""The simulated blocks cell."""
