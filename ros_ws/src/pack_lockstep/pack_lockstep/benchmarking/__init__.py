"""What the benchmarks of all cells share: many trials on many processors, kept in a file as they end."""
