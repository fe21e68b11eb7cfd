"""What the node `fsm` needs of ROS beside its shell."""
