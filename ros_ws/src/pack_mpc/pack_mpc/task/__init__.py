"""The task: stages of a goal, looks for what no camera has seen, and how a goal ends."""
