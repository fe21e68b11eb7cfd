"""What the page asks of the blocks cell."""
