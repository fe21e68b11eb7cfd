"""What the thesis on the palletizing cell does in another way than the cell that ships."""
