"""Messages of the blocks cell."""
