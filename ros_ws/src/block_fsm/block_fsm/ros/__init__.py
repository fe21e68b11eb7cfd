"""What the node `fsm` of the blocks cell needs of ROS beside its shell."""
