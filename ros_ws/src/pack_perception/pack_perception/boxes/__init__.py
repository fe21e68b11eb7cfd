"""Box vision: the pose of a cardboard box in the picture of an overhead camera."""
