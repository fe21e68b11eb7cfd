"""What listens to a running cell and injects faults into it."""
