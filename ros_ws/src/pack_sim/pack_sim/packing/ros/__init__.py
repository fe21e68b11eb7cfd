"""Publishers of the packing cell's node `sim`."""
