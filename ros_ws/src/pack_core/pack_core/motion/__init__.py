"""What simulators, motion and state machines say to each other about motion."""
