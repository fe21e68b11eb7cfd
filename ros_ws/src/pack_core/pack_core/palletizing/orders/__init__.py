"""Palletizing orders: what is to stand where on a pallet, and whether it can."""
