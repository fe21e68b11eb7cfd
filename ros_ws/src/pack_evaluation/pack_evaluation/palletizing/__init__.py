"""Runs of the palletizing cell: arrays, measures, plots, report."""
