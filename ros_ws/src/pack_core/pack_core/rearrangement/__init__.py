"""What the cells say about rearranging blocks on a table: problems and plans."""
