"""The calibration of the palletizing cell: what the arm does for it, and what is found.

Everything here is told what is seen and says what the cell shall do, so that it runs in lockstep and in the
node `fsm` alike.
"""
