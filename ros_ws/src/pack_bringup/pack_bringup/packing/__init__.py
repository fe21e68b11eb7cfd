"""The packing cell without ROS: presets, the log of a run, many scenes."""
