"""What the motion node shares of its ROS side with nobody else."""
