"""The cells composed in one process without ROS, on simulated time."""
