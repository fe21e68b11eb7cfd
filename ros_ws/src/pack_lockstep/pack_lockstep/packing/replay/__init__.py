"""Feeds recorded inputs to a core and compares its outputs with the recorded ones."""
