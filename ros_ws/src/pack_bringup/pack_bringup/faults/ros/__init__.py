"""The part of the faults benchmark that listens to the cell and sends it goals."""
