"""The palletizing cell composed in one process, its benchmark, and its job."""
