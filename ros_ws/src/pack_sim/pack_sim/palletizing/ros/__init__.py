"""What the node `pallet_sim` needs of ROS beside its shell."""
