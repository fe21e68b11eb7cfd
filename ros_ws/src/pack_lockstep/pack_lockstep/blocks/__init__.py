"""The blocks cell in lockstep, and its benchmark."""
