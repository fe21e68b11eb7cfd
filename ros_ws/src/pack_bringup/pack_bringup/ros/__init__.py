"""What commands and jobs need of ROS."""
