"""What moves: an arm with its kinematics, its limits and its shape."""
