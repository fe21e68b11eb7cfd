"""What the packing cell has recorded beside its bag."""
