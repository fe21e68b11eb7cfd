"""Pallet layouts that can be built: gaps between the boxes, and the side each box comes from."""
