"""What the page asks of the palletizing cell."""
