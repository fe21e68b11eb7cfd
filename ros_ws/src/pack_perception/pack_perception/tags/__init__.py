"""Blocks seen by the tags on top of them."""
