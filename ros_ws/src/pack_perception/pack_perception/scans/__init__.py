"""Compares what the scanners measure with what must stand on the pallet and on table B."""
