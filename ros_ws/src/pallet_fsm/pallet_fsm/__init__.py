"""The palletizing machine: 21 states from a box on the picking table to its place on the pallet."""
