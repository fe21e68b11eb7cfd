"""ROS messages of the node `planner`."""
