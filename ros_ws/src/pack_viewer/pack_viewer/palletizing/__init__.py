"""The palletizing cell's page."""
