"""Placement planning: where an object may go in a partially filled container."""
