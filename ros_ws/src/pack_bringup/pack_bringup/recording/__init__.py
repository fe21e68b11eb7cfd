"""Recordings: written, copied and played."""
