"""Runs of the blocks cell: arrays, measures, drawings, report."""
