"""Whether a move is clear of everything before it starts, and how high a transfer must go."""
