"""What the simulators of all cells share of their ROS side."""
