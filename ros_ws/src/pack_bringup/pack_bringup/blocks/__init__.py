"""The blocks cell brought up: its job."""
