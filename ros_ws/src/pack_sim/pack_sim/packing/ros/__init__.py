"""What the node `sim` needs of ROS beside its shell."""
