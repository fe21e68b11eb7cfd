"""Kinds of suction gripper: each module defines one as `GRIPPER`; its name is the `kind` in the cell."""
