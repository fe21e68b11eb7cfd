"""What the page asks of the packing cell."""
