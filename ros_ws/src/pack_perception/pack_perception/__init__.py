"""Object poses: rigid-body fits to markers, and physics for what is hidden."""
