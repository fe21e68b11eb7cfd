"""What the node `mpc` needs of ROS beside its shell."""
