"""In which order to move blocks, and how, so that they end up densely packed."""
