"""ROS shells of box vision."""
