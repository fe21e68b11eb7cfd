"""What the node `planner` needs of ROS beside its shell."""
