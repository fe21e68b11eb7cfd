"""Messages and parameters of the packing cell."""
