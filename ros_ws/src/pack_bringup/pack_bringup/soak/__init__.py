"""A cell that pursues one goal after the other for hours, and what grows meanwhile."""
