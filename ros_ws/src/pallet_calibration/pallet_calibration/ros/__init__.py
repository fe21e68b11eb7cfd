"""The calibration as an action of the node that has the arm."""
