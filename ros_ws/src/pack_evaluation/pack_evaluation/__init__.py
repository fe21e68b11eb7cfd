"""From a recording to its measures, plots, video and report."""
