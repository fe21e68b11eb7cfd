"""The ROS-free library under every cell; only `pack_core.ros` knows ROS."""
