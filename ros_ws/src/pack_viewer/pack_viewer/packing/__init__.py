"""The packing cell's page."""
