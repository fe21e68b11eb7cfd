"""Runs of the packing cell: arrays, measures, plots, report."""
