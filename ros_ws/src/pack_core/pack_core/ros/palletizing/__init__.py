"""Messages of the palletizing cell."""
