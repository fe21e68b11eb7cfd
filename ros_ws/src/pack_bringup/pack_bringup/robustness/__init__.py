"""How a cell takes faults of its nodes, disturbances from outside, and hours of work."""
