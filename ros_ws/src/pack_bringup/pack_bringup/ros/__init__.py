"""What bringup does in the ROS graph besides its nodes."""
