"""What the node `sim` of the blocks cell needs of ROS beside its shell."""
