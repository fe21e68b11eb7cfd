"""Iterative LQR on joint torques, the optimizer of the paper."""
