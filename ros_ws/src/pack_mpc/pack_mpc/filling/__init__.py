"""Filling a container: objects of a list are picked up, packed and let go, one after the other."""
