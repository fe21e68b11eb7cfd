"""What pictures need, whatever the cell: the room around it, surfaces, and a renderer without a screen."""
