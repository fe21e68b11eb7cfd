"""What runs of the palletizing cell are measured by."""
