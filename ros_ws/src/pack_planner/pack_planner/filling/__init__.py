"""Where the objects of a list shall stand in a container, and in which order they come."""
