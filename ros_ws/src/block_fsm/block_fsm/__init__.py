"""Executor of rearrangement plans."""
