"""Motion of an arm: checked transfers, jerk-limited references, RMPflow around what gets in the way."""
