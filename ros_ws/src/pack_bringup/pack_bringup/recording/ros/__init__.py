"""What recording needs of ROS beside its node."""
