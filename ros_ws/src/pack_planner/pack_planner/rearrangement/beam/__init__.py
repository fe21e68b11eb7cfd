"""The default planner: finite poses, collisions as bits, a beam search that a pattern database guides."""
