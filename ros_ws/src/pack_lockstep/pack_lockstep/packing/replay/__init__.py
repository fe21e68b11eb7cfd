"""Recorded inputs fed to a core, and what it answers compared with what was recorded."""
