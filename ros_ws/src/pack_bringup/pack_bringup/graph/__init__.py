"""Graphs of nodes: their files, processes, ROS domains and network."""
