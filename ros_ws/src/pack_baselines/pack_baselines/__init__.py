"""What exists to be compared with: optimizers, planners and profiles that no shipped package imports."""
